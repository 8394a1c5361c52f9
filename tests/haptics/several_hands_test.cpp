// Several hands in one loop: each has its own device, mapping, coupling, safety layer and fade.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int kFaults = 20;
#else
constexpr int kFaults = 200;
#endif

constexpr double kTick_s = 1e-3;
constexpr double kAside_m = 0.05;

enum class Fault { kNone, kUnplugged, kSilent, kNotFinite, kJump };
constexpr std::array kAllFaults{Fault::kUnplugged, Fault::kSilent, Fault::kNotFinite, Fault::kJump};

/// A person's device that presses its tool into the soil, and may fail.
class PersonsDevice final : public HapticDevice {
 public:
  PersonsDevice(double x_m, double surface_m, int presses_for = 60)
      : x_m_(x_m), surface_m_(surface_m), presses_for_(presses_for) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "a person's"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override {
    DeviceLimits limits;
    limits.max_force_n = 20;
    return limits;
  }
  [[nodiscard]] DeviceInput read() noexcept override {
    const int tick = reads_++;
    const double share = std::min(1.0, static_cast<double>(tick) / presses_for_);
    DeviceInput input;
    input.pose.position_m = Vec3(x_m_, 0, surface_m_ + 0.01 - 0.02 * share);
    input.twist.linear_m_s = Vec3(0, 0, share < 1 ? -0.02 / (presses_for_ * kTick_s) : 0);
    if (tick >= fails_at_) {
      switch (fault_) {
        case Fault::kNone: break;
        case Fault::kUnplugged: input.state = DeviceState::kLost; break;
        case Fault::kSilent: input.state = DeviceState::kStale; break;
        case Fault::kNotFinite: input.pose.position_m.y() = std::numeric_limits<double>::quiet_NaN(); break;
        case Fault::kJump: input.pose.position_m.x() += 10; break;
      }
    }
    return input;
  }
  void write(const DeviceOutput& output) noexcept override { sent_.push_back(output.wrench); }
  void releaseForce() noexcept override {}
  void resumeForce() noexcept override {}

  void failAt(int tick, Fault fault) {
    fails_at_ = tick;
    fault_ = fault;
  }
  [[nodiscard]] const std::vector<Wrench>& sent() const { return sent_; }

 private:
  double x_m_, surface_m_;
  int presses_for_;
  int reads_ = 0, fails_at_ = std::numeric_limits<int>::max();
  Fault fault_ = Fault::kNone;
  std::vector<Wrench> sent_;
};

BedParameters wideBed() {
  BedParameters bed;
  bed.soil = findPreset("P3").soil;
  bed.start = BedStart::kPacked;
  bed.width_m = 0.25;
  bed.length_m = 0.08;
  bed.depth_m = 0.03;
  return bed;
}

LoopParameters asFastAsPossible() {
  LoopParameters loop;
  loop.real_time = false;
  return loop;
}

HandlingParameters quickly() {
  HandlingParameters handling;
  handling.safety.soft_start_s = 0.05;
  return handling;
}

struct TwoHands {
  explicit TwoHands(const ToolSet& tools = ToolSet(std::vector<ToolParameters>(2)))
      : scene(wideBed(), tools),
        left(-kAside_m, scene.bed().surfaceHeight()),
        right(kAside_m, scene.bed().surfaceHeight()),
        loop(scene, std::array{ToolHandling{&left, quickly()}, ToolHandling{&right, quickly()}}, asFastAsPossible(),
             true) {}

  LoopEnd run(int ticks) {
    LoopEnd end = LoopEnd::kRunning;
    for (int tick = 0; tick < ticks && end == LoopEnd::kRunning; ++tick) {
      end = loop.tick();
      stiffness_n_m[0].push_back(scene.contactStiffness(0));
      stiffness_n_m[1].push_back(scene.contactStiffness(1));
    }
    loop.takeRecords(records);
    return end;
  }

  Scene scene;
  PersonsDevice left, right;
  HapticLoop loop;
  std::vector<TickRecord> records;
  std::array<std::vector<Eigen::Matrix3d>, 2> stiffness_n_m;  ///< contact stiffness per tool, after each tick
};

bool same(const Wrench& a, const Wrench& b) {
  return a.force_n == b.force_n && a.torque_nm == b.torque_nm;
}

/// Wrenches that this hand would have been sent for the same soil wrenches if it had been alone.
std::vector<Wrench> sentAlone(const TwoHands& two, std::size_t tool) {
  const DeviceLimits limits = two.left.limits();
  const HandlingParameters handling = quickly();
  const Scene scene(wideBed(), ToolParameters());
  Mapping mapping(handling.mapping, limits, kTick_s);
  Coupling coupling(handling.coupling, true, LoopParameters().filter_cutoff_hz, kTick_s);
  const double storage_n_m = std::min(ToolParameters().stiffness_n_m, scene.bed().parameters().soil.stiffness_n_m);
  SafetyLayer safety(handling.safety, limits, false, storage_n_m, kTick_s);
  std::vector<Wrench> sent;
  for (const TickRecord& record : two.records) {
    if (record.tool != tool) {
      continue;
    }
    safety.check(record.device, {});
    const HandState hand = mapping.toScene(record.device);
    if (sent.empty()) {
      coupling.place(hand);
    }
    (void)coupling.moveTool(hand);
    sent.push_back(
        safety.step(mapping.toDevice(coupling.feel({record.soil, 0}, two.stiffness_n_m[tool][sent.size()]))).wrench);
  }
  return sent;
}

TEST(SeveralHands, EachIsRecordedAndFeelsItsOwnTool) {
  TwoHands two;
  EXPECT_EQ(two.run(200), LoopEnd::kRunning);
  ASSERT_EQ(two.records.size(), 400U);
  for (std::size_t i = 0; i < two.records.size(); ++i) {
    EXPECT_EQ(two.records[i].tool, i % 2);
    EXPECT_EQ(two.records[i].time_s, two.records[i - i % 2].time_s);
    EXPECT_EQ(two.records[i].scene_T_tool.position_m.x(), i % 2 == 0 ? -kAside_m : kAside_m);
  }
  EXPECT_GT(two.records[398].sent.wrench.force_n.z(), 0.01);
  EXPECT_GT(two.records[399].sent.wrench.force_n.z(), 0.01);
  for (const std::size_t tool : {0U, 1U}) {
    const PersonsDevice& device = tool == 0 ? two.left : two.right;
    const std::vector<Wrench> alone = sentAlone(two, tool);
    for (std::size_t tick = 0; tick < alone.size(); ++tick) {
      ASSERT_TRUE(same(device.sent()[tick], alone[tick])) << tool << " " << tick;
    }
  }
}

TEST(SeveralHands, AFaultOfOneReleasesThatHandAndNotTheOther) {
  std::mt19937 random(7);
  for (int i = 0; i < kFaults; ++i) {
    const Fault fault = kAllFaults[static_cast<std::size_t>(i) % kAllFaults.size()];
    const bool on_left = random() % 2 == 0;
    const int at = 80 + static_cast<int>(random() % 60);
    SCOPED_TRACE("fault " + std::to_string(static_cast<int>(fault)) + " at " + std::to_string(at));
    TwoHands two;
    PersonsDevice& failing = on_left ? two.left : two.right;
    PersonsDevice& other = on_left ? two.right : two.left;
    failing.failAt(at, fault);
    ASSERT_EQ(two.run(180), LoopEnd::kRunning);
    constexpr int kReleased = 5;  // ms
    ASSERT_GT(failing.sent()[static_cast<std::size_t>(at - 1)].force_n.norm(), 0) << "it felt something before";
    for (std::size_t tick = static_cast<std::size_t>(at + kReleased); tick < failing.sent().size(); ++tick) {
      ASSERT_TRUE(failing.sent()[tick].isZero()) << tick;
    }
    const std::vector<Wrench> alone = sentAlone(two, on_left ? 1 : 0);
    ASSERT_EQ(other.sent().size(), alone.size());
    for (std::size_t tick = 0; tick < alone.size(); ++tick) {
      ASSERT_TRUE(same(other.sent()[tick], alone[tick])) << tick << ": not only by the soil";
    }
    EXPECT_GT(other.sent().back().force_n.norm(), 0);
    for (const TickRecord& record : two.records) {
      EXPECT_TRUE(record.tool == (on_left ? 0 : 1) || record.trip == 0);
    }
  }
}

TEST(SeveralHands, TheRunEndsWhenNoPersonIsLeft) {
  TwoHands two;
  two.left.failAt(50, Fault::kUnplugged);
  two.right.failAt(70, Fault::kUnplugged);
  EXPECT_EQ(two.run(200), LoopEnd::kLost);
  EXPECT_EQ(two.loop.statistics().ticks(), 71U);
  EXPECT_TRUE(two.left.sent().back().isZero());
  EXPECT_TRUE(two.right.sent().back().isZero());
}

TEST(SeveralHands, ATripIsReportedWithItsTool) {
  TwoHands two;
  two.right.failAt(90, Fault::kSilent);
  EXPECT_EQ(two.run(120), LoopEnd::kRunning);
  ASSERT_TRUE(two.loop.trips().update());
  const TripReport& report = two.loop.trips().latest();
  EXPECT_EQ(report.tool, 1U);
  EXPECT_EQ(report.trip, SafetyTrip::kStale);
  EXPECT_EQ(report.ticks[report.count - 1].tool, 1U);
}

TEST(SeveralHands, AnotherToolFadesInWhereTheOtherWasAndTheOtherHandFeelsOn) {
  TwoHands two;
  EXPECT_EQ(two.run(310), LoopEnd::kRunning);
  ASSERT_EQ(two.scene.toolFade(0), 1);
  const ToolParameters ball{.shape = ToolShape::kSphere, .diameter_m = 0.03};
  ASSERT_TRUE(two.loop.ask(request::Replace{request::ReplaceTool{ball, 1}}));
  EXPECT_EQ(two.run(1), LoopEnd::kRunning);
  EXPECT_EQ(two.scene.tool(1).shape, ToolShape::kBox) << "still fading";
  EXPECT_EQ(two.scene.toolFade(0), 1);
  EXPECT_EQ(two.run(110), LoopEnd::kRunning);
  EXPECT_EQ(two.scene.tool(1).shape, ToolShape::kSphere);
  EXPECT_EQ(two.scene.tool(0).shape, ToolShape::kBox);
  EXPECT_LT(two.scene.toolFade(1), 0.5);
  EXPECT_EQ(two.scene.toolFade(0), 1);
}

TEST(SeveralHands, AnotherBedWaitsUntilAllToolsHaveLeft) {
  TwoHands two;
  EXPECT_EQ(two.run(150), LoopEnd::kRunning);
  Scene other(wideBed(), ToolSet(std::vector<ToolParameters>(2)));
  ShownScene next(other);
  ASSERT_TRUE(two.loop.ask(request::Replace{request::ReplaceBed{&next}}));
  EXPECT_EQ(two.run(50), LoopEnd::kRunning);
  EXPECT_NE(&two.loop.shownScene(), &next);
  EXPECT_EQ(two.run(100), LoopEnd::kRunning);
  EXPECT_EQ(&two.loop.shownScene(), &next);
  EXPECT_EQ(other.toolPose(1).position_m.x(), kAside_m);
}

TEST(SeveralHands, SnapshotsHaveEveryTool) {
  ToolParameters wheel{.shape = ToolShape::kCylinder};
  wheel.joint = {.axis = Vec3::UnitZ(), .drive = Drive::kSpeed, .speed_rad_s = 2};
  TwoHands two(ToolSet({ToolParameters(), wheel}));
  EXPECT_EQ(two.run(64), LoopEnd::kRunning);
  ASSERT_TRUE(two.loop.snapshots().update());
  const SceneSnapshot& snapshot = two.loop.snapshots().latest();
  ASSERT_EQ(snapshot.tools.size(), 2U);
  EXPECT_EQ(snapshot.tools[0].scene_T_tool.position_m.x(), -kAside_m);
  EXPECT_NEAR(snapshot.tools[1].joint.angle_rad, 2 * snapshot.time_s, 1e-12);
  EXPECT_NEAR(std::abs(snapshot.tools[1].turned.orientation.z()), std::sin(snapshot.time_s), 1e-12);
  EXPECT_EQ(two.records.back().joint.speed_rad_s, 2);
}

TEST(SeveralHands, ToolsWithoutOneAreNotThere) {
  Scene scene(wideBed(), ToolSet(std::vector<ToolParameters>(2)));
  PersonsDevice left(-kAside_m, scene.bed().surfaceHeight());
  HapticLoop loop(scene, left, asFastAsPossible(), false, quickly());
  for (int tick = 0; tick < 50; ++tick) {
    ASSERT_EQ(loop.tick(), LoopEnd::kRunning);
  }
  EXPECT_EQ(scene.toolFade(1), 0);
  EXPECT_TRUE(scene.soilWrench(1).isZero());
}

TEST(SeveralHands, RefusesMoreThanTools) {
  Scene scene(wideBed(), ToolParameters());
  PersonsDevice left(-kAside_m, 0.03), right(kAside_m, 0.03);
  EXPECT_THAT(
      [&] {
        HapticLoop(scene, std::array{ToolHandling{&left}, ToolHandling{&right}}, asFastAsPossible(), false);
      },
      testing::ThrowsMessage<InvalidParameter>(testing::HasSubstr("at most the 1 tools")));
}

TEST(SeveralHands, AMotorsTorqueIsWhatTheHandFeelsAboutTheAxis) {
  ToolParameters wheel{.shape = ToolShape::kCylinder, .diameter_m = 0.03, .length_m = 0.02};
  wheel.joint = {.axis = Vec3::UnitZ(), .drive = Drive::kTorque, .torque_nm = 0.01, .inertia_kg_m2 = 0.01};
  Scene scene(wideBed(), wheel);
  const double surface_m = scene.bed().surfaceHeight();
  const Pose hub{Vec3(0, 0, surface_m), Quat(Eigen::AngleAxisd(M_PI / 2, Vec3::UnitX()))};
  scene.placeTool({{hub, {}}, 1});
  for (int tick = 0; tick < 20; ++tick) {
    ASSERT_EQ(scene.tick({{hub, {}}, 1}), StepStatus::kOk);
  }
  const Vec3 axis = hub.orientation * wheel.joint.axis;
  EXPECT_NE(scene.soilForce().wrench.torque_nm.dot(axis), 0);
  EXPECT_NEAR(scene.handForce().wrench.torque_nm.dot(axis), -0.01, 1e-12);
  EXPECT_EQ(scene.handForce().wrench.force_n, scene.soilForce().wrench.force_n);
}

}  // namespace
}  // namespace haptolith
