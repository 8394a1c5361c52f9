// Soil at rest sleeps, without an effect on forces.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "haptolith/device/hand/virtual_hand.h"
#include "haptolith/scene/scene.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

BedParameters sandbox(FrictionModel friction) {
  BedParameters bed;
  bed.soil = findPreset("P3").soil;
  bed.soil.friction = friction;
  bed.soil.contact_friction = 0.5;
  bed.start = BedStart::kPacked;
  bed.width_m = bed.length_m = 0.25;
  bed.depth_m = 0.05;
  return bed;
}

/// So wide that its borders sleep while the middle is stirred.
BedParameters wide(int threads) {
  BedParameters bed = sandbox(FrictionModel::kContact);
  bed.width_m = bed.length_m = 0.5;
  bed.sleep_speed_m_s = 2e-3;
  bed.threads = threads;
  return bed;
}

std::size_t highest(const Bed& bed) {
  const std::vector<Float4>& position = bed.state().position;
  return static_cast<std::size_t>(std::max_element(position.begin(),
                                                   position.begin() + static_cast<std::ptrdiff_t>(bed.particles()),
                                                   [](const Float4& a, const Float4& b) { return a.z < b.z; }) -
                                  position.begin());
}

/// A scene and a hand that stirs in it.
struct Stirred {
  Scene scene;
  VirtualHand hand;

  explicit Stirred(const BedParameters& bed, const HandParameters& parameters = stirring())
      : scene(bed, {}), hand(parameters, bed.tick_s) {}

  static HandParameters stirring() {
    HandParameters hand;
    hand.motion = HandMotion::kStir;
    hand.surface_m = 0.05;
    return hand;
  }

  /// One tick; returns the force on the tool.
  Vec3 tick() {
    const DeviceInput input = hand.read();
    EXPECT_EQ(scene.tick({{input.pose, input.twist}}), StepStatus::kOk);
    hand.write({{}});
    return scene.soilWrench().force_n;
  }
  void restFor(int steps) {
    for (int i = 0; i < steps; ++i) {
      ASSERT_EQ(scene.bed().step(scene.bed().parameters().tick_s / scene.substeps()), StepStatus::kOk);
    }
  }
};

/// Largest sum of what the two sides of a contact remember, both awake or both asleep: they are exact opposites.
float worstDisagreement(const BedState& state) {
  float worst = 0;
  for (std::size_t i = 0; i < state.particles(); ++i) {
    for (std::uint32_t s = 0; s < state.contacts.count(i); ++s) {
      const auto j = static_cast<std::size_t>(state.contacts.neighbour(i, s));
      const bool i_sleeps = state.asleep(i / kGroup);
      const bool j_sleeps = state.asleep(j / kGroup);
      if (i_sleeps == j_sleeps) {
        const Slip a = state.contacts.slip(i, s);
        const Slip b = state.contacts.slip(j, state.contacts.find(j, static_cast<std::int32_t>(i)));
        worst = std::max({worst, std::abs(a.x + b.x), std::abs(a.y + b.y), std::abs(a.z + b.z)});
      }
    }
  }
  return worst;
}

TEST(Sleep, WithIcra2021FrictionEveryBitIsAsIfNobodySlept) {
  BedParameters parameters = sandbox(FrictionModel::kIcra2021);
  parameters.width_m = parameters.length_m = 0.5;
  parameters.sleep_speed_m_s = 0;
  Stirred sleeping(parameters);
  parameters.sleep = false;
  Stirred waking(parameters);
  sleeping.restFor(1500);
  waking.restFor(1500);
  EXPECT_EQ(sleeping.scene.bed().awake(), 0U);
  std::size_t most = 0;
  std::size_t least = sleeping.scene.bed().particles();
  double felt = 0;
  for (int tick = 0; tick < 4000; ++tick) {
    const Vec3 force = sleeping.tick();
    ASSERT_EQ(force, waking.tick()) << "tick " << tick;
    felt += force.norm();
    most = std::max(most, sleeping.scene.bed().awake());
    least = tick > 2000 ? std::min(least, sleeping.scene.bed().awake()) : least;
    ASSERT_EQ(waking.scene.bed().awake(), waking.scene.bed().particles());
  }
  EXPECT_EQ(stateHash(sleeping.scene.bed().state()), stateHash(waking.scene.bed().state()));
  EXPECT_GT(felt, 100) << "nothing was stirred";
  EXPECT_GT(most, 100U);
  EXPECT_LT(least, sleeping.scene.bed().particles() / 2) << "nothing slept";
}

TEST(Sleep, WithContactFrictionTheToolFeelsTheSameToRounding) {
  BedParameters parameters = sandbox(FrictionModel::kContact);
  parameters.width_m = parameters.length_m = 0.15;
  Stirred sleeping(parameters);
  parameters.sleep = false;
  Stirred waking(parameters);
  for (Stirred* one : {&sleeping, &waking}) {
    one->scene.bed().setSettling(true);
    one->restFor(3000);
    one->scene.bed().setSettling(false);
    one->restFor(8000);
  }
  ASSERT_EQ(sleeping.scene.bed().awake(), 0U);
  double felt = 0;
  double apart = 0;
  for (int tick = 0; tick < 1000; ++tick) {  // then the least difference has grown: a stirred bed is chaotic
    const Vec3 force = sleeping.tick();
    felt += force.norm();
    apart += (force - waking.tick()).norm();
  }
  RecordProperty("relative_difference_1e6", static_cast<int>(1e6 * apart / felt));
  EXPECT_GT(felt, 10);
  EXPECT_LT(apart / felt, 1e-3);
  EXPECT_GT(sleeping.scene.bed().awake(), 100U);
}

TEST(Sleep, ThirdLawHoldsThroughSleepingAndWaking) {
  Stirred stirred(wide(1));
  stirred.restFor(2500);
  EXPECT_EQ(stirred.scene.bed().awake(), 0U);
  std::size_t least = stirred.scene.bed().particles();
  std::size_t most = 0;
  for (int tick = 0; tick < 3000; ++tick) {
    stirred.tick();
    if (tick % 50 == 0) {
      EXPECT_EQ(worstDisagreement(stirred.scene.bed().state()), 0) << "tick " << tick;
    }
    if (tick > 1000) {
      least = std::min(least, stirred.scene.bed().awake());
      most = std::max(most, stirred.scene.bed().awake());
    }
  }
  EXPECT_LT(least, most / 2) << "nobody fell asleep";
}

TEST(Sleep, SoilThatRingsButStaysWhereItIsSleepsAndTheToolFeelsTheSame) {
  // Grains that find new places under the tool let the whole bed swing at some mm/s, by a few um.
  BedParameters bed;
  bed.soil = findPreset("P3").soil;
  bed.soil.friction = FrictionModel::kContact;
  bed.soil.contact_friction = 0.5;
  bed.soil.contact_cohesion_n = 2e-3;
  bed.start = BedStart::kSettled;
  bed.width_m = bed.length_m = 0.42;
  bed.depth_m = 0.08;
  HandParameters hand = Stirred::stirring();
  hand.surface_m = bed.depth_m;
  struct Mean {
    double force_n = 0, awake = 0;
  };
  const auto stirred = [&](bool sleep, double speed_m_s, double distance_m) {
    bed.sleep = sleep;
    bed.sleep_speed_m_s = speed_m_s;
    bed.sleep_distance_m = distance_m;
    Stirred scene(bed, hand);
    constexpr int kTicks = 4000;
    Mean mean;
    for (int i = 0; i < kTicks; ++i) {
      scene.tick();
      mean.force_n += scene.scene.soilWrench().force_n.norm() / kTicks;
      mean.awake += static_cast<double>(scene.scene.bed().awake()) / kTicks;
    }
    return mean;
  };
  const Mean all = stirred(false, 0, 0);
  const Mean by_speed = stirred(true, 1e-3, 0);
  const Mean by_distance = stirred(true, 1e-2, 2e-4);
  EXPECT_GT(all.force_n, 0.3);
  // Each rounding leads to another specimen: 9 of them on three instruction sets gave 0.97 to 1.09, 1.01 in the mean.
  EXPECT_NEAR(by_speed.force_n / all.force_n, 1, 0.2);
  EXPECT_NEAR(by_distance.force_n / all.force_n, 1, 0.2);
  EXPECT_LT(by_distance.awake, 0.7 * by_speed.awake);  // soft soil; of measured soils a tenth
}

TEST(Sleep, IsTheSameForAnyNumberOfThreadsAndAfterRestoring) {
  std::vector<std::uint64_t> expected;
  for (const int threads : {1, 2, 3}) {
    auto stirred = std::make_unique<Stirred>(wide(threads));
    ASSERT_GT(stirred->scene.bed().particles(), 3U * 512);
    stirred->restFor(2500);
    std::vector<std::uint64_t> hashes;
    for (int tick = 0; tick < 2500; ++tick) {
      if (threads == 3 && tick == 1200) {  // into a bed that is all awake, with a hand that has come as far
        const std::string saved = serialise(stirred->scene.save());
        EXPECT_LT(stirred->scene.bed().awake(), stirred->scene.bed().particles());
        auto other = std::make_unique<Stirred>(wide(2));
        for (int i = 0; i < 1200; ++i) {
          other->hand.write({{}});
          (void)other->hand.read();
        }
        other->scene.restore(deserialiseSavedScene(saved));
        stirred = std::move(other);
      }
      stirred->tick();
      if (tick % 100 == 99) {
        hashes.push_back(stateHash(stirred->scene.bed().state()));
        hashes.push_back(stirred->scene.bed().awake());
      }
    }
    expected = expected.empty() ? hashes : expected;
    EXPECT_EQ(hashes, expected) << threads << " threads";
  }
}

class Waking : public testing::TestWithParam<FrictionModel> {
 protected:
  Waking() : stirred_(coarse(GetParam())) { stirred_.restFor(2500); }

  static BedParameters coarse(FrictionModel friction) {
    BedParameters bed = sandbox(friction);
    bed.sleep_speed_m_s = friction == FrictionModel::kIcra2021 ? 1e-6 : 1e-3;
    return bed;
  }
  Bed& bed() { return stirred_.scene.bed(); }

  Stirred stirred_;
};

TEST_P(Waking, ABedAtRestSleepsWholly) {
  EXPECT_EQ(bed().awake(), 0U);
  EXPECT_EQ(bed().largestSpeed(), 0);
  const std::uint64_t before = stateHash(bed().state());
  const std::uint64_t step = bed().state().step;
  stirred_.restFor(100);
  EXPECT_EQ(bed().state().step, step + 100);
  BedState state = bed().state();
  state.step = step;
  EXPECT_EQ(stateHash(state), before);
}

TEST_P(Waking, GravityThatTurnsWakesAllAndTheSameGravityNobody) {
  bed().setGravity(bed().parameters().gravity_m_s2);
  stirred_.restFor(1);
  EXPECT_EQ(bed().awake(), 0U);
  bed().setGravity({5, 0, -1});
  stirred_.restFor(1);
  EXPECT_EQ(bed().awake(), bed().particles());
  stirred_.restFor(100);
  EXPECT_GT(bed().largestSpeed(), 0.05);
}

TEST_P(Waking, AToolThatComesNearWakesWhatItMayTouch) {
  NearGroups of_tool = bed().nearGroups();
  EXPECT_TRUE(bed().groupsNear(of_tool, {0, 0, 0.5}, 0.02).empty());
  stirred_.restFor(1);
  EXPECT_EQ(bed().awake(), 0U);
  const auto near = bed().groupsNear(of_tool, {0, 0, 0.04}, 0.02);
  ASSERT_FALSE(near.empty());
  stirred_.restFor(1);
  EXPECT_EQ(bed().awake(), near.size() * kGroup);
  for (int i = 0; i < 300; ++i) {
    (void)bed().groupsNear(of_tool, {0, 0, 0.04}, 0.02);
    stirred_.restFor(1);
  }
  EXPECT_EQ(bed().awake(), near.size() * kGroup) << "they stay awake while it is there, and wake nobody";
  (void)bed().groupsNear(of_tool, {0, 0, 0.5}, 0.02);
  stirred_.restFor(300);
  EXPECT_EQ(bed().awake(), 0U);
}

TEST_P(Waking, WhoIsDrivenWakesOthersUntilItStands) {
  const std::size_t top = highest(bed());
  bed().drive(top, {0, 0, -0.05});
  stirred_.restFor(1);
  EXPECT_GE(bed().awake(), kGroup);
  bool pressed = false;
  for (int i = 0; i < 100; ++i) {
    stirred_.restFor(1);
    pressed = pressed || bed().contactForce(top).z() > 1e-3;
  }
  EXPECT_TRUE(pressed);
  EXPECT_GT(bed().awake(), 2 * kGroup);
  bed().drive(top, Vec3::Zero());
  stirred_.restFor(5000);
  EXPECT_EQ(bed().awake(), 0U);
}

TEST_P(Waking, WhatFallsOnThemWakesThemInTime) {
  // The highest is lifted by 60 mm and released: neither it nor those it falls on may sink into each other.
  const std::size_t top = highest(bed());
  const double dt = bed().parameters().tick_s / stirred_.scene.substeps();
  const int lifting = static_cast<int>(0.2 / dt);
  bed().drive(top, {0, 0, 0.3});
  stirred_.restFor(lifting);
  bed().release(top);
  double deepest = 1;
  std::size_t moved = 0;
  const BedState before = bed().state();
  const double diameter = 2 * bed().parameters().soil.radius_m;
  for (int i = 0; i < 5 * lifting; ++i) {
    stirred_.restFor(1);
    const Float4& p = bed().state().position[top];
    for (std::size_t j = 0; j < bed().particles(); ++j) {
      const Float4& q = bed().state().position[j];
      if (j != top) {
        deepest = std::min(deepest, static_cast<double>(std::hypot(p.x - q.x, p.y - q.y, p.z - q.z)) / diameter);
      }
    }
  }
  for (std::size_t j = 0; j < bed().particles(); ++j) {
    const Float4& p = before.position[j];
    const Float4& q = bed().state().position[j];
    moved += j != top && std::hypot(p.x - q.x, p.y - q.y, p.z - q.z) > 1e-6 ? 1 : 0;
  }
  EXPECT_LT(deepest, 1) << "it fell on nobody";
  EXPECT_GT(deepest, 0.75);
  EXPECT_GT(moved, 0U) << "those it fell on slept on";
}

TEST_P(Waking, WhoIsHeldInTheAirAndLetGoFalls) {
  const std::size_t top = highest(bed());
  const int lifting = static_cast<int>(0.2 / (bed().parameters().tick_s / stirred_.scene.substeps()));
  bed().drive(top, {0, 0, 0.3});
  stirred_.restFor(lifting);
  for (int turn = 0; turn < 64; ++turn) {  // at every phase of the checks of sleeping groups
    bed().drive(top, Vec3::Zero());
    stirred_.restFor(3 * lifting + 1);
    ASSERT_EQ(bed().awake(), 0U) << "it may sleep while it is held";
    const float height = bed().state().position[top].z;
    bed().release(top);
    stirred_.restFor(20);
    EXPECT_LT(bed().state().position[top].z, height) << turn;
    EXPECT_GT(bed().largestSpeed(), 1e-3);
  }
}

TEST_P(Waking, FrictionThatIsSwitchedOffAndAWishWake) {
  bed().setSettling(true);
  stirred_.restFor(1);
  EXPECT_EQ(bed().awake(), bed().particles());
  bed().setSettling(false);
  stirred_.restFor(6000);
  EXPECT_EQ(bed().awake(), 0U);
  bed().wake(0);
  stirred_.restFor(1);
  EXPECT_GE(bed().awake(), kGroup);
  EXPECT_LT(bed().awake(), bed().particles());
}

INSTANTIATE_TEST_SUITE_P(Frictions, Waking, testing::Values(FrictionModel::kIcra2021, FrictionModel::kContact));

}  // namespace
}  // namespace haptolith
