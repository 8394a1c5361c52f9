#pragma once

#include "haptolith/bed/bed_parameters.h"
#include "haptolith/bed/kernel/kernel_law.h"
#include "haptolith/soil/contact_law.h"
#include "haptolith/soil/soil_parameters.h"

namespace haptolith {

/// A soil and every law that follows from it, computed once so that a bed can switch to them between two ticks.
struct SoilLaws {
  /// @param grain_classes  of the bed. @throws InvalidParameter as validate(SoilParameters).
  explicit SoilLaws(const SoilParameters& made_of, int grain_classes = 1);

  SoilParameters soil;
  ContactLaw pair, wall;
  KernelLaw kernel;  ///< with ICRA 2021 friction
  GradedLaw graded;  ///< with contact friction
  double mass_kg;    ///< mass of a particle of the coarsest class
};

/// Whether a bed can continue with another soil than it was made of, without moving its particles: they keep their
/// size, mass and model of friction, reach no further than its neighbour lists, and neither they nor its stones need
/// shorter steps.
[[nodiscard]] bool isCompatible(const BedParameters& made, const SoilParameters& soil, double tool_stiffness_n_m);

}  // namespace haptolith
