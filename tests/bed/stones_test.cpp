// Stones against closed-form mechanics, alone in a box and in soil.

#include "haptolith/bed/stones.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/bed/critical_step.h"
#include "haptolith/core/math/random.h"

namespace haptolith {
namespace {

using testing::DoubleNear;
using testing::HasSubstr;

constexpr double kMoon_m_s2 = 1.625;
constexpr double kFriction = 0.5;

SoilParameters soilWithFriction() {
  SoilParameters soil;
  soil.friction = FrictionModel::kContact;
  soil.contact_friction = kFriction;
  soil.stiffness_n_m = 400;
  soil.gamma_nm = linearGamma(soil);
  return soil;
}

/// A wide box of which one particle, far in a corner, is all the soil.
BedParameters emptyBox() {
  BedParameters bed;
  bed.soil = soilWithFriction();
  bed.width_m = 3;
  bed.length_m = 3;
  bed.sleep = false;
  bed.gravity_m_s2 = Vec3::Zero();
  return bed;
}

PlacedStone ball(double size_m, const Vec3& place_m) {
  return {
      .form = StoneForm::kSphere, .size_m = size_m, .x_m = place_m.x(), .y_m = place_m.y(), .depth_m = -place_m.z()};
}

PlacedStone clump(std::vector<StoneSphere> spheres, const Vec3& place_m) {
  return {.form = StoneForm::kSpheres,
          .spheres = std::move(spheres),
          .x_m = place_m.x(),
          .y_m = place_m.y(),
          .depth_m = -place_m.z()};
}

/// A bed of nothing but stones, at heights above the floor.
Bed stonesOnly(BedParameters bed, std::vector<PlacedStone> stones) {
  const double corner_m = -bed.width_m / 2 + 2 * bed.soil.radius_m;
  const Vec3 far(corner_m, corner_m, bed.soil.radius_m);
  for (PlacedStone& stone : stones) {
    stone.depth_m += 2 * bed.soil.radius_m;  // from the particle's top
  }
  bed.stones.placed = std::move(stones);
  return {bed, std::vector<Vec3>{far}};
}

double stepOf(const Bed& bed) {
  return bed.parameters().tick_s / substepsFor(bed.parameters(), 0);
}

void run(Bed& bed, double time_s) {
  const double dt_s = stepOf(bed);
  for (int i = 0; i < std::lround(time_s / dt_s); ++i) {
    ASSERT_EQ(bed.step(dt_s), StepStatus::kOk);
  }
}

/// Until all of it sleeps, and a while longer: how long that takes differs between processors, whose bits differ.
void runUntilAsleep(Bed& bed, double longest_s) {
  for (double time_s = 0; time_s < longest_s && (time_s < 2 || bed.awake() > 0); time_s += 0.1) {
    run(bed, 0.1);
  }
}

/// Gravity in a box whose floor is a slope that falls towards +x.
Vec3 downSlope(double angle_deg) {
  const double angle = angle_deg * std::numbers::pi / 180;
  return kMoon_m_s2 * Vec3(std::sin(angle), 0, -std::cos(angle));
}

/// Approximate depth of a stone in the floor under its own weight.
void putOnFloor(Bed& bed) {
  const Stones& stones = bed.stones();
  double lowest_m = 1;
  for (std::size_t s = 0; s < stones.spheres(0).size(); ++s) {
    lowest_m = std::min(lowest_m, stones.spheres(0)[s].z() - stones.shape(0)->spheres[s].radius_m);
  }
  Pose pose = stones.pose(0);
  pose.position_m.z() -= lowest_m;
  bed.stones().place(0, pose);
}

std::vector<StoneSphere> table() {  // flat and wide: it does not topple
  std::vector<StoneSphere> spheres;
  for (const double x : {-0.02, 0.0, 0.02}) {
    for (const double y : {-0.02, 0.0, 0.02}) {
      spheres.push_back({Vec3(x, y, 0), 0.011});
    }
  }
  return spheres;
}

TEST(Stones, Fall) {
  BedParameters box = emptyBox();
  box.gravity_m_s2 = {0, 0, -kMoon_m_s2};
  Bed bed = stonesOnly(box, {ball(0.04, {0, 0, 0.5})});
  run(bed, 0.5);
  EXPECT_THAT(0.5 - bed.stones().pose(0).position_m.z(), DoubleNear(kMoon_m_s2 * 0.125, 0.002 * kMoon_m_s2 * 0.125));
  EXPECT_THAT(bed.stones().twist(0).linear_m_s.z(), DoubleNear(-kMoon_m_s2 * 0.5, 1e-9));
}

TEST(Stones, SlideDownASlopeAsCoulombSays) {
  BedParameters box = emptyBox();
  const double angle = 40 * std::numbers::pi / 180;
  box.gravity_m_s2 = downSlope(40);
  Bed bed = stonesOnly(box, {clump(table(), {0, 0, 0.05})});
  putOnFloor(bed);
  run(bed, 0.2);  // the springs of its contacts settle
  const double before = bed.stones().twist(0).linear_m_s.x();
  run(bed, 0.5);
  const double wanted = kMoon_m_s2 * (std::sin(angle) - kFriction * std::cos(angle));
  EXPECT_THAT((bed.stones().twist(0).linear_m_s.x() - before) / 0.5, DoubleNear(wanted, 0.02 * wanted));
  EXPECT_LT(bed.stones().twist(0).angular_rad_s.norm(), 0.05);
}

TEST(Stones, StayOnASlopeBelowTheAngleOfFriction) {
  BedParameters box = emptyBox();
  box.gravity_m_s2 = downSlope(24);  // atan 0.5 = 26.6
  Bed bed = stonesOnly(box, {clump(table(), {0, 0, 0.05})});
  putOnFloor(bed);
  run(bed, 1);
  const double x_m = bed.stones().pose(0).position_m.x();
  run(bed, 2);
  EXPECT_THAT(bed.stones().pose(0).position_m.x(), DoubleNear(x_m, 1e-7));
  EXPECT_LT(bed.stones().largestSpeed(), 1e-6);
}

TEST(Stones, RollDownASlope) {
  BedParameters box = emptyBox();
  const double angle = 20 * std::numbers::pi / 180;
  box.gravity_m_s2 = downSlope(20);
  Bed bed = stonesOnly(box, {ball(0.04, {0, 0, 0.02})});
  run(bed, 0.2);
  const double before = bed.stones().twist(0).linear_m_s.x();
  run(bed, 0.5);
  const double wanted = 5.0 / 7 * kMoon_m_s2 * std::sin(angle);
  EXPECT_THAT((bed.stones().twist(0).linear_m_s.x() - before) / 0.5, DoubleNear(wanted, 0.02 * wanted));
  // It rolls without sliding.
  const Twist twist = bed.stones().twist(0);
  EXPECT_THAT(twist.angular_rad_s.y() * 0.02, DoubleNear(twist.linear_m_s.x(), 0.02 * twist.linear_m_s.x()));
}

TEST(Stones, ABackSpinTurnsIntoRolling) {
  // A sphere that slides without rotation rolls in the end with 5/7 of its speed, however strong the friction.
  BedParameters box = emptyBox();
  box.gravity_m_s2 = {0, 0, -kMoon_m_s2};
  Bed bed = stonesOnly(box, {ball(0.04, {-1, 0, 0.02})});
  bed.stones().place(0, bed.stones().pose(0), {Vec3(0.3, 0, 0), Vec3::Zero()});
  run(bed, 1);
  EXPECT_THAT(bed.stones().twist(0).linear_m_s.x(), DoubleNear(0.3 * 5 / 7, 0.02 * 0.3 * 5 / 7));
}

TEST(Stones, SpinFreelyAsEulerSays) {
  BedParameters box = emptyBox();
  // Two equal spheres: a symmetric top, whose axis precesses about its angular momentum with L / I_across.
  Bed bed = stonesOnly(box, {clump({{Vec3(0.015, 0, 0), 0.02}, {Vec3(-0.015, 0, 0), 0.02}}, {0, 0, 1})});
  Stones& stones = bed.stones();
  int along = 0;
  stones.inertia(0).minCoeff(&along);
  const double across_kg_m2 = stones.inertia(0).maxCoeff();
  const Pose start = stones.pose(0);
  const Vec3 axis = start.orientation * Vec3(Vec3::Unit(along));
  const Vec3 beside = axis.unitOrthogonal();
  stones.place(0, start, {Vec3(0.1, 0.05, 0), 20 * axis + 10 * beside});
  const Vec3 momentum = stones.state().stones[0].angular_momentum_nms;
  const double energy = bed.energy();
  const double time_s = 1.5;
  run(bed, time_s);
  EXPECT_EQ(stones.state().stones[0].angular_momentum_nms, momentum);
  EXPECT_THAT(bed.energy(), DoubleNear(energy, 1e-5 * energy));
  const double turned = momentum.norm() / across_kg_m2 * time_s;  // several turns
  const Vec3 wanted = Eigen::AngleAxisd(turned, momentum.normalized()) * axis;
  EXPECT_LT((stones.pose(0).orientation * Vec3(Vec3::Unit(along)) - wanted).norm(), 0.02);
}

TEST(Stones, ATumblingStoneKeepsItsEnergy) {
  BedParameters box = emptyBox();
  Bed bed = stonesOnly(
      box, {clump({{Vec3(0.02, 0, 0), 0.02}, {Vec3(-0.02, 0, 0), 0.015}, {Vec3(0, 0.012, 0), 0.015}}, {0, 0, 1})});
  Stones& stones = bed.stones();
  int middle = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec3 moments = stones.inertia(0);
    middle = moments[i] > moments.minCoeff() && moments[i] < moments.maxCoeff() ? i : middle;
  }
  const Vec3 spin = stones.pose(0).orientation * Vec3(15 * Vec3::Unit(middle) + Vec3::Constant(0.1));
  stones.place(0, stones.pose(0), {Vec3::Zero(), spin});  // about the axis on which nothing spins steadily
  const double energy = bed.energy();
  double most = 0;
  for (int i = 0; i < 100; ++i) {
    run(bed, 0.1);
    most = std::max(most, std::abs(bed.energy() / energy - 1));
  }
  EXPECT_LT(most, 1e-4);
}

/// Collision of two spheres: speed of the first before and after, relative to the second, along their line.
double restitution(double damping_ratio) {
  BedParameters box = emptyBox();
  box.soil.damping_ratio = damping_ratio;
  Bed bed = stonesOnly(box, {ball(0.04, {-0.03, 0, 1}), ball(0.04, {0.03, 0, 1})});
  bed.stones().place(0, bed.stones().pose(0), {Vec3(0.1, 0, 0), Vec3::Zero()});
  bed.stones().place(1, bed.stones().pose(1), {Vec3(-0.1, 0, 0), Vec3::Zero()});
  run(bed, 0.5);
  return (bed.stones().twist(1).linear_m_s.x() - bed.stones().twist(0).linear_m_s.x()) / 0.2;
}

TEST(Stones, CollideWithTheRestitutionOfTheirDamping) {
  EXPECT_THAT(restitution(0), DoubleNear(1, 0.005));
  // A damped spring that never pulls, from where force begins to where it ends (Schwager and Poeschel 2007).
  const double zeta = 0.2;
  const double root = std::sqrt(1 - zeta * zeta);
  const double wanted = std::exp(-zeta / root * (std::numbers::pi - std::atan2(2 * zeta * root, 1 - 2 * zeta * zeta)));
  EXPECT_THAT(restitution(zeta), DoubleNear(wanted, 0.02 * wanted));
}

TEST(Stones, KeepBothMomentaWhenTheyCollide) {
  BedParameters box = emptyBox();
  std::vector<PlacedStone> placed;
  std::mt19937_64 random(3);
  for (int i = 0; i < 12; ++i) {
    const Vec3 place(0.08 * (i % 3 - 1), 0.08 * (i / 3 - 1.5), 1);
    placed.push_back(i % 2 == 0 ? ball(0.05, place)
                                : clump({{Vec3(0.012, 0, 0), 0.018}, {Vec3(-0.012, 0.004, 0.01), 0.02}}, place));
  }
  Bed bed = stonesOnly(box, placed);
  Stones& stones = bed.stones();
  for (std::size_t i = 0; i < stones.size(); ++i) {  // towards each other, and turning
    const Vec3 inwards = -0.5 * (stones.pose(i).position_m - Vec3(0, 0, 1));
    const Vec3 noise(uniformSigned(random), uniformSigned(random), uniformSigned(random));
    stones.place(i, stones.pose(i), {inwards + 0.02 * noise, 5 * noise});
  }
  const auto momenta = [&] {
    Vec3 linear = Vec3::Zero();
    Vec3 angular = Vec3::Zero();
    for (std::size_t i = 0; i < stones.size(); ++i) {
      const Vec3 p = stones.mass(i) * stones.twist(i).linear_m_s;
      linear += p;
      angular += stones.pose(i).position_m.cross(p) + stones.state().stones[i].angular_momentum_nms;
    }
    return std::pair(linear, angular);
  };
  const auto [linear, angular] = momenta();
  double energy = bed.energy();
  const double first = energy;
  for (int i = 0; i < 100; ++i) {
    run(bed, 0.02);
    EXPECT_LE(bed.energy(), energy + 0.001 * first) << i;
    energy = std::min(energy, bed.energy());
  }
  EXPECT_LT(energy, 0.9 * first) << "they have not met";
  const auto [linear_after, angular_after] = momenta();
  EXPECT_LT((linear_after - linear).norm(), 1e-14);
  // Semi-implicit steps keep it to rounding: forces act at one point, and places move along the new speeds.
  EXPECT_LT((angular_after - angular).norm(), 1e-14);
}

// In soil.

BedParameters soilWithStones() {
  BedParameters bed;
  bed.soil = soilWithFriction();
  bed.start = BedStart::kSettled;
  bed.width_m = 0.2;
  bed.length_m = 0.16;
  bed.depth_m = 0.06;
  bed.sleep_speed_m_s = 0.01;
  bed.sleep_distance_m = 7e-5;
  bed.stones.count = 4;
  bed.stones.smallest_m = 0.025;
  bed.stones.largest_m = 0.04;
  bed.stones.placed = {ball(0.04, {0, 0, -0.015})};
  return bed;
}

/// Mean height of the highest tenth of all grains: one of them alone may ride on a stone.
double heightOfTopTenth(const Bed& bed) {
  std::vector<float> heights_m;
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    heights_m.push_back(bed.state().position[i].z);
  }
  std::ranges::sort(heights_m, std::greater());
  const auto tenth = static_cast<std::ptrdiff_t>(heights_m.size() / 10);
  return std::accumulate(heights_m.begin(), heights_m.begin() + tenth, 0.0) / static_cast<double>(tenth);
}

TEST(Stones, LieInSoilThatCarriesThem) {
  Bed bed(soilWithStones());
  ASSERT_EQ(bed.stones().size(), 5U);
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < bed.stones().size(); ++i) {
    places.push_back(bed.stones().pose(i).position_m);
  }
  runUntilAsleep(bed, 12);
  for (std::size_t i = 0; i < bed.stones().size(); ++i) {
    EXPECT_LT((bed.stones().pose(i).position_m - places[i]).norm(), 0.1 * bed.parameters().soil.radius_m) << i;
    EXPECT_TRUE(bed.stones().asleep(i)) << i;
  }
  EXPECT_EQ(bed.awake(), 0U);
  // They are where soil would be, and the rest of it lies as before.
  BedParameters without = soilWithStones();
  without.stones = {};
  const Bed level(without);
  EXPECT_LT(bed.particles(), level.particles());
  EXPECT_NEAR(heightOfTopTenth(bed), heightOfTopTenth(level), 0.3 * bed.parameters().soil.radius_m);
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    const Float4& p = bed.state().position[i];
    EXPECT_LT(bed.stones().depthOf({p.x, p.y, p.z}, bed.parameters().soil.radius_m + p.w), 2e-3) << i;
  }
}

/// Grains around a point.
int grainsWithin(const Bed& bed, const Vec3& middle_m, double radius_m) {
  int count = 0;
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    const Float4& p = bed.state().position[i];
    count += (Vec3(p.x, p.y, p.z) - middle_m).norm() < radius_m ? 1 : 0;
  }
  return count;
}

TEST(Stones, SoilAroundThemIsAsDenseAsElsewhere) {
  constexpr double kStone_m = 0.02;
  constexpr double kAround_m = 0.045;
  BedParameters parameters = soilWithStones();
  parameters.depth_m = 0.1;
  parameters.stones = {};
  const Bed level(parameters);
  parameters.stones.placed = {ball(2 * kStone_m, {0, 0, -0.05})};
  parameters.stones.placed[0].fixed = true;
  const Bed bed(parameters);
  const Vec3 middle = bed.stones().pose(0).position_m;
  const int with = grainsWithin(bed, middle, kAround_m);
  const int without = grainsWithin(level, middle, kAround_m);
  // Soil is looser next to a wall, as if the wall were 0.35 R further out.
  const double taken = std::pow((kStone_m + 0.35 * soilWithStones().soil.radius_m) / kAround_m, 3);
  EXPECT_NEAR(with, (1 - taken) * without, 0.05 * without) << without;
}

TEST(Stones, WakeWhatTheyTouchAndAreWokenByIt) {
  Bed bed(soilWithStones());
  runUntilAsleep(bed, 12);
  ASSERT_EQ(bed.awake(), 0U);
  const double dt_s = stepOf(bed);
  const Vec3 start = bed.stones().pose(0).position_m;
  for (int i = 0; i < 200; ++i) {
    bed.stones().push(0, {0, 0, 0.4}, bed.stones().pose(0).position_m);  // its weight is 0.16 N
    ASSERT_EQ(bed.step(dt_s), StepStatus::kOk);
  }
  EXPECT_GT((bed.stones().pose(0).position_m - start).z(), 2e-3);
  EXPECT_GT(bed.awake(), 0U);
  run(bed, 4);
  EXPECT_TRUE(bed.stones().asleep(0));
  EXPECT_EQ(bed.awake(), 0U);
}

TEST(Stones, GiveTheSameBitsForAnyNumberOfThreadsAndFromASavedState) {
  const auto pushed = [](Bed& bed, int steps) {
    const double dt_s = stepOf(bed);
    for (int i = 0; i < steps; ++i) {
      bed.stones().push(0, {0.5, 0.1, 1}, bed.stones().pose(0).position_m + Vec3(0, 0.01, 0));
      ASSERT_EQ(bed.step(dt_s), StepStatus::kOk);
    }
  };
  BedParameters parameters = soilWithStones();
  parameters.sleep = false;
  parameters.width_m = 0.3;
  Bed one(parameters);
  parameters.threads = 3;
  Bed three(parameters);
  pushed(one, 500);
  pushed(three, 500);
  EXPECT_EQ(one.hash(), three.hash());
  const SavedBed saved = deserialiseSavedBed(serialise(one.save()));
  Bed restored(parameters, saved);
  EXPECT_EQ(restored.hash(), one.hash());
  pushed(one, 500);
  pushed(restored, 500);
  EXPECT_EQ(restored.hash(), one.hash());
  three.restore(saved);
  pushed(three, 500);
  EXPECT_EQ(three.hash(), one.hash());
}

TEST(Stones, FixedOnesStayWhateverPushes) {
  BedParameters parameters = soilWithStones();
  parameters.stones.placed[0].fixed = true;
  Bed bed(parameters);
  const Vec3 place = bed.stones().pose(0).position_m;
  const double dt_s = stepOf(bed);
  for (int i = 0; i < 300; ++i) {
    bed.stones().push(0, {0, 0, 30}, place);
    ASSERT_EQ(bed.step(dt_s), StepStatus::kOk);
  }
  EXPECT_EQ(bed.stones().pose(0).position_m, place);
}

TEST(Stones, ThatAreNowhereStopTheBedAndNothingElse) {
  BedParameters parameters = soilWithStones();
  parameters.start = BedStart::kPacked;
  for (const double away_m : {std::nan(""), std::numeric_limits<double>::infinity(), 1e300, -1e300, 1e30}) {
    Bed bed(parameters);
    Pose pose = bed.stones().pose(0);
    pose.position_m.x() = away_m;
    bed.stones().place(0, pose);
    const StepStatus status = bed.step(stepOf(bed));  // a cell number of it would lie outside of all memory
    if (std::isfinite(away_m)) {
      continue;
    }
    EXPECT_EQ(status, StepStatus::kNotFinite) << away_m;
  }
}

TEST(Stones, SmallerThanStiffGrainsFindTheirHold) {
  BedParameters bed = soilWithStones();  // as ottawa-f65: what presses on a stone throws it out at 70 m/s
  bed.soil.stiffness_n_m = 24'000;
  bed.soil.gamma_nm = linearGamma(bed.soil);
  bed.width_m = 0.14;
  bed.length_m = 0.12;
  bed.depth_m = 0.04;
  bed.gravity_m_s2 = {0, 0, -0.2};
  bed.stones.placed.clear();
  bed.stones.count = 8;
  bed.stones.smallest_m = 7e-3;
  bed.stones.largest_m = 9.5e-3;
  for (const std::uint64_t seed : {14U, 15U, 16U}) {
    bed.stones.seed = seed;
    Bed made(bed);
    run(made, 0.1);
    EXPECT_LT(made.stones().largestSpeed(), 20) << seed;
  }
}

std::string refusalOfSteps(const BedParameters& bed) {
  try {
    (void)substepsFor(bed, 0);
  } catch (const InvalidParameter& error) {
    return error.what();
  }
  return "taken";
}

TEST(Stones, ThatAreLightTakeMoreStepsOrAreRefused) {
  BedParameters bed = soilWithStones();
  const int for_soil = substepsFor(bed.soil, 0, bed.tick_s, bed.max_substeps);
  EXPECT_EQ(substepsFor(bed, 0), for_soil) << "of some grains' weight: nothing changes";
  bed.stones.smallest_m = 5e-3;
  EXPECT_GT(substepsFor(bed, 0), for_soil);
  bed.stones.smallest_m = 1e-3;
  bed.max_substeps = 12;
  EXPECT_THAT(refusalOfSteps(bed), testing::AllOf(HasSubstr("stones.smallest_mm = 1 is"), HasSubstr("at 2900 kg/m3"),
                                                  HasSubstr("max_substeps = 12")));
  bed.stones.fixed = true;
  EXPECT_EQ(substepsFor(bed, 0), for_soil) << "what never moves has no step";
  bed.stones.placed.push_back(ball(1e-3, Vec3::Zero()));
  EXPECT_THAT(refusalOfSteps(bed), HasSubstr("size_mm of stone 2 = 1 is"));
  bed.max_substeps = 1000;
  EXPECT_GT(substepsFor(bed, 0), 12);
  bed.stones.placed.back() = clump({{Vec3(0, 0, 0), 1e-3}, {Vec3(1e-3, 0, 0), 1e-3}}, Vec3::Zero());
  bed.max_substeps = 5;
  EXPECT_THAT(refusalOfSteps(bed), HasSubstr("spheres_mm of stone 2 = 2 is"));
  // The minimum that it names is sufficient, and barely more.
  bed.stones = {};
  bed.stones.placed = {ball(1e-3, Vec3::Zero())};
  const std::string refusal = refusalOfSteps(bed);
  const double least_m = 1e-3 * std::stod(refusal.substr(refusal.find(">= ") + 3));
  bed.stones.placed[0].size_m = 1.01 * least_m;
  EXPECT_LE(substepsFor(bed, 0), 5);
  bed.stones.placed[0].size_m = 0.98 * least_m;
  EXPECT_NE(refusalOfSteps(bed), "taken");
}

TEST(Stones, OfAnySizeAndWeightStayNumbers) {
  std::mt19937_64 random(7);
  const auto between = [&](double low, double high) {
    return low * std::pow(high / low, (uniformSigned(random) + 1) / 2);
  };
  int simulated = 0;
  for (int i = 0; i < 24; ++i) {
    BedParameters bed = soilWithStones();
    bed.start = BedStart::kPacked;
    bed.width_m = bed.length_m = 0.14;
    bed.depth_m = 0.04;
    bed.gravity_m_s2 = {0, 0, -between(0.1, 100)};
    bed.soil.damping_ratio = i % 3 == 0 ? 0 : i % 3 == 1 ? 0.2 : 0.5;
    bed.soil.tangential_ratio = i % 2 == 0 ? 0.5 : 1;
    bed.stones = {};
    bed.stones.form = i % 2 == 0 ? StoneForm::kSphere : StoneForm::kRock;
    bed.stones.count = 6;
    bed.stones.smallest_m = between(1e-3, 0.02);
    bed.stones.largest_m = bed.stones.smallest_m * between(1, 2);
    bed.stones.density_kg_m3 = between(100, 25'000);
    bed.max_substeps = 40;
    SCOPED_TRACE(fmt::format("{} mm, {} kg/m3, {} m/s2", 1e3 * bed.stones.smallest_m, bed.stones.density_kg_m3,
                             -bed.gravity_m_s2.z()));
    if (refusalOfSteps(bed) != "taken") {
      continue;
    }
    ++simulated;
    Bed made(bed);
    run(made, 0.3);
    // As fast as what has fallen through the box and the stones above it, at most.
    EXPECT_LT(made.stones().largestSpeed(), 5 * std::sqrt(2 * -bed.gravity_m_s2.z() * 0.1));
  }
  EXPECT_GT(simulated, 16);
}

TEST(Stones, AreRefusedWhereTheyCannotBe) {
  const auto refusal = [](const BedParameters& bed) -> std::string {
    try {
      const Bed made(bed);
    } catch (const InvalidParameter& error) {
      return error.what();
    }
    return "taken";
  };
  BedParameters bed = soilWithStones();
  bed.soil.friction = FrictionModel::kIcra2021;
  EXPECT_THAT(refusal(bed), HasSubstr("friction_model = \"contact\""));
  bed = soilWithStones();
  bed.stones.placed[0].x_m = 0.095;
  EXPECT_THAT(refusal(bed), HasSubstr("completely in the box"));
  bed = soilWithStones();
  bed.stones.count = 500;
  EXPECT_THAT(refusal(bed), HasSubstr("found no room"));
  bed = soilWithStones();
  bed.stones.largest_m = 0.01;
  EXPECT_THAT(refusal(bed), HasSubstr("0.025"));
  Bed other(soilWithStones());
  SavedBed saved = other.save();
  saved.stones.stones[0].velocity_m_s.x() = std::nan("");
  EXPECT_THROW(other.restore(saved), InvalidParameter);
  saved.stones.stones.pop_back();
  EXPECT_THROW(other.restore(saved), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
