#include "haptolith/trust/trust_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/soil/contact_law.h"
#include "haptolith/tool/tool_part.h"

namespace haptolith {

namespace {

constexpr int kMostSubsteps = 1000;

int timesAsMany(int particles, double factor) {
  return static_cast<int>(std::min<double>(kMostParticles, std::round(particles * factor)));
}

/// Widens the box; soil that is counted stays as deep, and stones as frequent.
std::string widen(BedParameters& bed, double BedParameters::*side) {
  if (bed.start == BedStart::kGiven) {
    return "its particles have given places";
  }
  bed.*side *= 2;
  if (bed.start == BedStart::kCount || bed.start == BedStart::kRain) {
    bed.particles = timesAsMany(bed.particles, 2);
  }
  bed.stones.count *= 2;
  return {};
}

std::string deepen(BedParameters& bed) {
  switch (bed.start) {
    case BedStart::kGiven: return "its particles have given places";
    case BedStart::kPacked:
    case BedStart::kSettled: bed.depth_m *= 2; return {};
    case BedStart::kCount: bed.layers *= 2; [[fallthrough]];
    case BedStart::kRain: bed.particles = timesAsMany(bed.particles, 2); return {};
  }
  return {};
}

std::string changeRadius(SceneFile& scene, double ratio) {
  BedParameters& bed = scene.bed;
  if (bed.start == BedStart::kGiven) {
    return "its particles have given places";
  }
  bed.soil = rescaled(bed.soil, bed.soil.radius_m * ratio);
  bed.grading.fine_radius_m *= ratio;
  if (bed.start == BedStart::kCount || bed.start == BedStart::kRain) {
    bed.particles = std::max(1, timesAsMany(bed.particles, std::pow(ratio, -3)));
    bed.layers = std::max(1, static_cast<int>(std::lround(bed.layers / ratio)));
  }
  return {};
}

std::string stiffen(SceneFile& scene) {
  scene.bed.soil.stiffness_n_m *= 2;
  scene.bed.soil.gamma_nm *= 2;
  scene.tool.stiffness_n_m *= 2;
  for (SceneTool& tool : scene.more_tools) {
    tool.tool.stiffness_n_m *= 2;
  }
  return {};
}

std::string drawTool(SceneFile& scene) {
  const ToolParameters& tool = scene.tool;
  ToolPart part;
  switch (tool.shape) {
    case ToolShape::kBox: part = {.form = ToolPartForm::kBox, .size_m = tool.size_m}; break;
    case ToolShape::kSphere: part = {.form = ToolPartForm::kSphere, .diameter_m = tool.diameter_m}; break;
    case ToolShape::kPlate:
      part = {.form = ToolPartForm::kCylinder, .diameter_m = tool.diameter_m, .length_m = tool.thickness_m};
      break;
    case ToolShape::kCylinder:
      part = {.form = ToolPartForm::kCylinder, .diameter_m = tool.diameter_m, .length_m = tool.length_m};
      break;
    case ToolShape::kMesh: return "the tool is a mesh";
    default: return "no mesh is made of this shape";
  }
  scene.mesh = {};
  scene.mesh.name = "the tool";
  scene.mesh.format = MeshFormat::kObj;
  scene.mesh.bytes = std::make_shared<const std::string>(drawn(std::span(&part, 1)));
  scene.mesh.origin_m = Vec3::Zero();
  scene.tool.shape = ToolShape::kMesh;
  return {};
}

std::string apply(TrustChange change, double radius_ratio, TrustRun& run) {
  SceneFile& scene = run.scene;
  switch (change) {
    case TrustChange::kNone: return {};
    case TrustChange::kWideX:
      return scene.bed.periodic_x ? "the box repeats itself" : widen(scene.bed, &BedParameters::width_m);
    case TrustChange::kWideY:
      return scene.bed.periodic_y ? "the box repeats itself" : widen(scene.bed, &BedParameters::length_m);
    case TrustChange::kDeep: return deepen(scene.bed);
    case TrustChange::kRadius: return changeRadius(scene, radius_ratio);
    case TrustChange::kStep: run.step_factor = 2; return {};
    case TrustChange::kAwake:
      if (!scene.bed.sleep) {
        return "no particle may sleep";
      }
      scene.bed.sleep = false;
      return {};
    case TrustChange::kStiff: return stiffen(scene);
    case TrustChange::kMesh: return drawTool(scene);
  }
  return {};
}

}  // namespace

std::string_view nameOf(TrustChange change) noexcept {
  static constexpr std::array<std::string_view, 9> kNames{"specimen", "wide-x", "wide-y", "deep", "radius",
                                                          "step",     "awake",  "stiff",  "mesh"};
  return kNames.at(static_cast<std::size_t>(change));
}

std::string titleOf(TrustChange change, double radius_ratio) {
  switch (change) {
    case TrustChange::kNone: return "another specimen";
    case TrustChange::kWideX: return "box twice as wide, x";
    case TrustChange::kWideY: return "box twice as wide, y";
    case TrustChange::kDeep: return "soil twice as deep";
    case TrustChange::kRadius:
      if (radius_ratio == 0.5) {
        return "particles half as large";
      }
      return fmt::format("particles {:.2g} times as large", radius_ratio);
    case TrustChange::kStep: return "step half as long";
    case TrustChange::kAwake: return "no particle sleeps";
    case TrustChange::kStiff: return "contacts twice as stiff";
    case TrustChange::kMesh: return "tool as a mesh";
  }
  return {};
}

bool hasSeed(const SceneFile& scene) noexcept {
  const BedParameters& bed = scene.bed;
  return bed.start == BedStart::kSettled || bed.start == BedStart::kRain || bed.grading.fine_radius_m > 0;
}

PlannedRun planned(const SceneFile& scene, TrustChange change, std::size_t specimen, double radius_ratio) {
  TrustRun run{.change = change, .radius_ratio = radius_ratio, .specimen = specimen, .scene = scene};
  BedParameters& bed = run.scene.bed;
  if (hasSeed(scene)) {
    bed.seed += specimen;
    bed.ready_made = bed.ready_made && specimen == 0;
  } else if (specimen > 0) {
    // Places that fill the square between particles evenly: the R2 sequence of Roberts (2018).
    const auto place = [&](double step) { return 2 * std::fmod(step * static_cast<double>(specimen), 1.0) - 1; };
    run.shift_m = bed.soil.radius_m * Vec3(place(0.7548776662466927), place(0.5698402909980532), 0);
  }
  bed.max_substeps = kMostSubsteps;
  std::string why_not = apply(change, radius_ratio, run);
  if (!why_not.empty()) {
    return {{}, std::move(why_not)};
  }
  try {
    makeToolMesh(run.scene);
    validate(run.scene);
  } catch (const InvalidParameter& refused) {
    return {{}, refused.what()};
  }
  return {std::move(run), {}};
}

double relativeCost(TrustChange change, double radius_ratio) noexcept {
  switch (change) {
    case TrustChange::kNone: return 1;
    case TrustChange::kWideX:
    case TrustChange::kWideY: return 1.5;
    case TrustChange::kDeep: return 2.5;
    case TrustChange::kRadius: return std::pow(radius_ratio, -4);
    case TrustChange::kStep: return 1.5;
    case TrustChange::kAwake: return 2;
    case TrustChange::kStiff: return 1.5;
    case TrustChange::kMesh: return 1.2;
  }
  return 1;
}

}  // namespace haptolith
