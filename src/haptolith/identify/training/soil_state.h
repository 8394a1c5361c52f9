#pragma once

#include <Eigen/Core>

#include "haptolith/core/error.h"

namespace haptolith {

/// State of a soil that determines the forces on a tool.
struct SoilState {
  double friction_angle_deg = 35;  ///< residual phi
  double cohesion_pa = 0;          ///< residual c
  double tool_friction = 0.36;     ///< tan(delta), between soil and tool
};

/// State as a vector with a uniform scale: phi, ln(c / (1500 kg/m^3 g) + 30 mm), tan(delta). It does not contain
/// density, which digging barely distinguishes from strength. Density varies among the soils of a training as on a real
/// body.
using StateVector = Eigen::Vector3d;
[[nodiscard]] StateVector stateVector(const SoilState& state, double gravity_m_s2);
[[nodiscard]] SoilState soilState(const StateVector& vector, double gravity_m_s2);

/// Uniform prior of the state: ranges of its numbers.
struct SoilPrior {
  Range friction_angle_deg{20, 52};
  /// Cohesion over 1500 kg/m^3 g: up to 1700 Pa on the Moon. Values below 0 represent soil without cohesion, one in
  /// six; otherwise no interval would contain 0.
  Range cohesion_m{-0.015, 0.7};
  Range tool_friction{0.1, 0.7};
};

/// Returns a corner of that box.
[[nodiscard]] StateVector lowest(const SoilPrior& prior);
[[nodiscard]] StateVector highest(const SoilPrior& prior);

}  // namespace haptolith
