#pragma once

#include <array>
#include <span>
#include <string_view>

#include "haptolith/soil/soil_parameters.h"

namespace haptolith {

/// One column of the paper: a row of Table II and the densities that Table I prints for it.
struct Preset {
  std::string_view name;
  double friction_coefficient = 0;  ///< mu the paper wants from this set; mu_hat = mu / sqrt(6) up to rounding
  SoilParameters soil;              ///< R = 7 mm, k = 100 N/m
  /// Table I, in the order of measuredBands(), kg/m^3. The equations give 11 to 26 less:
  /// docs/contributing/equations.md.
  std::array<double, 4> table1_density_kg_m3{};
};

/// The paper's sets P1 to P6, friction falling; all were made for lunar gravity and one cohesion (paper, Table II).
[[nodiscard]] std::span<const Preset> presets();

/// The preset called `name`; upper and lower case are the same.
/// @throws InvalidParameter listing the valid names.
[[nodiscard]] const Preset& findPreset(std::string_view name);

}  // namespace haptolith
