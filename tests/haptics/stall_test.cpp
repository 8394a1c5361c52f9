// A process that is stopped as a whole, with its watchdog: as by SIGSTOP, by a virtual machine that is not run, or by a
// control group that has used up its time. When it continues, any of its threads may be the first.

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <functional>
#include <new>
#include <optional>
#include <thread>

#include "haptolith/core/platform/clock.h"
#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

using namespace std::chrono_literals;

struct Shown {
  std::int64_t at_ns;
  double force_n;
};

/// Forces on the hand, in memory that two processes share.
struct Felt {
  static constexpr std::size_t kMost = 60'000;  // a minute
  std::atomic<std::size_t> count{0};
  std::array<Shown, kMost> shown{};

  [[nodiscard]] double now() const {
    const std::size_t all = count;
    return all == 0 ? 0 : shown[all - 1].force_n;
  }
};

/// A tool that is pressed into the soil and held there.
class PressingDevice final : public HapticDevice {
 public:
  PressingDevice(Felt& felt, double surface_m) : felt_(felt), surface_m_(surface_m) {}
  [[nodiscard]] std::string_view name() const noexcept override { return "pressing"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override {
    DeviceLimits limits;
    limits.max_force_n = 5;
    limits.max_torque_nm = 0.2;
    return limits;
  }
  [[nodiscard]] DeviceInput read() noexcept override {
    const double share = std::min(1.0, reads_++ / 500.0);
    DeviceInput input;
    input.pose.position_m = Vec3(0, 0, surface_m_ + 0.01 - 0.025 * share);
    input.twist.linear_m_s.z() = share < 1 ? -0.05 : 0;
    return input;
  }
  void write(const DeviceOutput& output) noexcept override { show(released_ ? 0 : output.wrench.force_n.norm()); }
  void releaseForce() noexcept override { released_ = true; }
  void resumeForce() noexcept override { released_ = false; }

 private:
  void show(double force_n) noexcept {
    const std::size_t next = felt_.count;
    if (next < Felt::kMost) {
      felt_.shown[next] = {monotonicNs(), force_n};
      felt_.count = next + 1;
    }
  }
  Felt& felt_;
  double surface_m_;
  int reads_ = 0;
  std::atomic<bool> released_{false};
};

void pressForAMinute(Felt& felt) {
  BedParameters bed;
  bed.soil = findPreset("P4").soil;
  bed.gravity_m_s2 = {0, 0, -9.807};
  Scene scene(bed, {});
  PressingDevice device(felt, scene.bed().surfaceHeight());
  HandlingParameters handling;
  handling.safety.recovery_s = 0.05;
  handling.safety.soft_start_s = 0.1;
  LoopParameters real_time;
  real_time.duration_s = 60;
  HapticLoop loop(scene, device, real_time, false, handling);
  const std::atomic<bool> never{false};
  (void)loop.run(never);
}

TEST(Stall, AProcessThatStoodStillShowsNothingFirstWhicheverThreadWakesFirst) {
  constexpr int kStalls = 10;
  // Longest time of a tick between two answers whose force is still rendered: 4 ms before it and 4 ms in it.
  constexpr std::int64_t kSurelyStalled_ns = 9'000'000;
  void* const memory = mmap(nullptr, sizeof(Felt), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  Felt& felt = *new (memory) Felt;
  const pid_t child = fork();
  if (child == 0) {
    pressForAMinute(felt);
    _exit(0);
  }
  const auto end = std::chrono::steady_clock::now() + 40s;
  int stalls = 0;
  for (; stalls < kStalls && std::chrono::steady_clock::now() < end;) {
    std::this_thread::sleep_for(std::chrono::microseconds(1000 + 137 * stalls));
    if (felt.now() > 0.2) {
      kill(child, SIGSTOP);
      std::this_thread::sleep_for(12ms + 7ms * stalls);
      kill(child, SIGCONT);
      ++stalls;
      std::this_thread::sleep_for(20ms);
    }
  }
  kill(child, SIGKILL);
  int status = 0;
  waitpid(child, &status, 0);

  int seen = 0;
  for (std::size_t i = 1; i < felt.count; ++i) {
    const auto& [at_ns, force_n] = felt.shown[i];
    const auto& [before_ns, before_n] = felt.shown[i - 1];
    if (at_ns - before_ns > kSurelyStalled_ns) {
      seen += before_n > 0.2 ? 1 : 0;
      EXPECT_EQ(force_n, 0) << "after " << 1e-6 * static_cast<double>(at_ns - before_ns) << " ms, " << before_n << " N";
      for (std::size_t later = i; later < std::min(i + 40, felt.count.load()); ++later) {
        ASSERT_EQ(felt.shown[later].force_n, 0) << "all must have been well for 50 ms";
      }
    }
    ASSERT_LT(force_n - before_n, 0.5) << "force comes back softly";
  }
  munmap(memory, sizeof(Felt));
  if (stalls < 3) {
    GTEST_SKIP() << "the machine is so busy that there was hardly any force to take away";
  }
  EXPECT_GE(seen, stalls - 1) << "each stall took a force away";
}

}  // namespace
}  // namespace haptolith
