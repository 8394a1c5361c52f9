#pragma once

#include "haptolith/core/movement.h"

namespace haptolith {

/// A human arm, or any other spring and damper between where a hand wants the tool and where it is.
struct ArmParameters {
  double mass_kg = 0.554;
  double damping_n_s_m = 6.45;
  double stiffness_n_m = 135;
  double lever_m = 0.1;  ///< rotation: inertia, damping and stiffness are the above times lever^2

  [[nodiscard]] bool operator==(const ArmParameters&) const = default;
};

/// One semi-implicit step of
///
///     m x'' = K (x_d - x) + B (x_d' - x') + F        x_d: where the hand wants the tool, F: the soil's force on it
///
/// and for rotation with m l^2, K l^2, B l^2 (l = lever). Stable for K dt^2 / m + 2 B dt / m < 4; for rotation
/// the lever cancels out. May be called in the tick.
/// @param soil  wrench on the tool, about its origin, scene frame.
/// @param strongest_n  the arm pulls no harder than this, and turns no harder than this times the lever.
/// @return wrench of spring and damper on the tool, about its origin, scene frame.
Wrench moveArm(const ArmParameters& arm, const Movement& wanted, const Wrench& soil, double strongest_n, double tick_s,
               Movement& tool) noexcept;

/// The lightest arm of this stiffness and damping that a tick can follow, in kg: see moveArm().
[[nodiscard]] double lightestArm(const ArmParameters& arm, double tick_s) noexcept;

}  // namespace haptolith
