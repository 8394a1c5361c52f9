#include "haptolith/tool/tool_contact.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "haptolith/tool/tool_shape.h"

namespace haptolith {
namespace {

constexpr double kRadius_m = 7e-3;
constexpr double kTick_s = 1e-3;
const ToolParameters kShovel;

// --- (paper 21) by hand: k_tool = 500 N/m, c_tool = 1.4 * 1 ms * 500 / 2 = 0.35 N s/m, 0.002 R = 14 um --------------

double force(double depth_m, double closing_m_s) {
  return toolForce(kShovel, kRadius_m, kTick_s, depth_m, closing_m_s);
}

TEST(ToolForce, IsTheSpringAndTheDamperOfTheEquation) {
  EXPECT_NEAR(force(2e-3, 0), 1.0, 1e-12);
  EXPECT_NEAR(force(2e-3, 0.1), 1.035, 1e-12);
  EXPECT_NEAR(force(2e-3, -0.1), 0.965, 1e-12);
  EXPECT_NEAR(force(1e-3, -2), 0.5 - 0.7, 1e-12);  // printed as it is: a quick retreat is held back
}

TEST(ToolForce, DampingFollowsTheStep) {
  EXPECT_NEAR(toolForce(kShovel, kRadius_m, 0.5e-3, 0, 1), 0.175, 1e-12);
}

TEST(ToolForce, DustSticksInANarrowZoneOutsideTheTool) {
  EXPECT_NEAR(force(-10e-6, 0), -0.005, 1e-12);
  EXPECT_LT(force(-13.9e-6, 0), 0);
  EXPECT_EQ(force(-14e-6, 0), 0);  // z <= -0.002 R belongs to the upper case
  EXPECT_EQ(force(-14.1e-6, 0), 0);
  EXPECT_EQ(force(-14.1e-6, 100), 0);
  EXPECT_EQ(force(-1, -100), 0);
}

TEST(ToolForce, WithoutAdhesionEndsAtTheSurface) {
  ToolParameters clean = kShovel;
  clean.adhesion_ratio = 0;
  EXPECT_EQ(toolForce(clean, kRadius_m, kTick_s, 0, 1), 0);
  EXPECT_EQ(toolForce(clean, kRadius_m, kTick_s, -1e-9, 1), 0);
  EXPECT_GT(toolForce(clean, kRadius_m, kTick_s, 1e-9, 0), 0);
}

// --- the tool against many -------------------------------------------------------------------------------------------

struct Crowd {
  SoilParameters soil{.radius_m = kRadius_m};
  BedState state;
  std::vector<std::int8_t> side;
  std::vector<Float4> forces;

  void add(const Vec3& x, const Vec3& v = Vec3::Zero()) {
    state.position.push_back(record(x));
    state.velocity.push_back(record(v));
    ++state.particle_count;
    side.push_back(0);
    forces.push_back({1, 2, 3, 0});  // left over from the step before
  }
  static Float4 record(const Vec3& v) {
    return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), 0};
  }
  [[nodiscard]] Vec3 at(std::size_t i) const { return vec(state.position[i]); }
  [[nodiscard]] Vec3 forceOn(std::size_t i) const { return vec(forces[i]); }
  static Vec3 vec(const Float4& f) { return {f.x, f.y, f.z}; }

  ToolReaction react(const ToolParameters& tool, const Pose& pose, const Twist& twist = {}) {
    BedState whole = state;
    whole.position.resize(paddedCount(state.particles()), kGhost);
    return applyToolContact(tool, pose, twist, soil, kTick_s, whole, {side, {}}, forces);
  }
  Wrench apply(const ToolParameters& tool, const Pose& pose, const Twist& twist = {}) {
    return react(tool, pose, twist).wrench;
  }
};

TEST(ToolContact, OneParticleUnderTheShovel) {
  // 8.5 mm under the centre of a level shovel at (10, 20, 30) mm, 12 mm along x: 1 mm deep, 0.5 N down on the particle.
  Crowd crowd;
  crowd.add(Vec3(0.022, 0.02, 0.0215));
  const Wrench on_tool = crowd.apply(kShovel, {Vec3(0.01, 0.02, 0.03), Quat::Identity()});
  // Floats near 30 mm are right to 2e-9 m: 1e-6 N at 500 N/m.
  EXPECT_LT((crowd.forceOn(0) - Vec3(0, 0, -0.5)).norm(), 3e-6);
  EXPECT_LT((on_tool.force_n - Vec3(0, 0, 0.5)).norm(), 3e-6);
  // 0.5 N up, 12 mm along x: torque (0.012, 0, .) x (0, 0, 0.5) = (0, -6 mNm, 0).
  EXPECT_LT((on_tool.torque_nm - Vec3(0, -6e-3, 0)).norm(), 1e-7);
  EXPECT_EQ(crowd.side[0], -1);
}

TEST(ToolContact, TurnsWithTheTool) {
  // As above, with the tool's z turned to the scene's x: the particle is on the tool's upper face, towards +x.
  const Pose upright{Vec3(0.01, 0.02, 0.03), Quat(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitY()))};
  Crowd crowd;
  crowd.add(upright.fromBody(Vec3(0.012, 0, 0.0085)));
  const Wrench on_tool = crowd.apply(kShovel, upright);
  EXPECT_LT((crowd.forceOn(0) - Vec3(0.5, 0, 0)).norm(), 3e-6);
  EXPECT_LT((on_tool.force_n - Vec3(-0.5, 0, 0)).norm(), 3e-6);
  // The tool's x is the scene's -z: lever (., 0, -12 mm) x (-0.5, 0, 0) = (0, 6 mNm, 0).
  EXPECT_LT((on_tool.torque_nm - Vec3(0, 6e-3, 0)).norm(), 1e-7);
  EXPECT_EQ(crowd.side[0], 1);
}

TEST(ToolContact, DoesNotMeetSoilThatIsHeldWhereTheBoxEnds) {
  Crowd crowd;
  crowd.add(Vec3(0, 0, -0.008));
  EXPECT_GT(crowd.apply(kShovel, {}).force_n.z(), 0);
  crowd.state.velocity[0].w = BedState::kHeld;
  EXPECT_EQ(crowd.apply(kShovel, {}).force_n.norm(), 0);
  EXPECT_EQ(crowd.forceOn(0).norm(), 0);
  crowd.state.velocity[0].w = BedState::kDriven;
  EXPECT_GT(crowd.apply(kShovel, {}).force_n.z(), 0);
}

TEST(ToolContact, DampsTheVelocityOfTheTouchedPointTowardsTheParticle) {
  // The tool turns at 10 rad/s about y: at 12 mm along x its point moves at -0.12 m/s along z, the particle at 0.03.
  Crowd crowd;
  crowd.add(Vec3(0.012, 0, -0.0085), Vec3(0.7, 0, -0.03));
  const Twist twist{Vec3(0.3, 0, 0), Vec3(0, 10, 0)};
  const Wrench on_tool = crowd.apply(kShovel, Pose{}, twist);
  // They close at 0.12 - 0.03 = 0.09 m/s: 0.5 N + 0.35 * 0.09.
  EXPECT_NEAR(on_tool.force_n.z(), 0.5315, 2e-6);
  EXPECT_NEAR(on_tool.force_n.x(), 0, 1e-12);  // no friction of the tool: only along the normal
}

TEST(ToolContact, LeavesNoForceOfTheStepBefore) {
  Crowd crowd;
  crowd.add(Vec3(0, 0, 0.5));     // outside the enclosing sphere
  crowd.add(Vec3(0, 0, 0.0096));  // inside it, out of touch
  crowd.apply(kShovel, Pose{});
  EXPECT_EQ(crowd.forceOn(0), Vec3::Zero());
  EXPECT_EQ(crowd.forceOn(1), Vec3::Zero());
}

Crowd randomCrowd(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> anywhere(-0.06, 0.06);
  Crowd crowd;
  for (int i = 0; i < 400; ++i) {
    crowd.add(Vec3(anywhere(random), anywhere(random), anywhere(random)),
              20 * Vec3(anywhere(random), anywhere(random), anywhere(random)));
  }
  return crowd;
}

std::vector<ToolParameters> everyShape() {
  std::vector<ToolParameters> tools(3);
  tools[1].shape = ToolShape::kSphere;
  tools[2].shape = ToolShape::kPlate;
  return tools;
}

TEST(ToolContact, ActionIsReactionInForceAndTorque) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const ToolParameters& tool : everyShape()) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      Crowd crowd = randomCrowd(seed);
      const Quat turn = Quat(unit(random), unit(random), unit(random), unit(random)).normalized();
      const Pose pose{0.02 * Vec3(unit(random), unit(random), unit(random)), turn};
      const Twist twist{Vec3(unit(random), unit(random), unit(random)), Vec3(unit(random), unit(random), unit(random))};
      const Wrench on_tool = crowd.apply(tool, pose, twist);
      Wrench on_particles;
      double total = 0;
      for (std::size_t i = 0; i < crowd.forces.size(); ++i) {
        // Forces act along the line from the touched point to the centre: there they have the same torque.
        on_particles.add(crowd.forceOn(i), crowd.at(i) - pose.position_m);
        total += crowd.forceOn(i).norm();
      }
      ASSERT_GT(total, 1);
      // The particles' forces are floats: 6e-8 of each.
      EXPECT_LT((on_tool.force_n + on_particles.force_n).norm(), 1e-6 * total);
      EXPECT_LT((on_tool.torque_nm + on_particles.torque_nm).norm(), 1e-6 * total * 0.06);
    }
  }
}

TEST(ToolContact, TheEnclosingSphereNeverDropsAContact) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const ToolParameters& tool : everyShape()) {
    int touched = 0;
    for (std::uint64_t seed = 1; seed <= 30; ++seed) {
      Crowd crowd = randomCrowd(seed);
      const Pose pose{0.01 * Vec3(unit(random), unit(random), unit(random)),
                      Quat(unit(random), unit(random), unit(random), unit(random)).normalized()};
      crowd.apply(tool, pose);
      for (std::size_t i = 0; i < crowd.forces.size(); ++i) {
        const Penetration exact = penetration(tool, pose.toBody(crowd.at(i)), kRadius_m, 0);
        const bool touches = exact.depth_m > -tool.adhesion_ratio * kRadius_m;
        // Within a rounding of touching (or of a force of exactly zero) either answer is right.
        if (std::abs(exact.depth_m + tool.adhesion_ratio * kRadius_m) > 1e-9) {
          EXPECT_EQ(crowd.forceOn(i) != Vec3::Zero() || crowd.side[i] != 0, touches) << i;
        }
        touched += touches ? 1 : 0;
      }
    }
    EXPECT_GT(touched, 300);
  }
}

TEST(ToolContact, TheCornerOfTheEnclosingSphereStillSticks) {
  // Along the box's diagonal the sphere is tight: adhesion reaches 14 um beyond one radius from the corner.
  const Vec3 corner = kShovel.size_m / 2;
  Crowd crowd;
  crowd.add(corner + corner.normalized() * (kRadius_m + 10e-6));
  crowd.apply(kShovel, Pose{});
  EXPECT_NEAR(crowd.forceOn(0).norm(), 0.005, 5e-6);
  EXPECT_LT(crowd.forceOn(0).dot(corner), 0);
}

TEST(ToolContact, StiffnessIsHowTheForceChangesWhenTheToolMoves) {
  // One particle over the tilted large face, one at the rim: two normals that are neither parallel nor upright.
  const Quat tilt(Eigen::AngleAxisd(0.4, Vec3(1, 2, 0.5).normalized()));
  const Vec3 over(0.005, 0.004, 0.0025 + 0.9 * kRadius_m);
  const Vec3 beside(0.025 + 0.8 * kRadius_m, 0.003, 0.001);
  Crowd crowd;
  crowd.add(tilt * over);
  crowd.add(tilt * beside);
  const Eigen::Matrix3d stiffness = crowd.react(kShovel, {Vec3::Zero(), tilt}).stiffness_n_m;
  EXPECT_GT(stiffness.norm(), kShovel.stiffness_n_m);
  constexpr double kMove_m = 1e-6;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 move = kMove_m * Vec3::Unit(axis);
    const Vec3 after = crowd.apply(kShovel, {move, tilt}).force_n;
    const Vec3 before = crowd.apply(kShovel, {-move, tilt}).force_n;
    // The rim's normal turns a little with the move: second order, 1e-3 of a face's 500 N/m.
    EXPECT_LT(((after - before) / (2 * kMove_m) + stiffness * Vec3::Unit(axis)).norm(), 1e-2 * kShovel.stiffness_n_m);
  }
}

TEST(ToolContact, OnlyContactsThatHoldAreStiff) {
  const Twist down{Vec3(0, 0, -0.1), Vec3::Zero()};
  const Vec3 below(0, 0, -0.0025 - 0.9 * kRadius_m);
  const struct { double particle_m_s, share; } cases[] = {{0, 1}, {-0.1, 0}, {-0.05, 0.5}, {-0.2, 0}, {0.1, 1}};
  for (const auto& [particle_m_s, share] : cases) {
    Crowd crowd;
    crowd.add(below, Vec3(0, 0, particle_m_s));
    const Eigen::Matrix3d stiffness = crowd.react(kShovel, Pose{}, down).stiffness_n_m;
    EXPECT_NEAR(stiffness(2, 2), share * kShovel.stiffness_n_m, 1e-4) << particle_m_s;  // velocities are floats
  }
}

TEST(ToolContact, InABedItIsToTheBitWhatItIsAgainstAllParticles) {
  // The shovel dives in, crosses the bed, leaves it, and comes back elsewhere.
  for (const FrictionModel friction : {FrictionModel::kIcra2021, FrictionModel::kContact}) {
    BedParameters parameters;
    parameters.soil.friction = friction;
    parameters.soil.stiffness_n_m = friction == FrictionModel::kContact ? 1000 : 100;
    parameters.width_m = parameters.length_m = 0.3;
    parameters.start = BedStart::kPacked;
    parameters.depth_m = 0.05;
    Bed bed(parameters);
    ToolMemory memory(bed);
    std::vector<Float4> forces(bed.particles());
    std::size_t touched = 0;
    constexpr double kStep_s = 2e-4;
    for (int step = 0; step < 3000; ++step) {
      const double t = step / 3000.0;
      const Pose pose{Vec3(0.25 * std::cos(9 * t), 0.1 * std::sin(7 * t), 0.05 + 0.06 * std::cos(20 * t)),
                      Quat(Eigen::AngleAxisd(5 * t, Vec3(1, 2, 3).normalized()))};
      const Twist twist{Vec3(0.1, 0.2, -0.3), Vec3(1, 2, 3)};
      std::vector<std::int8_t> side(memory.particles().side.begin(), memory.particles().side.end());
      std::vector<Float4> slip(memory.particles().slip.begin(), memory.particles().slip.end());
      const Wrench all =
          applyToolContact(kShovel, pose, twist, parameters.soil, kStep_s, bed.state(), {side, slip}, forces).wrench;
      const Wrench near = applyToolContact(kShovel, pose, twist, kStep_s, bed, memory).wrench;
      ASSERT_EQ(near.force_n, all.force_n) << step;
      ASSERT_EQ(near.torque_nm, all.torque_nm) << step;
      ASSERT_TRUE(std::ranges::equal(memory.particles().side, side)) << step;
      ASSERT_EQ(bed.step(kStep_s), StepStatus::kOk);
      for (std::size_t i = 0; i < bed.particles(); ++i) {
        const Float4& f = bed.externalForces()[i];
        ASSERT_TRUE(f.x == forces[i].x && f.y == forces[i].y && f.z == forces[i].z) << step << " " << i;
        touched += f.x != 0 || f.y != 0 || f.z != 0 ? 1 : 0;
      }
    }
    EXPECT_GT(touched, 10'000U);
  }
}

}  // namespace
}  // namespace haptolith
