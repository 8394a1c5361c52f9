#include "haptolith/teleop/link/robot_report.h"

namespace haptolith {

const char* text(RobotState state) noexcept {
  switch (state) {
    case RobotState::kTaring: return "taring";
    case RobotState::kWaiting: return "waiting";
    case RobotState::kApproaching: return "approaching";
    case RobotState::kFollowing: return "following";
    case RobotState::kHolding: return "holding";
    case RobotState::kRetracting: return "retracting";
    case RobotState::kFailed: return "failed";
  }
  return "?";
}

const char* text(StopReason reason) noexcept {
  switch (reason) {
    case StopReason::kNone: return "none";
    case StopReason::kSilence: return "silence";
    case StopReason::kReleased: return "the hand let go";
    case StopReason::kJump: return "an impossible jump";
    case StopReason::kGap: return "too much was lost";
    case StopReason::kForce: return "too much force";
    case StopReason::kRestart: return "the operator began anew";
    case StopReason::kFault: return "a fault";
  }
  return "?";
}

}  // namespace haptolith
