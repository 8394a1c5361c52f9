#include "haptolith/scene_file/scene_file.h"

#include <fmt/format.h>

#include <optional>

#include "haptolith/bed/start/ready_tile.h"
#include "haptolith/core/error.h"
#include "haptolith/scene_file/scene_words.h"
#include "haptolith/scene_file/toml/file_keys.h"
#include "haptolith/soil/bodies.h"
#include "haptolith/soil/presets.h"
#include "haptolith/tool/tool_contact.h"

namespace haptolith {

namespace {

std::string soilInWords(const SceneFile& scenario) {
  const std::string& named = scenario.preset.empty() ? scenario.soil_name : scenario.preset;
  return named.empty() ? "own soil" : named + " soil";
}

std::string toolInWords(const SceneFile& scenario) {
  switch (scenario.tool.shape) {
    case ToolShape::kBox: return "shovel";
    case ToolShape::kCone: return "cone";
    case ToolShape::kTube: return "tube";
    case ToolShape::kMesh: return scenario.mesh.name.empty() ? "mesh" : scenario.mesh.name;
    case ToolShape::kSphere:
    case ToolShape::kPlate:
    case ToolShape::kCylinder:
    case ToolShape::kJaws: break;
  }
  return std::string(wordFor(kToolShapeWords, scenario.tool.shape));
}

}  // namespace

HandlingParameters handlingOf(const SceneFile& scenario, double surface_m) {
  HandlingParameters handling = handlingOfOwnDevice(scenario, surface_m);
  if (scenario.device.kind == DeviceKind::kVirtualHand) {
    handling.mapping = {};
  }
  return handling;
}

HandlingParameters handlingOfOwnDevice(const SceneFile& scenario, double surface_m) {
  HandlingParameters handling = scenario.handling;
  handling.mapping.offset_m.z() += surface_m;
  return handling;
}

void setSoil(SceneFile& scenario, const SoilFile& soil) {
  scenario.preset.clear();
  scenario.soil_name = soil.name;
  scenario.bed.soil = soil.soil;
  if (soil.soil.friction == FrictionModel::kContact && scenario.bed.start == BedStart::kCount) {
    scenario.bed.start = BedStart::kRain;  // a lattice is a crystal, with planes it slips on: not what was calibrated
  }
}

std::string sceneInWords(const SceneFile& scenario) {
  std::string words =
      fmt::format("{}, {}, R = {:.3g} mm", soilInWords(scenario),
                  scenario.body.empty() ? fmt::format("{:.3g} m/s2", scenario.bed.gravity_m_s2.norm()) : scenario.body,
                  1e3 * scenario.bed.soil.radius_m);
  words += scenario.bed.stones.any() ? ", stones" : "";
  words += ", " + toolInWords(scenario);
  if (scenario.device.kind == DeviceKind::kVirtualHand && scenario.hand.manoeuvre != Manoeuvre::kStill) {
    words += fmt::format(", {}", wordFor(kManoeuvreWords, scenario.hand.manoeuvre));
  }
  return words;
}

void retitle(SceneFile& scenario, std::string_view before) {
  const std::string now = sceneInWords(scenario);
  if (now != before && now.size() <= mostBytes(TextSize::kLine)) {
    scenario.title = now;
  }
}

void changePreset(SceneFile& scenario, std::string_view name) {
  const Preset& preset = findPreset(name);
  const std::string before = sceneInWords(scenario);
  scenario.bed.soil = rescaled(preset.soil, scenario.bed.soil.radius_m);
  scenario.preset = preset.name;
  scenario.soil_name.clear();
  retitle(scenario, before);
}

void changeSoil(SceneFile& scenario, std::string_view name_or_file) {
  SoilFile file = findSoil(name_or_file);
  file.soil = rescaled(file.soil, scenario.bed.soil.radius_m);
  const std::string before = sceneInWords(scenario);
  setSoil(scenario, file);
  retitle(scenario, before);
}

void changeBody(SceneFile& scenario, std::string_view name) {
  const Body& body = findBody(name);
  const std::string before = sceneInWords(scenario);
  const double before_m_s2 = scenario.bed.gravity_m_s2.norm();
  const Vec3 direction = before_m_s2 > 0 ? Vec3(scenario.bed.gravity_m_s2 / before_m_s2) : Vec3(-Vec3::UnitZ());
  scenario.bed.gravity_m_s2 = body.gravity_m_s2 * direction;
  scenario.body = body.name;
  retitle(scenario, before);
}

void makeToolMesh(SceneFile& scenario) {
  const StonesParameters& stones = scenario.bed.stones;
  if (scenario.mesh.bytes != nullptr && largestSphere(stones) > kMostMeshReach_m) {
    throw InvalidParameter("stones", fmt::format("of spheres up to {:g} mm across", 2e3 * largestSphere(stones)),
                           fmt::format("at most {:g} mm where the tool is a mesh", 2e3 * kMostMeshReach_m));
  }
  scenario.tool.mesh =
      scenario.mesh.bytes == nullptr ? nullptr : toolMesh(scenario.mesh, contactReach(scenario.tool, scenario.bed));
}

/// On the inside of a shell a grain larger than its curve would touch it in two places, of which contact knows one.
void requireRoomInJaws(const SceneFile& scenario) {
  const ToolParameters& tool = scenario.tool;
  if (tool.shape != ToolShape::kJaws || tool.jaw_bend_rad == 0) {
    return;
  }
  const SoilParameters& soil = scenario.bed.soil;
  const double grain_m = soil.radius_m * (1 + soil.size_spread);
  const double inside_m = tool.size_m.x() / tool.jaw_bend_rad - tool.size_m.z() / 2;
  if (inside_m <= grain_m) {
    const double most_rad = tool.size_m.x() / (grain_m + tool.size_m.z() / 2);
    throw InvalidParameter(
        "jaw_bend_rad", fmt::format("{:g}", tool.jaw_bend_rad),
        fmt::format("less than {:.3g}, so that grains of {:g} mm fit into the curve", most_rad, 2e3 * grain_m));
  }
}

namespace {

/// Radius of particles one step coarser, in m; none where canBeCoarser() is false.
std::optional<double> coarserRadiusFor(SceneFile scenario) {
  BedParameters& bed = scenario.bed;
  if (bed.start != BedStart::kSettled || bed.grading.fine_radius_m > 0) {
    return std::nullopt;
  }
  const std::optional<double> radius_m = coarserRadius(bed.soil.radius_m);
  if (radius_m) {
    try {
      bed.soil = rescaled(bed.soil, *radius_m);
      validate(scenario);
    } catch (const InvalidParameter&) {  // larger than the box, the jaws
      return std::nullopt;
    }
  }
  return radius_m;
}

}  // namespace

bool canBeCoarser(const SceneFile& scenario) {
  return coarserRadiusFor(scenario).has_value();
}

void makeCoarser(SceneFile& scenario) {
  const std::optional<double> radius_m = coarserRadiusFor(scenario);
  if (!radius_m) {
    throw InvalidParameter("coarser", fmt::format("than {:g} mm", inUnits(scenario.bed.soil.radius_m, 1e-3)),
                           fmt::format("asked for where the bed starts as settled, with particles of one size below "
                                       "{:g} mm that leave room in the box",
                                       inUnits(kGrainRadii_m.front(), 1e-3)));
  }
  scenario.bed.soil = rescaled(scenario.bed.soil, *radius_m);
  makeToolMesh(scenario);
}

void validate(const SceneFile& scenario) {
  validate(scenario.bed);
  validate(scenario.mesh);
  validate(scenario.tool);
  validate(scenario.hand);
  validate(scenario.loop);
  validate(scenario.device);
  validate(scenario.handling.mapping);
  validate(scenario.handling.coupling, scenario.loop.tick_s);
  validate(scenario.handling.safety);
  requireRoomInJaws(scenario);
  if (scenario.bed.tick_s != scenario.loop.tick_s) {
    throw InvalidParameter("tick_s", fmt::format("{}", scenario.loop.tick_s),
                           fmt::format("the bed's {}", scenario.bed.tick_s));
  }
}

}  // namespace haptolith
