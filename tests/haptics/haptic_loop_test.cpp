#include "haptolith/haptics/loop/haptic_loop.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/platform/clock.h"
#include "haptolith/device/hand/virtual_hand.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

constexpr double kTick_s = 1e-3;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

BedParameters icra2021Bed() {
  BedParameters bed;
  bed.soil = findPreset("P4").soil;
  return bed;
}

LoopParameters asFastAsPossible(double duration_s) {
  LoopParameters loop;
  loop.real_time = false;
  loop.duration_s = duration_s;
  return loop;
}

/// A device that does what a test wants and remembers what it was made to feel.
class FakeDevice final : public HapticDevice {
 public:
  explicit FakeDevice(std::function<DeviceInput(int)> input) : input_(std::move(input)) {}
  [[nodiscard]] std::string_view name() const noexcept override { return "fake"; }
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return limits_; }
  [[nodiscard]] DeviceInput read() noexcept override {
    events_ += 'r';
    return input_(reads_++);
  }
  void write(const DeviceOutput& output) noexcept override {
    events_ += 'w';
    last_ = output.wrench;
    largest_force_n_ = std::max(largest_force_n_, last_.force_n.norm());
  }
  void releaseForce() noexcept override {}
  void resumeForce() noexcept override {}

  DeviceLimits limits_;
  int reads_ = 0;
  std::string events_;
  Wrench last_{Vec3(9, 9, 9), Vec3(9, 9, 9)};
  double largest_force_n_ = 0;

 private:
  std::function<DeviceInput(int)> input_;
};

/// A shovel pushed into the soil at 0.1 m/s from just above it.
DeviceInput pushing(int tick) {
  DeviceInput input;
  input.pose.position_m = Vec3(0, 0, 0.046 - 1e-4 * tick);
  input.twist.linear_m_s = Vec3(0, 0, -0.1);
  return input;
}

DeviceInput above(int) {
  DeviceInput input;
  input.pose.position_m = Vec3(0, 0, 0.12);
  return input;
}

bool isZero(const Wrench& wrench) {
  return wrench.force_n == Vec3::Zero() && wrench.torque_nm == Vec3::Zero();
}

const std::atomic<bool> kNeverStop{false};

TEST(HapticLoop, RunsForTheTimeAskedForAndLetsGo) {
  Scene scene(icra2021Bed(), {});
  FakeDevice device(pushing);
  HapticLoop loop(scene, device, asFastAsPossible(0.2), false);
  EXPECT_EQ(loop.run(kNeverStop), LoopEnd::kDuration);
  EXPECT_EQ(loop.statistics().ticks(), 200U);
  EXPECT_NEAR(loop.time(), 0.2, 1e-12);
  EXPECT_EQ(device.reads_, 200);
  EXPECT_GT(device.largest_force_n_, 0.1);
  EXPECT_TRUE(isZero(device.last_));
  // Read, write, read, write, and the zero at the end.
  std::string expected;
  for (int i = 0; i < 200; ++i) {
    expected += "rw";
  }
  EXPECT_EQ(device.events_, expected + "w");
}

TEST(HapticLoop, TheHandFeelsTheFilteredAndLimitedWrenchOfTheSoil) {
  Scene scene(icra2021Bed(), {});
  FakeDevice device(pushing);
  device.limits_ = {.max_force_n = 0.3, .max_torque_nm = 0.001};
  HapticLoop loop(scene, device, asFastAsPossible(0), true);
  WrenchFilter filter(30, kTick_s);
  QuickMovement quick(kTick_s);
  std::vector<TickRecord> records;
  for (int i = 0; i < 200; ++i) {
    ASSERT_EQ(loop.tick(), LoopEnd::kRunning);
    const Vec3 own_change_n = -kTick_s * scene.contactStiffness() * quick.step(pushing(i).twist.linear_m_s);
    const Wrench expected = limited(filter.step(scene.soilWrench(), own_change_n), device.limits_);
    ASSERT_EQ(device.last_.force_n, expected.force_n);
    ASSERT_EQ(device.last_.torque_nm, expected.torque_nm);
    loop.takeRecords(records);
    ASSERT_EQ(records.back().sent.wrench.force_n, expected.force_n);
    ASSERT_EQ(records.back().soil.force_n, scene.soilWrench().force_n);
  }
  EXPECT_NEAR(device.largest_force_n_, 0.3, 1e-12);  // the limit was reached, and not passed
}

/// In the air, up and down by 5 cm each second, turned on its side.
DeviceInput lifting(int tick) {
  constexpr double kAmplitude_m = 0.05;
  const double phase = 2 * std::numbers::pi * kTick_s * tick;
  DeviceInput input;
  input.pose = {Vec3(0, 0, 0.15 + kAmplitude_m * std::sin(phase)),
                Quat(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitZ()))};
  input.twist.linear_m_s = Vec3(0, 0, 2 * std::numbers::pi * kAmplitude_m * std::cos(phase));
  return input;
}

TEST(HapticLoop, AToolWithAMassIsFeltWithItsWeightAndNobodyDampsIt) {
  ToolParameters tool;
  tool.mass_kg = 0.2;
  tool.centre_of_mass_m = Vec3(0.03, 0, -0.01);
  Scene scene(icra2021Bed(), tool);
  FakeDevice device(lifting);
  HapticLoop loop(scene, device, asFastAsPossible(0), true);
  const double weight_n = 0.2 * 1.625;
  for (int tick = 0; tick < 5000; ++tick) {
    ASSERT_EQ(loop.tick(), LoopEnd::kRunning);
    ASSERT_LT((device.last_.force_n - Vec3(0, 0, -weight_n)).norm(), 1e-12) << tick;
    // The centre is along y, seen from the scene.
    ASSERT_LT((device.last_.torque_nm - Vec3(-0.03 * weight_n, 0, 0)).norm(), 1e-12) << tick;
  }
  std::vector<TickRecord> records;
  loop.takeRecords(records);
  ASSERT_FALSE(records.empty());
  for (const TickRecord& record : records) {
    ASSERT_EQ(record.flags & kTickPassivityDamped, 0U);
    ASSERT_EQ(record.injected_j, 0) << "gravity gives back what lifting cost";
    ASSERT_LT((record.rendered.wrench.force_n - Vec3(0, 0, -weight_n)).norm(), 1e-12);
  }
}

TEST(HapticLoop, AVirtualCouplingAlsoShowsTheInertiaOfAToolWithAMass) {
  ToolParameters tool;
  tool.mass_kg = 0.3;
  Scene scene(icra2021Bed(), tool);
  FakeDevice device(lifting);
  HandlingParameters handling;
  handling.coupling.kind = CouplingKind::kVirtual;
  HapticLoop loop(scene, device, asFastAsPossible(0), false, handling);
  double most_n = -1e9, least_n = 1e9;
  for (int tick = 0; tick < 4000; ++tick) {
    ASSERT_EQ(loop.tick(), LoopEnd::kRunning);
    if (tick >= 2000) {
      most_n = std::max(most_n, device.last_.force_n.z());
      least_n = std::min(least_n, device.last_.force_n.z());
    }
  }
  const double omega = 2 * std::numbers::pi;
  // Through a spring K the hand meets m a / |1 - m w^2 / (K + i B w)|, 6 % more than m a here.
  const double inertia_n = 0.3 * 0.05 * omega * omega;
  EXPECT_NEAR((most_n - least_n) / 2, inertia_n, 0.1 * inertia_n);
  EXPECT_NEAR((most_n + least_n) / 2, -0.3 * 1.625, 0.01);
}

TEST(HapticLoop, AStopFlagEndsItAndTheHandIsLetGo) {
  Scene scene(icra2021Bed(), {});
  std::atomic<bool> stop{false};
  FakeDevice device([&](int tick) {
    stop = tick == 149;
    return pushing(tick);
  });
  HapticLoop loop(scene, device, asFastAsPossible(0), false);
  EXPECT_EQ(loop.run(stop), LoopEnd::kStopped);
  EXPECT_EQ(loop.statistics().ticks(), 150U);
  EXPECT_GT(device.largest_force_n_, 0.1);
  EXPECT_TRUE(isZero(device.last_));
}

TEST(HapticLoop, AHandThatIsNoNumberOrFarAwayEndsItAndIsLetGo) {
  const std::function<void(DeviceInput&)> spoils[] = {
      [](DeviceInput& input) { input.pose.position_m.x() = kNaN; },
      [](DeviceInput& input) { input.pose.position_m.z() = kNaN; },
      [](DeviceInput& input) { input.pose.position_m.y() = std::numeric_limits<double>::infinity(); },
      [](DeviceInput& input) { input.pose.orientation.w() = kNaN; },
      [](DeviceInput& input) { input.twist.linear_m_s.z() = kNaN; },
      [](DeviceInput& input) { input.twist.angular_rad_s.x() = kNaN; },
      [](DeviceInput& input) { input.pose.position_m.x() = 1.1; },
      [](DeviceInput& input) { input.pose.position_m.y() = -1.1; },
      [](DeviceInput& input) { input.pose.position_m.z() = -1.1; },
      [](DeviceInput& input) { input.pose.position_m.z() = 3.1; }};
  int number = 0;
  for (const auto& spoil : spoils) {
    for (const bool through_run : {true, false}) {
      SCOPED_TRACE(number);
      Scene scene(icra2021Bed(), {});
      FakeDevice device([&](int tick) {
        DeviceInput input = pushing(tick);
        if (tick == 150) {
          spoil(input);
        }
        return input;
      });
      HapticLoop loop(scene, device, asFastAsPossible(0), false);
      LoopEnd end = LoopEnd::kRunning;
      if (through_run) {
        end = loop.run(kNeverStop);
      } else {
        while (end == LoopEnd::kRunning) {
          end = loop.tick();
        }
      }
      EXPECT_EQ(end, LoopEnd::kHandLeft);
      EXPECT_EQ(loop.statistics().ticks(), 151U) << "with the one that ended it";
      EXPECT_TRUE(isZero(device.last_));
      EXPECT_TRUE(std::isfinite(scene.bed().energy())) << "the bed was harmed";
    }
    ++number;
  }
}

TEST(HapticLoop, ABedThatIsNoNumberEndsItAndTheHandIsLetGo) {
  Scene scene(icra2021Bed(), {});
  FakeDevice device([](int tick) {
    DeviceInput input = pushing(tick);
    if (tick == 150) {
      input.twist.linear_m_s.z() = -1e300;  // finite, but no force that a float can hold
    }
    return input;
  });
  HapticLoop loop(scene, device, asFastAsPossible(0), false);
  EXPECT_EQ(loop.run(kNeverStop), LoopEnd::kNotFinite);
  EXPECT_TRUE(isZero(device.last_));
}

TEST(HapticLoop, APoseFilesEndEndsIt) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("haptolith_loop_" + std::to_string(getpid()) + ".csv");
  std::ofstream(path) << "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0.1,1,0,0,0\n0.25,0,0,0.035,1,0,0,0\n";
  HandParameters hand;
  hand.motion = HandMotion::kPoses;
  hand.compliance = HandCompliance::kRigid;
  hand.poses_file = path.string();
  VirtualHand device(hand, kTick_s);
  std::filesystem::remove(path);
  Scene scene(icra2021Bed(), {});
  HapticLoop loop(scene, device, asFastAsPossible(10), true);
  EXPECT_EQ(loop.run(kNeverStop), LoopEnd::kFinished);
  EXPECT_EQ(loop.statistics().ticks(), 251U);  // the last one goes past the end
  std::vector<TickRecord> records;
  loop.takeRecords(records);
  EXPECT_EQ(records.size(), 251U);
}

TEST(HapticLoop, RecordsAreCompleteAndInOrder) {
  Scene scene(icra2021Bed(), {});
  HandParameters hand;
  hand.surface_m = scene.bed().surfaceHeight();
  VirtualHand device(hand, kTick_s);
  HapticLoop loop(scene, device, asFastAsPossible(12), true);  // more than the queue holds: the loop waits for us
  LoopEnd end = LoopEnd::kRunning;
  std::atomic<bool> done{false};
  std::thread runner([&] {
    end = loop.run(kNeverStop);
    done = true;
  });
  std::vector<TickRecord> records;
  while (!done) {
    loop.takeRecords(records);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  runner.join();
  loop.takeRecords(records);
  EXPECT_EQ(end, LoopEnd::kDuration);
  ASSERT_EQ(records.size(), 12'000U);
  EXPECT_EQ(loop.lostRecords(), 0U);
  for (std::size_t i = 0; i < records.size(); ++i) {
    ASSERT_NEAR(records[i].time_s, static_cast<double>(i + 1) * kTick_s, 1e-9);
    ASSERT_TRUE(records[i].soil.force_n.allFinite());
    ASSERT_GE(records[i].tick_us, 0);
  }
}

TEST(HapticLoop, WithoutAListenerItKeepsNoRecordsAndWaitsForNobody) {
  Scene scene(icra2021Bed(), {});
  FakeDevice device(above);
  HapticLoop loop(scene, device, asFastAsPossible(9), false);  // more ticks than the queue has places
  EXPECT_EQ(loop.run(kNeverStop), LoopEnd::kDuration);
  std::vector<TickRecord> records;
  loop.takeRecords(records);
  EXPECT_TRUE(records.empty());
  EXPECT_EQ(loop.lostRecords(), 0U);
}

TEST(HapticLoop, SnapshotsShowTheScene) {
  Scene scene(icra2021Bed(), {});
  FakeDevice device(pushing);
  HapticLoop loop(scene, device, asFastAsPossible(0), false);
  int seen = 0;
  for (int i = 0; i < 160; ++i) {
    ASSERT_EQ(loop.tick(), LoopEnd::kRunning);
    if (loop.snapshots().update()) {
      ++seen;
      const SceneSnapshot& now = loop.snapshots().latest();
      ASSERT_EQ(now.position.size(), 256U);
      EXPECT_EQ(now.position[17].z, scene.bed().state().position[17].z);
      EXPECT_EQ(now.scene_T_tool.position_m, pushing(i).pose.position_m);
      EXPECT_EQ(now.ticks, static_cast<std::uint64_t>(i + 1)) << "the tick whose scene it is";
      EXPECT_DOUBLE_EQ(now.time_s, loop.time());
    }
  }
  EXPECT_EQ(seen, 10);  // every 16th tick
}

TEST(HapticLoop, SnapshotsOfALargeBedAreCopiedBitByBit) {
  BedParameters large = icra2021Bed();
  large.start = BedStart::kPacked;
  large.width_m = large.length_m = 0.5;
  large.depth_m = 0.08;
  large.gravity_m_s2 = {6, 3, -2};  // everything moves
  Scene scene(large, {});
  const std::size_t n = scene.bed().particles();
  ASSERT_GT(n, 5000U);
  FakeDevice device(pushing);
  HapticLoop loop(scene, device, asFastAsPossible(0), false);
  const auto same = [](const Float4& a, const Float4& b) { return a.x == b.x && a.y == b.y && a.z == b.z; };
  const auto part = static_cast<std::ptrdiff_t>(n / 16 - 2 * kGroup);  // it is whole groups that are copied
  std::vector<Float4> first_of_cycle;
  double fastest = 0;  // during the cycle
  int seen = 0;
  for (int i = 0; i < 160; ++i) {
    ASSERT_EQ(loop.tick(), LoopEnd::kRunning);
    const std::vector<Float4>& position = scene.bed().state().position;
    fastest = std::max(fastest, scene.bed().largestSpeed());
    if (loop.snapshots().update()) {
      ++seen;
      const SceneSnapshot& now = loop.snapshots().latest();
      const auto shown = now.position.begin();
      ASSERT_EQ(now.position.size(), n);
      EXPECT_TRUE(std::equal(now.position.end() - part, now.position.end(),
                             position.begin() + static_cast<std::ptrdiff_t>(n) - part, same))
          << "the last part is of this tick";
      if (i >= 16) {
        EXPECT_TRUE(std::equal(shown, shown + part, first_of_cycle.begin(), same)) << "the first is of 15 ticks ago";
        EXPECT_FALSE(std::equal(shown, shown + part, position.begin(), same));
        EXPECT_LE(now.largest_speed_m_s, fastest);
        EXPECT_GT(now.largest_speed_m_s, 0.1 * fastest);
      }
    }
    if (i % 16 == 1) {
      first_of_cycle = position;
      fastest = scene.bed().largestSpeed();
    }
  }
  EXPECT_EQ(seen, 10);
}

TEST(HapticLoop, ALoopInRealTimeKeepsStepWithTheClock) {
  Scene scene(icra2021Bed(), {});
  FakeDevice device(above);
  LoopParameters parameters;
  parameters.duration_s = 0.3;
  HapticLoop loop(scene, device, parameters, false);
  const std::int64_t start = monotonicNs();
  EXPECT_EQ(loop.run(kNeverStop), LoopEnd::kDuration);
  const double took_s = 1e-9 * static_cast<double>(monotonicNs() - start);
  EXPECT_EQ(loop.statistics().ticks(), 300U);
  // The first tick is at once, so 299 periods; never sooner. Later by as much as a busy machine likes, within reason.
  EXPECT_GE(took_s, 0.295);
  EXPECT_LT(took_s, 30);
}

TEST(HapticLoop, ALateTickIsNotMadeUpForByABurst) {
  Scene scene(icra2021Bed(), {});
  std::vector<std::int64_t> at_ns;
  FakeDevice device([&](int tick) {
    if (tick == 20) {
      sleepUntilNs(monotonicNs() + 50'000'000);  // 50 ticks late
    }
    at_ns.push_back(monotonicNs());
    return above(tick);
  });
  LoopParameters parameters;
  parameters.duration_s = 0.06;
  HapticLoop loop(scene, device, parameters, false);
  EXPECT_EQ(loop.run(kNeverStop), LoopEnd::kDuration);
  ASSERT_EQ(at_ns.size(), 60U);
  // 39 ticks after the late one: at most one of them at once, so at least 37 periods.
  EXPECT_GE(at_ns[59] - at_ns[20], 37'000'000);
  EXPECT_GE(loop.statistics().deadlineMisses(), 1U);
  EXPECT_GE(loop.statistics().misses(Miss::kPreempted), 1U) << "a device that blocks once looks like it";
}

TEST(HapticLoop, TicksThatAlwaysTakeLongerThanATickAreTooLong) {
  Scene scene(icra2021Bed(), {});
  FakeDevice device([](int tick) {
    const std::int64_t until_ns = monotonicNs() + 1'500'000;
    while (monotonicNs() < until_ns) {
    }
    return above(tick);
  });
  LoopParameters parameters;
  parameters.duration_s = 0.06;
  HapticLoop loop(scene, device, parameters, false);
  EXPECT_EQ(loop.run(kNeverStop), LoopEnd::kDuration);
  EXPECT_EQ(loop.statistics().deadlineMisses(), 60U);
  // Not all 60: a busy machine may interrupt some.
  EXPECT_GT(loop.statistics().misses(Miss::kTooLong), 30U);
}

TEST(HapticLoop, TheToolBeginsWhereTheHandIs) {
  // With substeps the tool moves through the bed within a tick: at the first one it must not come from the origin.
  BedParameters bed = icra2021Bed();
  bed.soil = rescaled(bed.soil, 3.5e-3);
  bed.width_m = bed.length_m = 0.063;
  Scene scene(bed, {});
  ASSERT_EQ(scene.substeps(), 2);
  ASSERT_LT(scene.bed().surfaceHeight(), 0.025);
  FakeDevice device([](int) {
    DeviceInput input;
    input.pose.position_m = Vec3(0, 0, 0.032);  // clear of the soil, but halfway to the origin is not
    return input;
  });
  HapticLoop loop(scene, device, asFastAsPossible(0.05), true);
  EXPECT_EQ(loop.run(kNeverStop), LoopEnd::kDuration);
  std::vector<TickRecord> records;
  loop.takeRecords(records);
  for (const TickRecord& record : records) {
    ASSERT_EQ(record.soil.force_n, Vec3::Zero()) << record.time_s;
  }
}

TEST(HapticLoop, RefusesWrongParametersAndABedOfAnotherTick) {
  Scene scene(icra2021Bed(), {});
  FakeDevice device(above);
  LoopParameters parameters;
  parameters.filter_cutoff_hz = 0;
  EXPECT_THROW((HapticLoop{scene, device, parameters, false}), InvalidParameter);
  parameters = {};
  parameters.tick_s = 2e-3;
  EXPECT_THROW((HapticLoop{scene, device, parameters, false}), InvalidParameter);
}

TEST(HapticLoop, EveryEndHasAText) {
  std::vector<std::string> texts;
  for (int i = 0; i < kLoopEnds; ++i) {
    const auto end = static_cast<LoopEnd>(i);
    texts.emplace_back(text(end));
    EXPECT_FALSE(texts.back().empty());
  }
  std::ranges::sort(texts);
  EXPECT_TRUE(std::ranges::adjacent_find(texts) == texts.end());
}

TEST(HapticLoop, SoilIsAdjustedAStepATickAndEachTickSaysSo) {
  BedParameters bed;
  bed.soil.friction = FrictionModel::kContact;
  bed.soil.contact_cohesion_n = 0.01;
  Scene scene(bed, {});
  FakeDevice device(above);
  HapticLoop loop(scene, device, asFastAsPossible(0), true);
  const auto adjust = [&](double friction) {
    SoilParameters soil = bed.soil;
    soil.contact_friction = friction;
    EXPECT_TRUE(loop.ask(request::Adjust{SoilLaws(soil), friction / 2}));
  };
  adjust(0.3);
  adjust(0.4);
  std::vector<TickRecord> ticks;
  std::vector<double> frictions;
  for (int i = 0; i < 3; ++i) {
    (void)loop.tick();
    frictions.push_back(scene.bed().parameters().soil.contact_friction);
  }
  loop.takeRecords(ticks);
  EXPECT_EQ(frictions, (std::vector<double>{0.3, 0.4, 0.4}));
  EXPECT_EQ(scene.tool().friction, 0.2);
  ASSERT_EQ(ticks.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ((ticks[i].flags & kTickSoilAdjusted) != 0, i < 2) << i;
    EXPECT_EQ(ticks[i].flags & kTickSceneChanged, 0U) << "a replay can follow";
  }
}

TEST(HapticLoop, GrainsAreMovedOneATickAndEachTickSaysSo) {
  BedParameters bed;
  Scene scene(bed, {});
  FakeDevice device([](int tick) {
    DeviceInput input = above(tick);
    input.pose.position_m = {0, 0, 0.5};
    return input;
  });
  HapticLoop loop(scene, device, asFastAsPossible(0), true);
  const auto x = [&](std::size_t grain) { return scene.bed().state().position[grain].x; };
  for (const int grain : {0, 1}) {
    const Float4& at = scene.bed().state().position[static_cast<std::size_t>(grain)];
    const Vec3 to_m(0.02 * (grain + 1), 0, 0.1);
    EXPECT_TRUE(loop.ask(request::MoveGrain{{static_cast<std::size_t>(grain), Vec3(at.x, at.y, at.z), to_m}}));
  }
  EXPECT_TRUE(loop.ask(request::MoveGrain{{0, {9, 9, 9}, {0, 0, 0.2}}})) << "which it will not do";
  std::vector<TickRecord> ticks;
  (void)loop.tick();
  EXPECT_EQ(x(0), 0.02F);
  EXPECT_NE(x(1), 0.04F);
  (void)loop.tick();
  EXPECT_EQ(x(1), 0.04F);
  (void)loop.tick();
  (void)loop.tick();
  EXPECT_LT(scene.bed().state().position[0].z, 0.11F);
  loop.takeRecords(ticks);
  ASSERT_EQ(ticks.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ((ticks[i].flags & kTickParticleMoved) != 0, i < 3) << i;
    EXPECT_EQ(ticks[i].flags & kTickSceneChanged, 0U) << "a replay can follow";
  }
}

}  // namespace
}  // namespace haptolith
