#include "haptolith/study/perception/exploration.h"

#include <gtest/gtest.h>

#include <cmath>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

SceneFile icra2021Scene(const char* preset = "P3") {
  SceneFile scene;
  changePreset(scene, preset);
  return scene;
}

/// Grains without cohesion, and a hand that digs deep and holds the tool firmly.
SceneFile grains(const char* body) {
  SceneFile scene;
  SoilParameters& soil = scene.bed.soil;
  soil.gamma_nm = 6e-5;
  soil.stiffness_n_m = 3000;
  soil.friction = FrictionModel::kContact;
  soil.contact_friction = 0.3;
  soil.size_spread = 0.15;
  scene.bed.start = BedStart::kRain;
  scene.hand.depth_m = 0.032;
  scene.hand.stiffness_n_m = 400;
  scene.hand.damping_n_s_m = 15;
  changeBody(scene, body);
  return scene;
}

TEST(Exploration, OfTheSameSeedFeelsTheSame) {
  const ExplorationOptions options{.rounds = 1, .seed = 7};
  const LevelBed bed = levelBed(icra2021Scene());
  const Exploration once = explore(icra2021Scene(), bed, options);
  EXPECT_EQ(explore(icra2021Scene(), options).summary.mean_force_n, once.summary.mean_force_n);
  EXPECT_NE(explore(icra2021Scene(), bed, {.rounds = 1, .seed = 8}).summary.mean_force_n, once.summary.mean_force_n);
}

TEST(Exploration, WithoutVariationRepeatsItselfWhateverTheSeed) {
  const LevelBed bed = levelBed(icra2021Scene());
  const Exploration one = explore(icra2021Scene(), bed, {.rounds = 1, .seed = 1, .variation = 0});
  const Exploration other = explore(icra2021Scene(), bed, {.rounds = 1, .seed = 2, .variation = 0});
  EXPECT_EQ(one.summary.mean_force_n, other.summary.mean_force_n);
}

TEST(Exploration, LastsItsRounds) {
  const Exploration done = explore(icra2021Scene(), {.rounds = 3, .variation = 0});
  EXPECT_NEAR(done.summary.duration_s, 3 * icra2021Scene().hand.period_s, 0.002);
}

TEST(Exploration, DrawsHandsAroundTheScenes) {
  const HandParameters usual = icra2021Scene().hand;
  bool mirrored = false;
  int turns = 0;
  double sum_m = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const ExploringHand drawn = exploringHand(icra2021Scene(), {.motion = HandMotion::kPress, .seed = seed});
    EXPECT_NEAR(drawn.hand.home_m.x(), usual.home_m.x(), 0.005);
    EXPECT_NEAR(drawn.hand.period_s / usual.period_s, 1, 0.1);
    EXPECT_DOUBLE_EQ(drawn.hand.mass_kg / usual.mass_kg, drawn.hand.stiffness_n_m / usual.stiffness_n_m);
    EXPECT_EQ(drawn.hand.motion, HandMotion::kPress);
    mirrored = mirrored || drawn.mirrored;
    turns |= 1 << drawn.quarter_turns;
    sum_m += drawn.hand.home_m.y();
  }
  EXPECT_TRUE(mirrored);
  EXPECT_EQ(turns, 0b1111);
  EXPECT_NEAR(sum_m / 200, usual.home_m.y(), 0.001);  // 4.9 standard errors
}

TEST(Exploration, FeelsTheSameWhenHandAndSoilAreMirrored) {
  const LevelBed bed = levelBed(icra2021Scene());
  ExploringHand hand{.hand = icra2021Scene().hand};
  hand.hand.motion = HandMotion::kPress;
  hand.hand.home_m.y() = 0.004;
  const double here_n = explore(icra2021Scene(), bed, hand, 1).summary.mean_force_n;
  hand.hand.home_m.y() = -0.004;
  const double there_n = explore(icra2021Scene(), bed, hand, 1).summary.mean_force_n;
  hand.mirrored = true;
  const double mirrored_n = explore(icra2021Scene(), bed, hand, 1).summary.mean_force_n;
  EXPECT_NEAR(mirrored_n, here_n, 1e-5 * here_n);
  EXPECT_GT(std::abs(there_n - here_n), 1e-4 * here_n);
}

TEST(Exploration, MeetsMoreResistanceWhereThereIsMoreFriction) {
  const ExplorationOptions stir{.rounds = 1, .variation = 0};
  EXPECT_GT(explore(icra2021Scene("P1"), stir).summary.mean_force_n,
            1.2 * explore(icra2021Scene("P6"), stir).summary.mean_force_n);
}

TEST(Exploration, OnlyLiftingCarries) {
  EXPECT_TRUE(std::isnan(explore(icra2021Scene(), {.motion = HandMotion::kPress, .rounds = 1}).carried_n));
  EXPECT_TRUE(std::isfinite(explore(icra2021Scene(), {.motion = HandMotion::kScoop, .rounds = 1}).carried_n));
}

TEST(Exploration, FeelsTheWeightOfTheGrainsOnTheTool) {
  const SceneFile earth = grains("Earth");
  const LevelBed bed = levelBed(earth);
  int right = 0;  // now and then a grain jams between the tool and a wall
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Exploration scoop = explore(earth, bed, {.motion = HandMotion::kScoop, .rounds = 1, .seed = seed});
    const double weight_n = scoop.carried_kg * 9.807;
    EXPECT_GT(weight_n, 0.02);
    right += std::abs(scoop.carried_n - weight_n) < 0.12 * weight_n ? 1 : 0;
  }
  EXPECT_GE(right, 4);
}

TEST(Exploration, FeelsNoWeightWithoutGravity) {
  SceneFile scene = grains("Moon");
  const LevelBed bed = levelBed(scene);
  scene.bed.gravity_m_s2 = Vec3::Zero();
  const Exploration scoop = explore(scene, bed, {.motion = HandMotion::kScoop, .rounds = 1});
  EXPECT_NEAR(scoop.carried_n, 0, 0.01);  // on Earth about 0.08
}

/// A built-in scene whose soil is so deep, packed instead of settled: at rest at once.
SceneFile filled(const char* scene, double depth_m) {
  SceneFile filled = findSceneFile(scene);
  filled.bed.start = BedStart::kPacked;
  filled.bed.depth_m = depth_m;
  return filled;
}

TEST(Exploration, FeelsHowHighSoilReaches) {
  const auto felt_m = [](double depth_m) {
    const SceneFile scene = filled("soil-surface", depth_m);
    const LevelBed bed = levelBed(scene);
    // The tip is half the rod's length below its middle.
    return explore(scene, bed, {.motion = HandMotion::kPress, .rounds = 2}).touched_up_to_m - 0.030 - bed.surface_m;
  };
  const double radius_m = findSceneFile("soil-surface").bed.soil.radius_m;
  for (const double depth_m : {0.028, 0.040, 0.052}) {
    EXPECT_NEAR(felt_m(depth_m), 0, 1.5 * radius_m) << depth_m;
  }
}

TEST(Exploration, FeelsNoSoilAboveIt) {
  SceneFile above = filled("soil-surface", 0.028);
  above.hand.surface_m = 0.2;
  EXPECT_TRUE(std::isnan(explore(above, {.motion = HandMotion::kPress, .rounds = 1}).touched_up_to_m));
}

TEST(Exploration, SeesWhatAScoopWithSidesCarries) {
  const auto scooped = [](double depth_m) {
    return explore(filled("scoop-load", depth_m), {.motion = HandMotion::kScoop, .rounds = 1, .variation = 0});
  };
  const Exploration little = scooped(0.006);
  const Exploration much = scooped(0.020);
  EXPECT_GT(much.seen.load_m, 1.2 * little.seen.load_m);
  const double volume_m3 = std::pow(much.seen.load_m, 3);
  EXPECT_NEAR(volume_m3 * findSceneFile("scoop-load").bed.soil.rho0_kg_m3, much.carried_kg, 1e-12);
  EXPECT_NEAR(much.carried_n, 9.807 * much.carried_kg, 0.2 * much.carried_n);  // it is still lifting, and losing some
}

TEST(Picture, IsWhatTheSurfaceDoes) {
  BedParameters bed;
  bed.width_m = bed.length_m = 0.028;  // two cells each way, of 14 mm
  const double r = bed.soil.radius_m;
  // Four particles on top, one hidden below another.
  const std::vector<Vec3> before_m{{-r, -r, 0.030}, {r, -r, 0.030}, {-r, r, 0.030}, {r, r, 0.030}, {r, r, 0.010}};
  std::vector<Vec3> after_m = before_m;
  EXPECT_EQ(pictureOf(before_m, after_m, bed).heave_m, 0);
  EXPECT_EQ(pictureOf(before_m, after_m, bed).moved_m, 0);
  EXPECT_NEAR(pictureOf(before_m, after_m, bed).height_m, 0.030 + r, 1e-12);
  after_m[4].z() = 0.002;  // not seen
  EXPECT_EQ(pictureOf(before_m, after_m, bed).moved_m, 0);
  after_m[0].z() = 0.034;
  after_m[1].z() = 0.022;
  const Picture seen = pictureOf(before_m, after_m, bed);
  EXPECT_NEAR(seen.heave_m, 0.004, 1e-12);
  EXPECT_NEAR(seen.hollow_m, 0.008, 1e-12);
  EXPECT_NEAR(seen.moved_m, (0.004 + 0.008) / 4, 1e-12);
}

TEST(Exploration, MeetsAStoneFromAnySideOfTheBed) {
  SceneFile scene = findSceneFile("buried-stone");
  scene.bed.start = BedStart::kPacked;
  scene.bed.stones.placed[0].x_m = 0.03;
  scene.hand.period_s = 1;
  const LevelBed bed = levelBed(scene);
  ASSERT_EQ(bed.lying.stones.size(), 1U);
  ExploringHand over_stone{.hand = scene.hand}, elsewhere{.hand = scene.hand};
  over_stone.hand.home_m.x() = elsewhere.hand.home_m.x() = 0.03;
  const double over_n = explore(scene, bed, over_stone, 1).summary.peak_force_n;
  elsewhere.quarter_turns = 2;
  EXPECT_GT(over_n, 1.5 * explore(scene, bed, elsewhere, 1).summary.peak_force_n);
  over_stone.quarter_turns = 1;  // the stone with its soil
  over_stone.hand.home_m = Vec3(0, 0.03, scene.hand.home_m.z());
  EXPECT_NEAR(explore(scene, bed, over_stone, 1).summary.peak_force_n, over_n, 0.05 * over_n);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    EXPECT_FALSE(exploringHand(scene, {.motion = HandMotion::kPress, .seed = seed}).mirrored);
  }
}

TEST(Exploration, RefusesNonsense) {
  EXPECT_THROW((void)explore(icra2021Scene(), {.motion = HandMotion::kPoses}), InvalidParameter);
  EXPECT_THROW((void)explore(icra2021Scene(), {.rounds = 0}), InvalidParameter);
  EXPECT_THROW((void)explore(icra2021Scene(), {.variation = -0.1}), InvalidParameter);
  EXPECT_THROW((void)explore(icra2021Scene(), {.variation = 2.1}), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
