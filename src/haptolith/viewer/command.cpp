#include "haptolith/viewer/command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "haptolith/core/error.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/scene_file/scene_words.h"

namespace haptolith {

namespace {

using Json = nlohmann::json;

constexpr double kMm = 1e-3;  // m
constexpr int kMostTicks = 1000;
constexpr double kLargestNumber = 1e9;
constexpr int kDeepest = 8;
constexpr std::int64_t kLargestWhole = (std::int64_t{1} << 53) - 1;
constexpr std::string_view kForGuest = "study";

/// Reads the keys of one JSON object, and knows which it was asked for.
class Keys {
 public:
  explicit Keys(const Json& object, std::set<std::string> known = {}) : object_(object), asked_(std::move(known)) {
    if (!object.is_object()) {
      throw InvalidParameter("message", std::string(object.type_name()), "a JSON object");
    }
  }

  [[nodiscard]] const Json* find(const std::string& key) {
    asked_.insert(key);
    const auto at = object_.find(key);
    return at == object_.end() ? nullptr : &*at;
  }

  [[nodiscard]] const Json& need(const std::string& key) {
    const Json* value = find(key);
    if (value == nullptr) {
      throw InvalidParameter(key, "nothing", "given");
    }
    return *value;
  }

  [[nodiscard]] std::optional<double> number(const std::string& key, const Range& valid) {
    const Json* value = find(key);
    return value == nullptr ? std::nullopt : std::optional(numberOf(key, *value, valid));
  }

  [[nodiscard]] std::optional<std::string> text(const std::string& key) {
    const Json* value = find(key);
    return value == nullptr ? std::nullopt : std::optional(textOf(key, *value));
  }

  template <class Table>
  [[nodiscard]] auto word(const std::string& key, const Table& table) -> std::optional<decltype(table.begin()->value)> {
    const std::optional<std::string> name = text(key);
    if (!name) {
      return std::nullopt;
    }
    for (const auto& entry : table) {
      if (entry.name == currentWord(*name)) {
        return entry.value;
      }
    }
    throw InvalidParameter(key, shortened(*name), fmt::format("{}", fmt::join(namesOf(table), ", ")));
  }

  void refuseOthers() const {
    for (const auto& [key, value] : object_.items()) {
      if (!asked_.contains(key)) {
        throw InvalidParameter(shortened(key), "given", "left out: there is no such key here");
      }
    }
  }

  static double numberOf(const std::string& key, const Json& value, const Range& valid) {
    if (!value.is_number()) {
      throw InvalidParameter(key, std::string(value.type_name()), "a number");
    }
    return requireInRange(key, value.get<double>(), valid);
  }

  static std::string textOf(const std::string& key, const Json& value) {
    if (!value.is_string()) {
      throw InvalidParameter(key, std::string(value.type_name()), "a text");
    }
    return value.get<std::string>();
  }

  /// What somebody sent, short enough to send back.
  static std::string shortened(const std::string& text) {
    constexpr std::size_t kLongest = 60;
    return text.size() <= kLongest ? text : text.substr(0, kLongest) + "...";
  }

 private:
  const Json& object_;
  std::set<std::string> asked_;
};

template <std::size_t kCount>
std::array<double, kCount> numbers(const std::string& key, const Json& value, const Range& valid) {
  if (!value.is_array() || value.size() != kCount) {
    throw InvalidParameter(key, std::string(value.type_name()), fmt::format("{} numbers", kCount));
  }
  std::array<double, kCount> read{};
  for (std::size_t i = 0; i < kCount; ++i) {
    read[i] = Keys::numberOf(key, value[i], valid);
  }
  return read;
}

command::Hold hold(Keys& keys) {
  const auto p = numbers<7>("pose", keys.need("pose"), {-1000, 1000});
  return {{Vec3(p[0], p[1], p[2]), Quat(p[3], p[4], p[5], p[6])}};
}

command::Play play(Keys& keys) {
  const auto manoeuvre = keys.word("manoeuvre", kManoeuvreWords);
  if (!manoeuvre || *manoeuvre == Manoeuvre::kPoses) {
    throw InvalidParameter("manoeuvre", manoeuvre ? "poses" : "nothing", anyOf(playableManoeuvres()));
  }
  return {*manoeuvre};
}

void readTool(const Json& object, SceneChange& change) {
  const Range valid_mm = ToolRanges::length_m.in(kMm);  // to the size of the box: changed()
  Keys keys(object);
  change.tool_shape = keys.word("shape", kToolShapeWords);
  if (const Json* size = keys.find("size_mm")) {
    const auto edges = numbers<3>("size_mm", *size, valid_mm);
    change.tool_size_m = kMm * Vec3(edges[0], edges[1], edges[2]);
  }
  const auto metres = [](std::optional<double> mm) { return mm ? std::optional(*mm * kMm) : std::nullopt; };
  change.tool_diameter_m = metres(keys.number("diameter_mm", valid_mm));
  change.tool_thickness_m = metres(keys.number("thickness_mm", valid_mm));
  change.tool_opening_m = metres(keys.number("opening_mm", valid_mm));
  change.tool_length_m = metres(keys.number("length_mm", valid_mm));
  keys.refuseOthers();
}

/// A name that the program knows; a client may not make it read files.
std::optional<std::string> soilName(Keys& keys) {
  std::optional<std::string> name = keys.text("soil");
  const std::vector<std::string> known = soilNames();
  if (name && std::ranges::find(known, *name) == known.end()) {
    throw InvalidParameter("soil", Keys::shortened(*name), fmt::format("{}", fmt::join(known, ", ")));
  }
  return name;
}

command::Change change(Keys& keys) {
  SceneChange change;
  change.preset = keys.text("preset");
  change.soil = soilName(keys);
  change.body = keys.text("body");
  change.friction = keys.word("friction", kFrictionWords);
  if (const Json* sliders = keys.find("sliders")) {
    if (!sliders->is_object()) {
      throw InvalidParameter("sliders", std::string(sliders->type_name()), "an object of numbers");
    }
    for (const auto& [key, value] : sliders->items()) {
      change.sliders.emplace_back(key, Keys::numberOf(Keys::shortened(key), value, {-kLargestNumber, kLargestNumber}));
    }
  }
  if (const Json* tool = keys.find("tool")) {
    readTool(*tool, change);
  }
  return {change};
}

/// A whole number that a page's numbers hold exactly.
std::int64_t wholeOf(const std::string& key, const Json& value) {
  const bool whole = value.is_number_integer() && (value.is_number_unsigned() || value.get<std::int64_t>() >= 0);
  if (!whole || value.get<std::uint64_t>() > static_cast<std::uint64_t>(kLargestWhole)) {
    throw InvalidParameter(key, value.is_number() ? value.dump() : std::string(value.type_name()),
                           fmt::format("a whole number from 0 to {}", kLargestWhole));
  }
  return value.get<std::int64_t>();
}

command::ToolFile toolFile(Keys& keys) {
  command::ToolFile file;
  file.upload = static_cast<std::uint64_t>(wholeOf("upload", keys.need("upload")));
  const std::string name = Keys::textOf("name", keys.need("name"));
  file.source.name = haptolith::shortened(name);
  file.source.format = requireMeshFormat(name);
  file.source.unit_m = keys.number("unit_mm", kMeshUnit_m.in(kMm)).value_or(1) * kMm;
  file.source.sheet_thickness_m = keys.number("sheet_thickness_mm", kSheetThickness_m.in(kMm)).value_or(0) * kMm;
  return file;
}

command::Step step(Keys& keys) {
  const double ticks = keys.number("ticks", {1, kMostTicks}).value_or(1);
  if (ticks != std::floor(ticks)) {
    throw InvalidParameter("ticks", fmt::format("{}", ticks), "a whole number");
  }
  return {static_cast<int>(ticks)};
}

command::Speed speed(Keys& keys) {
  return {Keys::numberOf("factor", keys.need("factor"), {0.01, 1})};
}

bool flag(const std::string& key, const Json& value) {
  if (!value.is_boolean()) {
    throw InvalidParameter(key, std::string(value.type_name()), "true or false");
  }
  return value.get<bool>();
}

command::Record record(Keys& keys) {
  return {flag("on", keys.need("on"))};
}

command::Colour colour(Keys& keys) {
  const std::optional<bool> by_force = keys.word("by", kColourWords);
  if (!by_force) {
    throw InvalidParameter("by", "nothing", "plain, force, speed, depth or sleep");
  }
  return {*by_force};
}

/// Whether brackets are nested more deeply than any message has them; what can be nested without end costs more and
/// more to take apart, and its parts are taken apart and freed recursively.
bool isTooDeep(std::string_view text) {
  int depth = 0;
  bool in_text = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_text) {
      i += c == '\\' ? 1 : 0;
      in_text = c != '"';
    } else if (c == '"') {
      in_text = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kDeepest) {
        return true;
      }
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return false;
}

Command commandOf(const Json& message) {
  Keys keys(message, {"id", "confirmed"});
  const std::string what = Keys::textOf("do", keys.need("do"));
  using Reader = Command (*)(Keys&);
  static const std::map<std::string, Reader> kReaders = {
      {"hold", [](Keys& k) -> Command { return hold(k); }},
      {"release", [](Keys&) -> Command { return command::Release{}; }},
      {"play", [](Keys& k) -> Command { return play(k); }},
      {"scene", [](Keys& k) -> Command { return change(k); }},
      {"tool_file", [](Keys& k) -> Command { return toolFile(k); }},
      {"reset", [](Keys&) -> Command { return command::Reset{}; }},
      {"level", [](Keys&) -> Command { return command::Level{}; }},
      {"coarser", [](Keys&) -> Command { return command::Coarser{}; }},
      {"undo", [](Keys&) -> Command { return command::Undo{}; }},
      {"pause", [](Keys&) -> Command { return command::Pause{}; }},
      {"resume", [](Keys&) -> Command { return command::Resume{}; }},
      {"step", [](Keys& k) -> Command { return step(k); }},
      {"speed", [](Keys& k) -> Command { return speed(k); }},
      {"record", [](Keys& k) -> Command { return record(k); }},
      {"colour", [](Keys& k) -> Command { return colour(k); }},
  };
  const auto reader = kReaders.find(what);
  if (reader == kReaders.end()) {
    std::vector<std::string> names;
    names.reserve(kReaders.size() + 1);
    for (const auto& [name, read] : kReaders) {
      names.push_back(name);
    }
    names.emplace_back(kForGuest);
    throw InvalidParameter("do", Keys::shortened(what), fmt::format("{}", fmt::join(names, ", ")));
  }
  Command command = reader->second(keys);
  keys.refuseOthers();
  return command;
}

}  // namespace

ClientMessage parseClientMessage(std::string_view text) {
  ClientMessage message;
  if (isTooDeep(text)) {
    message.refused = fmt::format("the message is nested more than {} deep", kDeepest);
    return message;
  }
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) {
    message.refused = "the message is not JSON";
    return message;
  }
  try {
    if (json.is_object() && json.contains("id")) {
      message.wants_reply = true;
      message.id = wholeOf("id", json["id"]);  // the reply repeats it
    }
    if (json.is_object() && json.contains("do") && json["do"] == kForGuest) {
      message.for_guest = true;
      return message;
    }
    message.confirmed = json.is_object() && json.contains("confirmed") && flag("confirmed", json["confirmed"]);
    message.command = commandOf(json);
  } catch (const InvalidParameter& error) {
    message.refused = error.what();
  }
  return message;
}

}  // namespace haptolith
