#include "haptolith/haptics/loop/loop_clock.h"

#include <algorithm>
#include <cmath>

#include "haptolith/core/platform/clock.h"

namespace haptolith {

namespace {

constexpr double kNsPerS = 1e9;
constexpr std::int64_t kMoment_ns = 1'000'000;

constexpr std::int64_t kBefore_ns = 150'000;
constexpr std::int64_t kLate_ns = 100'000;  // as the loop's thread may be itself

double us(std::int64_t ns) noexcept {
  return 1e-3 * static_cast<double>(ns);
}

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
  free_ns_ = monotonicNs();
  sleepUntilTick(due_ns_, bed);
  return wake();
}

double LoopClock::waitForTick() noexcept {
  free_ns_ = monotonicNs();
  sleepUntilNs(due_ns_);
  return wake();
}

double LoopClock::wake() noexcept {
  deadline_ns_ = due_ns_ + period_ns_;
  late_us_ = us(monotonicNs() - due_ns_);
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
  begun_cpu_ns_ = deadline_ns_ == 0 ? 0 : threadCpuNs();
}

void LoopClock::endTick(std::size_t awake) noexcept {
  const std::int64_t now_ns = monotonicNs();
  tick_us_ = us(now_ns - begun_ns_);
  TickTiming timing{.period_us = us(period_ns_), .wall_us = tick_us_, .cpu_us = tick_us_};
  bool missed = tick_us_ > 1e6 * tick_s_;
  if (deadline_ns_ != 0) {
    missed = now_ns > deadline_ns_;
    timing.late_us = us(begun_ns_ - due_ns_);
    timing.busy_us = us(std::max<std::int64_t>(0, free_ns_ - due_ns_));
    if (missed && begun_cpu_ns_ != 0) {  // a system call that a tick in time can do without
      timing.cpu_us = us(threadCpuNs() - begun_cpu_ns_);
    }
  }
  miss_ = misses_.classify(timing, missed, static_cast<double>(awake));
  late_ = deadline_ns_ != 0 && missed;
  ticks_left_ -= paused_ ? 1 : 0;
}

void LoopClock::resume() noexcept {
  paused_ = false;
  ticks_left_ = 0;
}

}  // namespace haptolith
