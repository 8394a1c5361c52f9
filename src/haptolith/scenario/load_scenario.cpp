#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

#include "haptolith/core/nearest_word.h"
#include "haptolith/scenario/scenario.h"
#include "haptolith/scenario/scenario_error.h"
#include "haptolith/scenario/scenario_keys.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestFileBytes = 1 << 20;  // a scene is some 2 kB; more is the wrong file
constexpr std::size_t kLongestQuote = 60;              // letters of a wrong value that a message repeats

// --- reading the file -----------------------------------------------------------------------------------------------

[[noreturn]] void refuseFile(const fs::path& path, std::string_view why) {
  throw ScenarioError(fmt::format("{}: {}", path.string(), why), 0);
}

std::string readText(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) {
    refuseFile(path, "no such file");
  }
  if (!fs::is_regular_file(status)) {
    refuseFile(path, "not a file");
  }
  if (fs::file_size(path) > kLargestFileBytes) {
    refuseFile(path, "too large for a scene: must be at most 1 MiB");
  }
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file.is_open() || file.bad()) {
    throw Failure(fmt::format("cannot read {}", path.string()));
  }
  return text;
}

toml::table parse(const fs::path& path) {
  toml::table file;
  try {
    file = toml::parse(readText(path), path.string());
  } catch (const toml::parse_error& error) {
    const int line = static_cast<int>(error.source().begin.line);
    throw ScenarioError(fmt::format("{}:{}: not TOML: {}", path.string(), line, error.description()), line);
  }
  if (file.empty()) {
    refuseFile(path, "empty: a scene has at least one key, for example title (docs/scenarios.md)");
  }
  return file;
}

int lineOf(const toml::node& node) {
  return static_cast<int>(node.source().begin.line);
}

/// The value as the file has it, shortened; what it is when it is no plain value.
std::string quote(const toml::node& node) {
  if (node.is_table()) {
    return "a table";
  }
  std::ostringstream out;
  out << toml::toml_formatter{node};
  std::string text = out.str();
  std::ranges::replace(text, '\n', ' ');
  return text.size() <= kLongestQuote ? text : text.substr(0, kLongestQuote) + "...";
}

std::string fullName(std::string_view table, std::string_view key) {
  return table.empty() ? std::string(key) : fmt::format("[{}] {}", table, key);
}

// --- applying it ----------------------------------------------------------------------------------------------------

/// One scene file on its way into a Scenario.
class Loader {
 public:
  explicit Loader(const fs::path& path) : path_(path), file_(parse(path)) {}

  Scenario load() {
    refuseUnknownKeys();
    refuseContradictions();
    for (const ScenarioKey& key : scenarioKeys()) {
      if (const toml::node* node = find(key.table, key.name)) {
        apply(key, *node);
      }
    }
    resolvePoses();
    validateWhole();
    return std::move(scene_);
  }

 private:
  [[nodiscard]] const toml::node* find(std::string_view table, std::string_view name) const {
    const toml::table* at = table.empty() ? &file_ : file_[table].as_table();
    return at == nullptr ? nullptr : at->get(name);
  }

  [[noreturn]] void refuse(int line, std::string_view message) const {
    throw ScenarioError(fmt::format("{}:{}: {}", path_.string(), line, message), line);
  }

  [[noreturn]] void refuseValue(const ScenarioKey& key, const toml::node& node, std::string_view valid) const {
    refuse(lineOf(node),
           fmt::format("{} = {} is not valid: must be {}", fullName(key.table, key.name), quote(node), valid));
  }

  // --- keys ---

  void refuseUnknownKeys() const {
    for (const auto& [name, node] : file_) {
      if (knowsTable(name.str())) {
        refuseUnknownKeysIn(name.str(), node);
      } else if (!knowsKey("", name.str())) {
        refuseUnknown("", name.str(), node);
      }
    }
  }

  void refuseUnknownKeysIn(std::string_view table, const toml::node& node) const {
    if (!node.is_table()) {
      refuse(lineOf(node), fmt::format("{} = {} is not valid: must be a table, [{}]", table, quote(node), table));
    }
    for (const auto& [name, value] : *node.as_table()) {
      if (!knowsKey(table, name.str())) {
        refuseUnknown(table, name.str(), value);
      }
    }
  }

  [[nodiscard]] static bool knowsTable(std::string_view name) {
    return !name.empty() &&
           std::ranges::any_of(scenarioKeys(), [&](const ScenarioKey& key) { return key.table == name; });
  }

  [[nodiscard]] static bool knowsKey(std::string_view table, std::string_view name) {
    return std::ranges::any_of(scenarioKeys(),
                               [&](const ScenarioKey& key) { return key.table == table && key.name == name; });
  }

  [[noreturn]] void refuseUnknown(std::string_view table, std::string_view name, const toml::node& node) const {
    const std::string shown = node.is_table() ? fmt::format("[{}]", name) : fullName(table, name);
    refuse(lineOf(node), fmt::format("{} is not known{}", shown, suggestion(table, name)));
  }

  /// The nearest key of the same table, or the same key in another table.
  [[nodiscard]] static std::string suggestion(std::string_view table, std::string_view name) {
    std::vector<std::string_view> beside;
    for (const ScenarioKey& key : scenarioKeys()) {
      if (key.table == table) {
        beside.push_back(key.name);
      } else if (table.empty()) {
        beside.push_back(key.table);
      }
    }
    if (const std::string_view nearest = nearestWord(name, beside); !nearest.empty()) {
      const bool is_table = table.empty() && knowsTable(nearest);
      return fmt::format("; did you mean {}?", is_table ? fmt::format("[{}]", nearest) : fullName(table, nearest));
    }
    for (const ScenarioKey& key : scenarioKeys()) {
      if (key.name == name) {
        return fmt::format("; did you mean {}?", fullName(key.table, key.name));
      }
    }
    return ", see docs/scenarios.md";
  }

  void refuseContradictions() const {
    for (const char* number : {"gamma_nm", "rho0_kg_m3", "rho_max_kg_m3", "mu_hat"}) {
      refuseBoth("soil", "preset", number);
    }
    refuseBoth("gravity", "body", "magnitude_m_s2");
    const toml::node* manoeuvre = find("hand", "manoeuvre");
    if (manoeuvre != nullptr && manoeuvre->value_or(std::string_view()) != "poses") {
      refuseBoth("hand", "poses", "manoeuvre");
    }
  }

  void refuseBoth(std::string_view table, std::string_view one, std::string_view other) const {
    const toml::node* first = find(table, one);
    const toml::node* second = find(table, other);
    if (first != nullptr && second != nullptr) {
      refuse(std::max(lineOf(*first), lineOf(*second)),
             fmt::format("[{}] {} and {} cannot both be given", table, one, other));
    }
  }

  // --- values ---

  void apply(const ScenarioKey& key, const toml::node& node) {
    try {
      std::visit([&](const auto& value) { set(key, value, node); }, key.value);
    } catch (const ScenarioError&) {
      throw;
    } catch (const InvalidParameter& error) {
      refuseValue(key, node, error.valid());
    }
  }

  void set(const ScenarioKey& key, const NumberValue& value, const toml::node& node) {
    value.set(scene_, number(key, value.valid, node, value.valid.text()));
  }

  void set(const ScenarioKey& key, const CountValue& value, const toml::node& node) {
    const auto count = node.value_exact<std::int64_t>();
    if (!count || !value.valid.contains(static_cast<double>(*count))) {
      refuseValue(key, node, validText(key));
    }
    value.set(scene_, *count);
  }

  void set(const ScenarioKey& key, const VectorValue& value, const toml::node& node) {
    const toml::array* array = node.as_array();
    if (array == nullptr || array->size() != 3) {
      refuseValue(key, node, validText(key));
    }
    Vec3 vector;
    for (std::size_t i = 0; i < 3; ++i) {
      vector[static_cast<Eigen::Index>(i)] = number(key, value.valid, *array->get(i), validText(key));
    }
    value.set(scene_, vector);
  }

  void set(const ScenarioKey& key, const SwitchValue& value, const toml::node& node) {
    const auto on = node.value_exact<bool>();
    if (!on) {
      refuseValue(key, node, validText(key));
    }
    value.set(scene_, *on);
  }

  void set(const ScenarioKey& key, const WordValue& value, const toml::node& node) {
    const std::string word = node.value_or(std::string());
    const auto same_letter = [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); };
    for (const std::string_view valid : value.valid) {
      if (std::ranges::equal(word, valid, same_letter)) {
        value.set(scene_, valid);
        return;
      }
    }
    refuseValue(key, node, validText(key));
  }

  void set(const ScenarioKey& key, const TextValue& value, const toml::node& node) {
    const toml::value<std::string>* text = node.as_string();
    if (text == nullptr || text->get().empty()) {
      refuseValue(key, node, text == nullptr ? validText(key) : "text that is not empty");
    }
    value.set(scene_, text->get());
  }

  /// A finite number in its range, written with or without a decimal point.
  [[nodiscard]] double number(const ScenarioKey& key, const Range& range, const toml::node& node,
                              const std::string& valid) const {
    const double value = node.is_integer()          ? static_cast<double>(node.ref<std::int64_t>())
                         : node.is_floating_point() ? node.ref<double>()
                                                    : std::nan("");
    if (!std::isfinite(value) || !range.contains(value)) {
      refuseValue(key, node, node.is_number() ? valid : "a number, " + valid);
    }
    return value;
  }

  // --- the whole ---

  /// The movement is looked for beside the scene, wherever the program was started.
  void resolvePoses() {
    if (scene_.hand.manoeuvre != Manoeuvre::kPoses) {
      return;
    }
    const toml::node* poses = find("hand", "poses");
    if (poses == nullptr) {
      refuse(lineOf(*find("hand", "manoeuvre")), "[hand] manoeuvre = 'poses' needs [hand] poses, a CSV file");
    }
    scene_.hand.poses_file = (path_.parent_path() / scene_.hand.poses_file).string();
    if (!fs::is_regular_file(scene_.hand.poses_file)) {
      refuse(lineOf(*poses), fmt::format("[hand] poses = {}: no such file", scene_.hand.poses_file));
    }
  }

  void validateWhole() const {
    validatePart("soil", [&] { validate(scene_.bed.soil); });
    validatePart("bed", [&] { validate(scene_.bed); });
    validatePart("tool", [&] { validate(scene_.tool); });
    validatePart("hand", [&] { validate(scene_.hand); });
    validatePart("loop", [&] { validate(scene_.loop); });
    validatePart("", [&] { validate(scene_); });
  }

  /// Runs a check of values against each other; its error names an SI parameter, for which the key is looked up.
  template <class Check>
  void validatePart(std::string_view table, Check check) const {
    try {
      check();
    } catch (const InvalidParameter& error) {
      for (const ScenarioKey& key : scenarioKeys()) {
        if (key.table != table || key.parameter != error.key()) {
          continue;
        }
        const toml::node* node = find(key.table, key.name);
        const bool same_unit = key.name == key.parameter;
        const std::string valid = same_unit ? error.valid() : fmt::format("{} ({})", error.valid(), key.parameter);
        if (node != nullptr) {
          refuseValue(key, *node, valid);
        }
        refuseFile(path_, fmt::format("{} = {} (left out, so the paper's) is not valid: must be {}",
                                      fullName(key.table, key.name), error.value(), valid));
      }
      refuseFile(path_, error.what());
    }
  }

  fs::path path_;
  toml::table file_;
  Scenario scene_;
};

}  // namespace

Scenario loadScenario(const fs::path& path) {
  return Loader(path).load();
}

}  // namespace haptolith
