#pragma once

#include <vector>

#include "haptolith/lab/apparatus/lab_bed.h"
#include "haptolith/lab/laboratory.h"
#include "haptolith/lab/theory/mohr_coulomb.h"

namespace haptolith {

// Strength of a soil for equations that ask for one, measured by shearing it. Soil without cohesion between its
// particles has none: a fitted line's cohesion would be scatter, and its friction is that of a line without.

/// When it first fails: dense soil's peak. Loose soil has none and is sheared for long. Friction angle in rad.
/// @param normal_stresses_pa  those that the equations' soil is under; three or more.
/// @throws as shearTest(). Not for the tick.
[[nodiscard]] MohrCoulomb undisturbedStrength(const LabConditions& conditions, Preparation preparation,
                                              const std::vector<double>& normal_stresses_pa);

/// What is left when it has sheared by `strain`; the residual state begins at 2.
/// @throws as shearTest(). Not for the tick.
[[nodiscard]] MohrCoulomb residualStrength(const LabConditions& conditions,
                                           const std::vector<double>& normal_stresses_pa, double strain);

}  // namespace haptolith
