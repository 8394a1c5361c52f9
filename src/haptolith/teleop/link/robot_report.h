#pragma once

#include <cstdint>

#include "haptolith/core/vec.h"

namespace haptolith {

/// States of a robot.
enum class RobotState : std::uint8_t {
  kTaring,       ///< its force sensor finds its zero: the tool hangs still
  kWaiting,      ///< for commands, where it is
  kApproaching,  ///< goes up, across and down to where the operator has the tool
  kFollowing,
  kHolding,     ///< stopped, for a reason
  kRetracting,  ///< lifts the tool out of the soil
  kFailed,      ///< for good: its readings make no sense
};
[[nodiscard]] const char* text(RobotState state) noexcept;

/// Why it stopped, last.
enum class StopReason : std::uint8_t {
  kNone,
  kSilence,   ///< no command came for too long
  kReleased,  ///< the operator's hand has released the tool
  kJump,      ///< commands were further apart than any hand moves
  kGap,       ///< too much of the movement was lost to guess it
  kForce,     ///< more than it may meet
  kRestart,   ///< the operator's program was started again
  kFault,     ///< a reading is not a number
};
[[nodiscard]] const char* text(StopReason reason) noexcept;

/// Report of the robot on a range of executed commands.
struct RobotReport {
  std::uint64_t index = 0;  ///< command that it has come to; with the ticks before it, that the means are over
  std::uint32_t ticks = 0;  ///< 0: it follows none
  Pose pose;                ///< current pose of the tool, site frame
  Wrench met;               ///< mean reading of the force sensor, site frame, about the tool's origin
};

}  // namespace haptolith
