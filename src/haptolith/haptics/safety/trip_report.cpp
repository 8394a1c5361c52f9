#include "haptolith/haptics/safety/trip_report.h"

#include "haptolith/bed/bed.h"

namespace haptolith {

const char* text(LoopEnd end) noexcept {
  switch (end) {
    case LoopEnd::kRunning: return "running";
    case LoopEnd::kDuration: return "duration reached";
    case LoopEnd::kStopped: return "stopped";
    case LoopEnd::kFinished: return "end of the recorded movement";
    case LoopEnd::kHandLeft: return "the hand left the scene: it can move up to 1 m beyond the box";
    case LoopEnd::kLost: return text(SafetyTrip::kLost);
    case LoopEnd::kNotFinite: return text(StepStatus::kNotFinite);
    case LoopEnd::kCollapsed: return text(StepStatus::kCollapsed);
  }
  return "";
}

}  // namespace haptolith
