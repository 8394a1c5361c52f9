#pragma once

#include <cstdint>

#include "haptolith/lab/laboratory.h"
#include "haptolith/lab/tests/shear.h"
#include "haptolith/soil/soil_target.h"

namespace haptolith {

/// Valid ranges.
struct CalibrateSoilRanges {
  static constexpr Range verification_seeds{2, 100};
};

/// Dependence of density on depth.
enum class DensityProfile {
  kLunar,     ///< grows with depth, as on the Moon: contacts are soft at first (paper 7)
  kConstant,  ///< uniform, as in a laboratory's box: contacts are linear springs
};

struct CalibrateSoilOptions {
  double radius_m = 7e-3;         ///< R of the calibrated soil, 0.5 to 20 mm
  double stiffness_n_m = 0;       ///< k; 0: chosen for max_pressure_pa, see calibrateSoil()
  double max_pressure_pa = 10e3;  ///< largest pressure that the soil shall bear as soil of rigid particles; 100 to 1e6
  DensityProfile density = DensityProfile::kLunar;
  double gravity_m_s2 = 1.625;  ///< gravity under which the soil has the target's bulk density
  std::uint64_t seed = 1;       ///< seed of all specimens, those of the verification included
  int threads = 1;
  int verification_seeds = 5;  ///< 2 or more
  ShearOptions shear{};
  LabProgress progress{};
};

struct CalibratedSoil {
  SoilParameters soil;
  SoilReached reached;
  int rounds = 0;  ///< rounds of simulated shear tests until it was within tolerance
};

/// Reachable targets with contacts of the shipped kind.
inline constexpr double kLeastFrictionAngle_deg = 20;
inline constexpr double kMostFrictionAngle_deg = 52;
inline constexpr double kMostCohesion_pa = 4500;

/// Finds the contact parameters for the wanted friction angle and cohesion of a sheared bed, and the particle mass for
/// the wanted bulk density.
///
/// The shape of the contact law is that of lunar soil, whose density with depth it reproduces
/// (docs/reference/soils.md), or a linear spring. Under 0.3 of max_pressure_pa a contact has an
/// overlap of 2.8 % of R. Four times the stiffness raises the residual angle by less than 2 degrees
/// (docs/explanation/contact-model.md) and costs twice the steps. Linear springs, which do not stiffen, have an overlap
/// of 0.35 %.
///
/// Contact friction and cohesion start from a table of simulated shear tests. Further shear tests of this soil correct
/// them (Broyden's method) until its line is within 0.5 degrees and 6 % (or 20 Pa) of the target. The best of seven
/// rounds is taken. rho0 and rho_max are scaled together until the mean density of the upper 15 cm of a settled column
/// is the target's. Finally, `verification_seeds` other specimens are sheared, and their results are reported
/// unchanged.
/// @param target  residual or peak strength; 800 to 3000 kg/m^3, 20 to 52 degrees, 0 to 4500 Pa.
/// @throws InvalidParameter for a target out of reach, with the reachable range; Failure as shearTest().
[[nodiscard]] CalibratedSoil calibrateSoil(const SoilTarget& target, const CalibrateSoilOptions& options = {});

}  // namespace haptolith
