#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "haptolith/core/math/random.h"
#include "haptolith/mesh/triangle_tree.h"
#include "haptolith/scene/scene.h"
#include "haptolith/soil/presets.h"
#include "haptolith/tool/tool_box.h"
#include "haptolith/tool/tool_contact.h"
#include "haptolith/tool/tool_shape.h"
#include "haptolith/tool/tool_surface.h"

namespace haptolith {
namespace {

constexpr double kRadius_m = 7e-3;
constexpr double kTick_s = 1e-3;

/// Jaws 50 mm high, 40 mm wide and 5 mm thick: between them x is from -opening / 2 to opening / 2.
ToolParameters jaws(double opening_m, double bend_rad = 0) {
  ToolParameters tool;
  tool.shape = ToolShape::kJaws;
  tool.opening_m = opening_m;
  tool.jaw_bend_rad = bend_rad;
  return tool;
}

/// Flat plates, shells, and shells that close to a tube.
constexpr std::array kBends_rad{0.0, 1.2, std::numbers::pi};

Float4 record(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), 0};
}
Vec3 vec(const Float4& f) {
  return {f.x, f.y, f.z};
}

/// Motion of a tool.
struct Motion {
  Twist twist;
  double opening_m_s = 0;
};

/// Particles that stay where they are put, and what a tool does to them.
struct Grains {
  SoilParameters soil{.radius_m = kRadius_m};
  std::vector<Vec3> at, speed;
  std::vector<std::int8_t> side;
  std::vector<Float4> slip, forces;

  void add(const Vec3& x, const Vec3& v = Vec3::Zero()) {
    at.push_back(x);
    speed.push_back(v);
    side.push_back(0);
    slip.push_back({});
    forces.push_back({1, 2, 3, 0});  // left over from the step before
  }
  [[nodiscard]] Vec3 forceOn(std::size_t i) const { return vec(forces[i]); }

  ToolReaction react(const ToolParameters& tool, const Pose& pose = {}, const Motion& motion = {}) {
    BedState state;
    for (std::size_t i = 0; i < at.size(); ++i) {
      state.position.push_back(record(at[i]));
      state.velocity.push_back(record(speed[i]));
      ++state.particle_count;
    }
    state.position.resize(paddedCount(at.size()), kGhost);
    return applyToolContact(tool, pose, motion.twist, soil, kTick_s, state, {side, slip}, forces, motion.opening_m_s);
  }
};

Vec3 anyVector(std::mt19937_64& random, double size) {
  return size * Vec3(uniformSigned(random), uniformSigned(random), uniformSigned(random));
}

// --- what they are ---------------------------------------------------------------------------------------------------

TEST(Jaws, ReachAsFarAsTheirCorners) {
  EXPECT_NEAR(enclosingRadius(jaws(0.06)), std::sqrt(35.0 * 35 + 20 * 20 + 25 * 25) * 1e-3, 1e-15);
  const ToolBox box = boxAround(jaws(0.06), Pose{});
  EXPECT_FLOAT_EQ(box.half_edges_m[0], 0.035F);
  EXPECT_FLOAT_EQ(box.half_edges_m[1], 0.02F);
  EXPECT_FLOAT_EQ(box.half_edges_m[2], 0.025F);
}

TEST(Jaws, BentOnesAreAsFarAwayAsTheirSurfaceIs) {
  std::mt19937_64 random(7);
  for (const double bend_rad : kBends_rad) {
    const ToolParameters tool = jaws(0.02, bend_rad);
    const ToolSurface surface = toolSurface(tool, tool.opening_m);
    int outside = 0;
    for (int i = 0; i < 3000; ++i) {
      const Vec3 centre = anyVector(random, 0.06);
      double nearest_m = 1;
      for (const auto& [a, b, c] : surface.triangles) {
        const auto at = [&](std::int32_t point) { return surface.points_tool_m[static_cast<std::size_t>(point)]; };
        nearest_m = std::min(nearest_m, std::sqrt(squaredDistance(centre, {at(a), at(b), at(c)})));
      }
      const JawContacts found = jawContacts(tool, centre, kRadius_m, 0);
      const double nearer_m = kRadius_m - std::max(found.jaws[0].found.depth_m, found.jaws[1].found.depth_m);
      if (nearer_m < 1e-4) {
        continue;  // inside, where the face that a particle came over counts
      }
      ++outside;
      ASSERT_NEAR(nearer_m, nearest_m, 4e-5) << centre.transpose() << ", bend " << bend_rad << ": arcs of 24 chords";
      for (const JawContact& jaw : found.jaws) {
        ASSERT_NEAR(jaw.found.outward.norm(), 1, 1e-12);
      }
      ASSERT_LE(centre.norm() - nearer_m, enclosingRadius(tool) + 1e-9);
    }
    EXPECT_GT(outside, 2000);
    const ToolCorners corners = cornersOf(tool);
    Vec3 farthest = Vec3::Zero();
    for (const Vec3& point : surface.points_tool_m) {
      farthest = farthest.cwiseMax(point);
    }
    EXPECT_LT((farthest - corners.high_m).norm(), 2e-5) << bend_rad;
  }
}

TEST(Jaws, BentOnesPushTheWayInWhichTheirDistanceGrows) {
  std::mt19937_64 random(8);
  const ToolParameters tool = jaws(0.02, 2);
  int compared = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 centre = anyVector(random, 0.05);
    const auto depth_at = [&](const Vec3& at, std::size_t jaw) {
      return jawContacts(tool, at, kRadius_m, 0).jaws[jaw].found.depth_m;
    };
    for (const std::size_t jaw : {0U, 1U}) {
      if (depth_at(centre, jaw) > kRadius_m - 1e-3) {
        continue;
      }
      constexpr double kStep_m = 1e-7;
      Vec3 slope;
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3 step = kStep_m * Vec3::Unit(axis);
        slope[axis] = (depth_at(centre - step, jaw) - depth_at(centre + step, jaw)) / (2 * kStep_m);
      }
      ASSERT_LT((slope - jawContacts(tool, centre, kRadius_m, 0).jaws[jaw].found.outward).norm(), 1e-3)
          << centre.transpose();
      ++compared;
    }
  }
  EXPECT_GT(compared, 2000);
}

TEST(Jaws, PushAParticleAwayFromTheFaceItTouches) {
  // Opening 60 mm: the right jaw is from 30 to 35 mm. 500 N/m times 1 mm on each of its two large faces and below it.
  for (const auto& [centre, force] :
       {std::pair{Vec3(0.024, 0, 0), Vec3(-0.5, 0, 0)}, std::pair{Vec3(0.041, 0.01, 0.02), Vec3(0.5, 0, 0)},
        std::pair{Vec3(0.0325, 0, -0.031), Vec3(0, 0, -0.5)}, std::pair{Vec3(-0.0325, 0.026, 0), Vec3(0, 0.5, 0)},
        std::pair{Vec3(0, 0, 0), Vec3(0, 0, 0)}}) {
    Grains grains;
    grains.add(centre);
    const ToolReaction reaction = grains.react(jaws(0.06));
    EXPECT_LT((grains.forceOn(0) - force).norm(), 3e-6) << centre.transpose();
    EXPECT_LT((reaction.wrench.force_n + force).norm(), 3e-6) << centre.transpose();
    EXPECT_NEAR(reaction.grip_n, -force.x() / 2 * (centre.x() > 0 ? 1 : -1), 3e-6) << centre.transpose();
  }
}

TEST(Jaws, ClosedWithoutAGapAreABoxOfTwiceTheThickness) {
  std::mt19937_64 random(2);
  ToolParameters box;
  box.size_m = {0.05, 0.04, 0.01};
  const Pose pose{Vec3(0.01, 0.02, 0.03), Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()))};
  const Pose box_pose{pose.position_m, pose.orientation * Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitY())};
  const Motion motion{{Vec3(0.1, 0.2, -0.1), Vec3(1, -2, 1)}};
  Grains with_jaws;
  const auto deep = [](const Vec3& in_tool) {  // deeper than half a radius
    const Vec3 p = in_tool.cwiseAbs();
    return p.x() < 0.0085 && p.y() < 0.0235 && p.z() < 0.0285;
  };
  while (with_jaws.at.size() < 300) {
    const Vec3 x(0.013 * uniformSigned(random), 0.028 * uniformSigned(random), 0.033 * uniformSigned(random));
    if (!deep(x)) {
      with_jaws.add(pose.fromBody(x), anyVector(random, 0.1));
    }
  }
  Grains with_box = with_jaws;
  int touched = 0;
  int at_seam = 0;
  for (int step = 0; step < 30; ++step) {
    for (std::size_t i = 0; i < with_jaws.at.size(); ++i) {
      const Vec3 moved = with_jaws.at[i] + anyVector(random, 2e-4);
      if (!deep(pose.toBody(moved))) {
        with_jaws.at[i] = with_box.at[i] = moved;
      }
      touched += with_jaws.forceOn(i).isZero() ? 0 : 1;
      at_seam += with_jaws.forceOn(i).isZero() || std::abs(pose.toBody(moved).x()) > 0.0025 ? 0 : 1;
    }
    const ToolReaction of_jaws = with_jaws.react(jaws(0), pose, motion);
    const ToolReaction of_box = with_box.react(box, box_pose, motion);
    for (std::size_t i = 0; i < with_jaws.at.size(); ++i) {
      ASSERT_LT((with_jaws.forceOn(i) - with_box.forceOn(i)).norm(), 1e-6) << pose.toBody(with_jaws.at[i]).transpose();
    }
    EXPECT_LT((of_jaws.wrench.force_n - of_box.wrench.force_n).norm(), 1e-9);
    EXPECT_LT((of_jaws.wrench.torque_nm - of_box.wrench.torque_nm).norm(), 1e-9);
    EXPECT_LT((of_jaws.stiffness_n_m - of_box.stiffness_n_m).norm(), 1e-6);
  }
  EXPECT_GT(touched, 1000);
  EXPECT_GT(at_seam, 100);
}

TEST(Jaws, AreTheSameFromLeftAndRight) {
  std::mt19937_64 random(3);
  const auto mirrored = [](const Vec3& v) { return Vec3(-v.x(), v.y(), v.z()); };
  for (const auto& [friction, bend_rad] : {std::pair{FrictionModel::kIcra2021, 0.0},
                                           {FrictionModel::kContact, 0.0},
                                           {FrictionModel::kIcra2021, 2.0},
                                           {FrictionModel::kContact, 2.0}}) {
    for (const double opening_m : {0.0, 0.003, 0.012, 0.04}) {
      Grains grains;
      grains.soil.friction = friction;
      Grains mirror = grains;
      for (int i = 0; i < 300; ++i) {
        const Vec3 x = anyVector(random, 0.04);
        const Vec3 v = anyVector(random, 0.1);
        grains.add(x, v);
        mirror.add(mirrored(x), mirrored(v));
      }
      for (int step = 0; step < 3; ++step) {
        const Motion closing{.twist = {}, .opening_m_s = -0.2};
        const ToolReaction one = grains.react(jaws(opening_m, bend_rad), {}, closing);
        const ToolReaction other = mirror.react(jaws(opening_m, bend_rad), {}, closing);
        EXPECT_NEAR(one.grip_n, other.grip_n, 1e-6);
        EXPECT_LT((one.wrench.force_n - mirrored(other.wrench.force_n)).norm(), 1e-6);
        EXPECT_GT(one.wrench.force_n.norm(), 0.1);
        for (std::size_t i = 0; i < grains.at.size(); ++i) {
          ASSERT_LT((grains.forceOn(i) - mirrored(mirror.forceOn(i))).norm(), 1e-6);
        }
      }
    }
  }
}

// --- gripping --------------------------------------------------------------------------------------------------------

TEST(Jaws, SqueezeAParticleEquallyFromBothSides) {
  // 10 mm apart around 14 mm: 2 mm deep in each, 1 N; closing at 0.2 m/s, each jaw at 0.1: 0.35 N s/m * 0.1 m/s more.
  for (const FrictionModel friction : {FrictionModel::kIcra2021, FrictionModel::kContact}) {
    Grains grains;
    grains.soil.friction = friction;
    grains.add(Vec3(0, 0.01, -0.01));
    const ToolReaction held = grains.react(jaws(0.010));
    EXPECT_LT(grains.forceOn(0).norm(), 1e-6);
    EXPECT_NEAR(held.grip_n, 1.0, 1e-6);
    EXPECT_LT(held.wrench.force_n.norm(), 1e-6);
    const ToolReaction closing = grains.react(jaws(0.010), {}, {.twist = {}, .opening_m_s = -0.2});
    EXPECT_LT(grains.forceOn(0).norm(), 1e-6);
    EXPECT_NEAR(closing.grip_n, 1.035, 1e-6);
  }
}

TEST(Jaws, FeelEachSideOfAParticleThatIsNotInTheMiddle) {
  // 0.5 mm to the right: 2.5 and 1.5 mm deep. The particle is pushed back by the difference, the grip feels the mean.
  Grains grains;
  grains.add(Vec3(0.0005, 0, 0));
  const ToolReaction held = grains.react(jaws(0.010));
  EXPECT_NEAR(grains.forceOn(0).x(), -0.5, 3e-6);
  EXPECT_NEAR(held.wrench.force_n.x(), 0.5, 3e-6);
  EXPECT_NEAR(held.grip_n, 1.0, 3e-6);
}

TEST(Jaws, ObeyNewtonsThirdLaw) {
  std::mt19937_64 random(4);
  for (const auto& [opening_m, bend_rad] : {std::pair{0.0, 0.0},
                                            {0.004, 0.0},
                                            {0.013, 0.0},
                                            {0.04, 0.0},
                                            {0.0, 1.2},
                                            {0.013, 2.0},
                                            {0.04, std::numbers::pi}}) {
    Grains grains;
    for (int i = 0; i < 400; ++i) {
      grains.add(anyVector(random, 0.04), anyVector(random, 0.1));
    }
    const ToolReaction reaction =
        grains.react(jaws(opening_m, bend_rad), {}, {{Vec3(0.1, -0.2, 0.3), Vec3(1, 2, -1)}, -0.5});
    Wrench on_grains;
    for (std::size_t i = 0; i < grains.at.size(); ++i) {
      on_grains.add(grains.forceOn(i), grains.at[i]);  // along normals, which go through the centres
    }
    EXPECT_GT(on_grains.force_n.norm(), 1);
    EXPECT_LT((on_grains.force_n + reaction.wrench.force_n).norm(), 1e-5);
    EXPECT_LT((on_grains.torque_nm + reaction.wrench.torque_nm).norm(), 1e-6);
  }
}

TEST(Jaws, GiveTheSoilThePowerThatTheirWrenchAndTheirGripTake) {
  // The work of tool and particles goes into the springs and dampers: for each contact the force times how fast it
  // deepens, which is measured here by going a little back and forth.
  std::mt19937_64 random(5);
  const Pose pose{Vec3::Zero(), Quat(Eigen::AngleAxisd(0.5, Vec3(1, -1, 2).normalized()))};
  const Motion motion{{Vec3(0.05, -0.1, 0.08), Vec3(0.6, -0.4, 0.5)}, -0.3};
  ToolParameters tool = jaws(0.03);
  tool.adhesion_ratio = 0;
  Grains grains;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 x = anyVector(random, 0.04);
    const Vec3 from_jaw(std::abs(x.x()) - 0.0175, std::abs(x.y()), std::abs(x.z()));
    const bool over_face = from_jaw.y() < 0.018 && from_jaw.z() < 0.023;
    if (over_face && std::abs(from_jaw.x()) > 0.0045 && std::abs(from_jaw.x()) < 0.0085) {
      grains.add(pose.fromBody(x), anyVector(random, 0.05));
    }
  }
  ASSERT_GT(grains.at.size(), 50U);
  const auto depths = [&](double after_s) {
    Grains then = grains;
    for (std::size_t i = 0; i < then.at.size(); ++i) {
      then.at[i] += after_s * then.speed[i];
      then.speed[i].setZero();
    }
    const Vec3& turn = motion.twist.angular_rad_s;
    const Pose moved{pose.position_m + after_s * motion.twist.linear_m_s,
                     Quat(Eigen::AngleAxisd(after_s * turn.norm(), turn.normalized())) * pose.orientation};
    ToolParameters later = tool;
    later.opening_m += after_s * motion.opening_m_s;
    then.react(later, moved);
    std::vector<double> depths_m;
    for (std::size_t i = 0; i < then.at.size(); ++i) {
      depths_m.push_back(then.forceOn(i).norm() / tool.stiffness_n_m);
    }
    return depths_m;
  };
  const ToolReaction reaction = grains.react(tool, pose, motion);
  constexpr double kMoment_s = 1e-4;
  const std::vector<double> before = depths(-kMoment_s);
  const std::vector<double> after = depths(kMoment_s);
  double on_grains_w = 0;
  double into_contacts_w = 0;
  for (std::size_t i = 0; i < grains.at.size(); ++i) {
    on_grains_w += grains.forceOn(i).dot(grains.speed[i]);
    into_contacts_w += grains.forceOn(i).norm() * (after[i] - before[i]) / (2 * kMoment_s);
  }
  const double on_tool_w = reaction.wrench.force_n.dot(motion.twist.linear_m_s) +
                           reaction.wrench.torque_nm.dot(motion.twist.angular_rad_s) +
                           reaction.grip_n * motion.opening_m_s;
  EXPECT_GT(std::abs(reaction.grip_n * motion.opening_m_s), 0.1) << "else nothing is tested";
  EXPECT_NEAR(on_tool_w + on_grains_w, -into_contacts_w, 1e-3 * std::abs(into_contacts_w));
}

TEST(Jaws, GiveBackTheWorkOfAClosedWay) {
  // To the side and together, apart and back, around particles that stay where they are: springs keep nothing.
  for (const double bend_rad : kBends_rad) {
    Grains grains;
    grains.add(Vec3(0.001, 0, -0.02));
    grains.add(Vec3(-0.002, 0.01, 0.02));
    grains.add(Vec3(0.0145, -0.01, 0));
    grains.add(Vec3(0.012, 0.005, 0.01));
    double work_j = 0;
    double to_and_fro_j = 0;
    constexpr int kSteps = 2000;
    const auto x = [](double s) { return 0.001 * std::sin(2 * std::numbers::pi * s); };
    const auto opening = [](double s) { return 0.008 + 0.003 * std::cos(2 * std::numbers::pi * s); };
    for (int i = 0; i < kSteps; ++i) {
      const double from = static_cast<double>(i) / kSteps;
      const double to = static_cast<double>(i + 1) / kSteps;
      const double middle = (from + to) / 2;
      const ToolReaction now = grains.react(jaws(opening(middle), bend_rad), {Vec3(x(middle), 0, 0), Quat::Identity()});
      const double step_j = now.wrench.force_n.x() * (x(to) - x(from)) + now.grip_n * (opening(to) - opening(from));
      work_j += step_j;
      to_and_fro_j += std::abs(step_j);
    }
    EXPECT_GT(to_and_fro_j, 1e-3);
    EXPECT_LT(std::abs(work_j), 1e-3 * to_and_fro_j) << bend_rad;
  }
}

TEST(Jaws, PushWithoutJumpsWhereTheyMakeUpOneSurface) {
  // A particle 1 mm deep in the lower edges moves from one jaw over the slot to the other, and the slot opens under it:
  // in steps of 10 um its force changes by what a few springs of 500 N/m give, and never grows to two pushes for one.
  const auto push = [](double x_m, double opening_m) {
    Grains grains;
    grains.add(Vec3(x_m, 0, -0.025 - 0.006));
    ToolParameters tool = jaws(opening_m);
    tool.adhesion_ratio = 0;
    grains.react(tool);
    return grains.forceOn(0);
  };
  constexpr double kStep_m = 1e-5;
  for (const double opening_m : {0.0, 0.0002, 0.001, 0.004, 0.008, 0.012}) {
    for (double x_m = -0.012; x_m < 0.012; x_m += kStep_m) {
      EXPECT_LT((push(x_m + kStep_m, opening_m) - push(x_m, opening_m)).norm(), 4 * 500 * kStep_m)
          << x_m << " " << opening_m;
      EXPECT_GT(-push(x_m, opening_m).z(), -1e-9);
      EXPECT_LT(-push(x_m, opening_m).z(), 0.5 * 1.02) << x_m << " " << opening_m;
    }
  }
  for (double opening_m = kStep_m; opening_m < 0.02; opening_m += kStep_m) {
    EXPECT_LT((push(0.001, opening_m + kStep_m) - push(0.001, opening_m)).norm(), 4 * 500 * kStep_m) << opening_m;
  }
}

TEST(Jaws, HoldAParticleByFriction) {
  // Contact friction: a particle between jaws that go up is dragged along by both, tan(delta) times the grip at most.
  Grains grains;
  grains.soil.friction = FrictionModel::kContact;
  grains.add(Vec3(0, 0, 0));
  double lifted_n = 0;
  for (int step = 0; step < 200; ++step) {
    const Pose pose{Vec3(0, 0, 1e-5 * step), Quat::Identity()};
    const ToolReaction reaction = grains.react(jaws(0.010), pose, {{Vec3(0, 0, 0.01), Vec3::Zero()}});
    EXPECT_NEAR(reaction.wrench.force_n.z(), -grains.forceOn(0).z(), 1e-6);
    EXPECT_LT(std::abs(grains.forceOn(0).x()), 1e-6);
    EXPECT_GE(grains.forceOn(0).z(), lifted_n - 1e-6) << "what it has slid is remembered";
    lifted_n = grains.forceOn(0).z();
  }
  EXPECT_NEAR(lifted_n, 2 * 0.36 * 1.0, 0.02);
}

// --- in a scene ------------------------------------------------------------------------------------------------------

BedParameters p4() {
  BedParameters bed;
  bed.soil = findPreset("P4").soil;
  return bed;
}

/// A bed of one particle that floats.
Scene oneParticle(const Vec3& centre, const ToolParameters& tool) {
  BedParameters bed = p4();
  bed.gravity_m_s2.setZero();
  bed.particles = 1;
  bed.layers = 1;
  bed.start = BedStart::kRain;
  return {bed, tool, std::vector<Vec3>{centre}};
}

TEST(JawsInAScene, MoveEvenlyToWhereTheyAreAsked) {
  Scene scene(p4(), jaws(0.06));
  const Pose above{Vec3(0, 0, 0.3), Quat::Identity()};
  EXPECT_DOUBLE_EQ(scene.opening(), 0.06) << "wide open at first";
  scene.placeTool({{above, {}}});
  ASSERT_EQ(scene.tick({{above, {}}, 0.5}), StepStatus::kOk);
  EXPECT_DOUBLE_EQ(scene.opening(), 0.03);
  ASSERT_EQ(scene.tick({{above, {}}, std::numeric_limits<double>::quiet_NaN()}), StepStatus::kOk);
  EXPECT_DOUBLE_EQ(scene.opening(), 0.03);
  scene.placeTool({{above, {}}, -3});
  EXPECT_DOUBLE_EQ(scene.opening(), 0) << "placed, not moved";
  EXPECT_EQ(scene.soilForce().grip_n, 0);
  ToolParameters other = jaws(0.04);
  scene.placeTool({{above, {}}, 1});
  scene.setTool(other);
  EXPECT_DOUBLE_EQ(scene.opening(), 0.04);
  other.shape = ToolShape::kSphere;
  scene.setTool(other);
  EXPECT_EQ(scene.opening(), 0);
}

TEST(JawsInAScene, AreNoticedByNoOtherTool) {
  const auto hashAfter = [](double opening) {
    Scene scene(p4(), ToolParameters{});
    scene.placeTool({{{Vec3(0, 0, 0.05), Quat::Identity()}, {}}});
    for (int i = 1; i <= 200; ++i) {
      const Movement down{{Vec3(0, 0, 0.05 - 1e-4 * i), Quat::Identity()}, {Vec3(0, 0, -0.1), Vec3::Zero()}};
      EXPECT_EQ(scene.tick({down, i % 2 == 0 ? opening : 1}), StepStatus::kOk);
      EXPECT_EQ(scene.soilForce().grip_n, 0);
    }
    EXPECT_GT(scene.soilWrench().force_n.norm(), 0);
    return scene.hash();
  };
  EXPECT_EQ(hashAfter(0), hashAfter(1));
}

TEST(JawsInAScene, LetNothingThroughWhenTheySnapShut) {
  // From 60 mm to 9 mm, with 14 mm of particle between, as quickly as a hand can and quicker.
  for (const double speed_m_s : {0.1, 0.5, 1.0, 3.0}) {
    for (const double x_m : {-0.02, -0.001, 0.0, 0.015}) {
      Scene scene = oneParticle(Vec3(x_m, 0.003, 0.06), jaws(0.06));
      const Pose pose{Vec3(0, 0, 0.06), Quat::Identity()};
      scene.placeTool({{pose, {}}});
      for (int i = 1; i <= 600; ++i) {
        ASSERT_EQ(scene.tick({{pose, {}}, std::max(1 - speed_m_s * i * kTick_s / 0.06, 0.15)}), StepStatus::kOk);
        const double x = scene.bed().state().position[0].x;
        ASSERT_LT(std::abs(x), scene.opening() / 2 + 0.0025) << speed_m_s << " " << x_m << " tick " << i;
      }
      EXPECT_NEAR(scene.soilForce().grip_n, 500 * 0.0025, 0.05) << speed_m_s << " " << x_m;
      EXPECT_LT(std::abs(scene.soilWrench().force_n.x()), 0.05) << "it has come to rest in the middle";
    }
  }
}

/// Leads upright jaws, open by a share, from one height and opening to others.
void lead(Scene& scene, double from_m, double to_m, double open_from, double open_to, int ticks) {
  for (int i = 1; i <= ticks; ++i) {
    const double share = static_cast<double>(i) / ticks;
    const Twist twist{Vec3(0, 0, (to_m - from_m) / (ticks * kTick_s)), Vec3::Zero()};
    const Pose pose{Vec3(0, 0, std::lerp(from_m, to_m, share)), Quat::Identity()};
    ASSERT_EQ(scene.tick({{pose, twist}, std::lerp(open_from, open_to, share)}), StepStatus::kOk);
  }
}

TEST(JawsInAScene, GatherSoilAndFeelItBetweenThem) {
  BedParameters bed = p4();
  bed.soil.friction = FrictionModel::kContact;  // with ICRA 2021 friction, nothing but dust holds on to a tool
  Scene scene(bed, jaws(0.04));
  scene.placeTool({{{Vec3(0, 0, 0.12), Quat::Identity()}, {}}});
  lead(scene, 0.12, 0.045, 1, 1, 500);
  const double open_n = scene.soilForce().grip_n;
  lead(scene, 0.045, 0.045, 1, 0.3, 40);  // 28 mm in 40 ms, to less than a particle
  EXPECT_GT(scene.soilForce().grip_n, open_n + 0.2);
  lead(scene, 0.045, 0.12, 0.3, 0.3, 500);
  EXPECT_GT(scene.soilForce().grip_n, 0.05) << "something is still between them";
  lead(scene, 0.12, 0.12, 0.3, 1, 100);
  EXPECT_NEAR(scene.soilForce().grip_n, 0, 0.05);
}

TEST(JawsInAScene, ShellsCarryWhatFlatOnesDrop) {
  const auto carried = [](double bend_rad) {
    BedParameters bed = p4();
    bed.soil.friction = FrictionModel::kContact;
    ToolParameters tool = jaws(0.05, bend_rad);
    tool.size_m = {0.08, 0.06, 0.004};
    tool.friction = 0;
    Scene scene(bed, tool);
    scene.placeTool({{{Vec3(0, 0, 0.12), Quat::Identity()}, {}}});
    lead(scene, 0.12, 0.04, 1, 1, 800);
    lead(scene, 0.04, 0.04, 1, 0.04, 400);
    lead(scene, 0.04, 0.2, 0.04, 0.04, 1600);
    lead(scene, 0.2, 0.2, 0.04, 0.04, 500);
    int high = 0;
    const BedState& state = scene.bed().state();
    for (std::size_t i = 0; i < state.particles(); ++i) {
      high += state.position[i].z > 0.15F ? 1 : 0;
    }
    return high;
  };
  EXPECT_GE(carried(2.5), carried(0) + 4) << "without friction at the tool only a floor carries";
}

}  // namespace
}  // namespace haptolith
