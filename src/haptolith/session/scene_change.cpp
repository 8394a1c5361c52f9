#include "haptolith/session/scene_change.h"

#include "haptolith/core/error.h"
#include "haptolith/session/soil_sliders.h"

namespace haptolith {

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
    scenario.bed.soil = withSlider(scenario.bed.soil, key, value);
  }
  if (change.body) {
    changeBody(scenario, *change.body);
  }
  ToolParameters& tool = scenario.tool;
  tool.shape = change.tool_shape.value_or(tool.shape);
  tool.size_m = change.tool_size_m.value_or(tool.size_m);
  tool.diameter_m = change.tool_diameter_m.value_or(tool.diameter_m);
  tool.thickness_m = change.tool_thickness_m.value_or(tool.thickness_m);
  tool.opening_m = change.tool_opening_m.value_or(tool.opening_m);
  validate(scenario);
  return scenario;
}

}  // namespace haptolith
