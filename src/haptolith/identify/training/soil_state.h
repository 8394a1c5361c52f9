#pragma once

#include <Eigen/Core>

#include "haptolith/core/error.h"

namespace haptolith {

/// What of a soil decides the forces on a tool.
struct SoilState {
  double friction_angle_deg = 35;  ///< phi, residual
  double cohesion_pa = 0;          ///< c, residual
  double tool_friction = 0.36;     ///< tan(delta), between soil and tool
};

/// The state as numbers that go evenly: phi, ln(c / (1500 kg/m^3 g) + 30 mm), tan(delta). Density, which digging hardly
/// tells from strength, is no part of it: it differs among the soils of a training as it does among those of a world.
using StateVector = Eigen::Vector3d;
[[nodiscard]] StateVector stateVector(const SoilState& state, double gravity_m_s2);
[[nodiscard]] SoilState soilState(const StateVector& vector, double gravity_m_s2);

/// Between which the state is held to be before anything is known, evenly.
struct SoilPrior {
  Range friction_angle_deg{20, 52};
  /// Over 1500 kg/m^3 g: to 1700 Pa on the Moon. What is below 0 stands for soil without any, one in six: else no
  /// interval would ever hold 0.
  Range cohesion_m{-0.015, 0.7};
  Range tool_friction{0.1, 0.7};
};

/// The corners of that box.
[[nodiscard]] StateVector lowest(const SoilPrior& prior);
[[nodiscard]] StateVector highest(const SoilPrior& prior);

}  // namespace haptolith
