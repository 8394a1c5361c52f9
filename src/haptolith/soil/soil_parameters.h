#pragma once

#include "haptolith/core/error.h"

namespace haptolith {

/// What friction acts against, and where cohesion comes from.
enum class FrictionModel {
  kPaper,    ///< against absolute space (paper 14, 20); cohesion is the attraction of (paper 19)
  kContact,  ///< between particles that touch (Cundall and Strack 1979); cohesion is a parameter of its own
};

/// The soil as its macroparticles see it: one row of the paper's Table II and the constants the paper fixes once; and
/// what contact friction has instead of mu_hat, R_attr and lambda.
struct SoilParameters {
  double radius_m = 7e-3;         ///< R, radius of a macroparticle
  double gamma_nm = 4e-5;         ///< gamma of the contact law (paper 7), N m
  double rho0_kg_m3 = 1330;       ///< bulk density at the surface
  double rho_max_kg_m3 = 1824;    ///< bulk density at which the contact force would diverge (paper 8)
  double mu_hat = 0.342;          ///< model friction (paper 14)
  double stiffness_n_m = 100;     ///< k, limiting stiffness (paper 7); infinity is allowed in the layer analysis only
  double attraction_ratio = 1.1;  ///< R_attr / R (paper 19); 1 switches attraction off
  double moving_friction_ratio = 0.8;  ///< lambda, moving over static friction (paper 14)

  FrictionModel friction = FrictionModel::kPaper;
  double contact_friction = 0.5;      ///< mu_p, Coulomb friction of a contact
  double contact_cohesion_n = 0;      ///< F_c, largest pull of a contact, and what it adds to the normal force
  double cohesion_range_ratio = 0.4;  ///< how far apart two particles still cohere, in R
  double tangential_ratio = 0.5;      ///< k_t / k, tangential over normal stiffness of a contact
  double size_spread = 0;      ///< radii lie evenly between R (1 - spread) and R (1 + spread); all weigh the same
  double damping_ratio = 0.2;  ///< zeta, of a pair that bounces, over critical damping

  [[nodiscard]] bool operator==(const SoilParameters&) const = default;
};

/// What is valid of each number alone; read by validate(), scene files and soil files alike.
struct SoilRanges {
  static constexpr Range radius_m{1e-5, 1};
  static constexpr Range gamma_nm{0, Range{}.highest, Ends::kOpen};
  static constexpr Range rho0_kg_m3{0, 1e5, Ends::kOpenBelow};
  static constexpr Range rho_max_kg_m3{0, 1e6, Ends::kOpenBelow};  ///< and more than rho0_kg_m3
  static constexpr Range stiffness_n_m{0, Range{}.highest, Ends::kOpen};
  static constexpr Range mu_hat{0, 10};
  static constexpr Range attraction_ratio{1, 2};
  static constexpr Range moving_friction_ratio{0, 1};
  static constexpr Range contact_friction{0, 10};
  static constexpr Range contact_cohesion_n{0, 1e6};
  static constexpr Range cohesion_range_ratio{0.001, 0.5};
  static constexpr Range tangential_ratio{0.01, 1};
  static constexpr Range size_spread{0, 0.3};
  static constexpr Range damping_ratio{0, 0.5};
};

/// @throws InvalidParameter with the key, the value and the valid range. An infinite stiffness passes.
void validate(const SoilParameters& soil);

/// What of a soil with contact friction, and of a tool in it, can be changed little by little while they touch.
struct SoilAdjustment {
  double contact_friction = 0, contact_cohesion_n = 0;  ///< as in SoilParameters
  double tool_friction = 0;                             ///< tan(delta)

  [[nodiscard]] SoilParameters of(SoilParameters soil) const noexcept {
    soil.contact_friction = contact_friction;
    soil.contact_cohesion_n = contact_cohesion_n;
    return soil;
  }
  [[nodiscard]] bool operator==(const SoilAdjustment&) const = default;
};

/// m = 4 sqrt(2) rho0 R^3, in kg (paper 4).
[[nodiscard]] double macroparticleMass(const SoilParameters& soil);

/// The same soil made of particles of another radius: stress at equal relative overlap stays, so
/// gamma ~ R^3, k ~ R (and m ~ R^3), F_c ~ R^2. See docs/equations.md.
[[nodiscard]] SoilParameters rescaled(SoilParameters soil, double radius_m);

}  // namespace haptolith
