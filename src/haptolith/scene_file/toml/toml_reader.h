#pragma once

#include <toml++/toml.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/vec.h"
#include "haptolith/scene_file/toml/file_keys.h"
#include "haptolith/scene_file/toml/toml_error.h"

namespace haptolith {

/// The words in which a reader speaks of its file.
struct FileKind {
  std::string_view name;         ///< "scene"
  std::string_view example_key;  ///< "title"
  std::string_view document;     ///< "docs/reference/scenes.md"
  std::string_view left_out;     ///< text for absent keys: "left out, so as in icra2021"
};

/// Place of a key of any type.
struct KeyName {
  std::string_view table, name;
};

template <class Target>
[[nodiscard]] std::vector<KeyName> keyNames(std::span<const FileKey<Target>> keys) {
  std::vector<KeyName> names;
  for (const FileKey<Target>& key : keys) {
    names.push_back({key.table, key.name});
  }
  return names;
}

/// Two keys of a table of which a file may have one.
struct RivalKeys {
  std::string_view table, one, other;
};

/// A TOML file on its way into the program, key by key. Everything that is wrong with it is thrown as a TomlError
/// with file, line, key, value and what would be valid.
class TomlReader {
 public:
  /// @throws TomlError when there is no such file or it is no TOML; Failure when it cannot be read.
  TomlReader(const std::filesystem::path& path, const FileKind& kind);

  /// As above for a text that is not a file, or not yet; messages call it `path`.
  TomlReader(const std::filesystem::path& path, std::string_view text, const FileKind& kind);

  /// Nothing but overrides.
  TomlReader(std::span<const std::string> overrides, const FileKind& kind);

  /// Overrides keys of the file: each is "table.key=value", or "key=value" at the top. The value is TOML, otherwise
  /// text. A key of the file that is a rival of one of these is ignored. @throws TomlError.
  void takeOverrides(std::span<const std::string> overrides, std::span<const RivalKeys> rivals);

  /// Leaves out the keys of a table, or of the file itself where that is empty, that `which` chooses and no override
  /// has set.
  void passOver(std::string_view table, const std::function<bool(std::string_view key)>& which);

  /// Null when the file does not have it.
  [[nodiscard]] const toml::node* find(std::string_view table, std::string_view name) const;

  /// As above, without what a part has from its file.
  [[nodiscard]] const toml::node* findOwn(std::string_view table, std::string_view name) const;

  /// Whether there are only overrides.
  [[nodiscard]] bool isChange() const noexcept { return is_change_; }

  [[nodiscard]] bool has(std::string_view table) const { return table_->contains(table); }
  [[nodiscard]] bool has(std::string_view table, std::string_view name) const { return find(table, name) != nullptr; }

  /// A reader for each of the tables [[name]], which reads their keys as those of a separate file.
  /// @throws TomlError when there is something else of that name.
  [[nodiscard]] std::vector<TomlReader> parts(std::string_view name) const;

  /// As above; the keys of [home] stand at the top of each of these tables. Absent keys have the values of this file's
  /// tables. Each has a `name`, by which overrides know it.
  [[nodiscard]] std::vector<TomlReader> parts(std::string_view name, std::string_view home) const;

  /// Lets one source decide on the keys of a table that belong together: of those of this part and those that it has
  /// from the file, the ones that the others would contradict are passed over. Overrides decide first, then the part.
  void decideTogether(std::string_view table, const std::function<bool(std::string_view key)>& belongs);

  /// First line of this reader's table; 1 for a complete file.
  [[nodiscard]] int line() const;

  /// The nearest of the known keys is suggested.
  void refuseUnknownKeys(std::span<const KeyName> known) const;

  void refuseBoth(std::string_view table, std::string_view one, std::string_view other) const;
  void refuseBoth(const RivalKeys& rivals) const { refuseBoth(rivals.table, rivals.one, rivals.other); }

  void require(std::string_view table, std::string_view name) const;

  /// Line of a key in the file.
  [[nodiscard]] int lineOf(std::string_view table, std::string_view name) const;

  /// "file:line: message", or which override it is, of a key that is there.
  [[nodiscard]] std::string located(const KeyName& key, std::string_view message) const {
    return located(*find(key.table, key.name), message);
  }

  [[noreturn]] void refuse(int line, std::string_view message) const;

  /// Refuses the value of a key in the file.
  [[noreturn]] void refuseKey(const KeyName& key, std::string_view valid) const;

  /// Sets the target of `key`, if the file has it.
  template <class Target>
  void apply(const FileKey<Target>& key, Target& target) const;

  /// Runs a check of values against each other; its error names an SI parameter, for which the key of `table` is looked
  /// up in `keys`.
  template <class Target, class Check>
  void check(std::span<const FileKey<Target>> keys, std::string_view table, Check check) const;

 private:
  /// A value in the file, where it stands and what would be valid there.
  struct Place {
    KeyName key;
    const toml::node& node;
    std::string valid;
  };

  TomlReader(const TomlReader& whole, std::string_view name, toml::table& part);

  [[nodiscard]] toml::table* tableOf(std::string_view table) const;
  [[nodiscard]] toml::table& partNamed(std::string_view list, std::string_view name);

  [[noreturn]] void refuseFile(std::string_view why) const;
  [[noreturn]] void refuseValue(const Place& place) const;
  [[noreturn]] void refuseLeftOut(const KeyName& key, std::string_view value, std::string_view valid) const;
  void refuseUnknownKeysIn(std::string_view table, const toml::node& node, std::span<const KeyName> known) const;
  [[noreturn]] void refuseUnknown(const KeyName& key, const toml::node& node, std::span<const KeyName> known) const;
  [[nodiscard]] std::string suggestion(const KeyName& key, std::span<const KeyName> known) const;

  [[nodiscard]] std::string located(int line, std::string_view message) const;
  [[nodiscard]] bool isOverride(const toml::node& node) const;
  [[nodiscard]] std::string located(const toml::node& node, std::string_view message) const;
  [[nodiscard]] std::string fullName(const KeyName& key) const;
  [[nodiscard]] std::string readText() const;
  [[nodiscard]] toml::table parse(std::string_view text) const;

  [[nodiscard]] double number(const Place& place, const Range& range) const;
  [[nodiscard]] std::int64_t count(const Place& place, const Range& range) const;
  [[nodiscard]] Vec3 vector(const Place& place, const Range& range) const;
  [[nodiscard]] Range interval(const Place& place, const Range& range) const;
  [[nodiscard]] bool onOrOff(const Place& place) const;
  [[nodiscard]] std::string_view word(const Place& place, const std::vector<std::string_view>& words) const;
  [[nodiscard]] std::string text(const Place& place, TextSize size) const;
  [[nodiscard]] std::string_view data(const Place& place) const;
  void requireSize(const Place& place, std::string_view text, TextSize size) const;
  [[nodiscard]] std::vector<TextOrNumber> items(const Place& place) const;
  [[nodiscard]] std::filesystem::path besideFile(const Place& place) const;

  std::filesystem::path path_;
  FileKind kind_;
  std::string part_;                     // "block" in a reader of [[block]]; empty for the whole file
  std::string home_;                     // table whose keys stand at the top
  std::shared_ptr<toml::table> behind_;  // the file of a part that has keys from it
  std::vector<std::pair<std::string, std::string>> passed_;  // of its keys, those that the part does not have from it
  std::shared_ptr<toml::table> table_;                       // or a part of what it points into
  bool is_change_ = false;
};

template <class Target>
void TomlReader::apply(const FileKey<Target>& key, Target& target) const {
  using Key = FileKey<Target>;
  const toml::node* node = find(key.table, key.name);
  if (node == nullptr) {
    return;
  }
  const Place place{{key.table, key.name}, *node, validText(key)};
  const auto set = [&](const auto& value) {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, typename Key::NumberValue>) {
      value.set(target, number(place, value.valid));
    } else if constexpr (std::is_same_v<Value, typename Key::CountValue>) {
      value.set(target, count(place, value.valid));
    } else if constexpr (std::is_same_v<Value, typename Key::VectorValue>) {
      value.set(target, vector(place, value.valid));
    } else if constexpr (std::is_same_v<Value, typename Key::IntervalValue>) {
      value.set(target, interval(place, value.valid));
    } else if constexpr (std::is_same_v<Value, typename Key::SwitchValue>) {
      value.set(target, onOrOff(place));
    } else if constexpr (std::is_same_v<Value, typename Key::WordValue>) {
      value.set(target, word(place, value.valid));
    } else if constexpr (std::is_same_v<Value, typename Key::TextValue>) {
      value.set(target, text(place, value.size));
    } else if constexpr (std::is_same_v<Value, typename Key::DataValue>) {
      value.set(target, data(place));
    } else if constexpr (std::is_same_v<Value, typename Key::ItemsValue>) {
      value.set(target, items(place));
    } else {
      value.set(target, besideFile(place));
    }
  };
  try {
    std::visit(set, key.value);
  } catch (const TomlError&) {
    throw;
  } catch (const InvalidParameter& error) {
    refuseValue({place.key, *node, error.valid()});
  }
}

template <class Target, class Check>
void TomlReader::check(std::span<const FileKey<Target>> keys, std::string_view table, Check check) const {
  try {
    check();
  } catch (const InvalidParameter& error) {
    for (const FileKey<Target>& key : keys) {
      if (key.table != table || key.parameter != error.key()) {
        continue;
      }
      const InvalidParameter own = inUnitOfKey(error, key.name);
      if (const toml::node* node = find(key.table, key.name)) {
        refuseValue({{key.table, key.name}, *node, own.valid()});
      }
      refuseLeftOut({key.table, key.name}, own.value(), own.valid());
    }
    refuseFile(error.what());
  }
}

}  // namespace haptolith
