#pragma once

#include "haptolith/device/mapping.h"
#include "haptolith/haptics/coupling.h"
#include "haptolith/haptics/safety/safety_parameters.h"

namespace haptolith {

/// How the hand and the tool are joined, and what protects the hand. By default as in the paper, for a device whose
/// frame is the scene's.
struct HandlingParameters {
  MappingParameters mapping = {};
  CouplingParameters coupling = {};
  SafetyParameters safety = {};

  [[nodiscard]] bool operator==(const HandlingParameters&) const = default;
};

}  // namespace haptolith
