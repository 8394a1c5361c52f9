#include "haptolith/core/clock.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdint>

namespace haptolith {
namespace {

constexpr std::int64_t kMillisecondNs = 1'000'000;

TEST(Clock, NeverGoesBack) {
  std::int64_t last_ns = monotonicNs();
  for (int i = 0; i < 1000; ++i) {
    const std::int64_t now_ns = monotonicNs();
    ASSERT_GE(now_ns, last_ns);
    last_ns = now_ns;
  }
}

TEST(SleepUntil, NeverWakesEarly) {
  for (int i = 0; i < 10; ++i) {
    const std::int64_t deadline_ns = monotonicNs() + kMillisecondNs;
    sleepUntilNs(deadline_ns);
    EXPECT_GE(monotonicNs(), deadline_ns);
  }
}

TEST(SleepUntil, ReturnsAtOnceWhenTheTimeIsPast) {
  const std::int64_t start_ns = monotonicNs();
  for (int i = 0; i < 100; ++i) {
    sleepUntilNs(start_ns - 1000 * kMillisecondNs);
  }
  EXPECT_LT(monotonicNs() - start_ns, 500 * kMillisecondNs);  // a sleep relative to now would take 100 s
}

/// Duration of 40 ticks of 5 ms, each with 2 ms of work.
std::int64_t fortyTicksNs() {
  constexpr int kTicks = 40;
  const std::int64_t start_ns = monotonicNs();
  for (int tick = 1; tick <= kTicks; ++tick) {
    const std::int64_t work_until_ns = monotonicNs() + 2 * kMillisecondNs;
    while (monotonicNs() < work_until_ns) {
    }
    sleepUntilNs(start_ns + tick * 5 * kMillisecondNs);
  }
  return monotonicNs() - start_ns;
}

TEST(SleepUntil, DoesNotAddUpTheWorkBetweenTwoTicks) {
  // Sleeping 5 ms after 2 ms of work would take 280 ms each time. A busy machine may take so long, too, but not always.
  std::int64_t least_ns = fortyTicksNs();
  EXPECT_GE(least_ns, 200 * kMillisecondNs);
  for (int trial = 0; trial < 50 && least_ns >= 270 * kMillisecondNs; ++trial) {
    least_ns = std::min(least_ns, fortyTicksNs());
  }
  EXPECT_LT(least_ns, 270 * kMillisecondNs);
}

}  // namespace
}  // namespace haptolith
