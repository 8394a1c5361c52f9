#include "haptolith/bed/soil_laws.h"

#include "haptolith/bed/critical_step.h"

namespace haptolith {

SoilLaws::SoilLaws(const SoilParameters& made_of, int grain_classes)
    : soil(made_of),
      pair(makeContactLaw(soil)),
      wall(wallLaw(pair, soil.radius_m)),
      kernel(kernelLaw(pair, soil.radius_m)),
      graded(gradedLaw(soil, grain_classes)),
      mass_kg(macroparticleMass(soil)) {}

bool isCompatible(const SoilParameters& made_of, const SoilParameters& soil, double tool_stiffness_n_m) {
  return soil.radius_m == made_of.radius_m && soil.rho0_kg_m3 == made_of.rho0_kg_m3 &&
         soil.friction == made_of.friction && soil.size_spread == made_of.size_spread &&
         soil.damping_ratio <= made_of.damping_ratio &&
         makeContactLaw(soil).cutoff_m <= makeContactLaw(made_of).cutoff_m &&
         stepsPerSecond(soil, tool_stiffness_n_m) <= stepsPerSecond(made_of, tool_stiffness_n_m);
}

}  // namespace haptolith
