#pragma once

#include <optional>
#include <string>
#include <vector>

#include "haptolith/lab/apparatus/settle.h"
#include "haptolith/lab/tests/blade.h"
#include "haptolith/lab/tests/carry.h"
#include "haptolith/lab/tests/cone.h"
#include "haptolith/lab/tests/cut.h"
#include "haptolith/lab/tests/fall.h"
#include "haptolith/lab/tests/funnel.h"
#include "haptolith/lab/tests/plate.h"
#include "haptolith/lab/tests/repose.h"
#include "haptolith/lab/tests/shear.h"
#include "haptolith/soil/soil_target.h"

namespace haptolith {

// What each test of the laboratory should give, and whether it does. `target` is what an engineer measured of the soil;
// without it, and without a law that holds for every soil, there is nothing to pass or fail.

/// Whether the densities measured on the Moon (measuredBands()) say anything of this soil: on the Moon, for soil of
/// which nothing else is known or which is as dense there.
[[nodiscard]] bool isLunar(double gravity_m_s2, const std::optional<SoilTarget>& target);

/// One for each of its bands: lunar soil against the Lunar Sourcebook; another with a target against that, +- 5 %, in
/// the upper 15 cm.
[[nodiscard]] std::vector<Finding> findings(const SettleResult& result, double gravity_m_s2,
                                            const std::optional<SoilTarget>& target);
/// Friction angle +- 2 degrees; cohesion +- 20 %, or +- 50 Pa where that is more.
[[nodiscard]] std::vector<Finding> findings(const ShearResult& result, const std::optional<SoilTarget>& target);
/// What calibrateSoil() reached beside what was asked: as of a sheared and a settled bed.
[[nodiscard]] std::vector<Finding> findings(const SoilReached& reached, const SoilTarget& target);
/// +- 3 degrees of the friction angle of a soil without cohesion.
[[nodiscard]] std::vector<Finding> findings(const ReposeResult& result, const std::optional<SoilTarget>& target);
/// Stands (kStandingCut) with 100 Pa of cohesion or more, else falls.
[[nodiscard]] std::vector<Finding> findings(const CutResult& result, double height_m,
                                            const std::optional<SoilTarget>& target);
[[nodiscard]] std::vector<Finding> findings(const PlateResult& result, double diameter_m);
[[nodiscard]] std::vector<Finding> findings(const ConeResult& result);
/// +- 40 % of the earthmoving equation, for a soil with a target; wedges with sides are beside it, not judged.
[[nodiscard]] std::vector<Finding> findings(const BladeResult& result, const std::optional<SoilTarget>& target);
/// Beverloo (1961): the opening to the power of 2.5 +- 0.3; it clogs below some opening of 3 to 8 particle diameters.
[[nodiscard]] std::vector<Finding> findings(const FunnelResult& result);
/// Newton: the weight is felt within 3 %, and no drag above 3 % of it.
[[nodiscard]] std::vector<Finding> findings(const CarryResult& result);
/// Newton: falls with g, +- 0.1 %.
[[nodiscard]] std::vector<Finding> findings(const FallResult& result);

}  // namespace haptolith
