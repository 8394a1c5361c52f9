#include "haptolith/bed/kernel/soil_laws.h"

#include <algorithm>

#include "haptolith/bed/critical_step.h"

namespace haptolith {

SoilLaws::SoilLaws(const SoilParameters& made_of, int grain_classes)
    : soil(made_of),
      pair(makeContactLaw(soil)),
      wall(wallLaw(pair, soil.radius_m)),
      kernel(kernelLaw(pair, soil.radius_m)),
      graded(gradedLaw(soil, grain_classes)),
      mass_kg(macroparticleMass(soil)) {}

bool isCompatible(const BedParameters& made, const SoilParameters& soil, double tool_stiffness_n_m) {
  BedParameters next = made;
  next.soil = soil;
  const auto may_change = [&](const SoilNumber& number) {
    const double now = made.soil.*number.member;
    const double wanted = soil.*number.member;
    return number.change == SoilChange::kFree || wanted == now ||
           (number.change == SoilChange::kNotLarger && wanted < now);
  };
  return soil.friction == made.soil.friction && std::ranges::all_of(kSoilNumbers, may_change) &&
         makeContactLaw(soil).cutoff_m <= makeContactLaw(made.soil).cutoff_m &&
         stepsPerSecond(next, tool_stiffness_n_m) <= stepsPerSecond(made, tool_stiffness_n_m);
}

}  // namespace haptolith
