#include "haptolith/core/clock.h"

#include <gmock/gmock.h>

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
  constexpr int kTicks = 40;
  const std::int64_t start_ns = monotonicNs();
  for (int tick = 1; tick <= kTicks; ++tick) {
    const std::int64_t work_until_ns = monotonicNs() + 2 * kMillisecondNs;
    while (monotonicNs() < work_until_ns) {
    }
    sleepUntilNs(start_ns + tick * 5 * kMillisecondNs);
  }
  // Sleeping 5 ms after 2 ms of work would take 280 ms. The margin is for a busy machine.
  const std::int64_t taken_ns = monotonicNs() - start_ns;
  EXPECT_GE(taken_ns, kTicks * 5 * kMillisecondNs);
  EXPECT_LT(taken_ns, kTicks * 5 * kMillisecondNs + 70 * kMillisecondNs);
}

}  // namespace
}  // namespace haptolith
