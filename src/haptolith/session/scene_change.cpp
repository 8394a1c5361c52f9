#include "haptolith/session/scene_change.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "haptolith/session/soil_sliders.h"

namespace haptolith {

namespace {

constexpr double kMm = 1e-3;  // m

double checkedLength(std::string_view key, double length_m, const Range& valid_m) {
  requireInRange(key, inUnits(length_m, kMm), valid_m.in(kMm));
  return length_m;
}

[[noreturn]] void refuseLength(std::string_view key, double length_m, const char* why) {
  throw InvalidParameter(std::string(key), fmt::format("{:g}", inUnits(length_m, kMm)),
                         fmt::format("left out: {}", why));
}

void changeDepth(BedParameters& bed, double depth_m) {
  if (bed.start != BedStart::kPacked && bed.start != BedStart::kSettled) {
    refuseLength("soil_depth_mm", depth_m, "only a bed that starts `packed` or `settled` is filled up to a depth");
  }
  bed.depth_m = checkedLength("soil_depth_mm", depth_m, BedRanges::length_m);
}

void changeStones(std::vector<PlacedStone>& stones, const SceneChange& change) {
  if (stones.empty() && (change.stone_size_m || change.stone_depth_m)) {
    refuseLength(change.stone_size_m ? "stone_size_mm" : "stone_depth_mm",
                 change.stone_size_m.value_or(change.stone_depth_m.value_or(0)), "the scene has no [[stone]]");
  }
  for (PlacedStone& stone : stones) {
    if (change.stone_size_m && stone.form == StoneForm::kSpheres) {
      refuseLength("stone_size_mm", *change.stone_size_m, "a stone of shape = spheres has the size of its spheres");
    }
    stone.size_m =
        change.stone_size_m ? checkedLength("stone_size_mm", *change.stone_size_m, kStoneSize_m) : stone.size_m;
    stone.depth_m = change.stone_depth_m ? checkedLength("stone_depth_mm", *change.stone_depth_m, StonesRanges::depth_m)
                                         : stone.depth_m;
  }
}

void changeGravity(SceneFile& scene_file, double gravity_m_s2) {
  Vec3& gravity = scene_file.bed.gravity_m_s2;
  const double now_m_s2 = gravity.norm();
  requireInRange("gravity_m_s2", gravity_m_s2, BedRanges::gravity_m_s2);
  gravity = now_m_s2 > 0 ? Vec3(gravity * (gravity_m_s2 / now_m_s2)) : Vec3(0, 0, -gravity_m_s2);
  scene_file.body.clear();
}

}  // namespace

Range toolLengths(const BedParameters& bed) {
  return {ToolRanges::length_m.lowest, std::min(bed.width_m, bed.length_m)};
}

void requireFitting(const MeshCorners& mesh, const std::string& name, const Range& lengths_m) {
  Vec3 size_m = mesh.high_m - mesh.low_m;
  std::ranges::sort(size_m);
  if (size_m[1] > lengths_m.highest) {
    throw InvalidParameter(
        name,
        fmt::format("{:.0f} x {:.0f} x {:.0f} mm", inUnits(size_m[0], kMm), inUnits(size_m[1], kMm),
                    inUnits(size_m[2], kMm)),
        fmt::format("at most {:.0f} mm in two of its directions, as wide as the box: is its unit right?",
                    inUnits(lengths_m.highest, kMm)));
  }
}

SceneFile changed(SceneFile scene_file, const SceneChange& change) {
  if (change.preset && change.soil) {
    throw InvalidParameter("soil", *change.soil, "left out when there is a preset");
  }
  const std::string before = sceneInWords(scene_file);
  if (change.preset) {
    changePreset(scene_file, *change.preset);
  }
  if (change.soil) {
    changeSoil(scene_file, *change.soil);
  }
  scene_file.bed.soil.friction = change.friction.value_or(scene_file.bed.soil.friction);
  for (const auto& [key, value] : change.sliders) {
    scene_file.bed.soil = withSlider(scene_file.bed.soil, key, value, calibrationOf(scene_file));
  }
  if (change.body) {
    changeBody(scene_file, *change.body);
  }
  if (change.gravity_m_s2) {
    changeGravity(scene_file, *change.gravity_m_s2);
  }
  if (change.soil_depth_m) {
    changeDepth(scene_file.bed, *change.soil_depth_m);
  }
  changeStones(scene_file.bed.stones.placed, change);
  ToolParameters& tool = scene_file.tool;
  tool.shape = change.tool_shape.value_or(tool.shape);
  const Range lengths_m = toolLengths(scene_file.bed);
  for (int axis = 0; axis < 3 && change.tool_size_m; ++axis) {
    tool.size_m[axis] = checkedLength("size_mm", (*change.tool_size_m)[axis], lengths_m);
  }
  const auto set = [&](double& length_m, std::string_view key, const std::optional<double>& wanted_m) {
    length_m = wanted_m ? checkedLength(key, *wanted_m, lengths_m) : length_m;
  };
  set(tool.diameter_m, "diameter_mm", change.tool_diameter_m);
  set(tool.thickness_m, "thickness_mm", change.tool_thickness_m);
  set(tool.opening_m, "opening_mm", change.tool_opening_m);
  set(tool.length_m, "length_mm", change.tool_length_m);
  if (change.tool_mesh) {
    scene_file.mesh = *change.tool_mesh;
  }
  makeToolMesh(scene_file);
  if (change.tool_mesh) {
    requireFitting(scene_file.tool.mesh->field.corners(), scene_file.mesh.name, lengths_m);
  }
  retitle(scene_file, before);
  validate(scene_file);
  return scene_file;
}

}  // namespace haptolith
