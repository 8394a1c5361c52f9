#include "haptolith/scene_file/scene_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "haptolith/bed/start/ready_tile.h"
#include "haptolith/core/error.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/core/pluralise.h"
#include "haptolith/scene_file/scene_words.h"
#include "haptolith/scene_file/toml/file_keys.h"
#include "haptolith/soil/bodies.h"
#include "haptolith/soil/presets.h"
#include "haptolith/tool/tool_contact.h"

namespace haptolith {

namespace {

std::string soilInWords(const SceneFile& scene_file) {
  const std::string& named = scene_file.preset.empty() ? scene_file.soil_name : scene_file.preset;
  return named.empty() ? "own soil" : named + " soil";
}

std::string toolInWords(const SceneFile& scene_file) {
  switch (scene_file.tool.shape) {
    case ToolShape::kBox: return "shovel";
    case ToolShape::kCone: return "cone";
    case ToolShape::kTube: return "tube";
    case ToolShape::kMesh: return scene_file.mesh.name.empty() ? "mesh" : scene_file.mesh.name;
    case ToolShape::kSphere:
    case ToolShape::kPlate:
    case ToolShape::kCylinder:
    case ToolShape::kJaws: break;
  }
  return std::string(wordFor(kToolShapeWords, scene_file.tool.shape));
}

}  // namespace

void requireToolName(std::string_view name) {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyz0123456789_-";
  constexpr std::size_t kMost = 32;
  if (name.empty() || name.size() > kMost || name.find_first_not_of(kLetters) != std::string_view::npos) {
    throw InvalidParameter("name", inQuotes(name), fmt::format("1 to {} of a to z, 0 to 9, _ and -", kMost));
  }
}

std::vector<std::string_view> toolNames(const SceneFile& scene_file) {
  std::vector<std::string_view> names{scene_file.tool_name};
  for (const SceneTool& tool : scene_file.more_tools) {
    names.push_back(tool.name);
  }
  return names;
}

std::size_t toolNumber(const SceneFile& scene_file, std::string_view name) {
  const std::vector<std::string_view> names = toolNames(scene_file);
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) {
    throw InvalidParameter("tools", inQuotes(name), fmt::format("one of {}", fmt::join(names, ", ")));
  }
  return static_cast<std::size_t>(found - names.begin());
}

void requireOneTool(const SceneFile& scene_file, std::string_view what) {
  if (!scene_file.more_tools.empty()) {
    throw InvalidParameter("scenario", fmt::format("'{}' with {} tools", scene_file.title, toolCount(scene_file)),
                           fmt::format("a scene with one tool for {}", what));
  }
}

ToolSet toolSet(const SceneFile& scene_file) {
  std::vector<ToolParameters> tools{scene_file.tool};
  for (const SceneTool& tool : scene_file.more_tools) {
    tools.push_back(tool.tool);
  }
  return ToolSet(std::move(tools));
}

void exchangeFirst(SceneFile& scene_file, std::size_t tool) {
  if (tool > 0) {
    SceneTool& other = scene_file.more_tools.at(tool - 1);
    std::swap(scene_file.tool_name, other.name);
    std::swap(scene_file.mesh, other.mesh);
    std::swap(scene_file.tool, other.tool);
    std::swap(scene_file.hand, other.hand);
    std::swap(scene_file.device, other.device);
    std::swap(scene_file.handling, other.handling);
  }
}

HandlingParameters handlingOf(const SceneFile& scene_file, double surface_m) {
  HandlingParameters handling = handlingOfOwnDevice(scene_file, surface_m);
  if (scene_file.device.kind == DeviceKind::kVirtualHand) {
    handling.mapping = {};
  }
  return handling;
}

HandlingParameters handlingOfOwnDevice(const SceneFile& scene_file, double surface_m) {
  HandlingParameters handling = scene_file.handling;
  handling.mapping.offset_m.z() += surface_m;
  return handling;
}

void setSoil(SceneFile& scene_file, const SoilFile& soil) {
  scene_file.preset.clear();
  scene_file.soil_name = soil.name;
  scene_file.bed.soil = soil.soil;
  if (soil.soil.friction == FrictionModel::kContact && scene_file.bed.start == BedStart::kCount) {
    scene_file.bed.start = BedStart::kRain;  // a lattice is a crystal, with planes it slips on: not what was calibrated
  }
}

std::string sceneInWords(const SceneFile& scene_file) {
  std::string words = fmt::format(
      "{}, {}, R = {:.3g} mm", soilInWords(scene_file),
      scene_file.body.empty() ? fmt::format("{:.3g} m/s2", scene_file.bed.gravity_m_s2.norm()) : scene_file.body,
      1e3 * scene_file.bed.soil.radius_m);
  words += scene_file.bed.stones.any() ? ", stones" : "";
  words += ", " + toolInWords(scene_file);
  if (!scene_file.more_tools.empty()) {
    words += fmt::format(" and {}", pluralise(scene_file.more_tools.size(), "more tool"));
  }
  if (scene_file.device.kind == DeviceKind::kVirtualHand && scene_file.hand.motion != HandMotion::kStill) {
    words += fmt::format(", {}", wordFor(kHandMotionWords, scene_file.hand.motion));
  }
  return words;
}

void retitle(SceneFile& scene_file, std::string_view before) {
  const std::string now = sceneInWords(scene_file);
  if (now != before && now.size() <= mostBytes(TextSize::kLine)) {
    scene_file.title = now;
  }
}

void changePreset(SceneFile& scene_file, std::string_view name) {
  const Preset& preset = findPreset(name);
  const std::string before = sceneInWords(scene_file);
  scene_file.bed.soil = rescaled(preset.soil, scene_file.bed.soil.radius_m);
  scene_file.preset = preset.name;
  scene_file.soil_name.clear();
  retitle(scene_file, before);
}

void changeSoil(SceneFile& scene_file, std::string_view name_or_file) {
  SoilFile file = findSoil(name_or_file);
  file.soil = rescaled(file.soil, scene_file.bed.soil.radius_m);
  const std::string before = sceneInWords(scene_file);
  setSoil(scene_file, file);
  retitle(scene_file, before);
}

void changeBody(SceneFile& scene_file, std::string_view name) {
  const Body& body = findBody(name);
  const std::string before = sceneInWords(scene_file);
  const double before_m_s2 = scene_file.bed.gravity_m_s2.norm();
  const Vec3 direction = before_m_s2 > 0 ? Vec3(scene_file.bed.gravity_m_s2 / before_m_s2) : Vec3(-Vec3::UnitZ());
  scene_file.bed.gravity_m_s2 = body.gravity_m_s2 * direction;
  scene_file.body = body.name;
  retitle(scene_file, before);
}

namespace {

void makeMeshOfFirst(SceneFile& scene_file) {
  const StonesParameters& stones = scene_file.bed.stones;
  if (scene_file.mesh.bytes != nullptr && largestSphere(stones) > kMostMeshReach_m) {
    throw InvalidParameter("stones", fmt::format("spheres up to {:g} mm in diameter", 2e3 * largestSphere(stones)),
                           fmt::format("at most {:g} mm with a mesh tool", 2e3 * kMostMeshReach_m));
  }
  scene_file.tool.mesh = scene_file.mesh.bytes == nullptr
                             ? nullptr
                             : toolMesh(scene_file.mesh, contactReach(scene_file.tool, scene_file.bed));
}

/// On the inside of a shell a grain larger than its curve would touch it in two places, of which contact knows one.
void requireRoomInJaws(const SceneFile& scene_file) {
  const ToolParameters& tool = scene_file.tool;
  if (tool.shape != ToolShape::kJaws || tool.jaw_bend_rad == 0) {
    return;
  }
  const SoilParameters& soil = scene_file.bed.soil;
  const double grain_m = soil.radius_m * (1 + soil.size_spread);
  const double inside_m = tool.size_m.x() / tool.jaw_bend_rad - tool.size_m.z() / 2;
  if (inside_m <= grain_m) {
    const double most_rad = tool.size_m.x() / (grain_m + tool.size_m.z() / 2);
    throw InvalidParameter("jaw_bend_rad", fmt::format("{:g}", tool.jaw_bend_rad),
                           fmt::format("less than {:.3g}, so that particles of {:g} mm diameter fit into the curve",
                                       most_rad, 2e3 * grain_m));
  }
}

/// Checks the first tool and its hand.
void validateFirst(const SceneFile& scene_file) {
  validate(scene_file.mesh);
  validate(scene_file.tool);
  validate(scene_file.hand);
  validate(scene_file.device);
  validate(scene_file.handling.mapping);
  validate(scene_file.handling.coupling, scene_file.loop.tick_s);
  validate(scene_file.handling.safety);
  requireRoomInJaws(scene_file);
}

void requireNames(const SceneFile& scene_file) {
  const std::vector<std::string_view> names = toolNames(scene_file);
  for (auto name = names.begin(); name != names.end(); ++name) {
    requireToolName(*name);
    if (std::find(names.begin(), name, *name) != name) {
      throw InvalidParameter("name", inQuotes(*name), "another name than those of the tools before it");
    }
  }
}

/// Each tool has its own device.
void requireDevices(const SceneFile& scene_file) {
  std::vector<const DeviceParameters*> devices{&scene_file.device};
  for (const SceneTool& tool : scene_file.more_tools) {
    devices.push_back(&tool.device);
  }
  std::erase_if(devices, [](const DeviceParameters* device) { return device->kind == DeviceKind::kVirtualHand; });
  if (devices.size() > SceneFile::kMostDevices) {
    throw InvalidParameter("device", fmt::format("{} devices", devices.size()),
                           fmt::format("at most {}", SceneFile::kMostDevices));
  }
  for (auto device = devices.begin(); device != devices.end(); ++device) {
    const auto is_it = [&](const DeviceParameters* other) {
      return other->kind == (*device)->kind && other->id == (*device)->id && other->address == (*device)->address;
    };
    if (std::find_if(devices.begin(), device, is_it) != device) {
      throw InvalidParameter("device", fmt::format("'{}' of two tools", wordFor(kDeviceWords, (*device)->kind)),
                             "another one for each tool, with its id or address");
    }
  }
}

}  // namespace

void makeToolMesh(SceneFile& scene_file) {
  for (std::size_t i = 0; i < toolCount(scene_file); ++i) {
    exchangeFirst(scene_file, i);
    const auto back = [&] { exchangeFirst(scene_file, i); };
    try {
      makeMeshOfFirst(scene_file);
    } catch (...) {
      back();
      throw;
    }
    back();
  }
}

namespace {

/// Radius of particles one step coarser, in m; none where canBeCoarser() is false.
std::optional<double> coarserRadiusFor(SceneFile scene_file) {
  BedParameters& bed = scene_file.bed;
  if (bed.start != BedStart::kSettled || bed.grading.fine_radius_m > 0) {
    return std::nullopt;
  }
  const std::optional<double> radius_m = coarserRadius(bed.soil.radius_m);
  if (radius_m) {
    try {
      bed.soil = rescaled(bed.soil, *radius_m);
      validate(scene_file);
    } catch (const InvalidParameter&) {  // larger than the box, the jaws
      return std::nullopt;
    }
  }
  return radius_m;
}

}  // namespace

bool canBeCoarser(const SceneFile& scene_file) {
  return coarserRadiusFor(scene_file).has_value();
}

void makeCoarser(SceneFile& scene_file) {
  const std::optional<double> radius_m = coarserRadiusFor(scene_file);
  if (!radius_m) {
    throw RefusedAction(
        "coarser", fmt::format("cannot use particles coarser than R = {:g} mm: the bed must start as settled, with "
                               "particles of one size below {:g} mm that leave room in the box",
                               inUnits(scene_file.bed.soil.radius_m, 1e-3), inUnits(kGrainRadii_m.front(), 1e-3)));
  }
  scene_file.bed.soil = rescaled(scene_file.bed.soil, *radius_m);
  makeToolMesh(scene_file);
}

void validate(const SceneFile& scene_file) {
  validate(scene_file.bed);
  validate(scene_file.loop);
  requireNames(scene_file);
  requireDevices(scene_file);
  validateFirst(scene_file);
  if (!scene_file.more_tools.empty()) {
    SceneFile each = scene_file;
    for (std::size_t i = 1; i < toolCount(each); ++i) {
      exchangeFirst(each, i);
      validateFirst(each);
    }
  }
  if (scene_file.bed.tick_s != scene_file.loop.tick_s) {
    throw InvalidParameter("tick_s", fmt::format("{}", scene_file.loop.tick_s),
                           fmt::format("the bed's {}", scene_file.bed.tick_s));
  }
}

}  // namespace haptolith
