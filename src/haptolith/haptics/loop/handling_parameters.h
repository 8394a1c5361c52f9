#pragma once

#include "haptolith/device/mapping.h"
#include "haptolith/haptics/coupling.h"
#include "haptolith/haptics/safety/safety_parameters.h"

namespace haptolith {

/// Coupling of hand and tool, and protection of the hand. By default as in the paper, for a device whose
/// frame is the scene's.
struct HandlingParameters {
  MappingParameters mapping = {};
  CouplingParameters coupling = {};
  SafetyParameters safety = {};

  [[nodiscard]] bool operator==(const HandlingParameters&) const = default;
};

}  // namespace haptolith
