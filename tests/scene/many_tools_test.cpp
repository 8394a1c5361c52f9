// Several tools in one bed.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "haptolith/bed/critical_step.h"
#include "haptolith/core/error.h"
#include "haptolith/scene/scene.h"
#include "haptolith/tool/tool_contact.h"

namespace haptolith {
namespace {

constexpr double kTick_s = 1e-3;

HandState handAt(const Vec3& position_m, const Vec3& velocity_m_s = Vec3::Zero()) {
  return {{{position_m, Quat::Identity()}, {velocity_m_s, Vec3::Zero()}}, 1};
}

class ManyTools : public testing::TestWithParam<FrictionModel> {
 protected:
  [[nodiscard]] static BedParameters longBed(double width_m = 0.4) {
    BedParameters bed;
    bed.soil.friction = GetParam();
    bed.soil.stiffness_n_m = GetParam() == FrictionModel::kContact ? 1000 : bed.soil.stiffness_n_m;
    bed.width_m = width_m;
    bed.length_m = 0.1;
    bed.depth_m = 0.05;
    bed.start = BedStart::kPacked;
    return bed;
  }
};
INSTANTIATE_TEST_SUITE_P(EitherFriction, ManyTools, testing::Values(FrictionModel::kIcra2021, FrictionModel::kContact),
                         [](const auto& param) {
                           return param.param == FrictionModel::kIcra2021 ? "Icra2021" : "Contact";
                         });

ToolParameters ball() {
  return {.shape = ToolShape::kSphere, .diameter_m = 0.03};
}

/// Into the soil at x, and round in a small circle.
HandState dipping(double x_m, double surface_m, int tick) {
  const auto at = [&](double t_s) {
    return Vec3(x_m + 0.01 * std::sin(20 * t_s), 0.01 * std::cos(20 * t_s) - 0.01,
                surface_m + 0.02 - std::min(0.03, 0.2 * t_s));
  };
  return handAt(at(kTick_s * tick), (at(kTick_s * tick) - at(kTick_s * (tick - 1))) / kTick_s);
}

TEST_P(ManyTools, FarApartEachFeelsWhatItFeelsAloneToTheBit) {
  constexpr double kApart_m = 1.2;
  const BedParameters bed = longBed(kApart_m + 0.2);
  const ToolParameters shovel;
  Scene left(bed, shovel);
  Scene right(bed, ball());
  Scene both(bed, ToolSet({shovel, ball()}));
  ASSERT_EQ(both.substeps(), left.substeps());
  const double surface_m = both.bed().surfaceHeight();
  const auto handsAt = [&](int tick) {
    return std::array{dipping(-kApart_m / 2, surface_m + 0.0025, tick), dipping(kApart_m / 2, surface_m + 0.015, tick)};
  };
  left.placeTool(handsAt(0)[0]);
  right.placeTool(handsAt(0)[1]);
  both.placeTool(handsAt(0)[0]);
  both.placeTool(handsAt(0)[1], 1);
  // A disturbance gets from one to the other in some time: by a particle's reach in a substep, and not across the
  // tools.
  const int ticks = static_cast<int>((kApart_m - 0.1) / (2.5 * bed.soil.radius_m) / both.substeps());
  double felt_n = 0;
  int felt = 0;
  for (int tick = 1; felt < ticks; ++tick) {
    const auto hands = handsAt(tick);
    ASSERT_EQ(left.tick(hands[0]), StepStatus::kOk);
    ASSERT_EQ(right.tick(hands[1]), StepStatus::kOk);
    ASSERT_EQ(both.tickAll(hands), StepStatus::kOk);
    felt += felt > 0 || !left.soilWrench().force_n.isZero(0) || !right.soilWrench().force_n.isZero(0) ? 1 : 0;
    ASSERT_EQ(both.soilWrench(0).force_n, left.soilWrench().force_n) << tick;
    ASSERT_EQ(both.soilWrench(0).torque_nm, left.soilWrench().torque_nm) << tick;
    ASSERT_EQ(both.contactStiffness(0), left.contactStiffness()) << tick;
    ASSERT_EQ(both.soilWrench(1).force_n, right.soilWrench().force_n) << tick;
    ASSERT_EQ(both.soilWrench(1).torque_nm, right.soilWrench().torque_nm) << tick;
    felt_n = std::max(felt_n, std::min(left.soilWrench().force_n.norm(), right.soilWrench().force_n.norm()));
  }
  EXPECT_GT(felt_n, 0.05) << "both were in the soil";
}

TEST_P(ManyTools, TheirOrderChangesNothingWhereTheyShareNoParticle) {
  const BedParameters bed = longBed();
  Scene one(bed, ToolSet({ToolParameters{}, ball()}));
  Scene other(bed, ToolSet({ball(), ToolParameters{}}));
  const double surface_m = one.bed().surfaceHeight();
  for (int tick = 0; tick <= 600; ++tick) {
    const std::array hands{dipping(-0.1, surface_m, tick), dipping(0.1, surface_m, tick)};
    const std::array swapped{hands[1], hands[0]};
    if (tick == 0) {
      for (std::size_t i = 0; i < 2; ++i) {
        one.placeTool(hands[i], i);
        other.placeTool(swapped[i], i);
      }
    }
    ASSERT_EQ(one.tickAll(hands), StepStatus::kOk);
    ASSERT_EQ(other.tickAll(swapped), StepStatus::kOk);
    ASSERT_EQ(one.bed().hash(), other.bed().hash()) << tick;
  }
  EXPECT_EQ(one.soilWrench(0).force_n, other.soilWrench(1).force_n);
  EXPECT_GT(one.soilWrench(0).force_n.norm(), 0.01);
}

TEST_P(ManyTools, GoOnFromASavedSceneBitForBit) {
  const BedParameters bed = longBed();
  const ToolSet tools({ToolParameters{}, ball(), {.shape = ToolShape::kJaws}});
  Scene scene(bed, tools);
  const double surface_m = scene.bed().surfaceHeight();
  const auto hands = [&](int tick) {
    std::array all{dipping(-0.12, surface_m, tick), dipping(0, surface_m, tick), dipping(0.12, surface_m, tick)};
    all[2].opening = 0.5 + 0.5 * std::cos(0.01 * tick);
    return all;
  };
  for (std::size_t i = 0; i < 3; ++i) {
    scene.placeTool(hands(0)[i], i);
  }
  for (int tick = 1; tick <= 400; ++tick) {
    ASSERT_EQ(scene.tickAll(hands(tick)), StepStatus::kOk);
  }
  const std::string bytes = serialise(scene.save());
  Scene again(bed, tools, deserialiseSavedScene(bytes));
  EXPECT_EQ(serialise(again.save()), bytes);
  ASSERT_EQ(again.hash(), scene.hash());
  for (int tick = 401; tick <= 600; ++tick) {
    ASSERT_EQ(scene.tickAll(hands(tick)), StepStatus::kOk);
    ASSERT_EQ(again.tickAll(hands(tick)), StepStatus::kOk);
  }
  EXPECT_EQ(again.hash(), scene.hash());
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(again.soilWrench(i).force_n, scene.soilWrench(i).force_n) << i;
    EXPECT_GT(scene.soilWrench(i).force_n.norm(), 0.01) << i;
  }
  EXPECT_EQ(again.soilForce(2).grip_n, scene.soilForce(2).grip_n);
}

/// A cluster of particles that floats in the middle of a box, without gravity, between two plates.
struct Pinch {
  static BedParameters weightless(double damping_ratio, double friction) {
    BedParameters bed;
    bed.soil.friction = FrictionModel::kContact;
    bed.soil.stiffness_n_m = 1000;
    bed.soil.damping_ratio = damping_ratio;
    bed.soil.contact_friction = friction;
    bed.gravity_m_s2 = Vec3::Zero();
    bed.width_m = bed.length_m = 0.4;
    return bed;
  }
  static std::vector<Vec3> cluster(double radius_m) {
    std::vector<Vec3> centres;
    for (int x = -2; x <= 2; ++x) {
      for (int y = -2; y <= 2; ++y) {
        for (int z = -2; z <= 2; ++z) {
          centres.push_back(Vec3(0.003 * y * z, 0.002 * x * z, 0.2) + 2.02 * radius_m * Vec3(x, y, z));
        }
      }
    }
    return centres;
  }
  static ToolParameters plate(double damping_factor, double friction) {
    ToolParameters tool;
    tool.size_m = {0.005, 0.2, 0.2};
    std::swap(tool.size_m.x(), tool.size_m.z());
    tool.damping_factor = damping_factor;
    tool.friction = friction;
    return tool;
  }

  Pinch(double damping, double friction, double tick_s = kTick_s)
      : bed([&] {
          BedParameters parameters = weightless(damping, friction);
          parameters.tick_s = tick_s;
          return parameters;
        }()),
        scene(bed, ToolSet({plate(damping > 0 ? 1.4 : 0, friction), plate(damping > 0 ? 1.4 : 0, friction)}),
              cluster(bed.soil.radius_m)) {
    hands = {at(0, -1), at(0, 1)};
    scene.placeTool(hands[0], 0);
    scene.placeTool(hands[1], 1);
  }

  /// The plates close along z for the first half of a period, and open again.
  static HandState at(double time_s, double side) {
    const double height = 0.075 - 0.045 * std::sin(std::numbers::pi * time_s / 0.4);
    const double speed = -0.045 * std::numbers::pi / 0.4 * std::cos(std::numbers::pi * time_s / 0.4);
    return handAt({side * 0.001 * std::sin(9 * time_s), 0, 0.2 + side * height},
                  {side * 0.009 * std::cos(9 * time_s), 0, side * speed});
  }

  [[nodiscard]] Vec3 momentum() const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < scene.bed().particles(); ++i) {
      const Float4& v = scene.bed().state().velocity[i];
      sum += scene.bed().mass() * Vec3(v.x, v.y, v.z);
    }
    return sum;
  }

  BedParameters bed;
  Scene scene;
  std::array<HandState, 2> hands;
};

TEST(TwoToolsInOneCluster, FeelTheOppositeOfTheImpulseOnTheSoil) {
  Pinch pinch(0.3, 0.5);
  Vec3 impulse_ns = Vec3::Zero();
  double both_ns = 0;
  for (int tick = 1; tick <= 400; ++tick) {
    const Vec3 before = pinch.momentum();
    pinch.hands = {Pinch::at(kTick_s * tick, -1), Pinch::at(kTick_s * tick, 1)};
    ASSERT_EQ(pinch.scene.tickAll(pinch.hands), StepStatus::kOk);
    const Vec3 felt_ns = kTick_s * (pinch.scene.soilWrench(0).force_n + pinch.scene.soilWrench(1).force_n);
    impulse_ns += pinch.momentum() - before + felt_ns;
    both_ns += kTick_s * (pinch.scene.soilWrench(0).force_n.norm() + pinch.scene.soilWrench(1).force_n.norm());
  }
  EXPECT_GT(both_ns, 0.05);
  EXPECT_LT(impulse_ns.norm(), 1e-6 * both_ns);
}

TEST(TwoToolsInOneCluster, CloseTheEnergyBalance) {
  constexpr double kShortTick_s = 1e-4;
  Pinch pinch(0, 0, kShortTick_s);
  double work_j = pinch.scene.bed().energy();
  double in_j = 0;
  for (int tick = 1; tick <= 4000; ++tick) {
    pinch.hands = {Pinch::at(kShortTick_s * tick, -1), Pinch::at(kShortTick_s * tick, 1)};
    ASSERT_EQ(pinch.scene.tickAll(pinch.hands), StepStatus::kOk);
    for (std::size_t i = 0; i < 2; ++i) {
      const double power_w = -pinch.scene.soilWrench(i).force_n.dot(pinch.hands[i].twist.linear_m_s);
      work_j += kShortTick_s * power_w;
      in_j += std::max(0.0, kShortTick_s * power_w);
    }
  }
  // The plates touch nothing any more; their work is the movement that is left.
  EXPECT_TRUE(pinch.scene.soilWrench(0).force_n.isZero(0) && pinch.scene.soilWrench(1).force_n.isZero(0));
  EXPECT_GT(in_j, 1e-3);
  EXPECT_NEAR(pinch.scene.bed().energy(), work_j, 1e-3 * in_j);
}

TEST(SceneWithoutATool, IsSoilAlone) {
  BedParameters bed;
  Scene scene(bed, ToolSet(std::vector<ToolParameters>{}));
  Bed alone(bed);
  for (int tick = 0; tick < 20; ++tick) {
    ASSERT_EQ(scene.tickAll(std::span<const HandState>{}), StepStatus::kOk);
    for (int i = 0; i < scene.substeps(); ++i) {
      ASSERT_EQ(alone.step(bed.tick_s / scene.substeps()), StepStatus::kOk);
    }
  }
  EXPECT_EQ(scene.hash(), alone.hash());
}

TEST(ToolSet, HoldsAtMostSixteen) {
  EXPECT_EQ(ToolSet(std::vector<ToolParameters>(16)).all().size(), 16U);
  EXPECT_THROW((void)ToolSet(std::vector<ToolParameters>(17)), InvalidParameter);
}

TEST(ManyToolsInAScene, OneThatIsNowhereMovesNothingAndToolsWithoutAHandStay) {
  Scene scene(BedParameters{}, ToolSet({ToolParameters{}, ball()}));
  scene.placeTool(handAt({0, 0, 0.2}), 0);
  scene.placeTool(handAt({0, 0, 0.3}), 1);
  ASSERT_EQ(scene.tick(handAt({0, 0, 0.19})), StepStatus::kOk);
  EXPECT_EQ(scene.toolPose(0).position_m.z(), 0.19);
  EXPECT_EQ(scene.toolPose(1).position_m.z(), 0.3);
  const std::uint64_t before = scene.hash();
  EXPECT_EQ(scene.tickAll(std::array{handAt({0, 0, 0.18}), handAt({0, 0, std::nan("")})}), StepStatus::kNotFinite);
  EXPECT_EQ(scene.toolPose(0).position_m.z(), 0.19);
  EXPECT_EQ(scene.hash(), before);
}

TEST(StiffnessInStep, OfSeveralToolsIsThatOfOneUnlessTheSecondIsStifferThanAWall) {
  SoilParameters soil;
  soil.friction = FrictionModel::kIcra2021;
  soil.stiffness_n_m = 300;
  const auto of = [&](std::vector<double> stiffness) {
    std::vector<ToolParameters> tools(stiffness.size());
    std::ranges::transform(stiffness, tools.begin(), [](double k) { return ToolParameters{.stiffness_n_m = k}; });
    return stiffnessInStep(tools, soil);
  };
  EXPECT_EQ(of({}), 0);
  EXPECT_EQ(of({500}), 500);
  EXPECT_EQ(of({500, 600}), 600);
  EXPECT_EQ(of({800, 500, 700}), 800 + 100);
  EXPECT_EQ(of({800, 800}), 800 + 200);
}

}  // namespace
}  // namespace haptolith
