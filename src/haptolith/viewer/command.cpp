#include "haptolith/viewer/command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "haptolith/core/error.h"
#include "haptolith/core/files/json_reader.h"
#include "haptolith/core/former_names.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/scene_file/scene_words.h"

namespace haptolith {

namespace {

constexpr double kMm = 1e-3;  // m
constexpr int kMostTicks = 1000;
constexpr double kLargestNumber = 1e9;
constexpr int kDeepest = 8;
constexpr std::uint64_t kLargestWhole = (std::uint64_t{1} << 53) - 1;  // largest exact whole number in JavaScript
constexpr std::string_view kForGuest = "study";

template <class Table>
auto word(const JsonValue& object, const char* key, const Table& table)
    -> std::optional<decltype(table.begin()->value)> {
  const std::optional<JsonValue> name = object.find(key);
  if (!name) {
    return std::nullopt;
  }
  for (const auto& entry : table) {
    if (entry.name == currentName(NameKind::kWord, name->text())) {
      return entry.value;
    }
  }
  name->refuse(name->given(), fmt::format("{}", fmt::join(namesOf(table), ", ")));
}

std::optional<std::string> text(const JsonValue& object, const char* key) {
  const std::optional<JsonValue> value = object.find(key);
  return value ? std::optional(value->text()) : std::nullopt;
}

/// A length in mm, in m.
std::optional<double> millimetres(const JsonValue& object, const char* key, const Range& valid_mm) {
  const std::optional<JsonValue> value = object.find(key);
  return value ? std::optional(value->number(valid_mm) * kMm) : std::nullopt;
}

command::Hold hold(const JsonValue& message) {
  const auto p = message.at("pose").numbers<7>({-1000, 1000});
  return {{Vec3(p[0], p[1], p[2]), Quat(p[3], p[4], p[5], p[6])}, text(message, "tool")};
}

command::Play play(const JsonValue& message) {
  auto motion = word(message, "motion", kHandMotionWords);
  motion = motion ? motion : word(message, "manoeuvre", kHandMotionWords);  // its name in version 0.2
  if (!motion || *motion == HandMotion::kPoses) {
    throw InvalidParameter("motion", motion ? "poses" : "nothing", anyOf(playableMotions()));
  }
  return {*motion, text(message, "tool")};
}

void readTool(const JsonValue& tool, SceneChange& change) {
  const Range valid_mm = ToolRanges::length_m.in(kMm);  // to the size of the box: changed()
  change.tool_shape = word(tool, "shape", kToolShapeWords);
  if (const auto size = tool.find("size_mm")) {
    const auto edges = size->numbers<3>(valid_mm);
    change.tool_size_m = kMm * Vec3(edges[0], edges[1], edges[2]);
  }
  change.tool_diameter_m = millimetres(tool, "diameter_mm", valid_mm);
  change.tool_thickness_m = millimetres(tool, "thickness_mm", valid_mm);
  change.tool_opening_m = millimetres(tool, "opening_mm", valid_mm);
  change.tool_length_m = millimetres(tool, "length_mm", valid_mm);
  tool.refuseOtherKeys();
}

/// A name that the program knows; a client may not make it read files.
std::optional<std::string> soilName(const JsonValue& message) {
  std::optional<std::string> name = text(message, "soil");
  const std::vector<std::string> known = soilNames();
  if (name && std::ranges::find(known, *name) == known.end()) {
    message.at("soil").refuse(inQuotes(*name), fmt::format("{}", fmt::join(known, ", ")));
  }
  return name;
}

command::Change change(const JsonValue& message) {
  SceneChange change;
  change.preset = text(message, "preset");
  change.soil = soilName(message);
  change.body = text(message, "body");
  change.friction = word(message, "friction", kFrictionWords);
  if (const auto sliders = message.find("sliders")) {
    for (const auto& [key, value] : sliders->members()) {
      change.sliders.emplace_back(key, value.number({-kLargestNumber, kLargestNumber}));
    }
  }
  if (const auto tool = message.find("tool")) {
    readTool(*tool, change);
  }
  return {change};
}

command::ToolFile toolFile(const JsonValue& message) {
  command::ToolFile file;
  file.upload = message.at("upload").whole(kLargestWhole);
  const std::string& name = message.at("name").text();
  file.source.name = shortened(name);
  file.source.format = requireMeshFormat(name);
  file.source.unit_m = millimetres(message, "unit_mm", kMeshUnit_m.in(kMm)).value_or(kMm);
  file.source.sheet_thickness_m = millimetres(message, "sheet_thickness_mm", kSheetThickness_m.in(kMm)).value_or(0);
  return file;
}

command::Step step(const JsonValue& message) {
  const auto ticks = message.find("ticks");
  const double count = ticks ? ticks->number({1, kMostTicks}) : 1;
  if (count != std::floor(count)) {
    ticks->refuse(ticks->given(), "a whole number");
  }
  return {static_cast<int>(count)};
}

command::Speed speed(const JsonValue& message) {
  return {message.at("factor").number({0.01, 1})};
}

command::Record record(const JsonValue& message) {
  return {message.at("on").flag()};
}

command::Colour colour(const JsonValue& message) {
  const std::optional<bool> by_force = word(message, "by", kColourWords);
  if (!by_force) {
    throw InvalidParameter("by", "nothing", "plain, force, speed, depth or sleep");
  }
  return {*by_force};
}

Command commandOf(const JsonValue& message) {
  const JsonValue what = message.at("do");
  using Reader = Command (*)(const JsonValue&);
  static const std::map<std::string, Reader> kReaders = {
      {"hold", [](const JsonValue& m) -> Command { return hold(m); }},
      {"release", [](const JsonValue& m) -> Command { return command::Release{text(m, "tool")}; }},
      {"play", [](const JsonValue& m) -> Command { return play(m); }},
      {"scene", [](const JsonValue& m) -> Command { return change(m); }},
      {"tool_file", [](const JsonValue& m) -> Command { return toolFile(m); }},
      {"reset", [](const JsonValue&) -> Command { return command::Reset{}; }},
      {"level", [](const JsonValue&) -> Command { return command::Level{}; }},
      {"coarser", [](const JsonValue&) -> Command { return command::Coarser{}; }},
      {"undo", [](const JsonValue&) -> Command { return command::Undo{}; }},
      {"pause", [](const JsonValue&) -> Command { return command::Pause{}; }},
      {"resume", [](const JsonValue&) -> Command { return command::Resume{}; }},
      {"step", [](const JsonValue& m) -> Command { return step(m); }},
      {"speed", [](const JsonValue& m) -> Command { return speed(m); }},
      {"record", [](const JsonValue& m) -> Command { return record(m); }},
      {"colour", [](const JsonValue& m) -> Command { return colour(m); }},
  };
  const auto reader = kReaders.find(what.text());
  if (reader == kReaders.end()) {
    std::vector<std::string> names;
    names.reserve(kReaders.size() + 1);
    for (const auto& [name, read] : kReaders) {
      names.push_back(name);
    }
    names.emplace_back(kForGuest);
    what.refuse(what.given(), fmt::format("{}", fmt::join(names, ", ")));
  }
  Command command = reader->second(message);
  message.refuseOtherKeys();
  return command;
}

}  // namespace

ClientMessage parseClientMessage(std::string_view text) {
  ClientMessage message;
  try {
    const JsonValue root = parseJson(text, "", "a JSON object", {.depth = kDeepest});
    if (const auto id = root.find("id")) {
      message.wants_reply = true;
      message.id = static_cast<std::int64_t>(id->whole(kLargestWhole));  // the reply repeats it
    }
    if (const auto what = root.find("do"); what && what->text() == kForGuest) {
      message.for_guest = true;
      return message;
    }
    const auto confirmed = root.find("confirmed");
    message.confirmed = confirmed && confirmed->flag();
    message.command = commandOf(root);
  } catch (const InvalidParameter& error) {
    message.refused = error.what();
  }
  return message;
}

}  // namespace haptolith
