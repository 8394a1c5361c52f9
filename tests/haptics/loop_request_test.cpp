// What another thread asks of a running loop: pause, slow motion, another soil, gravity, tool or scene.

#include "haptolith/haptics/loop/loop_request.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <numbers>
#include <vector>

#include "haptolith/bed/critical_step.h"
#include "haptolith/core/platform/clock.h"
#include "haptolith/device/hand/virtual_hand.h"
#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

/// A blade that goes round in the soil, and remembers what it felt.
class Stirrer final : public HapticDevice {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "stirrer"; }
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return {}; }
  [[nodiscard]] DeviceInput read() noexcept override {
    constexpr double kRadius_m = 0.02;
    constexpr double kSpeed_rad_s = 3;
    const double angle = kSpeed_rad_s * 1e-3 * reads_++;
    DeviceInput input;
    input.pose.position_m = Vec3(kRadius_m * std::cos(angle), kRadius_m * std::sin(angle), 0.03);
    input.pose.orientation = Quat(Eigen::AngleAxisd(angle + std::numbers::pi / 2, Vec3::UnitZ()) *
                                  Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitY()));
    input.twist.linear_m_s = kRadius_m * kSpeed_rad_s * Vec3(-std::sin(angle), std::cos(angle), 0);
    input.twist.angular_rad_s = Vec3(0, 0, kSpeed_rad_s);
    return input;
  }
  void write(const DeviceOutput& output) noexcept override {
    largest_jump_n_ = std::max(largest_jump_n_, (output.wrench.force_n - last_.force_n).norm());
    last_ = output.wrench;
  }
  void releaseForce() noexcept override {}
  void resumeForce() noexcept override {}

  int reads_ = 0;
  double largest_jump_n_ = 0;
  Wrench last_;
};

BedParameters icra2021Bed() {
  BedParameters bed;
  bed.soil = findPreset("P3").soil;
  return bed;
}

LoopParameters asFastAsPossible() {
  LoopParameters loop;
  loop.real_time = false;
  return loop;
}

HandParameters scooping() {
  HandParameters hand;
  hand.surface_m = 0.04;
  return hand;
}

/// A scene that is stirred.
struct Stirred {
  explicit Stirred(const BedParameters& bed = icra2021Bed())
      : scene(bed, {}), loop(scene, device, asFastAsPossible(), false) {}
  Stirred(const BedParameters& bed, const std::vector<Vec3>& centres_m)
      : scene(bed, {}, centres_m), loop(scene, device, asFastAsPossible(), false) {}

  void ticks(int count) {
    for (int i = 0; i < count; ++i) {
      ASSERT_EQ(loop.tick(), LoopEnd::kRunning);
    }
  }
  /// The largest speed of any particle of `shown` during a number of ticks, in m/s.
  double fastestOf(const Scene& shown, int count) {
    double fastest = 0;
    for (int i = 0; i < count; ++i) {
      ticks(1);
      fastest = std::max(fastest, shown.bed().largestSpeed());
    }
    return fastest;
  }
  [[nodiscard]] std::uint64_t hash() const { return scene.hash(); }

  Scene scene;
  Stirrer device;
  HapticLoop loop;
};

TEST(LoopRequest, APauseStopsTimeAndLetsGoAndLeavesNoTrace) {
  Stirred paused;
  Stirred never;
  paused.ticks(300);
  never.ticks(300);
  ASSERT_GT(paused.device.last_.force_n.norm(), 0.05);
  ASSERT_TRUE(paused.loop.ask(request::Pause{}));
  paused.ticks(50);
  EXPECT_EQ(paused.device.last_.force_n, Vec3::Zero());
  EXPECT_EQ(paused.loop.statistics().ticks(), 300U);
  EXPECT_EQ(paused.hash(), never.hash());
  ASSERT_TRUE(paused.loop.snapshots().update());
  EXPECT_TRUE(paused.loop.snapshots().latest().paused);

  ASSERT_TRUE(paused.loop.ask(request::Advance{7}));
  paused.ticks(20);
  EXPECT_EQ(paused.loop.statistics().ticks(), 307U);
  ASSERT_TRUE(paused.loop.ask(request::Resume{}));
  paused.ticks(93);
  never.ticks(100);
  EXPECT_EQ(paused.hash(), never.hash());
  EXPECT_EQ(paused.device.last_.force_n, never.device.last_.force_n);
}

TEST(LoopRequest, ASimulatedHandMovesTheSameWithAndWithoutPauses) {
  struct Scooped {
    Scene scene{icra2021Bed(), {}};
    VirtualHand hand{scooping(), 1e-3};
    HapticLoop loop{scene, hand, asFastAsPossible(), false};
  };
  Scooped paused;
  Scooped never;
  ASSERT_TRUE(paused.loop.ask(request::Pause{}));
  double largest_n = 0;
  for (int part = 0; part < 25; ++part) {
    ASSERT_TRUE(paused.loop.ask(request::Advance{32}));
    for (int i = 0; i < 32 + 40; ++i) {  // time is paused for the last 40
      ASSERT_EQ(paused.loop.tick(), LoopEnd::kRunning);
    }
    for (int i = 0; i < 32; ++i) {
      ASSERT_EQ(never.loop.tick(), LoopEnd::kRunning);
    }
    // A picture of the pause shows what was felt when it began.
    ASSERT_TRUE(paused.loop.snapshots().update());
    ASSERT_TRUE(never.loop.snapshots().update());
    EXPECT_EQ(paused.loop.snapshots().latest().ticks, never.loop.statistics().ticks());
    EXPECT_GT(paused.loop.snapshots().latest().tick_us_lately, 0);
    largest_n = std::max(largest_n, paused.loop.snapshots().latest().device_wrench.force_n.norm());
    ASSERT_EQ(stateHash(paused.scene.bed().state()), stateHash(never.scene.bed().state())) << part;
  }
  EXPECT_GT(largest_n, 0.1);
}

TEST(LoopRequest, ASlowedLoopTakesItsTime) {
  Stirrer device;
  Scene scene(icra2021Bed(), {});
  LoopParameters parameters;
  parameters.duration_s = 0.02;
  HapticLoop loop(scene, device, parameters, false);
  ASSERT_TRUE(loop.ask(request::Speed{0.1}));
  const std::int64_t start_ns = monotonicNs();
  const std::atomic<bool> never{false};
  EXPECT_EQ(loop.run(never), LoopEnd::kDuration);
  EXPECT_GT(1e-9 * static_cast<double>(monotonicNs() - start_ns), 0.18);
  EXPECT_EQ(loop.statistics().ticks(), 20U);
}

TEST(LoopRequest, GravityAndSoilCountFromTheNextTick) {
  BedParameters wanted = icra2021Bed();
  wanted.gravity_m_s2 = Vec3(0, 0, -3.721);
  wanted.soil.mu_hat = 0.1;
  wanted.soil.gamma_nm *= 2;
  std::vector<Vec3> centres_m;
  for (const Float4& p : SceneSnapshot(Stirred().loop.snapshots().latest()).position) {
    centres_m.emplace_back(p.x, p.y, p.z);
  }
  Stirred made_so(wanted, centres_m);
  Stirred changed(icra2021Bed(), centres_m);
  ASSERT_TRUE(isCompatible(icra2021Bed(), wanted.soil, ToolParameters{}.stiffness_n_m));
  ASSERT_TRUE(changed.loop.ask(request::Gravity{wanted.gravity_m_s2}));
  ASSERT_TRUE(changed.loop.ask(request::Soil{SoilLaws(wanted.soil)}));
  made_so.ticks(500);
  changed.ticks(500);
  EXPECT_EQ(changed.hash(), made_so.hash());

  Stirred as_it_was(icra2021Bed(), centres_m);
  as_it_was.ticks(500);
  EXPECT_NE(changed.hash(), as_it_was.hash());
}

TEST(LoopRequest, ABedGoesOnOnlyWithSoilThatItsListsAndStepsAreGoodFor) {
  BedParameters made;
  made.soil = findPreset("P3").soil;
  const auto good = [&](auto change) {
    SoilParameters soil = made.soil;
    change(soil);
    return isCompatible(made, soil, 500);
  };
  EXPECT_TRUE(good([](SoilParameters&) {}));
  EXPECT_TRUE(good([](SoilParameters& s) { s.mu_hat = 2; }));
  EXPECT_TRUE(good([](SoilParameters& s) { s.gamma_nm *= 3; }));
  EXPECT_TRUE(good([](SoilParameters& s) { s.attraction_ratio = 1; }));
  EXPECT_FALSE(good([](SoilParameters& s) { s.attraction_ratio = 1.2; }));  // reaches further
  EXPECT_FALSE(good([](SoilParameters& s) { s.stiffness_n_m *= 2; }));      // needs shorter steps
  EXPECT_FALSE(good([](SoilParameters& s) { s.radius_m *= 1.01; }));
  EXPECT_FALSE(good([](SoilParameters& s) { s.rho0_kg_m3 *= 1.01; }));
  EXPECT_FALSE(good([](SoilParameters& s) { s.friction = FrictionModel::kContact; }));
  EXPECT_FALSE(good([](SoilParameters& s) { s.size_spread = 0.1; }));
}

TEST(LoopRequest, ABedWithALightStoneDoesNotGoOnWithSoilThatNeedsShorterStepsBesideIt) {
  BedParameters made;
  made.soil.friction = FrictionModel::kContact;
  made.stones.placed = {{.size_m = 0.01}};
  made.stones.density_kg_m3 = 100;
  int good_without_the_stone = 0;
  for (double across = 0.1; across <= 1; across += 0.1) {
    for (double softer = 0.5; softer <= 1; softer += 0.02) {
      BedParameters next = made;
      next.soil.tangential_ratio = across;
      next.soil.stiffness_n_m *= softer;
      const bool more_steps = stepsPerSecond(next, 0) > stepsPerSecond(made, 0);
      EXPECT_EQ(isCompatible(made, next.soil, 0), !more_steps) << across << ' ' << softer;
      good_without_the_stone += more_steps && stepsPerSecond(next.soil, 0) <= stepsPerSecond(made.soil, 0) ? 1 : 0;
    }
  }
  EXPECT_GT(good_without_the_stone, 0) << "else the test cannot fail";
}

TEST(LoopRequest, AnotherSceneComesWithoutAJumpAndWithoutAShot) {
  Stirred stirred;
  stirred.ticks(1000);
  stirred.device.largest_jump_n_ = 0;
  const double usual_m_s = stirred.fastestOf(stirred.scene, 500);
  const double usual_jump_n = stirred.device.largest_jump_n_;
  stirred.device.largest_jump_n_ = 0;

  Scene level(icra2021Bed(), {});
  ShownScene next(level);
  ASSERT_TRUE(stirred.loop.ask(request::ReplaceBed{&next}));
  stirred.ticks(99);
  EXPECT_NE(&stirred.loop.shownScene(), &next) << "the old one fades for a tenth of a second";
  EXPECT_LT(stirred.device.last_.force_n.norm(), 0.2);
  stirred.ticks(2);
  EXPECT_EQ(&stirred.loop.shownScene(), &next);
  const std::uint64_t left = stirred.hash();

  EXPECT_LT(stirred.fastestOf(level, 400), 2 * usual_m_s) << "the blade stands in soil that knows nothing of it";
  EXPECT_LT(stirred.device.largest_jump_n_, 2 * usual_jump_n);
  EXPECT_GT(stirred.device.last_.force_n.norm(), 0.05) << "it is felt again";
  EXPECT_EQ(stirred.hash(), left) << "what is not shown stands still";
  EXPECT_EQ(stirred.loop.statistics().ticks(), 2001U);

  ASSERT_TRUE(stirred.loop.snapshots().update());
  EXPECT_EQ(stirred.loop.snapshots().latest().position.size(), level.bed().particles());
}

TEST(LoopRequest, ASceneOfAnotherSizeIsShownWhole) {
  Stirred stirred;
  stirred.ticks(100);
  BedParameters more = icra2021Bed();
  more.start = BedStart::kPacked;
  more.width_m = more.length_m = 0.5;
  more.depth_m = 0.08;
  Scene large(more, {});
  ShownScene next(large);
  ASSERT_TRUE(stirred.loop.ask(request::Pause{}));
  ASSERT_TRUE(stirred.loop.ask(request::ReplaceBed{&next}));  // no force: immediately
  stirred.ticks(1);
  EXPECT_EQ(&stirred.loop.shownScene(), &next);
  ASSERT_TRUE(stirred.loop.ask(request::Resume{}));
  stirred.ticks(64);
  ASSERT_TRUE(stirred.loop.snapshots().update());
  const SceneSnapshot& shown = stirred.loop.snapshots().latest();
  ASSERT_EQ(shown.position.size(), large.bed().particles());
  for (std::size_t i = 0; i < shown.position.size(); ++i) {
    ASSERT_NEAR(shown.position[i].z, large.bed().state().position[i].z, 5e-3) << i;
  }
}

TEST(LoopRequest, AnotherToolIsFeltWithoutAJump) {
  Stirred stirred;
  stirred.ticks(1000);
  const double usual_m_s = stirred.fastestOf(stirred.scene, 500);
  stirred.device.largest_jump_n_ = 0;
  ToolParameters ball;
  ball.shape = ToolShape::kSphere;
  ball.diameter_m = 0.03;
  ASSERT_TRUE(stirred.loop.ask(request::ReplaceTool{ball}));
  stirred.ticks(102);
  EXPECT_EQ(stirred.scene.tool().shape, ToolShape::kSphere);
  EXPECT_LT(stirred.fastestOf(stirred.scene, 400), 2 * usual_m_s);
  EXPECT_LT(stirred.device.largest_jump_n_, 0.3);
  EXPECT_GT(stirred.device.last_.force_n.norm(), 0.02);
}

TEST(LoopRequest, OnlySoManyWait) {
  Stirred stirred;
  int taken = 0;
  while (taken < 1000 && stirred.loop.ask(request::Speed{0.5})) {
    ++taken;
  }
  EXPECT_GE(taken, 60);
  EXPECT_LT(taken, 100);
  stirred.ticks(1);
  EXPECT_TRUE(stirred.loop.ask(request::Speed{1}));
}

}  // namespace
}  // namespace haptolith
