#pragma once

#include "haptolith/core/vec.h"
#include "haptolith/device/hand/hand_parameters.h"

namespace haptolith {

/// Pose scene_T_tool that a hand aims at, `time_s` after the start of the motion. Motions begin and end at
/// `hand.home_m` and repeat every `hand.period_s`; movements between their key poses are minimum-jerk (Flash and Hogan
/// 1985, J. Neurosci. 5:1688). After `hand.active_s` the motion under way is finished, then the hand waits at home.
/// Not for kPoses. May be called in the tick.
[[nodiscard]] Pose handMotionPose(const HandParameters& hand, double time_s) noexcept;

/// Opening of the gripper at that time, 0 closed to 1 wide open: lifting motions close at their lowest point and open
/// where they release the soil. Not for kPoses. May be called in the tick.
[[nodiscard]] double handMotionOpening(const HandParameters& hand, double time_s) noexcept;

}  // namespace haptolith
