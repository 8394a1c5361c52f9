#pragma once

#include <optional>
#include <string>
#include <vector>

#include "haptolith/lab/apparatus/settle.h"
#include "haptolith/lab/tests/blade.h"
#include "haptolith/lab/tests/cone.h"
#include "haptolith/lab/tests/free_fall.h"
#include "haptolith/lab/tests/hopper.h"
#include "haptolith/lab/tests/payload.h"
#include "haptolith/lab/tests/plate.h"
#include "haptolith/lab/tests/repose.h"
#include "haptolith/lab/tests/shear.h"
#include "haptolith/lab/tests/vertical_cut.h"
#include "haptolith/soil/soil_target.h"

namespace haptolith {

// Results of the laboratory's tests, compared with their targets. `target` holds the measured values of the real soil.
// Without it, and without a law that holds for every soil, there is no verdict.

/// Whether the densities measured on the Moon (measuredBands()) apply to this soil: under lunar gravity, for soil
/// without a target or with a target of the same density.
[[nodiscard]] bool isLunar(double gravity_m_s2, const std::optional<SoilTarget>& target);

/// Returns one finding per band. Lunar soil is compared with the Lunar Sourcebook; another soil with its target, +- 5
/// %, in the upper 15 cm.
[[nodiscard]] std::vector<Finding> findings(const SettleResult& result, double gravity_m_s2,
                                            const std::optional<SoilTarget>& target);
/// Returns findings of a shear test: friction angle +- 2 degrees; cohesion +- 20 %, or +- 50 Pa where that is more.
[[nodiscard]] std::vector<Finding> findings(const ShearResult& result, const std::optional<SoilTarget>& target);
/// Compares the result of calibrateSoil() with its target, with the tolerances of the shear and settle tests.
[[nodiscard]] std::vector<Finding> findings(const SoilReached& reached, const SoilTarget& target);
/// Returns the angle of repose: +- 3 degrees of the friction angle of a soil without cohesion.
[[nodiscard]] std::vector<Finding> findings(const ReposeResult& result, const std::optional<SoilTarget>& target);
/// Expects a cut to stand (kStandingCut) with 100 Pa of cohesion or more, and to fall otherwise.
[[nodiscard]] std::vector<Finding> findings(const VerticalCutResult& result, double height_m,
                                            const std::optional<SoilTarget>& target);
[[nodiscard]] std::vector<Finding> findings(const PlateResult& result, double diameter_m);
[[nodiscard]] std::vector<Finding> findings(const ConeResult& result);
/// Compares with the earthmoving equation, +- 40 %, for a soil with a target. Wedges with sides are listed without a
/// verdict.
[[nodiscard]] std::vector<Finding> findings(const BladeResult& result, const std::optional<SoilTarget>& target);
/// Compares with Beverloo (1961): exponent of the opening 2.5 +- 0.3; clogging below an opening of 3 to 8 particle
/// diameters.
[[nodiscard]] std::vector<Finding> findings(const HopperResult& result);
/// Compares with Newton's laws: weight within 3 %, and drag of at most 3 % of it.
[[nodiscard]] std::vector<Finding> findings(const PayloadResult& result);
/// Compares with Newton's laws: acceleration g, +- 0.1 %.
[[nodiscard]] std::vector<Finding> findings(const FreeFallResult& result);

}  // namespace haptolith
