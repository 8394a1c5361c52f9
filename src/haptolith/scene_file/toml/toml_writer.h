#pragma once

#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>

#include "haptolith/scene_file/toml/file_keys.h"

namespace haptolith {

/// The shortest text that TOML reads back as this number exactly.
[[nodiscard]] std::string tomlNumber(double value);

/// Quoted, and escaped where it has to be.
[[nodiscard]] std::string tomlText(std::string_view text);

/// The line of a TOML file that gives `key` its value in `target`: "width_mm = 126\n". Empty for a key that is only
/// read, and for a value that is left out.
template <class Target>
[[nodiscard]] std::string tomlLine(const FileKey<Target>& key, const Target& target) {
  using Key = FileKey<Target>;
  const auto text = [&](const auto& value) -> std::string {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, typename Key::ItemsValue>) {
      return "";  // only read
    } else {
      if (value.get == nullptr) {
        return "";
      }
      const auto now = value.get(target);
      if constexpr (std::is_same_v<Value, typename Key::NumberValue>) {
        return std::isnan(now) ? "" : tomlNumber(now);
      } else if constexpr (std::is_same_v<Value, typename Key::CountValue>) {
        return fmt::format("{}", now);
      } else if constexpr (std::is_same_v<Value, typename Key::VectorValue>) {
        return now.hasNaN()
                   ? ""
                   : fmt::format("[{}, {}, {}]", tomlNumber(now.x()), tomlNumber(now.y()), tomlNumber(now.z()));
      } else if constexpr (std::is_same_v<Value, typename Key::IntervalValue>) {
        return now ? fmt::format("[{}, {}]", tomlNumber(now->lowest), tomlNumber(now->highest)) : "";
      } else if constexpr (std::is_same_v<Value, typename Key::SwitchValue>) {
        return now ? "true" : "false";
      } else if constexpr (std::is_same_v<Value, typename Key::PathValue>) {
        return now.empty() ? "" : tomlText(now.string());
      } else {
        return now.empty() ? "" : tomlText(now);
      }
    }
  };
  const std::string value = std::visit(text, key.value);
  return value.empty() ? "" : fmt::format("{} = {}\n", key.name, value);
}

}  // namespace haptolith
