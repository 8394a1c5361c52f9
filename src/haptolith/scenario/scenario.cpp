#include "haptolith/scenario/scenario.h"

#include <fmt/format.h>

#include "haptolith/core/error.h"

namespace haptolith {

void setSoil(Scenario& scenario, const SoilFile& soil) {
  scenario.preset.clear();
  scenario.soil_name = soil.name;
  scenario.bed.soil = soil.soil;
  if (soil.soil.friction == FrictionModel::kPairwise && scenario.bed.start == BedStart::kCount) {
    scenario.bed.start = BedStart::kRain;  // a lattice is a crystal, with planes it slips on: not what was calibrated
  }
}

void validate(const Scenario& scenario) {
  validate(scenario.bed);
  validate(scenario.tool);
  validate(scenario.hand);
  validate(scenario.loop);
  if (scenario.bed.tick_s != scenario.loop.tick_s) {
    throw InvalidParameter("tick_s", fmt::format("{}", scenario.loop.tick_s),
                           fmt::format("the bed's {}", scenario.bed.tick_s));
  }
}

}  // namespace haptolith
