// The shovel buried between compacted particles, both large faces touching many, held by an arm: the paper (II-E) saw
// it vibrate there. With a low-pass alone it does; with what the hand's own movement explains let through it must not.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "haptolith/device/hand/hand_parameters.h"
#include "haptolith/device/hand/virtual_hand.h"
#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

constexpr double kTick_s = 1e-3;

/// The virtual hand's arm, holding the shovel level in the middle of the bed and pressing it 15 mm downwards within the
/// first second.
class PressingArm : public HapticDevice {
 public:
  explicit PressingArm(const Vec3& start_m) : start_m_(start_m), position_m_(start_m) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "pressing arm"; }
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  [[nodiscard]] DeviceLimits limits() const noexcept override {
    DeviceLimits limits;
    limits.max_force_n = arm_.max_force_n;
    limits.max_torque_nm = arm_.max_torque_nm;
    return limits;
  }

  [[nodiscard]] DeviceInput read() noexcept override {
    const double time_s = static_cast<double>(++ticks_) * kTick_s;
    const Vec3 wanted = start_m_ - Vec3(0, 0, 0.015 * std::min(time_s, 1.0));
    const Vec3 force = arm_.stiffness_n_m * (wanted - position_m_) - arm_.damping_n_s_m * velocity_m_s_ + felt_.force_n;
    velocity_m_s_ += kTick_s / arm_.mass_kg * force;
    position_m_ += kTick_s * velocity_m_s_;
    if (time_s > 4) {
      highest_m_ = std::max(highest_m_, position_m_.z());
      lowest_m_ = std::min(lowest_m_, position_m_.z());
    }
    DeviceInput input;
    input.pose.position_m = position_m_;
    input.twist.linear_m_s = velocity_m_s_;
    return input;
  }
  void write(const DeviceOutput& output) noexcept override { felt_ = output.wrench; }
  void releaseForce() noexcept override {}
  void resumeForce() noexcept override {}

  /// Vertical amplitude of the hand at the end, in m.
  [[nodiscard]] double vibration() const { return highest_m_ - lowest_m_; }
  [[nodiscard]] double force() const { return felt_.force_n.norm(); }

 private:
  HandParameters arm_;
  Vec3 start_m_, position_m_, velocity_m_s_ = Vec3::Zero();
  Wrench felt_;
  std::uint64_t ticks_ = 0;
  double highest_m_ = -1, lowest_m_ = 1;
};

struct Case {
  const char* preset;
  double gravity_m_s2;
  FrictionModel friction = FrictionModel::kIcra2021;
};

BedParameters deepBed(const Case& c) {
  BedParameters bed;
  bed.soil = findPreset(c.preset).soil;
  if (c.friction == FrictionModel::kContact) {
    bed.soil.friction = c.friction;
    bed.soil.stiffness_n_m = 3000;  // as the named soils have it
  }
  bed.gravity_m_s2 = {0, 0, -c.gravity_m_s2};
  bed.start = BedStart::kPacked;
  bed.depth_m = 0.06;
  return bed;
}

class BuriedShovel : public testing::TestWithParam<Case> {};

TEST_P(BuriedShovel, DoesNotVibrate) {
  Scene scene(deepBed(GetParam()), ToolParameters{});
  PressingArm arm(Vec3(0, 0, 0.03));
  HapticLoop loop(scene, arm, LoopParameters{}, false);
  for (int tick = 0; tick < 5000; ++tick) {
    ASSERT_EQ(loop.tick(), LoopEnd::kRunning);
  }
  EXPECT_GT(arm.force(), 0.5) << "it must press against something";
  EXPECT_GT(scene.contactStiffness()(2, 2), 5 * ToolParameters{}.stiffness_n_m) << "and against many particles";
  // A finger feels 10 um at 30 Hz at best; this is a hundredth of that. Springs of contact friction, which forget
  // nothing, still move by a third of a micrometre where ICRA 2021 friction has stopped every particle dead.
  EXPECT_LT(arm.vibration(), GetParam().friction == FrictionModel::kContact ? 1e-6 : 1e-7);
}

INSTANTIATE_TEST_SUITE_P(PresetsAndWorlds, BuriedShovel,
                         testing::Values(Case{"P1", 1.625}, Case{"P1", 9.807}, Case{"P3", 1.625}, Case{"P3", 9.807},
                                         Case{"P6", 1.625}, Case{"P6", 9.807},
                                         Case{"P3", 1.625, FrictionModel::kContact},
                                         Case{"P3", 9.807, FrictionModel::kContact}),
                         [](const testing::TestParamInfo<Case>& test) {
                           return test.param.preset + std::string(test.param.gravity_m_s2 > 5 ? "Earth" : "Moon") +
                                  (test.param.friction == FrictionModel::kContact ? "Contact" : "");
                         });

TEST(BuriedShovelWithALowPassAlone, Vibrates) {  // the case that the test above distinguishes
  Scene scene(deepBed({"P3", 1.625}), ToolParameters{});
  PressingArm arm(Vec3(0, 0, 0.03));
  WrenchFilter filter(30, kTick_s);
  scene.placeTool({{{Vec3(0, 0, 0.03), Quat::Identity()}, {}}});
  for (int tick = 0; tick < 5000; ++tick) {
    const DeviceInput hand = arm.read();
    ASSERT_EQ(scene.tick({{hand.pose, hand.twist}}), StepStatus::kOk);
    arm.write({filter.step(scene.soilWrench())});
  }
  EXPECT_GT(arm.vibration(), 1e-4);
}

class Digging : public testing::TestWithParam<HandMotion> {};

// Letting the hand's own movement through must not feel like a viscous soil, nor take away from a load that is lifted.
TEST_P(Digging, FeelsAsALowPassAloneWouldShowIt) {
  Scene scene(BedParameters{}, ToolParameters{});
  HandParameters parameters;
  parameters.motion = GetParam();
  parameters.surface_m = scene.bed().surfaceHeight();
  VirtualHand hand(parameters, kTick_s);
  HapticLoop loop(scene, hand, LoopParameters{}, true);
  std::vector<TickRecord> records;
  for (int tick = 0; tick < 8000; ++tick) {
    ASSERT_EQ(loop.tick(), LoopEnd::kRunning);
    loop.takeRecords(records);
  }
  WrenchFilter plain(30, kTick_s);
  double felt = 0, expected = 0, apart = 0;
  for (const TickRecord& record : records) {
    const Vec3 low_passed = plain.step(record.soil).force_n;
    felt += record.sent.wrench.force_n.norm();
    expected += low_passed.norm();
    apart += (record.sent.wrench.force_n - low_passed).norm();
  }
  // Over eight hands that differ by 10 um, carrying has 0.954 +- 0.002 and 0.103 +- 0.003; the others less.
  EXPECT_NEAR(felt / expected, 1, 0.05);
  EXPECT_LT(apart / expected, 0.115);
}

INSTANTIATE_TEST_SUITE_P(Motions, Digging, testing::Values(HandMotion::kStir, HandMotion::kScoop, HandMotion::kCarry));

}  // namespace
}  // namespace haptolith
