#pragma once

#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "haptolith/core/error.h"
#include "haptolith/core/vec.h"
#include "haptolith/scene_file/toml/file_keys.h"
#include "haptolith/scene_file/toml/key_words.h"

namespace haptolith {

/// Instead of a number that may be left out.
inline constexpr double kLeftOut = std::numeric_limits<double>::quiet_NaN();

/// The unit of a key's name, and the one of SI in which its number is held.
struct KeyUnit {
  double in_si = 1;
  std::string_view name = {}, si_name = {};

  /// "width_m" for "width_mm".
  [[nodiscard]] std::string parameter(std::string_view key) const {
    return std::string(key.substr(0, key.size() - name.size())).append(si_name);
  }
};
inline constexpr KeyUnit kMillimetres{1e-3, "mm", "m"};
inline constexpr KeyUnit kMilliseconds{1e-3, "ms", "s"};
inline constexpr KeyUnit kDegrees{std::numbers::pi / 180, "deg", "rad"};

/// Makes the keys of a table that set and get a member of a part of a Target. Ranges are in SI. A member that is
/// optional may be left out.
template <class Target, class PartOf>
class MemberKeys {
 public:
  using Key = FileKey<Target>;

  /// @param part_of  gives the part of a Target, const or not
  MemberKeys(std::string_view table, PartOf part_of) : table_(table), part_of_(part_of) {}

  [[nodiscard]] Key number(std::string_view name, auto member, const Range& valid, const KeyUnit& unit,
                           std::string_view meaning) const {
    return {table_, name, unit.parameter(name),
            typename Key::NumberValue{valid.in(unit.in_si),
                                      [part = part_of_, member, unit](Target& target, double value) {
                                        part(target).*member = value * unit.in_si;
                                      },
                                      [part = part_of_, member, unit](const Target& target) {
                                        const std::optional<double> value = part(target).*member;
                                        return inUnits(value.value_or(kLeftOut), unit.in_si);
                                      }},
            meaning};
  }
  [[nodiscard]] Key number(std::string_view name, auto member, const Range& valid, std::string_view meaning) const {
    return number(name, member, valid, KeyUnit(), meaning);
  }

  [[nodiscard]] Key vector(std::string_view name, auto member, const Range& valid, const KeyUnit& unit,
                           std::string_view meaning) const {
    return {table_, name, unit.parameter(name),
            typename Key::VectorValue{valid.in(unit.in_si),
                                      [part = part_of_, member, unit](Target& target, const Vec3& value) {
                                        part(target).*member = value * unit.in_si;
                                      },
                                      [part = part_of_, member, unit](const Target& target) -> Vec3 {
                                        const std::optional<Vec3> value = part(target).*member;
                                        return value.value_or(Vec3::Constant(kLeftOut)).unaryExpr([unit](double x) {
                                          return inUnits(x, unit.in_si);
                                        });
                                      }},
            meaning};
  }

  [[nodiscard]] Key interval(std::string_view name, auto member, const Range& valid, std::string_view meaning) const {
    return {table_, name, std::string(name),
            typename Key::IntervalValue{valid, setter<const Range&>(member), getter<std::optional<Range>>(member)},
            meaning};
  }

  /// A key of whole numbers of any type.
  [[nodiscard]] Key count(std::string_view name, auto member, const Range& valid, std::string_view meaning) const {
    return {table_, name, std::string(name),
            typename Key::CountValue{valid, setter<std::int64_t>(member), getter<std::int64_t>(member)}, meaning};
  }

  [[nodiscard]] Key onOrOff(std::string_view name, auto member, std::string_view meaning) const {
    return {table_, name, std::string(name), typename Key::SwitchValue{setter<bool>(member), getter<bool>(member)},
            meaning};
  }

  [[nodiscard]] Key text(std::string_view name, auto member, std::string_view meaning,
                         TextSize size = TextSize::kLine) const {
    return {table_, name, "",
            typename Key::TextValue{setter<std::string_view>(member), getter<std::string_view>(member), size}, meaning};
  }

  /// @param words  lives as long as the program
  template <class Words>
  [[nodiscard]] Key word(std::string_view name, auto member, const Words& words, std::string_view meaning) const {
    return {table_, name, "",
            typename Key::WordValue{namesOf(words),
                                    [part = part_of_, member, &words](Target& target, std::string_view value) {
                                      part(target).*member = valueOf(words, value);
                                    },
                                    [part = part_of_, member, &words](const Target& target) {
                                      return wordFor(words, part(target).*member);
                                    }},
            meaning};
  }

 private:
  template <class Value>
  auto setter(auto member) const {
    return [part = part_of_, member](Target& target, Value value) {
      auto& to = part(target).*member;
      to = static_cast<std::remove_reference_t<decltype(to)>>(value);
    };
  }
  template <class Value>
  auto getter(auto member) const {
    return [part = part_of_, member](const Target& target) { return static_cast<Value>(part(target).*member); };
  }

  std::string_view table_;
  PartOf part_of_;
};

/// The part of `target` at the end of a path of members. An optional on the way is filled when it is to be set.
auto& partAt(auto& target) {
  return target;
}
template <class Target, class Member>
auto& partAt(Target& target, Member member, auto... path) {
  auto& part = target.*member;
  if constexpr (!requires { part.value(); }) {
    return partAt(part, path...);
  } else if constexpr (std::is_const_v<Target>) {
    return partAt(*part, path...);
  } else {
    return partAt(part ? *part : part.emplace(), path...);
  }
}

/// @param path  members that lead from a Target to the part, one after the other: &SceneFile::bed,
/// &BedParameters::stones
template <class Target>
[[nodiscard]] auto memberKeys(std::string_view table, auto... path) {
  const auto part_of = [path...](auto& target) -> auto& {
    return partAt(target, path...);
  };
  return MemberKeys<Target, decltype(part_of)>(table, part_of);
}

}  // namespace haptolith
