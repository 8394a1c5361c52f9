// The table of faults: what can go wrong between the soil and a person's hand, and what the hand then feels. Each row
// presses a tool into the soil with a device in a person's hand, injects a fault, and checks every force
// that was sent to the device.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "haptolith/core/platform/clock.h"
#include "haptolith/core/platform/last_resort.h"
#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/haptics/loop/loop_thread.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

constexpr double kTick_s = 1e-3;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kMaxForce_n = 3.3;
constexpr double kMaxRate_n_s = 2000;
constexpr int kPressed = 2500;  ///< ticks until the tool is in the soil and the soft start over
const std::atomic<bool> kNeverStop{false};

/// A person's device. It does what a test wants and remembers every force.
class PersonsDevice final : public HapticDevice {
 public:
  explicit PersonsDevice(double surface_m) : surface_m_(surface_m) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "a person's"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override {
    DeviceLimits limits;
    limits.max_force_n = kMaxForce_n;
    limits.max_torque_nm = 0.2;
    limits.max_force_rate_n_s = kMaxRate_n_s;
    limits.max_torque_rate_nm_s = 100;
    limits.workspace_radius_m = workspace_radius_m;
    return limits;
  }
  [[nodiscard]] DeviceInput read() noexcept override {
    const int tick = reads++;
    DeviceInput input;
    const double share = std::min(1.0, tick / 1000.0);  // pressed into the soil within the first second
    input.pose.position_m = Vec3(aside_m, 0, surface_m_ + 0.01 - 0.025 * share);
    input.twist.linear_m_s = Vec3(0, 0, share < 1 ? -0.025 : 0);
    if (spoil) {
      spoil(tick, input);
    }
    return input;
  }
  void write(const DeviceOutput& output) noexcept override {
    const Wrench shown = let_go ? Wrench{} : output.wrench;
    forces_n.push_back(shown.force_n);
    torques_nm.push_back(shown.torque_nm);
  }
  void releaseForce() noexcept override {
    let_go = true;
    let_go_ns = monotonicNs();
    ++let_goes;
  }
  void resumeForce() noexcept override { let_go = false; }

  [[nodiscard]] bool feelsNothing() const {
    return forces_n.back() == Vec3::Zero() && torques_nm.back() == Vec3::Zero();
  }

  std::function<void(int tick, DeviceInput& input)> spoil;
  double workspace_radius_m = DeviceLimits::kNone;
  double aside_m = 0;
  int reads = 0;
  std::vector<Vec3> forces_n, torques_nm;  ///< one for a write()
  std::atomic<bool> let_go{false};
  std::atomic<std::int64_t> let_go_ns{0};
  std::atomic<int> let_goes{0};

 private:
  double surface_m_;
};

BedParameters icra2021Bed() {
  BedParameters bed;
  bed.soil = findPreset("P4").soil;
  bed.gravity_m_s2 = {0, 0, -9.807};
  return bed;
}

LoopParameters asFastAsPossible(double duration_s = 0) {
  LoopParameters loop;
  loop.real_time = false;
  loop.duration_s = duration_s;
  return loop;
}

/// A loop, what it joins, and how it went.
struct Bench {
  explicit Bench(const LoopParameters& parameters = asFastAsPossible(), const HandlingParameters& handling = {})
      : scene(icra2021Bed(), {}),
        device(scene.bed().surfaceHeight()),
        loop(std::make_unique<HapticLoop>(scene, device, parameters, true, handling)) {}

  /// With a device that has been changed since.
  void renew(const LoopParameters& parameters = asFastAsPossible()) {
    loop = std::make_unique<HapticLoop>(scene, device, parameters, true);
  }

  /// Runs a number of ticks, or until the run ends.
  LoopEnd ticks(int count) {
    LoopEnd end = LoopEnd::kRunning;
    for (int i = 0; i < count && end == LoopEnd::kRunning; ++i) {
      end = loop->tick();
      loop->takeRecords(records);
    }
    return end;
  }

  Scene scene;
  PersonsDevice device;
  std::unique_ptr<HapticLoop> loop;
  std::vector<TickRecord> records;
};

void tell(const char* fault, const char* trip, double zero_after_ms, double back_after_ms, double steepest_n) {
  const auto number = [](double value) { return value < 0 ? std::string("-") : std::to_string(value).substr(0, 7); };
  std::printf("| %-28s | %-46s | %8s | %8s | %8s |\n", fault, trip, number(zero_after_ms).c_str(),
              number(back_after_ms).c_str(), number(steepest_n).c_str());
  testing::Test::RecordProperty("zero_after_ms", number(zero_after_ms));
  testing::Test::RecordProperty("half_back_after_ms", number(back_after_ms));
  testing::Test::RecordProperty("steepest_n_per_tick", number(steepest_n));
}

struct Fault {
  const char* name;
  SafetyTrip trip;
  LoopEnd end;  ///< kRunning: the fault passes
  std::function<void(DeviceInput&)> spoil;
  double workspace_radius_m = DeviceLimits::kNone;
  int comes_back_after = 0;  ///< ticks: 1 when that is no movement of a hand, either
};

class FaultTable : public testing::TestWithParam<Fault> {};

/// Largest force of a soft start a number of ticks after its begin.
double softly(double ticks) {
  const double share = std::clamp(ticks / 2000, 0.0, 1.0);
  return kMaxForce_n * share * share * (3 - 2 * share);
}

TEST_P(FaultTable, TheHandFeelsNothingWithinFiveTicksAndForceComesBackSoftly) {
  const Fault& fault = GetParam();
  constexpr int kLasts = 100;
  Bench bench;
  bench.device.workspace_radius_m = fault.workspace_radius_m;
  bench.device.spoil = [&fault](int tick, DeviceInput& input) {
    if (tick >= kPressed && tick < kPressed + kLasts) {
      fault.spoil(input);
    }
  };
  bench.renew();
  ASSERT_EQ(bench.ticks(kPressed), LoopEnd::kRunning);
  const double before_n = bench.device.forces_n.back().norm();
  const double soil_before_n = bench.records.back().soil.force_n.norm();
  ASSERT_GT(before_n, 0.3) << "the hand must feel something, else nothing is tested";

  int zero_after = 0;  // ticks
  LoopEnd end = bench.ticks(1);
  while (end == LoopEnd::kRunning && !bench.device.feelsNothing() && zero_after < 100) {
    end = bench.ticks(1);
    ++zero_after;
  }
  EXPECT_LE(zero_after, 5);
  EXPECT_TRUE(bench.device.feelsNothing());
  EXPECT_EQ(end, fault.end);
  if (fault.end != LoopEnd::kRunning) {
    tell(fault.name, text(fault.end), zero_after, -1, -1);
    const TickRecord& last = bench.records.back();
    EXPECT_EQ(bench.records.size(), static_cast<std::size_t>(kPressed + 1)) << "the tick that failed is recorded";
    EXPECT_NE(last.flags & kTickFailed, 0U);
    EXPECT_EQ(last.sent.wrench.force_n.norm(), 0);
    ASSERT_TRUE(bench.loop->trips().update());
    const TripReport& report = bench.loop->trips().latest();
    EXPECT_STREQ(report.reason(), text(fault.end));
    EXPECT_EQ(report.ticks[report.count - 1].time_s, last.time_s) << "and reported";
    return;
  }
  EXPECT_EQ(bench.records.back().trip, static_cast<int>(fault.trip));
  ASSERT_TRUE(bench.loop->trips().update());
  EXPECT_EQ(bench.loop->trips().latest().trip, fault.trip);

  ASSERT_EQ(bench.ticks(kLasts - 1 - zero_after + fault.comes_back_after), LoopEnd::kRunning);
  for (int tick = 0; tick < 1000; ++tick) {  // a second of calm
    ASSERT_EQ(bench.ticks(1), LoopEnd::kRunning);
    ASSERT_TRUE(bench.device.feelsNothing()) << tick;
  }
  double steepest_n = 0;
  int half_after = -1;
  for (int tick = 1; tick <= 2500; ++tick) {
    const Vec3 last_n = bench.device.forces_n.back();
    ASSERT_EQ(bench.ticks(1), LoopEnd::kRunning);
    const Vec3 now_n = bench.device.forces_n.back();
    ASSERT_LE(now_n.norm(), softly(tick) + 1e-9) << tick;
    ASSERT_LE((now_n - last_n).norm(), kTick_s * kMaxRate_n_s + 1e-12) << tick;
    ASSERT_EQ(bench.records.back().trip, 0);
    if (tick <= 30) {
      ASSERT_LT(bench.records.back().soil.force_n.norm(), 0.5 * soil_before_n) << "the tool fades into the soil";
    }
    steepest_n = std::max(steepest_n, (now_n - last_n).norm());
    half_after = half_after < 0 && now_n.norm() > before_n / 2 ? tick : half_after;
  }
  EXPECT_GT(half_after, 300) << "force came back, and not at once";
  tell(fault.name, text(fault.trip), zero_after, kLasts + 1000 + half_after, steepest_n);
}

Fault noNumber(const char* name, const std::function<void(DeviceInput&)>& spoil) {
  return {name, SafetyTrip::kDeviceNotFinite, LoopEnd::kRunning, spoil};
}

Fault noHand(const char* name, const std::function<void(DeviceInput&)>& spoil) {
  return {name, SafetyTrip::kImplausible, LoopEnd::kRunning, spoil, DeviceLimits::kNone, 1};
}

INSTANTIATE_TEST_SUITE_P(
    Of, FaultTable,
    testing::Values(
        noNumber("PositionX", [](DeviceInput& i) { i.pose.position_m.x() = kNaN; }),
        noNumber("PositionY", [](DeviceInput& i) { i.pose.position_m.y() = kNaN; }),
        noNumber("PositionZ", [](DeviceInput& i) { i.pose.position_m.z() = kInf; }),
        noNumber("OrientationW", [](DeviceInput& i) { i.pose.orientation.w() = kNaN; }),
        noNumber("OrientationX", [](DeviceInput& i) { i.pose.orientation.x() = kNaN; }),
        noNumber("OrientationY", [](DeviceInput& i) { i.pose.orientation.y() = kNaN; }),
        noNumber("OrientationZ", [](DeviceInput& i) { i.pose.orientation.z() = kNaN; }),
        noNumber("OrientationEmpty", [](DeviceInput& i) { i.pose.orientation.coeffs().setZero(); }),
        noNumber("VelocityX", [](DeviceInput& i) { i.twist.linear_m_s.x() = kNaN; }),
        noNumber("VelocityY", [](DeviceInput& i) { i.twist.linear_m_s.y() = kInf; }),
        noNumber("VelocityZ", [](DeviceInput& i) { i.twist.linear_m_s.z() = kNaN; }),
        noNumber("TurningX", [](DeviceInput& i) { i.twist.angular_rad_s.x() = kNaN; }),
        noNumber("TurningY", [](DeviceInput& i) { i.twist.angular_rad_s.y() = kNaN; }),
        noNumber("TurningZ", [](DeviceInput& i) { i.twist.angular_rad_s.z() = -kInf; }),
        noNumber("Gripper", [](DeviceInput& i) { i.gripper_open = kNaN; }),
        Fault{"Stale", SafetyTrip::kStale, LoopEnd::kRunning, [](DeviceInput& i) { i.state = DeviceState::kStale; }},
        Fault{"Lost", SafetyTrip::kLost, LoopEnd::kLost, [](DeviceInput& i) { i.state = DeviceState::kLost; }},
        Fault{"OutsideTheWorkspace", SafetyTrip::kWorkspace, LoopEnd::kRunning,
              [](DeviceInput& i) { i.pose.position_m.x() = 0.21; }, 0.2, 1},
        noHand("OneJumpOf5cm", [](DeviceInput& i) { i.pose.position_m.z() -= 0.05; }),
        noHand("TurnedBy180Degrees", [](DeviceInput& i) { i.pose.orientation = Quat(0, 0, 1, 0); }),
        noHand("VelocityOf99MetresPerSecond", [](DeviceInput& i) { i.twist.linear_m_s.z() = -99; }),
        noHand("VelocityBeyondAllNumbers", [](DeviceInput& i) { i.twist.linear_m_s.z() = -1e300; })),
    [](const testing::TestParamInfo<Fault>& test) { return std::string(test.param.name); });

TEST(FaultTable, TheToolGoesFarFromTheBed) {
  constexpr double kSpeed_m_s = 2;
  Bench bench;
  bench.device.spoil = [](int tick, DeviceInput& input) {
    if (tick >= kPressed) {
      input.pose.position_m.x() = kSpeed_m_s * kTick_s * (tick - kPressed);
      input.twist.linear_m_s.x() = kSpeed_m_s;
    }
  };
  ASSERT_EQ(bench.ticks(kPressed + 520), LoopEnd::kRunning);
  EXPECT_EQ(bench.records.back().trip, 0);
  ASSERT_EQ(bench.ticks(100), LoopEnd::kRunning);
  EXPECT_EQ(bench.records.back().trip, static_cast<int>(SafetyTrip::kWorkspace));
  EXPECT_TRUE(bench.device.feelsNothing());
}

TEST(FaultTable, TheBedIsNoNumber) {
  Bench bench;
  ASSERT_EQ(bench.ticks(kPressed), LoopEnd::kRunning);
  ASSERT_TRUE(bench.loop->ask(request::Gravity{Vec3(0, 0, -1e300)}));  // finite, but no force that a float can hold
  EXPECT_EQ(bench.ticks(5), LoopEnd::kNotFinite);
  EXPECT_TRUE(bench.device.feelsNothing());
  tell("BedIsNoNumber", text(LoopEnd::kNotFinite), 0, -1, -1);
}

TEST(FaultTable, ASinglePacketThatIsOffIsNeverFelt) {
  for (const auto& spoil : std::vector<std::function<void(DeviceInput&)>>{
           [](DeviceInput& i) { i.pose.position_m.z() -= 0.05; }, [](DeviceInput& i) { i.pose.position_m.x() += 0.5; },
           [](DeviceInput& i) { i.pose.orientation = Quat(0, 1, 0, 0); },
           [](DeviceInput& i) { i.twist.linear_m_s.z() = 99; }}) {
    Bench bench;
    bench.device.spoil = [&spoil](int tick, DeviceInput& input) {
      if (tick == kPressed) {
        spoil(input);
      }
    };
    ASSERT_EQ(bench.ticks(kPressed), LoopEnd::kRunning);
    for (int tick = 0; tick < 1000; ++tick) {
      ASSERT_EQ(bench.ticks(1), LoopEnd::kRunning);
      ASSERT_TRUE(bench.device.feelsNothing()) << tick;
    }
    EXPECT_EQ(bench.loop->trips().update(), true);
    EXPECT_EQ(bench.loop->trips().latest().trip, SafetyTrip::kImplausible);
  }
}

TEST(FaultTable, MoreThanTwentyMissedDeadlines) {
  Bench bench;
  ASSERT_EQ(bench.ticks(kPressed), LoopEnd::kRunning);
  int zero_after = 0;
  for (; !bench.device.feelsNothing() && zero_after < 100; ++zero_after) {
    bench.loop->overrideHealth({.late = true});
    ASSERT_EQ(bench.ticks(1), LoopEnd::kRunning);
  }
  EXPECT_EQ(zero_after, 21) << "twenty are borne";
  EXPECT_EQ(bench.records.back().trip, static_cast<int>(SafetyTrip::kMissedDeadlines));
  tell("MissedDeadlines", text(SafetyTrip::kMissedDeadlines), zero_after - 21, -1, -1);
}

TEST(FaultTable, TheLoopHangsAndTheWatchdogLetsGoBeforeItIsOver) {
  constexpr std::int64_t kHang_ns = 300'000'000;
  constexpr int kHangsAt = 300;
  LoopParameters real_time;
  real_time.duration_s = 1;
  HandlingParameters handling;
  handling.safety.soft_start_s = 0.05;
  handling.safety.recovery_s = 0.3;
  Bench bench(real_time, handling);
  std::int64_t hangs_ns = 0, over_ns = 0;
  std::int64_t let_go_ns = 0;
  std::size_t written = 0;
  bench.device.spoil = [&](int tick, DeviceInput&) {
    if (tick == kHangsAt) {
      hangs_ns = monotonicNs();  // the loop's last beat is a moment ago
      sleepUntilNs(hangs_ns + kHang_ns);
      over_ns = monotonicNs();
      let_go_ns = bench.device.let_go_ns;
      written = bench.device.forces_n.size();
    }
  };
  EXPECT_EQ(bench.loop->run(kNeverStop), LoopEnd::kDuration);
  ASSERT_GT(let_go_ns, 0) << "nobody let go of the hand";
  EXPECT_LT(let_go_ns, over_ns);
  ASSERT_GT(bench.device.forces_n.size(), written + 200);
  for (std::size_t i = written; i < written + 200; ++i) {
    ASSERT_EQ(bench.device.forces_n[i], Vec3::Zero()) << "nor is it shown anything until all has been well";
  }
  EXPECT_FALSE(bench.device.let_go) << "it is taken up again";
  const double after_ms =
      1e-6 * static_cast<double>(let_go_ns - hangs_ns);  // earlier, when the machine was slow before
  tell("LoopHangs", text(SafetyTrip::kHeartbeat), std::max(0.0, after_ms), -1, -1);
}

/// Ticks from the last contact until the force stays zero, and whether it was released softly.
int ticksToNothing(const std::vector<Vec3>& forces_n) {
  std::size_t last = forces_n.size();
  while (last > 0 && forces_n[last - 1] == Vec3::Zero()) {
    --last;
  }
  for (std::size_t i = 1; i < last; ++i) {
    EXPECT_LE((forces_n[i] - forces_n[i - 1]).norm(), kTick_s * kMaxRate_n_s / 4) << "it jumped at " << i;
  }
  return static_cast<int>(last);
}

TEST(FaultTable, TheStopFlagIsASoftStop) {
  Bench bench;
  std::atomic<bool> stop{false};
  bench.device.spoil = [&stop](int tick, DeviceInput&) { stop = stop || tick == kPressed; };
  EXPECT_EQ(bench.loop->run(stop), LoopEnd::kStopped);
  EXPECT_TRUE(bench.device.feelsNothing());
  const int zero_after = ticksToNothing(bench.device.forces_n) - kPressed;
  EXPECT_NEAR(zero_after, 200, 5);
  tell("StopFlag", "soft stop", zero_after, -1, -1);
}

TEST(FaultTable, AStopWhileTheDeviceIsSilentEndsTheRunAllTheSame) {
  Bench bench;
  std::atomic<bool> stop{false};
  bench.device.spoil = [&](int tick, DeviceInput& input) {
    input.state = tick >= kPressed ? DeviceState::kStale : DeviceState::kLive;
    stop = stop || tick == kPressed + 10;
    if (tick > kPressed + 1000) {
      input.state = DeviceState::kLost;  // else a defect would hold up all tests for ever
    }
  };
  EXPECT_EQ(bench.loop->run(stop), LoopEnd::kStopped);
  EXPECT_TRUE(bench.device.feelsNothing());
}

TEST(FaultTable, TheEndOfTheTimeAskedForIsASoftStop) {
  Bench bench;
  bench.loop = std::make_unique<HapticLoop>(bench.scene, bench.device, asFastAsPossible(2.5), false);
  EXPECT_EQ(bench.loop->run(kNeverStop), LoopEnd::kDuration);
  EXPECT_TRUE(bench.device.feelsNothing());
  const int zero_after = ticksToNothing(bench.device.forces_n) - kPressed;
  EXPECT_NEAR(zero_after, 200, 5);
  tell("DurationOver", "soft stop", zero_after, -1, -1);
}

TEST(FaultTable, AnErrorOnTheOtherSideLetsGoOfTheHandBeforeAnybodyHearsOfIt) {
  Bench bench;
  bench.loop = std::make_unique<HapticLoop>(bench.scene, bench.device, asFastAsPossible(), false);
  std::atomic<bool> stop{false}, pressed{false};
  bench.device.spoil = [&pressed](int tick, DeviceInput&) { pressed = pressed || tick == kPressed; };
  try {
    const LoopThread thread(*bench.loop, asFastAsPossible(), stop);
    while (!pressed) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    throw std::runtime_error("the disk is full");
  } catch (const std::runtime_error&) {
    EXPECT_TRUE(bench.device.feelsNothing());
  }
  (void)ticksToNothing(bench.device.forces_n);
  tell("ErrorOnTheOtherSide", "soft stop", 200, -1, -1);
}

/// The release is recorded as the time in a pipe: it outlives the process.
class PipedDevice final : public HapticDevice {
 public:
  explicit PipedDevice(int pipe) : pipe_(pipe) {}
  [[nodiscard]] std::string_view name() const noexcept override { return "piped"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return {}; }
  [[nodiscard]] DeviceInput read() noexcept override {
    if (++reads_ == 50) {
      tellTime();
      volatile int* nowhere = nullptr;
      *nowhere = 1;
    }
    DeviceInput input;
    input.pose.position_m.z() = 0.2;
    return input;
  }
  void write(const DeviceOutput&) noexcept override {}
  void releaseForce() noexcept override { tellTime(); }
  void resumeForce() noexcept override {}

 private:
  void tellTime() const noexcept {
    const std::int64_t now_ns = monotonicNs();
    (void)!::write(pipe_, &now_ns, sizeof now_ns);
  }
  int pipe_, reads_ = 0;
};

TEST(FaultTable, ACrashInTheLoopLetsGoOfTheHand) {
  if (kSanitized) {
    GTEST_SKIP() << "the sanitizer handles SIGSEGV";
  }
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  const pid_t child = fork();
  if (child == 0) {
    PipedDevice device(ends[1]);
    Scene scene(icra2021Bed(), {});
    HapticLoop loop(scene, device, asFastAsPossible(1), false);
    const LastResort last_resort(device);
    (void)loop.run(kNeverStop);
    _exit(0);
  }
  close(ends[1]);
  std::array<std::int64_t, 2> at_ns{};
  const ssize_t told = read(ends[0], at_ns.data(), sizeof at_ns);
  const ssize_t told_later = told == 8 ? read(ends[0], &at_ns[1], 8) : 8;
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGSEGV);
  ASSERT_EQ(told_later, 8) << "nobody let go of the hand";
  const double after_ms = 1e-6 * static_cast<double>(at_ns[1] - at_ns[0]);
  EXPECT_LT(after_ms, 1000);
  tell("Crash", "SIGSEGV", after_ms, -1, -1);
}

TEST(FaultTable, SoftStartTakesTwoSecondsFromTheFirstTick) {
  Bench bench;
  ASSERT_EQ(bench.ticks(3000), LoopEnd::kRunning);
  for (std::size_t tick = 0; tick < bench.records.size(); ++tick) {
    if (tick < 1998 || tick > 2001) {  // 2000 steps of 1 / 2000 are 1 except for rounding
      ASSERT_EQ((bench.records[tick].flags & kTickSoftStart) != 0, tick < 2000) << tick;
    }
    ASSERT_LE(bench.device.forces_n[tick].norm(), softly(static_cast<double>(tick) + 1) + 1e-12);
  }
  EXPECT_GT(bench.device.forces_n.back().norm(), 0.3);
}

TEST(FaultTable, TheLastFiftyTicksBeforeATripAreTold) {
  Bench bench;
  bench.device.spoil = [](int tick, DeviceInput& input) {
    input.state = tick == kPressed ? DeviceState::kStale : DeviceState::kLive;
  };
  ASSERT_EQ(bench.ticks(kPressed), LoopEnd::kRunning);
  EXPECT_FALSE(bench.loop->trips().update());
  ASSERT_EQ(bench.ticks(10), LoopEnd::kRunning);
  ASSERT_TRUE(bench.loop->trips().update());
  const TripReport& report = bench.loop->trips().latest();
  EXPECT_EQ(report.trip, SafetyTrip::kStale);
  ASSERT_EQ(report.count, 50U);
  for (std::size_t i = 0; i < 50; ++i) {
    const TickRecord& kept = bench.records[kPressed + 1 - 50 + i];
    EXPECT_EQ(report.ticks[i].time_s, kept.time_s);
    EXPECT_EQ(report.ticks[i].sent.wrench.force_n, kept.sent.wrench.force_n);
    EXPECT_EQ(report.ticks[i].trip != 0, i == 49) << "the last one is the trip's";
  }
}

TEST(FaultTable, ATripWithinTheFirstTicksIsToldWithWhatThereIs) {
  Bench bench;
  bench.device.spoil = [](int tick, DeviceInput& input) {
    input.state = tick == 7 ? DeviceState::kStale : DeviceState::kLive;
  };
  ASSERT_EQ(bench.ticks(20), LoopEnd::kRunning);
  ASSERT_TRUE(bench.loop->trips().update());
  const TripReport& report = bench.loop->trips().latest();
  ASSERT_EQ(report.count, 8U);
  EXPECT_EQ(report.ticks[0].time_s, kTick_s);
}

TEST(FaultTable, ResumingIsNoJumpForADeviceThatHasMovedMeanwhile) {
  Bench bench;
  ASSERT_EQ(bench.ticks(kPressed), LoopEnd::kRunning);
  const double soil_before_n = bench.records.back().soil.force_n.norm();
  ASSERT_TRUE(bench.loop->ask(request::Pause{}));
  ASSERT_EQ(bench.ticks(200), LoopEnd::kRunning);
  EXPECT_TRUE(bench.device.feelsNothing());
  const std::size_t recorded = bench.records.size();
  EXPECT_EQ(recorded, static_cast<std::size_t>(kPressed)) << "time stands still";
  bench.device.aside_m = 0.03;  // next to the hole, in the interior of the soil
  ASSERT_TRUE(bench.loop->ask(request::Resume{}));
  double fastest_m_s = 0;
  for (int tick = 1; tick <= 2500; ++tick) {
    const Vec3 last_n = bench.device.forces_n.back();
    ASSERT_EQ(bench.ticks(1), LoopEnd::kRunning);
    const Vec3 now_n = bench.device.forces_n.back();
    ASSERT_LE(now_n.norm(), softly(tick) + 1e-9) << tick;
    ASSERT_LE((now_n - last_n).norm(), kTick_s * kMaxRate_n_s + 1e-12) << tick;
    if (tick == 1) {
      EXPECT_NE(bench.records.back().flags & kTickResumed, 0U);
      EXPECT_NEAR(bench.records.back().scene_T_tool.position_m.x(), 0.03, 1e-12);
      EXPECT_LT(bench.records.back().soil.force_n.norm(), 0.1 * soil_before_n);
    }
    fastest_m_s = std::max(fastest_m_s, bench.scene.bed().largestSpeed());
  }
  EXPECT_LT(fastest_m_s, 1) << "the soil is moved out of the way, not shot";
}

}  // namespace
}  // namespace haptolith
