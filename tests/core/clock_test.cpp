#include "haptolith/core/platform/clock.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdint>
#include <limits>

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

TEST(SleepUntil, DoesNotAddUpTheWorkBetweenTwoTicks) {
  // Ticks of 5 ms with 2 ms of work each. A sleep of 5 ms after the work would never be shorter; one until the next
  // tick takes 3 ms, or no time on a machine that is late.
  constexpr int kTicks = 40;
  const std::int64_t start_ns = monotonicNs();
  std::int64_t shortest_ns = std::numeric_limits<std::int64_t>::max();
  for (int tick = 1; tick <= kTicks; ++tick) {
    const std::int64_t work_until_ns = monotonicNs() + 2 * kMillisecondNs;
    while (monotonicNs() < work_until_ns) {
    }
    const std::int64_t asleep_ns = monotonicNs();
    sleepUntilNs(start_ns + tick * 5 * kMillisecondNs);
    shortest_ns = std::min(shortest_ns, monotonicNs() - asleep_ns);
  }
  EXPECT_GE(monotonicNs() - start_ns, 5 * kTicks * kMillisecondNs);
  EXPECT_LT(shortest_ns, 5 * kMillisecondNs);
}

}  // namespace
}  // namespace haptolith
