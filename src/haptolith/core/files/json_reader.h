#pragma once

#include <nlohmann/json_fwd.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "haptolith/core/error.h"

namespace haptolith {

/// A value of a JSON text with its path, "hand.glb: meshes[2].mode", which is the key of every refusal. All readers
/// throw InvalidParameter for a value of another type or out of range, or that is missing.
class JsonValue {
 public:
  using Json = std::shared_ptr<const nlohmann::json>;
  static constexpr std::size_t kAnySize = std::numeric_limits<std::size_t>::max();

  /// @param path  empty for a message, whose keys are named without it.
  JsonValue(Json json, std::string path, bool is_root = false)
      : json_(std::move(json)), path_(std::move(path)), is_root_(is_root) {}

  [[nodiscard]] const nlohmann::json& json() const noexcept { return *json_; }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

  [[nodiscard]] bool has(std::string_view key) const;
  [[nodiscard]] JsonValue at(std::string_view key) const;
  [[nodiscard]] std::optional<JsonValue> find(std::string_view key) const;
  /// Keys and values of an object, in alphabetical order.
  [[nodiscard]] std::vector<std::pair<std::string, JsonValue>> members() const;
  /// Refuses every key that neither at(), find() nor members() of this object has returned.
  void refuseOtherKeys() const;

  [[nodiscard]] std::size_t size() const noexcept;  ///< length of a list; 0 for any other value
  [[nodiscard]] JsonValue at(std::size_t index) const;
  [[nodiscard]] std::vector<JsonValue> list(std::size_t min_size = 0, std::size_t max_size = kAnySize) const;

  [[nodiscard]] double number(const Range& valid) const;
  [[nodiscard]] std::uint64_t whole(std::uint64_t max) const;  ///< a whole number from 0 to `max`
  [[nodiscard]] const std::string& text() const;
  [[nodiscard]] bool flag() const;
  template <std::size_t kCount>
  [[nodiscard]] std::array<double, kCount> numbers(const Range& valid) const {
    std::array<double, kCount> values{};
    if (size() != kCount) {
      refuse(given(), std::to_string(kCount) + " numbers");
    }
    for (std::size_t i = 0; i < kCount; ++i) {
      values[i] = at(i).number(valid);
    }
    return values;
  }

  /// The value as a refusal repeats it: short, and without control characters.
  [[nodiscard]] std::string given() const;
  [[noreturn]] void refuse(const std::string& given, const std::string& valid) const;

 private:
  void require(bool has_type, const char* type) const;
  void requireList(std::size_t min_size, std::size_t max_size) const;
  [[nodiscard]] std::string pathOf(std::string_view key) const;

  Json json_;
  std::string path_;
  bool is_root_;
  mutable std::vector<const nlohmann::json*> read_;  ///< members that have been returned
};

struct JsonLimits {
  int depth = 32;  ///< limit of nested brackets
  std::size_t values = JsonValue::kAnySize;
};

/// Parses a JSON object.
/// @param name  of the file, for refusals; empty for a message.
/// @param kind  what the text should be, for refusals: "glTF 2.0".
/// @throws InvalidParameter if the text is something else or exceeds the limits.
[[nodiscard]] JsonValue parseJson(std::string_view text, const std::string& name, const std::string& kind,
                                  const JsonLimits& limits = {});

}  // namespace haptolith
