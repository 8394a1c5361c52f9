#include "haptolith/machine/wake_ups.h"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mman.h>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

class WakeUpsTest : public testing::Test {
 protected:
  ~WakeUpsTest() override { munlockall(); }
  std::atomic<bool> stop_{false};
};

TEST_F(WakeUpsTest, EachTickIsOneSleep) {
  int told = 0;
  const WakeUps measured = measureWakeUps({}, 0.1, stop_, [&](double elapsed_s, double latest_us) {
    ++told;
    EXPECT_GE(elapsed_s, 0);
    EXPECT_GE(latest_us, 0);
  });
  EXPECT_EQ(measured.late_us.count(), 100U);
  EXPECT_GE(measured.seconds, 0.099);  // no sleep ends early
  EXPECT_GT(measured.late_us.mean(), 0);
  EXPECT_GT(told, 0);
}

TEST_F(WakeUpsTest, MissesAreSleepsThatAreATickLate) {
  // Ticks so short that, on any machine, some are missed and the count shows it.
  const WakeUps measured = measureWakeUps({.tick_s = 1e-4}, 0.5, stop_, [](double, double) {});
  std::uint64_t surely = 0;
  for (std::size_t bucket = 1; bucket < Histogram::kBuckets; ++bucket) {
    surely += measured.late_us.upperEnd(bucket - 1) >= 100 ? measured.late_us.inBucket(bucket) : 0;
  }
  EXPECT_GE(measured.missed, surely);
  EXPECT_LE(measured.missed, surely + measured.late_us.inBucket(637));  // the bucket in which 100 us lie: 64 log2(1000)
}

TEST_F(WakeUpsTest, StoppedItTellsWhatItHas) {
  const WakeUps measured =
      measureWakeUps({}, 1000, stop_, [this](double elapsed_s, double) { stop_ = elapsed_s > 0.02; });
  EXPECT_GT(measured.late_us.count(), 10U);
  EXPECT_LT(measured.seconds, 100);
  EXPECT_GE(measured.seconds, 0.02);
  const WakeUps none = measureWakeUps({}, 1000, stop_, [](double, double) {});
  EXPECT_EQ(none.late_us.count(), 0U);
}

TEST_F(WakeUpsTest, SleepsOnTheCpuThatIsNamed) {
  const int cpu = sched_getcpu();
  EXPECT_EQ(measureWakeUps({.cpu = cpu}, 0.01, stop_, [](double, double) {}).real_time.cpu, cpu);
  EXPECT_THROW((void)measureWakeUps({.cpu = 1023}, 0.01, stop_, [](double, double) {}), InvalidParameter);
  EXPECT_THROW((void)measureWakeUps({.tick_s = 0}, 0.01, stop_, [](double, double) {}), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
