#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "haptolith/core/error.h"

namespace haptolith {

/// Reference of friction, and source of cohesion.
enum class FrictionModel {
  kIcra2021,  ///< against absolute space (paper 14, 20); cohesion is the attraction of (paper 19)
  kContact,   ///< between particles that touch (Cundall and Strack 1979); cohesion is a separate parameter
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

  FrictionModel friction = FrictionModel::kIcra2021;
  double contact_friction = 0.5;      ///< mu_p, Coulomb friction of a contact
  double contact_cohesion_n = 0;      ///< F_c, largest pull of a contact, and what it adds to the normal force
  double cohesion_range_ratio = 0.4;  ///< gap at which two particles still cohere, in R
  double tangential_ratio = 0.5;      ///< k_t / k, tangential over normal stiffness of a contact
  double size_spread = 0;      ///< radii lie evenly between R (1 - spread) and R (1 + spread); all weigh the same
  double damping_ratio = 0.2;  ///< zeta, of a pair that bounces, over critical damping

  [[nodiscard]] bool operator==(const SoilParameters&) const = default;
};

/// Whether scene files and soil files may leave a number out.
enum class SoilRole {
  kUsual,     ///< they may; it then has its usual value
  kRequired,  ///< a soil file states it
  kDefining,  ///< a soil file states it, and a scene file states it or names a soil, which may be a preset unless the
              ///< number is of contacts
};

/// Changes of a number that a bed allows without being made again.
enum class SoilChange { kFree, kNotLarger, kNever };

/// Slider of the browser view and of studies.
struct SoilControl {
  std::string_view key, label, unit, axis_label, meaning;  ///< empty: they do not
  double unit_si = 1;
  double highest = 0;  ///< in `unit`, with particles of 7 mm; scales as rescaled() scales the number
};

/// One number of SoilParameters and what the program does with it.
struct SoilNumber {
  std::string_view key;  ///< as errors, trainings, scene files and soil files name it (but radius_mm in the last two)
  double SoilParameters::*member;
  Range valid;
  std::optional<FrictionModel> model;  ///< the one that uses it; none: both
  SoilRole role;
  SoilChange change;
  int radius_power;          ///< rescaled() multiplies it by the ratio of radii to this power
  int tile_place;            ///< in the key of kept tiles (bed/start/tile_cache.h); a new number takes the next place
  int training_place;        ///< in a run of a training (identify/training); 0: not part of it
  std::string_view meaning;  ///< one sentence for docs/reference/scene-keys-soil.md
  SoilControl control = {};

  [[nodiscard]] constexpr bool isUsedBy(FrictionModel friction) const { return !model || *model == friction; }
  /// Whether presets define it, so that a soil with another value is no preset.
  [[nodiscard]] constexpr bool makesPreset() const {
    return role == SoilRole::kDefining && model != FrictionModel::kContact;
  }
};

/// Every number of a soil, in the order of scene files. Columns: key, member, range, model, role, change in a bed,
/// power of the radius, place in a tile's key and in a training; meaning; control.
inline constexpr std::array kSoilNumbers = [] {
  using S = SoilParameters;
  using enum FrictionModel;
  using enum SoilRole;
  using enum SoilChange;
  const auto row = [](std::string_view key, double S::*member, Range valid, std::optional<FrictionModel> model,
                      SoilRole role, SoilChange change, int radius_power, int tile_place, int training_place,
                      std::string_view meaning, SoilControl control = {}) {
    return SoilNumber{key,          member,     valid,          model,   role,   change,
                      radius_power, tile_place, training_place, meaning, control};
  };
  return std::array{
      row("radius_m", &S::radius_m, {1e-5, 1}, {}, kRequired, kNever, 1, 1, 1,
          "Particle radius R; `gamma_nm`, `stiffness_n_m` and `contact_cohesion_n` rescale with it unless given."),
      row("gamma_nm", &S::gamma_nm, {0, Range{}.highest, Ends::kOpen}, {}, kDefining, kFree, 3, 2, 3,
          "Strength gamma of the contact law (paper 7), N m."),
      row("rho0_kg_m3", &S::rho0_kg_m3, {0, 1e5, Ends::kOpenBelow}, {}, kDefining, kNever, 0, 3, 5,
          "Bulk density at the surface."),
      row("rho_max_kg_m3", &S::rho_max_kg_m3, {0, 1e6, Ends::kOpenBelow}, {}, kDefining, kFree, 0, 4, 0,
          "Bulk density that no load exceeds (paper 8); above `rho0_kg_m3`."),
      row("stiffness_n_m", &S::stiffness_n_m, {0, Range{}.highest, Ends::kOpen}, {}, kRequired, kFree, 1, 6, 2,
          "Limiting stiffness k of a contact (paper 7)."),
      row("mu_hat", &S::mu_hat, {0, 10}, kIcra2021, kDefining, kFree, 0, 5, 0,
          "Model friction (paper 14); `icra2021` only."),
      row("attraction_ratio", &S::attraction_ratio, {1, 2}, kIcra2021, kUsual, kFree, 0, 7, 0,
          "Range of attraction over radius (paper 19); 1: no attraction; `icra2021` only."),
      row("moving_friction_ratio", &S::moving_friction_ratio, {0, 1}, kIcra2021, kUsual, kFree, 0, 8, 0,
          "Moving over static friction (paper 14); `icra2021` only."),
      row("contact_friction", &S::contact_friction, {0, 10}, kContact, kDefining, kFree, 0, 9, 6,
          "Coulomb friction coefficient of a contact; `contact` only.",
          {"contact_friction", "contact friction", "", "friction of a contact",
           "Friction of a contact; for `contact` friction.", 1, 2}),
      row("contact_cohesion_n", &S::contact_cohesion_n, {0, 1e6}, kContact, kDefining, kFree, 2, 10, 7,
          "Pull-off force of a contact, added to its normal force; `contact` only.",
          {"contact_cohesion_mn", "contact cohesion", "mN", "cohesion of a contact (mN)",
           "Largest pull of a contact; for `contact` friction.", 1e-3, 10}),
      row("cohesion_range_ratio", &S::cohesion_range_ratio, {0.001, 0.5}, kContact, kUsual, kFree, 0, 11, 10,
          "Gap, in radii, up to which particles cohere; `contact` only."),
      row("tangential_ratio", &S::tangential_ratio, {0.01, 1}, kContact, kUsual, kFree, 0, 12, 9,
          "Tangential over normal stiffness of a contact; `contact` only."),
      row("damping_ratio", &S::damping_ratio, {0, 0.5}, kContact, kUsual, kNotLarger, 0, 14, 4,
          "Damping of a colliding pair over critical damping; `contact` only."),
      row("size_spread", &S::size_spread, {0, 0.3}, kContact, kUsual, kNever, 0, 13, 8,
          "Radii are uniform between (1 - spread) R and (1 + spread) R; `contact` only."),
  };
}();
static_assert(sizeof(SoilParameters) == (kSoilNumbers.size() + 1) * sizeof(double), "a number without a row");

/// The rows that have this place, in its order.
[[nodiscard]] std::vector<SoilNumber> soilNumbersBy(int SoilNumber::*place);

/// @throws InvalidParameter with the key, the value and the valid range. An infinite stiffness passes.
void validate(const SoilParameters& soil);

/// Parameters of a soil with contact friction, and of a tool in it, that can change gradually during contact.
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

/// Returns the soil made of particles of another radius: stress at equal relative overlap stays, so
/// gamma ~ R^3, k ~ R (and m ~ R^3), F_c ~ R^2: SoilNumber::radius_power. See docs/contributing/equations.md.
[[nodiscard]] SoilParameters rescaled(SoilParameters soil, double radius_m);
}  // namespace haptolith
