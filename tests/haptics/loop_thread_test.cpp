#include "haptolith/haptics/loop/loop_thread.h"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mman.h>

#include <algorithm>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

/// A handle that stays above the soil and notes on which CPU it is asked.
class CpuWitness final : public HapticDevice {
 public:
  CpuWitness() { CPU_ZERO(&seen_); }
  [[nodiscard]] std::string_view name() const noexcept override { return "witness"; }
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return {}; }
  [[nodiscard]] DeviceInput read() noexcept override {
    CPU_SET(static_cast<std::size_t>(sched_getcpu()), &seen_);
    cpu_set_t allowed;
    CPU_ZERO(&allowed);
    sched_getaffinity(0, sizeof allowed, &allowed);
    most_allowed_ = std::max(most_allowed_, CPU_COUNT(&allowed));
    DeviceInput hand;
    hand.pose.position_m = {0, 0, 0.3};
    return hand;
  }
  void write(const DeviceOutput& output) noexcept override { (void)output; }
  void releaseForce() noexcept override {}
  void resumeForce() noexcept override {}

  /// Whether every tick, the first one included, was on this CPU and could be on no other.
  [[nodiscard]] bool onlyOn(int cpu) const {
    return CPU_COUNT(&seen_) == 1 && CPU_ISSET(cpu, &seen_) && most_allowed_ == 1;
  }

 private:
  cpu_set_t seen_;
  int most_allowed_ = 0;
};

class LoopThreadTest : public testing::Test {
 protected:
  ~LoopThreadTest() override { munlockall(); }

  Scene scene_{BedParameters{}, ToolParameters{}};
  CpuWitness device_;
  std::atomic<bool> stop_{false};
};

TEST_F(LoopThreadTest, IsPinnedBeforeTheFirstTick) {
  for (const bool real_time : {true, false}) {
    const LoopParameters parameters{.duration_s = 0.02, .real_time = real_time, .cpu = sched_getcpu()};
    CpuWitness device;
    HapticLoop loop(scene_, device, parameters, false);
    LoopThread thread(loop, parameters, stop_);
    EXPECT_EQ(thread.join(), LoopEnd::kDuration);
    EXPECT_EQ(thread.realTime().cpu, parameters.cpu);
    EXPECT_TRUE(device.onlyOn(parameters.cpu)) << (real_time ? "in real time" : "not in real time");
  }
}

TEST_F(LoopThreadTest, ACpuThatCannotBeHadIsRefusedBeforeAnyTick) {
  const LoopParameters parameters{.cpu = CPU_SETSIZE - 1};
  HapticLoop loop(scene_, device_, parameters, false);
  EXPECT_THROW(LoopThread(loop, parameters, stop_), InvalidParameter);
  EXPECT_EQ(loop.statistics().ticks(), 0U);
}

}  // namespace
}  // namespace haptolith
