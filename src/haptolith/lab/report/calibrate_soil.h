#pragma once

#include <cstdint>

#include "haptolith/lab/laboratory.h"
#include "haptolith/lab/tests/shear.h"
#include "haptolith/soil/soil_target.h"

namespace haptolith {

/// What is valid.
struct CalibrateSoilRanges {
  static constexpr Range verification_seeds{2, 100};
};

/// How dense the soil is that lies deeper.
enum class DensityProfile {
  kLunar,     ///< denser with depth, as the Moon's: contacts yield at first (paper 7)
  kConstant,  ///< as dense below as above, as in a laboratory's box: contacts are linear springs
};

struct CalibrateSoilOptions {
  double radius_m = 7e-3;    ///< R of the soil that comes out, 0.5 to 20 mm
  double stiffness_n_m = 0;  ///< k; 0: what the greatest normal stress of the shear test needs, see calibrateSoil()
  DensityProfile density = DensityProfile::kLunar;
  double gravity_m_s2 = 1.625;  ///< under which the soil has the target's bulk density
  std::uint64_t seed = 1;       ///< another one: other specimens, those of the verification as well
  int threads = 1;
  int verification_seeds = 5;  ///< 2 or more
  ShearOptions shear{};
  LabProgress progress{};
};

struct CalibratedSoil {
  SoilParameters soil;
  SoilReached reached;
  int rounds = 0;  ///< of simulated shear tests until it was good enough
};

/// What can be asked for, and what contacts of the shipped kind can give.
inline constexpr double kLeastFrictionAngle_deg = 20;
inline constexpr double kMostFrictionAngle_deg = 52;
inline constexpr double kMostCohesion_pa = 4500;

/// Finds the contacts whose sheared bed has the wanted friction angle and cohesion, and the mass at which it has the
/// wanted bulk density.
///
/// The shape of the contact law is that of lunar soil, whose density with depth it reproduces
/// (docs/reference/soils.md), or a linear spring. Stiffness is such that a contact under the greatest normal stress of
/// the shear test gives way by 2.8 % of R: contacts four times as stiff raise the residual angle by less than 2 degrees
/// (docs/explanation/contact-model.md) and cost twice the steps. Linear springs give way
/// by 0.35 %. Contact friction and cohesion start from a table of simulated shear tests, and are then corrected by
/// shear tests of this very soil (Broyden's method) until its line lies within 0.5 degrees and 6 % (or 20 Pa) of the
/// target; the best of seven rounds is taken. rho0 and rho_max are scaled together until the mean density of the upper
/// 15 cm of a settled column is the target's. At last `verification_seeds` other specimens are sheared, and what they
/// showed is reported as it came.
/// @param target  residual or peak strength; 1000 to 2500 kg/m^3, 20 to 52 degrees, 0 to 4500 Pa.
/// @throws InvalidParameter for a target out of reach, with the reachable range; Failure as shearTest().
[[nodiscard]] CalibratedSoil calibrateSoil(const SoilTarget& target, const CalibrateSoilOptions& options = {});

}  // namespace haptolith
