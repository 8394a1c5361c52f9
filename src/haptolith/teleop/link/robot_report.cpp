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
    case StopReason::kReleased: return "the hand released the tool";
    case StopReason::kJump: return "an impossible jump";
    case StopReason::kGap: return "too many packets lost";
    case StopReason::kForce: return "force limit exceeded";
    case StopReason::kRestart: return "the operator restarted";
    case StopReason::kFault: return "a fault";
  }
  return "?";
}

}  // namespace haptolith
