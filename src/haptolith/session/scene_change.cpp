#include "haptolith/session/scene_change.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "haptolith/session/soil_sliders.h"

namespace haptolith {

namespace {

constexpr double kMm = 1e-3;  // m

double checkedLength(std::string_view key, double length_m, const Range& valid_m) {
  requireInRange(key, inUnits(length_m, kMm), valid_m.in(kMm));
  return length_m;
}

}  // namespace

Range toolLengths(const BedParameters& bed) {
  return {ToolRanges::length_m.lowest, std::min(bed.width_m, bed.length_m)};
}

Scenario changed(Scenario scenario, const SceneChange& change) {
  if (change.preset && change.soil) {
    throw InvalidParameter("soil", *change.soil, "left out when there is a preset");
  }
  if (change.preset) {
    changePreset(scenario, *change.preset);
  }
  if (change.soil) {
    changeSoil(scenario, *change.soil);
  }
  scenario.bed.soil.friction = change.friction.value_or(scenario.bed.soil.friction);
  for (const auto& [key, value] : change.sliders) {
    scenario.bed.soil = withSlider(scenario.bed.soil, key, value, calibrationOf(scenario));
  }
  if (change.body) {
    changeBody(scenario, *change.body);
  }
  ToolParameters& tool = scenario.tool;
  tool.shape = change.tool_shape.value_or(tool.shape);
  const Range lengths_m = toolLengths(scenario.bed);
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
  makeToolMesh(scenario);
  validate(scenario);
  return scenario;
}

}  // namespace haptolith
