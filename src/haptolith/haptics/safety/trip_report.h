#pragma once

#include <array>
#include <cstddef>

#include "haptolith/haptics/safety/safety_layer.h"
#include "haptolith/haptics/tick_record.h"

namespace haptolith {

/// Why a loop ended.
enum class LoopEnd {
  kRunning,
  kDuration,   ///< the time asked for is over
  kStopped,    ///< stopped on request
  kFinished,   ///< the device has nothing more to give: a pose file's end
  kHandLeft,   ///< a simulated hand left the space around the bed, or its pose or velocity is NaN or infinite
  kLost,       ///< the device is gone
  kNotFinite,  ///< the bed, the tool or the wrench is no longer a number
  kCollapsed,  ///< the bed has collapsed onto itself
};
inline constexpr int kLoopEnds = static_cast<int>(LoopEnd::kCollapsed) + 1;

[[nodiscard]] const char* text(LoopEnd end) noexcept;

/// The last ticks up to and including the one that tripped, oldest first.
struct TripReport {
  static constexpr std::size_t kTicks = 50;

  SafetyTrip trip = SafetyTrip::kNone;
  std::size_t tool = 0;             ///< whose hand's trip it was
  LoopEnd end = LoopEnd::kRunning;  ///< end of the run, if the trip ended it
  double time_s = 0;
  std::size_t count = 0;
  std::array<TickRecord, kTicks> ticks;

  [[nodiscard]] const char* reason() const noexcept { return end == LoopEnd::kRunning ? text(trip) : text(end); }
};

}  // namespace haptolith
