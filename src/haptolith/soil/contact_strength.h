#pragma once

#include "haptolith/core/error.h"
#include "haptolith/soil/soil_parameters.h"
#include "haptolith/soil/soil_target.h"

namespace haptolith {

/// Radius of the macroparticles that the table of shear tests is about, in m.
inline constexpr double kTabulatedRadius_m = 7e-3;

/// Soil whose contacts behave like the lunar soil's, of kTabulatedRadius_m, with friction between its particles and no
/// cohesion: what named soils are calibrated from. gamma and rho_max / rho0 give the measured density with depth, k
/// carries 3 kPa with an overlap that still leaves the particles round, and the sizes differ enough that they never
/// crystallise.
[[nodiscard]] SoilParameters lunarContacts();

/// A strength as a shear test gives it.
struct ShearStrength {
  double angle_deg = 0;
  double cohesion_pa = 0;
};

/// Contact friction and cohesion, the latter for R = kTabulatedRadius_m.
struct ContactStrength {
  double friction = 0;
  double cohesion_n = 0;
};

/// Interpolates simulated shear tests of lunar contacts, and extrapolates linearly beyond them. Its slopes also hold
/// for other soils; its values are off by a few degrees and a fifth of the cohesion.
[[nodiscard]] ShearStrength tabulatedStrength(const ContactStrength& contact, SoilStrength kind);

/// The contact for which tabulatedStrength() is the wanted one, as near as contacts go.
[[nodiscard]] ContactStrength tabulatedContact(const ShearStrength& wanted, SoilStrength kind);

/// Change of a calibrated soil's friction angle and cohesion with its contacts: at the calibrated contacts
/// they are the soil's own, elsewhere an estimate from tabulatedStrength().
class CalibratedStrength {
 public:
  /// @param calibrated  soil with contact friction that has the strength of `target`
  CalibratedStrength(const SoilParameters& calibrated, const SoilTarget& target);

  /// Friction angle, deg, and cohesion, Pa, of the soil with other contacts.
  [[nodiscard]] ShearStrength of(const SoilParameters& soil) const;
  /// The soil with contacts that have this strength, as near as contacts go.
  [[nodiscard]] SoilParameters with(SoilParameters soil, const ShearStrength& wanted) const;
  /// The friction angles, in deg, that contacts of the soil's cohesion can have, and the cohesions, in Pa, that
  /// contacts of its friction can have.
  [[nodiscard]] Range anglesFor(const SoilParameters& soil) const;
  [[nodiscard]] Range cohesionsFor(const SoilParameters& soil) const;

 private:
  [[nodiscard]] ShearStrength at(const ContactStrength& contact) const;
  [[nodiscard]] double cohesionOf(const ContactStrength& contact) const;
  [[nodiscard]] double contactCohesionFor(double friction, double cohesion_pa) const;

  SoilStrength kind_;
  double angle_offset_deg_ = 0, cohesion_factor_ = 1;
};

}  // namespace haptolith
