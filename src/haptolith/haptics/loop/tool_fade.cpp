#include "haptolith/haptics/loop/tool_fade.h"

#include <utility>

namespace haptolith {

namespace {

/// Duration for which the tool leaves the soil before tool or bed are replaced, by the clock, and returns, in
/// simulated time. A choice: the force of a press vanishes within what a finger feels as instantaneous, and returns
/// slower than a hand reacts, so that a released hand is not struck.
constexpr double kOut_s = 0.1;
constexpr double kIn_s = 0.3;

}  // namespace

void ToolFade::begin() noexcept {
  ramp_.set(0);
  placed_ = false;
  leaves_ = false;
}

void ToolFade::step(bool hand_feels, double speed) noexcept {
  if (leaves_) {
    ramp_.fall(tick_s_, kOut_s * speed);
  } else if (touches_ && hand_feels) {
    ramp_.rise(tick_s_, kIn_s);
  } else {
    ramp_.fall(tick_s_, kOut_s);
  }
}

bool ToolFade::takePlacing() noexcept {
  return !std::exchange(placed_, true);
}

}  // namespace haptolith
