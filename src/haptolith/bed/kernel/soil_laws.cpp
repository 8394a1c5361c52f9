#include "haptolith/bed/kernel/soil_laws.h"

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
  return soil.radius_m == made.soil.radius_m && soil.rho0_kg_m3 == made.soil.rho0_kg_m3 &&
         soil.friction == made.soil.friction && soil.size_spread == made.soil.size_spread &&
         soil.damping_ratio <= made.soil.damping_ratio &&
         makeContactLaw(soil).cutoff_m <= makeContactLaw(made.soil).cutoff_m &&
         stepsPerSecond(next, tool_stiffness_n_m) <= stepsPerSecond(made, tool_stiffness_n_m);
}

}  // namespace haptolith
