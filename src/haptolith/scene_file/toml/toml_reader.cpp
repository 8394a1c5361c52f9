#include "haptolith/scene_file/toml/toml_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>

#include "haptolith/core/files/input_file.h"
#include "haptolith/core/files/moved_file.h"
#include "haptolith/core/former_names.h"
#include "haptolith/core/nearest_word.h"
#include "haptolith/core/plain_text.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestFileBytes = 1 << 20;  // a scene is about 2 kB; more is the wrong file

int lineOfNode(const toml::node& node) {
  return static_cast<int>(node.source().begin.line);
}

/// The value as a person would write it. toml++ alone gives 17 digits: 0.69999999999999996 for 0.7.
std::string written(const toml::node& node) {
  if (node.is_table()) {
    return "a table";
  }
  if (node.is_floating_point()) {
    return fmt::format("{:#}", node.ref<double>());
  }
  std::ostringstream out;
  if (const toml::array* array = node.as_array(); array != nullptr && !array->empty()) {
    for (const toml::node& element : *array) {
      out << (&element == array->get(0) ? "[ " : ", ") << written(element);
    }
    out << " ]";
  } else {
    out << toml::toml_formatter{node};
  }
  return out.str();
}

/// On one line and shortened.
std::string quote(const toml::node& node) {
  if (const toml::value<std::string>* text = node.as_string()) {
    return inQuotes(text->get());
  }
  std::string text = written(node);
  std::ranges::replace(text, '\n', ' ');
  return shortened(text);
}

bool knowsTable(std::span<const KeyName> known, std::string_view name) {
  return !name.empty() && std::ranges::any_of(known, [&](const KeyName& key) { return key.table == name; });
}

bool knowsKey(std::span<const KeyName> known, std::string_view table, std::string_view name) {
  return std::ranges::any_of(known, [&](const KeyName& key) { return key.table == table && key.name == name; });
}

/// As an override names it.
std::string dotted(const KeyName& key) {
  return key.table.empty() ? std::string(key.name) : fmt::format("{}.{}", key.table, key.name);
}

/// Renames the keys of `table` that earlier versions called otherwise; a key whose current name is also there stays.
/// @param name  of the table, last part
/// @param current  currentName() or currentNameReported()
void useCurrentKeys(toml::table& table, std::string_view name,
                    const std::function<std::string_view(NameKind, std::string_view)>& current) {
  std::vector<std::pair<std::string, std::string>> renamed;
  for (auto&& [key, node] : table) {
    if (toml::table* part = node.as_table()) {
      useCurrentKeys(*part, key.str(), current);
    } else if (toml::array* parts = node.as_array()) {
      for (toml::node& element : *parts) {
        if (toml::table* one = element.as_table()) {
          useCurrentKeys(*one, key.str(), current);
        }
      }
    }
    const std::string full = dotted({name, key.str()});
    const std::string_view now = current(NameKind::kKey, full);
    if (now != full) {
      renamed.emplace_back(key.str(), now.substr(now.rfind('.') + 1));
    }
  }
  for (const auto& [former, now] : renamed) {
    if (!table.contains(now)) {
      table.get(former)->visit([&, to = now](auto& value) { table.insert(to, std::move(value)); });  // and its source
      table.erase(former);
    }
  }
}

}  // namespace

// --- the file ---

TomlReader::TomlReader(const fs::path& path, const FileKind& kind) : path_(currentPath(path)), kind_(kind) {
  table_ = std::make_shared<toml::table>(parse(readText()));
  useCurrentKeys(*table_, "", currentNameReported);
}

TomlReader::TomlReader(const fs::path& path, std::string_view text, const FileKind& kind) : path_(path), kind_(kind) {
  table_ = std::make_shared<toml::table>(parse(text));
  useCurrentKeys(*table_, "", currentName);  // recordings report no former names
}

TomlReader::TomlReader(const TomlReader& whole, std::string_view name, toml::table& part)
    : path_(whole.path_),
      kind_(whole.kind_),
      part_(whole.part_.empty() ? name : fmt::format("{}.{}", whole.part_, name)),
      table_(whole.table_, &part) {}

TomlReader::TomlReader(std::span<const std::string> overrides, const FileKind& kind)
    : path_("the change"), kind_(kind), table_(std::make_shared<toml::table>()), is_change_(true) {
  takeOverrides(overrides, {});
}

std::string TomlReader::readText() const {
  std::error_code error;
  const fs::file_status status = fs::status(path_, error);
  if (status.type() == fs::file_type::not_found) {
    refuseFile("no such file");
  }
  if (error) {
    throw Failure(fmt::format("cannot read {}: {}", path_.string(), error.message()));
  }
  if (!fs::is_regular_file(status)) {
    refuseFile("not a file");
  }
  std::ifstream file(path_, std::ios::binary);
  std::string text(kLargestFileBytes + 1, '\0');  // more than the system's size, which may be wrong
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!file.is_open() || file.bad()) {
    throw Failure(fmt::format("cannot read {}: {}", path_.string(), std::strerror(errno)));
  }
  rememberInput(path_);
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > kLargestFileBytes) {
    refuseFile(fmt::format("too large for a {}: must be at most 1 MiB", kind_.name));
  }
  return text;
}

toml::table TomlReader::parse(std::string_view text) const {
  toml::table file;
  try {
    file = toml::parse(text, path_.string());
  } catch (const toml::parse_error& error) {
    const int line = static_cast<int>(error.source().begin.line);
    refuse(line, fmt::format("not TOML: {}", error.description()));
  }
  if (file.empty()) {
    refuseFile(fmt::format("empty: a {} has at least one key, for example {} ({})", kind_.name, kind_.example_key,
                           kind_.document));
  }
  return file;
}

toml::table* TomlReader::tableOf(std::string_view table) const {
  return table.empty() || table == home_ ? table_.get() : (*table_)[table].as_table();
}

const toml::node* TomlReader::findOwn(std::string_view table, std::string_view name) const {
  const toml::table* at = tableOf(table);
  return at == nullptr ? nullptr : at->get(name);
}

const toml::node* TomlReader::find(std::string_view table, std::string_view name) const {
  const toml::node* own = findOwn(table, name);
  if (behind_ == nullptr || (own != nullptr && isOverride(*own))) {
    return own;
  }
  const auto is_it = [&](const auto& passed) { return passed.first == table && passed.second == name; };
  const toml::table* at = table.empty() ? behind_.get() : (*behind_)[table].as_table();
  const toml::node* behind = at == nullptr || std::ranges::any_of(passed_, is_it) ? nullptr : at->get(name);
  return own == nullptr || (behind != nullptr && isOverride(*behind)) ? behind : own;
}

void TomlReader::decideTogether(std::string_view table, const std::function<bool(std::string_view key)>& belongs) {
  constexpr int kOfFile = 1, kOwn = 2, kOverrideOfFile = 3, kOwnOverride = 4;
  struct Found {
    std::string key;
    int strength;
  };
  std::vector<Found> found;
  const auto look = [&](const toml::table* at, int usual, int overridden) {
    if (at != nullptr) {
      for (const auto& [key, node] : *at) {
        if (belongs(key.str())) {
          found.push_back({std::string(key.str()), isOverride(node) ? overridden : usual});
        }
      }
    }
  };
  look(tableOf(table), kOwn, kOwnOverride);
  if (behind_ != nullptr) {
    look(table.empty() ? behind_.get() : (*behind_)[table].as_table(), kOfFile, kOverrideOfFile);
  }
  int strongest = 0;
  for (const Found& one : found) {
    strongest = std::max(strongest, one.strength);
  }
  for (const Found& one : found) {
    if (one.strength == strongest) {
      continue;
    }
    if (one.strength == kOwn || one.strength == kOwnOverride) {
      tableOf(table)->erase(one.key);
    } else {
      passed_.emplace_back(table, one.key);
    }
  }
}

std::vector<TomlReader> TomlReader::parts(std::string_view name) const {
  const toml::node* node = find("", name);
  if (node == nullptr) {
    return {};
  }
  const toml::array* array = node->as_array();
  if (array == nullptr || !array->is_array_of_tables()) {
    refuseKey({"", name}, fmt::format("tables, each under [[{}{}{}]]", part_, part_.empty() ? "" : ".", name));
  }
  std::vector<TomlReader> parts;
  for (const toml::node& part : *array) {
    parts.push_back(TomlReader(*this, name, const_cast<toml::table&>(*part.as_table())));
  }
  return parts;
}

std::vector<TomlReader> TomlReader::parts(std::string_view name, std::string_view home) const {
  std::vector<TomlReader> parts = this->parts(name);
  for (TomlReader& part : parts) {
    part.home_ = home;
    part.is_change_ = is_change_;
    part.behind_ = table_;
    part.require("", "name");
  }
  return parts;
}

int TomlReader::line() const {
  return part_.empty() ? 1 : lineOfNode(*table_);
}

/// "title", "[soil] preset", "[[block]] title" or "[block.scene] preset".
std::string TomlReader::fullName(const KeyName& key) const {
  if (part_.empty()) {
    return key.table.empty() ? std::string(key.name) : fmt::format("[{}] {}", key.table, key.name);
  }
  return key.table.empty() || key.table == home_ ? fmt::format("[[{}]] {}", part_, key.name)
                                                 : fmt::format("[{}.{}] {}", part_, key.table, key.name);
}

// --- refusing ---

int TomlReader::lineOf(std::string_view table, std::string_view name) const {
  return lineOfNode(*find(table, name));
}

std::string TomlReader::located(int line, std::string_view message) const {
  return fmt::format("{}:{}: {}", path_.string(), line, message);
}

bool TomlReader::isOverride(const toml::node& node) const {
  const toml::source_region& source = node.source();
  return source.path && *source.path != path_.string();
}

std::string TomlReader::located(const toml::node& node, std::string_view message) const {
  return isOverride(node) ? fmt::format("{}: {}", *node.source().path, message) : located(lineOfNode(node), message);
}

void TomlReader::refuse(int line, std::string_view message) const {
  throw TomlError(located(line, message), line);
}

void TomlReader::refuseFile(std::string_view why) const {
  throw TomlError(fmt::format("{}: {}", path_.string(), why), 0);
}

void TomlReader::refuseKey(const KeyName& key, std::string_view valid) const {
  refuseValue({key, *find(key.table, key.name), std::string(valid)});
}

void TomlReader::refuseValue(const Place& place) const {
  const std::string value = quote(place.node);
  throw TomlError(
      located(place.node, fmt::format("{} = {} is not valid: must be {}", fullName(place.key), value, place.valid)),
      lineOfNode(place.node), {dotted(place.key), value, place.valid});
}

void TomlReader::refuseLeftOut(const KeyName& key, std::string_view value, std::string_view valid) const {
  const std::string message =
      fmt::format("{} = {} ({}) is not valid: must be {}", fullName(key), value, kind_.left_out, valid);
  const std::string where = part_.empty() ? fmt::format("{}: {}", path_.string(), message) : located(line(), message);
  throw TomlError(where, part_.empty() ? 0 : line(), {dotted(key), std::string(value), std::string(valid)});
}

void TomlReader::refuseUnknownKeys(std::span<const KeyName> known) const {
  for (const auto& [name, node] : *table_) {
    if (knowsTable(known, name.str())) {
      refuseUnknownKeysIn(name.str(), node, known);
    } else if (!knowsKey(known, "", name.str()) && !knowsKey(known, home_, name.str())) {
      refuseUnknown({home_, name.str()}, node, known);
    }
  }
}

void TomlReader::refuseUnknownKeysIn(std::string_view table, const toml::node& node,
                                     std::span<const KeyName> known) const {
  if (!node.is_table()) {
    refuse(lineOfNode(node), fmt::format("{} = {} is not valid: must be a table, [{}]", table, quote(node), table));
  }
  for (const auto& [name, value] : *node.as_table()) {
    if (!knowsKey(known, table, name.str())) {
      refuseUnknown({table, name.str()}, value, known);
    }
  }
}

void TomlReader::refuseUnknown(const KeyName& key, const toml::node& node, std::span<const KeyName> known) const {
  const std::string shown = node.is_table() ? fmt::format("[{}]", key.name) : fullName(key);
  const std::string message = fmt::format("{} is not known{}", shortened(shown), suggestion(key, known));
  // A table that an override has made has no line: its key names the override.
  const toml::table* made = node.source().begin ? nullptr : node.as_table();
  const toml::node& at = made == nullptr || made->empty() ? node : made->begin()->second;
  throw TomlError(located(at, message), lineOfNode(at), {dotted(key), quote(node), "a key that is known"});
}

/// The nearest key of the same table, or the same key in another table.
std::string TomlReader::suggestion(const KeyName& key, std::span<const KeyName> known) const {
  std::vector<std::string_view> beside;
  for (const KeyName& other : known) {
    if (other.table == key.table) {
      beside.push_back(other.name);
    } else if (key.table.empty()) {
      beside.push_back(other.table);
    }
  }
  if (const std::string_view nearest = nearestWord(key.name, beside); !nearest.empty()) {
    const bool is_table = key.table.empty() && knowsTable(known, nearest);
    return fmt::format("; did you mean {}?", is_table ? fmt::format("[{}]", nearest) : fullName({key.table, nearest}));
  }
  for (const KeyName& other : known) {
    if (other.name == key.name) {
      return fmt::format("; did you mean {}?", fullName(other));
    }
  }
  return fmt::format(", see {}", kind_.document);
}

void TomlReader::refuseBoth(std::string_view table, std::string_view one, std::string_view other) const {
  const toml::node* first = find(table, one);
  const toml::node* second = find(table, other);
  if (first != nullptr && second != nullptr) {
    refuse(std::max(lineOfNode(*first), lineOfNode(*second)),
           fmt::format("[{}] {} and {} cannot both be given", table, one, other));
  }
}

void TomlReader::require(std::string_view table, std::string_view name) const {
  if (find(table, name) == nullptr) {
    const std::string message = fmt::format("{} is missing, see {}", fullName({table, name}), kind_.document);
    if (!part_.empty()) {
      refuse(line(), message);
    }
    refuseFile(message);
  }
}

// --- values ---

/// A finite number in its range, written with or without a decimal point.
double TomlReader::number(const Place& place, const Range& range) const {
  const toml::node& node = place.node;
  const double value = node.is_integer()          ? static_cast<double>(node.ref<std::int64_t>())
                       : node.is_floating_point() ? node.ref<double>()
                                                  : std::nan("");
  if (!std::isfinite(value) || !range.contains(value)) {
    refuseValue({place.key, node, node.is_number() ? place.valid : "a number, " + place.valid});
  }
  return value;
}

std::int64_t TomlReader::count(const Place& place, const Range& range) const {
  const auto count = place.node.value_exact<std::int64_t>();
  if (!count || !range.contains(static_cast<double>(*count))) {
    refuseValue(place);
  }
  return *count;
}

Vec3 TomlReader::vector(const Place& place, const Range& range) const {
  const toml::array* array = place.node.as_array();
  if (array == nullptr || array->size() != 3) {
    refuseValue(place);
  }
  Vec3 vector;
  for (std::size_t i = 0; i < 3; ++i) {
    vector[static_cast<Eigen::Index>(i)] = number({place.key, *array->get(i), place.valid}, range);
  }
  return vector;
}

Range TomlReader::interval(const Place& place, const Range& range) const {
  const toml::array* array = place.node.as_array();
  if (array == nullptr || array->size() != 2) {
    refuseValue(place);
  }
  const Range interval{number({place.key, *array->get(0), place.valid}, range),
                       number({place.key, *array->get(1), place.valid}, range)};
  if (interval.lowest > interval.highest) {
    refuseValue(place);
  }
  return interval;
}

bool TomlReader::onOrOff(const Place& place) const {
  const auto on = place.node.value_exact<bool>();
  if (!on) {
    refuseValue(place);
  }
  return *on;
}

std::string_view TomlReader::word(const Place& place, const std::vector<std::string_view>& words) const {
  const std::string given(currentName(NameKind::kWord, place.node.value_or(std::string())));
  const auto same_letter = [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); };
  for (const std::string_view valid : words) {
    if (std::ranges::equal(given, valid, same_letter)) {
      return valid;
    }
  }
  const std::string_view nearest = nearestWord(given, words);
  refuseValue({place.key, place.node,
               nearest.empty() ? place.valid : fmt::format("{}; did you mean {}?", place.valid, nearest)});
}

/// Texts are shown on pages, in figures and on terminals, and written into tables.
std::string TomlReader::text(const Place& place, TextSize size) const {
  const toml::value<std::string>* text = place.node.as_string();
  if (text == nullptr || text->get().empty()) {
    refuseValue({place.key, place.node, text == nullptr ? place.valid : "text that is not empty"});
  }
  requireSize(place, text->get(), size);
  return text->get();
}

std::string_view TomlReader::data(const Place& place) const {
  const toml::value<std::string>* text = place.node.as_string();
  if (text == nullptr) {
    refuseValue(place);
  }
  return text->get();
}

void TomlReader::requireSize(const Place& place, std::string_view text, TextSize size) const {
  const Lines lines = size == TextSize::kLine ? Lines::kOne : Lines::kSeveral;
  if (!isPlainText(text, lines)) {
    refuseValue({place.key, place.node,
                 lines == Lines::kOne ? "text on one line without control characters"
                                      : "text without control characters but newlines and tabs"});
  }
  if (const std::size_t most = mostBytes(size); text.size() > most) {
    refuseValue({place.key, place.node, fmt::format("at most {} bytes long, not {}", most, text.size())});
  }
}

/// Several, or one alone.
std::vector<TextOrNumber> TomlReader::items(const Place& place) const {
  const auto item = [&](const toml::node& node) -> TextOrNumber {
    if (const toml::value<std::string>* text = node.as_string()) {
      requireSize(place, text->get(), TextSize::kLine);
      return {.text = text->get(), .number = std::nullopt};
    }
    const double value = node.value_or(std::nan(""));
    if (!node.is_number() || !std::isfinite(value)) {
      refuseValue(place);
    }
    return {.text = fmt::format("{}", value), .number = value};
  };
  const toml::array* array = place.node.as_array();
  if (array == nullptr) {
    return {item(place.node)};
  }
  std::vector<TextOrNumber> items;
  for (const toml::node& node : *array) {
    items.push_back(item(node));
  }
  return items;
}

/// Searched relative to the file, wherever the program was started.
fs::path TomlReader::besideFile(const Place& place) const {
  const fs::path folder = isOverride(place.node) ? fs::path() : path_.parent_path();
  fs::path path = currentPath(folder / text(place, TextSize::kPath));
  std::error_code ignored;  // such as a name that is too long for any file
  if (!fs::is_regular_file(path, ignored)) {
    throw TomlError(located(place.node, fmt::format("{} = {}: no such file", fullName(place.key), path.string())),
                    lineOfNode(place.node), {dotted(place.key), path.string(), "a file"});
  }
  return path;
}

}  // namespace haptolith
