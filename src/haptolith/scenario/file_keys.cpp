#include "haptolith/scenario/file_keys.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <numbers>

namespace haptolith {

namespace {

/// A unit of keys that parameters do not have.
struct KeyUnit {
  std::string_view name;
  double in_si;
};

constexpr std::array kKeyUnits{
    KeyUnit{"mm", 1e-3},
    KeyUnit{"ms", 1e-3},
    KeyUnit{"deg", std::numbers::pi / 180},
};

}  // namespace

InvalidParameter inUnitOfKey(const InvalidParameter& error, std::string_view key) {
  if (key == error.key()) {
    return error;
  }
  const std::string_view suffix = key.substr(key.rfind('_') + 1);
  for (const KeyUnit& unit : kKeyUnits) {
    if (unit.name == suffix && error.outOfRange()) {
      const auto& [value, range] = *error.outOfRange();
      return {std::string(key), fmt::format("{}", inUnits(value, unit.in_si)),
              fmt::format("{} ({})", range.in(unit.in_si).text(), unit.name)};
    }
  }
  return {std::string(key), error.value(), fmt::format("{} ({})", error.valid(), error.key())};
}

std::string anyOf(const std::vector<std::string_view>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    text += fmt::format("{}{}", i == 0 ? "" : i + 1 == words.size() ? " or " : ", ", words[i]);
  }
  return text;
}

std::string_view currentWord(std::string_view word) noexcept {
  constexpr std::string_view kFormer = "pairwise";  // until 0.1
  const auto same_letter = [](unsigned char a, unsigned char b) { return std::tolower(a) == b; };
  return std::ranges::equal(word, kFormer, same_letter) ? "contact" : word;
}

}  // namespace haptolith
