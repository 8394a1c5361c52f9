#include "haptolith/haptics/loop_clock.h"

#include <algorithm>
#include <cmath>

#include "haptolith/core/clock.h"

namespace haptolith {

namespace {

constexpr double kNsPerS = 1e9;
constexpr std::int64_t kMoment_ns = 1'000'000;

constexpr std::int64_t kBefore_ns = 150'000;
constexpr std::int64_t kLate_ns = 100'000;  // as the loop's thread may be itself

}  // namespace

void sleepUntilTick(std::int64_t due_ns, Bed& bed) noexcept {
  if (bed.sharesSteps()) {
    sleepUntilNs(due_ns - kBefore_ns);
    bed.expectStep(kBefore_ns + kLate_ns);
  }
  sleepUntilNs(due_ns);
}

LoopClock::LoopClock(double tick_s, bool paced) noexcept
    : tick_s_(tick_s), period_ns_(static_cast<std::int64_t>(std::llround(tick_s * kNsPerS))), paced_(paced) {}

void LoopClock::start() noexcept {
  due_ns_ = monotonicNs();
}

double LoopClock::waitForTick(Bed& bed) noexcept {
  sleepUntilTick(due_ns_, bed);
  return waitForTick();
}

double LoopClock::waitForTick() noexcept {
  sleepUntilNs(due_ns_);
  deadline_ns_ = due_ns_ + period_ns_;
  late_us_ = 1e-3 * static_cast<double>(monotonicNs() - due_ns_);
  return late_us_;
}

void LoopClock::planNextTick() noexcept {
  const auto stretched_ns = static_cast<std::int64_t>(static_cast<double>(period_ns_) / speed_);
  due_ns_ = std::max(due_ns_ + stretched_ns, monotonicNs() - period_ns_);
}

void LoopClock::waitAMoment() noexcept {
  sleepUntilNs(monotonicNs() + kMoment_ns);
}

void LoopClock::beginTick() noexcept {
  begun_ns_ = monotonicNs();
}

void LoopClock::endTick() noexcept {
  const std::int64_t now_ns = monotonicNs();
  tick_us_ = 1e-3 * static_cast<double>(now_ns - begun_ns_);
  in_time_ = deadline_ns_ == 0 ? tick_us_ <= 1e6 * tick_s_ : now_ns <= deadline_ns_;
  late_ = deadline_ns_ != 0 && !in_time_;
  ticks_left_ -= paused_ ? 1 : 0;
}

void LoopClock::resume() noexcept {
  paused_ = false;
  ticks_left_ = 0;
}

}  // namespace haptolith
