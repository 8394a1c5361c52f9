#include "haptolith/haptics/loop/deadline_miss.h"

#include <algorithm>

namespace haptolith {

namespace {

/// A tick of soil at rest costs as much as some of its particles awake: 20 us at 0.2 to 0.5 us each.
constexpr double kRestingLoad = 64;

/// Step of the running median: it follows a change by a factor of 3 within 55 ticks, and one tick moves it by 2 %.
constexpr double kMedianStep = 1.02;

}  // namespace

Miss causeOfMiss(const TickTiming& tick, double usual_us, Miss before) noexcept {
  const double woken_us = tick.late_us - tick.busy_us;
  const double unusual_us = std::max(0.0, tick.wall_us - usual_us);
  const double stopped_us = std::max(0.0, tick.wall_us - tick.cpu_us);
  const double taken_us = tick.cpu_us > kUnusual * usual_us ? unusual_us : std::min(stopped_us, unusual_us);
  const double work_us = tick.wall_us - taken_us;
  const double woken_beyond_us = woken_us - kWakeUpShare * tick.period_us;
  const double work_beyond_us = work_us - (1 - kWakeUpShare) * tick.period_us;

  const bool fits_alone = woken_us + tick.wall_us <= tick.period_us;
  if (fits_alone && tick.busy_us > 0) {
    // A pause or a request can delay a tick after one in time: no tick is the cause then, the thread came late.
    return work_beyond_us > 0 ? Miss::kTooLong : before == Miss::kNone ? Miss::kWokenLate : before;
  }
  if (work_beyond_us >= std::max(woken_beyond_us, taken_us)) {
    return Miss::kTooLong;
  }
  return taken_us >= woken_beyond_us ? Miss::kPreempted : Miss::kWokenLate;
}

Miss MissClassifier::classify(const TickTiming& tick, bool missed, double awake) noexcept {
  const double load = awake + kRestingLoad;
  const double took_us = tick.wall_us / load;
  usual_us_ = usual_us_ == 0 ? took_us : usual_us_;
  before_ = missed ? causeOfMiss(tick, usual_us_ * load, before_) : Miss::kNone;
  usual_us_ *= took_us > usual_us_ ? kMedianStep : 1 / kMedianStep;
  return before_;
}

}  // namespace haptolith
