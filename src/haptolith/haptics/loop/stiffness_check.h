#pragma once

#include <string>

#include "haptolith/device/haptic_device.h"
#include "haptolith/haptics/loop/handling_parameters.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// Whether a device's own damping is enough for the stiffest contact that it may render, before a person touches it.
///
///     b > K dt / 2 + B        (Colgate and Schenkel 1997, J. Robotic Systems 14:37)
///
/// Directly coupled, K is at most that of all contacts at once that fit on the tool, as felt at the device, and B is 0;
/// virtually, they are the coupling's. A person's hand adds damping: a device that fails this may be
/// stable in a hand, and shake when it is released.
struct StiffnessCheck {
  double stiffness_n_m = 0;   ///< K at the device
  double needed_n_s_m = 0;    ///< K dt / 2 + B
  double declared_n_s_m = 0;  ///< b
  std::string text;           ///< the numbers in a sentence, and what helps

  [[nodiscard]] bool stable() const noexcept { return declared_n_s_m > needed_n_s_m; }
};

/// @param radius_m  of a macroparticle.
[[nodiscard]] StiffnessCheck checkStiffness(const HandlingParameters& handling, const ToolParameters& tool,
                                            double radius_m, const DeviceLimits& device, double tick_s);

}  // namespace haptolith
