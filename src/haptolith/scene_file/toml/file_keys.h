#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/vec.h"

namespace haptolith {

/// Instead of get(): a way to choose what other keys write by its numbers.
inline constexpr std::nullptr_t kOnlyRead = nullptr;

/// "P3" or 0.835; a number has the text with which it would be written.
struct TextOrNumber {
  std::string text = {};
  std::optional<double> number = {};
};

/// Length limit of a text: a line such as a title, the path of a file, or paragraphs for a page.
enum class TextSize { kLine, kPath, kPage };

/// In bytes of UTF-8.
[[nodiscard]] constexpr std::size_t mostBytes(TextSize size) noexcept {
  return size == TextSize::kLine ? 200 : size == TextSize::kPath ? 4096 : 20'000;
}

/// One key of a TOML file that is read into a Target and written from it: its place, valid values, its
/// target, and its meaning. A set() may throw InvalidParameter. Every key has a way to be written, or kOnlyRead.
template <class Target>
struct FileKey {
  struct NumberValue {
    Range valid;  ///< in the unit of the key's name
    std::function<void(Target&, double)> set;
    std::function<double(const Target&)> get;  ///< NaN: left out
  };
  struct CountValue {
    Range valid;
    std::function<void(Target&, std::int64_t)> set;
    std::function<std::int64_t(const Target&)> get;
  };
  struct VectorValue {
    Range valid;  ///< range of each of the three numbers
    std::function<void(Target&, const Vec3&)> set;
    std::function<Vec3(const Target&)> get;
  };
  struct IntervalValue {
    Range valid;  ///< range of both ends
    std::function<void(Target&, const Range&)> set;
    std::function<std::optional<Range>(const Target&)> get;  ///< none: left out
  };
  struct SwitchValue {
    std::function<void(Target&, bool)> set;
    std::function<bool(const Target&)> get;
  };
  struct WordValue {
    std::vector<std::string_view> valid;
    std::function<void(Target&, std::string_view)> set;
    std::function<std::string_view(const Target&)> get;
  };
  struct TextValue {
    std::function<void(Target&, std::string_view)> set;
    std::function<std::string_view(const Target&)> get;  ///< empty: left out
    TextSize size = TextSize::kLine;
  };
  /// Bytes as text, of any length, as programs write them.
  struct DataValue {
    std::function<void(Target&, std::string_view)> set;
    std::function<std::string(const Target&)> get;  ///< empty: left out
  };
  /// Texts or numbers, several or one alone; what is more to say about them, set() checks. Only read.
  struct ItemsValue {
    std::string_view valid;
    std::function<void(Target&, const std::vector<TextOrNumber>&)> set;
    std::nullptr_t get = kOnlyRead;
  };
  /// The name of another file, relative to the one that names it.
  struct PathValue {
    std::function<void(Target&, const std::filesystem::path&)> set;
    std::function<std::filesystem::path(const Target&)> get;  ///< empty: left out
  };

  std::string_view table;  ///< "soil"; empty at the top of the file
  std::string_view name;
  std::string parameter;  ///< name in validate(), in SI: "width_m" for width_mm
  std::variant<NumberValue, CountValue, VectorValue, IntervalValue, SwitchValue, WordValue, TextValue, DataValue,
               ItemsValue, PathValue>
      value;
  std::string_view meaning;  ///< one sentence for the document
};

/// "P1, P2 or P3".
[[nodiscard]] std::string anyOf(const std::vector<std::string_view>& words);

/// For example "14 to 100000", "three numbers, each > 0", "count, packed or rain", "true or false".
template <class Target>
[[nodiscard]] std::string validText(const FileKey<Target>& key) {
  using Key = FileKey<Target>;
  const auto text = [](const auto& value) -> std::string {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, typename Key::NumberValue>) {
      return value.valid.text();
    } else if constexpr (std::is_same_v<Value, typename Key::CountValue>) {
      return fmt::format("a whole number, {}", value.valid.text());
    } else if constexpr (std::is_same_v<Value, typename Key::VectorValue>) {
      return fmt::format("three numbers, each {}", value.valid.text());
    } else if constexpr (std::is_same_v<Value, typename Key::IntervalValue>) {
      return fmt::format("two numbers, each {}, the smaller first", value.valid.text());
    } else if constexpr (std::is_same_v<Value, typename Key::SwitchValue>) {
      return "true or false";
    } else if constexpr (std::is_same_v<Value, typename Key::WordValue>) {
      return anyOf(value.valid);
    } else if constexpr (std::is_same_v<Value, typename Key::TextValue>) {
      return value.size == TextSize::kLine ? "a line of text" : "text";
    } else if constexpr (std::is_same_v<Value, typename Key::DataValue>) {
      return "data written by the program";
    } else if constexpr (std::is_same_v<Value, typename Key::ItemsValue>) {
      return std::string(value.valid);
    } else {
      return "a file";
    }
  };
  return std::visit(text, key.value);
}

}  // namespace haptolith
