#pragma once

#include <functional>

#include "haptolith/identify/soil_belief.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/teleop/robot/robot.h"

namespace haptolith {

/// Result of a robot's probe.
struct ProbedSoil {
  SoilBelief belief;
  std::size_t windows = 0;     ///< in which its tool was where it should have been
  std::size_t of_windows = 0;  ///< windows of the complete movement
};

/// Runs the probe automatically, in undisturbed soil of the site, next to the place of
/// work: the movement of `training`, by its arm, read by its sensor.
/// @param site  its scene; the box is the training's. @throws as Scene, Robot and SoilIdentifier; Failure when
/// `progress` gives up.
[[nodiscard]] ProbedSoil probeSite(const SceneFile& site, const RobotParameters& parameters, const Training& training,
                                   const LabProgress& progress = {});

/// The model with soil of its kind and the estimated strength, and the tool's friction in it.
/// @throws InvalidParameter for a model with ICRA 2021 friction.
[[nodiscard]] SceneFile withBelievedSoil(SceneFile model, const SoilBelief& belief, const StrengthMap& strengths);

}  // namespace haptolith
