// The physics of one step, with numbers a person can compute by hand. Soil P4: gamma = 6e-5 N m, R = 7 mm, k = 100 N/m,
//
//     m = 4 sqrt(2) 1360 R^3 = 2.638809e-3 kg      a_min = 11.563433 mm    a_thr = a_min + sqrt(gamma/k) = 12.338030 mm
//     h = gamma / (2R - a_min) = 0.0246248 N      c = k dt / 2 = 0.05 N s/m at dt = 1 ms

#include "haptolith/bed/bed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "haptolith/core/error.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

constexpr double kTick_s = 1e-3;
constexpr double kMass_kg = 2.638809e-3;
constexpr double kWeight_n = kMass_kg * 1.625;
// Fraction of a velocity after damping by one contact in one step: 1 / (1 + dt c / m) = 1 / 1.0189479.
constexpr double kKeptByOneContact = 1 / 1.0189479;

BedParameters frictionless() {
  BedParameters bed;
  bed.soil = findPreset("P4").soil;
  bed.soil.mu_hat = 0;
  bed.gravity_m_s2 = Vec3::Zero();
  return bed;
}

BedParameters onTheMoon() {
  BedParameters bed;
  bed.soil = findPreset("P4").soil;
  return bed;
}

Vec3 position(const Bed& bed, std::size_t i) {
  const Float4& p = bed.state().position[i];
  return {p.x, p.y, p.z};
}

Vec3 velocity(const Bed& bed, std::size_t i) {
  const Float4& v = bed.state().velocity[i];
  return {v.x, v.y, v.z};
}

void setVelocity(Bed& bed, std::size_t i, const Vec3& v) {
  BedState state = bed.state();
  state.velocity[i] = {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), 0};
  bed.restore(state);
}

void push(Bed& bed, std::size_t i, const Vec3& force) {
  bed.externalForces()[i] = {static_cast<float>(force.x()), static_cast<float>(force.y()),
                             static_cast<float>(force.z()), 0};
}

/// Height at which the floor carries one particle's weight: F(2s) = m g, s = (a_min + gamma / (m g + h)) / 2.
double restingHeight() {
  return (11.563433e-3 + 6e-5 / (kWeight_n + 0.0246248)) / 2;
}

TEST(Bed, MassIsTheOneInThePaper) {
  EXPECT_NEAR(Bed(frictionless()).mass(), kMass_kg, 1e-8);
}

// --- contact --------------------------------------------------------------------------------------------------------

TEST(Contact, TwoParticlesPushEachOtherApart) {
  // F(13 mm) = 6e-5 / 1.436567e-3 - 0.0246248 = 0.0171414 N; 6.4959 m/s^2. One contact each.
  Bed bed(frictionless(), {Vec3(0, 0, 0.05), Vec3(0, 0, 0.063)});
  ASSERT_EQ(bed.step(kTick_s), StepStatus::kOk);
  const double expected = 6.495898e-3 * kKeptByOneContact;
  // A distance of 13 mm between floats near 60 mm is known to 4e-9 m; the slope there is 29 N/m: 1e-7 N of 0.017 N.
  EXPECT_NEAR(velocity(bed, 1).z(), expected, 2e-5 * expected);
  EXPECT_EQ(velocity(bed, 0), -velocity(bed, 1));
  EXPECT_EQ(velocity(bed, 0).head<2>(), Eigen::Vector2d::Zero());
}

TEST(Contact, TheLineTakesOverBelowTheThreshold) {
  // 12 mm is 0.338 mm below a_thr: F = F(a_thr) + 100 * 0.338030e-3 = (0.0774597 - 0.0246248) + 0.033803 = 0.0866379 N.
  Bed bed(frictionless(), {Vec3(0, 0, 0.05), Vec3(0.012, 0, 0.05)});
  ASSERT_EQ(bed.step(kTick_s), StepStatus::kOk);
  const double expected = 1e-3 * 0.0866379 / kMass_kg * kKeptByOneContact;
  EXPECT_NEAR(velocity(bed, 1).x(), expected, 2e-5 * expected);
}

TEST(Contact, ParticlesApartAttractWithoutDampingOrFriction) {
  // 14.5 mm is between 2R and 2 R_attr = 15.4 mm: F = 6e-5 / 2.936567e-3 - 0.0246248 = -4.192790e-3 N. p counts
  // overlaps.
  BedParameters parameters = frictionless();
  parameters.soil.mu_hat = 0.3;  // attraction adds nothing to the sum of (14): nothing holds them
  Bed bed(parameters, {Vec3(0, 0, 0.05), Vec3(0, 0.0145, 0.05)});
  ASSERT_EQ(bed.step(kTick_s), StepStatus::kOk);
  const double expected = 1e-3 * 4.192790e-3 / kMass_kg;
  EXPECT_NEAR(velocity(bed, 0).y(), expected, 5e-5 * expected);
  EXPECT_EQ(velocity(bed, 0), -velocity(bed, 1));
}

TEST(Contact, ParticlesBeyondTheCutoffDoNotFeelEachOther) {
  Bed bed(frictionless(), {Vec3(0, 0, 0.05), Vec3(0, 0.01541, 0.05)});
  const std::uint64_t before = stateHash(bed.state());
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(bed.step(kTick_s), StepStatus::kOk);
  }
  BedState after = bed.state();
  after.step = 0;
  EXPECT_EQ(stateHash(after), before);
}

TEST(Contact, ForcesInACrowdAddUpToNothing) {
  // Action = reaction. Damping (paper 20) takes momentum from the whole, because it brakes against empty space; at a
  // step of 1 us its share is 20 contacts * k dt^2 / 2m = 4e-7.
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> anywhere(-0.03, 0.03);
  std::vector<Vec3> centres;
  for (int i = 0; i < 200; ++i) {
    centres.emplace_back(anywhere(random), anywhere(random), 0.06 + anywhere(random));
  }
  Bed bed(frictionless(), centres);
  ASSERT_EQ(bed.step(1e-6), StepStatus::kOk);
  Vec3 sum = Vec3::Zero();
  double total = 0;
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    sum += velocity(bed, i);
    total += velocity(bed, i).norm();
  }
  EXPECT_GT(total, 1e-3);
  EXPECT_LT(sum.norm(), 1e-6 * total);
}

TEST(Contact, TwoParticlesKeepTheirMomentumToTheBit) {
  // p = 1 for both and opposite velocities: even damping takes as much from one as from the other.
  Bed bed(frictionless(), {Vec3(0, 0, 0.0625), Vec3(0.0125, 0, 0.0625)});
  for (int i = 0; i < 200; ++i) {
    ASSERT_EQ(bed.step(kTick_s), StepStatus::kOk);
    ASSERT_EQ(velocity(bed, 0), -velocity(bed, 1)) << i;
  }
}

TEST(Contact, ItDoesNotMatterWhichWayThePairLies) {
  const Vec3 middle(0, 0, 0.06);
  double first = 0;
  for (const Vec3& way : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, 1, 1), Vec3(-2, 1, 0.5)}) {
    const Vec3 arm = 0.0065 * way.normalized();
    Bed bed(frictionless(), {middle - arm, middle + arm});
    ASSERT_EQ(bed.step(kTick_s), StepStatus::kOk);
    const Vec3 v = velocity(bed, 1);
    first = first == 0 ? v.norm() : first;
    EXPECT_NEAR(v.norm(), first, 5e-5 * first);
    EXPECT_GT(v.dot(way.normalized()), (1 - 1e-6) * v.norm());
  }
}

// --- walls ----------------------------------------------------------------------------------------------------------

TEST(Wall, PushesLikeTheParticlesMirrorImage) {
  // s = 6.2 mm: F(12.4 mm) = 6e-5 / 0.836567e-3 - 0.0246248 = 0.0470969 N, one contact.
  Bed bed(frictionless(), {Vec3(0, 0, 0.0062)});
  ASSERT_EQ(bed.step(kTick_s), StepStatus::kOk);
  const double expected = 1e-3 * 0.0470969 / kMass_kg * kKeptByOneContact;
  EXPECT_NEAR(velocity(bed, 0).z(), expected, 2e-5 * expected);
}

TEST(Wall, AllFivePushAlikeAndInwards) {
  const double s = 0.0062;
  const double half_width = 0.07;
  const double half_length = 0.05;
  BedParameters parameters = frictionless();
  parameters.width_m = 2 * half_width;
  parameters.length_m = 2 * half_length;
  const double expected = 1e-3 * 0.0470969 / kMass_kg * kKeptByOneContact;
  const std::pair<Vec3, Vec3> cases[] = {{Vec3(0, 0, s), Vec3::UnitZ()},
                                         {Vec3(-half_width + s, 0, 0.5), Vec3::UnitX()},
                                         {Vec3(half_width - s, 0, 0.5), -Vec3::UnitX()},
                                         {Vec3(0, -half_length + s, 0.5), Vec3::UnitY()},
                                         {Vec3(0, half_length - s, 0.5), -Vec3::UnitY()}};
  for (const auto& [centre, inwards] : cases) {
    Bed bed(parameters, {centre});
    ASSERT_EQ(bed.step(kTick_s), StepStatus::kOk);
    // 70 mm as a float is wrong by up to 4e-9 m, so is the centre; twice that in a, at 86 N/m: 3e-5 of 0.047 N.
    EXPECT_LT((velocity(bed, 0) - expected * inwards).norm(), 5e-5 * expected);
  }
}

TEST(Wall, InACornerThreePushesAddUp) {
  Bed bed(frictionless(), {Vec3(-0.063 + 0.0062, 0.063 - 0.0062, 0.0062)});
  ASSERT_EQ(bed.step(kTick_s), StepStatus::kOk);
  const double expected = 1e-3 * 0.0470969 / kMass_kg / (1 + 3 * 0.0189479);  // three contacts damp
  EXPECT_LT((velocity(bed, 0) - expected * Vec3(1, -1, 1)).norm(), 1e-4 * expected);
}

TEST(Wall, NeverAttractsAndEndsAtOneRadius) {
  for (const double s : {0.00701, 0.0076, 0.02}) {
    Bed bed(frictionless(), {Vec3(0, 0, s)});
    ASSERT_EQ(bed.step(kTick_s), StepStatus::kOk);
    EXPECT_EQ(velocity(bed, 0), Vec3::Zero()) << s;
  }
  Bed touching(frictionless(), {Vec3(0, 0, 0.0069)});
  ASSERT_EQ(touching.step(kTick_s), StepStatus::kOk);
  EXPECT_GT(velocity(touching, 0).z(), 0);
}

TEST(Wall, PushesBackWhatIsBeyondIt) {
  Bed bed(frictionless(), {Vec3(0.08, 0, -0.01)});
  ASSERT_EQ(bed.step(kTick_s), StepStatus::kOk);
  EXPECT_LT(velocity(bed, 0).x(), 0);
  EXPECT_GT(velocity(bed, 0).z(), 0);
}

TEST(Wall, TheFloorCarriesAParticleAtTheHeightThatItsWeightAsksFor) {
  BedParameters parameters = onTheMoon();
  parameters.soil.mu_hat = 0;
  Bed bed(parameters, {Vec3(0, 0, 0.01)});  // falls 3 mm and settles
  for (int i = 0; i < 5000; ++i) {
    ASSERT_EQ(bed.step(kTick_s), StepStatus::kOk);
  }
  EXPECT_NEAR(restingHeight(), 6.8193e-3, 1e-7);
  EXPECT_NEAR(position(bed, 0).z(), restingHeight(), 2e-8);  // the weight over the floor's 22 N/m, to 1e-4
  EXPECT_LT(velocity(bed, 0).norm(), 1e-6);
}

// --- friction -------------------------------------------------------------------------------------------------------

/// A particle at rest on the floor of the Moon, and a push sideways in shares of what friction can hold.
class OnTheFloor {
 public:
  explicit OnTheFloor(double share_of_limit) { push(bed, 0, Vec3(0, share_of_limit * 0.3 * kWeight_n, 0)); }
  Bed bed{onTheMoon(), {Vec3(0, 0, restingHeight())}};
};

TEST(Friction, AParticleAtRestStaysExactlyAtRestUpToTheStaticLimit) {
  OnTheFloor pushed(0.999);
  Bed& bed = pushed.bed;
  const Vec3 start = position(bed, 0);
  for (int i = 0; i < 1000; ++i) {
    ASSERT_EQ(bed.step(kTick_s), StepStatus::kOk);
  }
  EXPECT_EQ(position(bed, 0), start);
  EXPECT_EQ(velocity(bed, 0), Vec3::Zero());
}

TEST(Friction, JustAboveTheStaticLimitItMovesAgainstTheSmallerMovingFriction) {
  OnTheFloor pushed(1.001);
  Bed& bed = pushed.bed;
  ASSERT_EQ(bed.step(kTick_s), StepStatus::kOk);
  // dt/m (1.001 mu N kept - lambda mu N), lambda = 0.8, mu N = 0.3 * weight.
  const double expected = 1e-3 / kMass_kg * 0.3 * kWeight_n * (1.001 * kKeptByOneContact - 0.8);
  EXPECT_NEAR(velocity(bed, 0).y(), expected, 1e-4 * expected);  // the resting height is right to 1e-8 m of 1e-4 m
}

TEST(Friction, AParticleInMotionIsBrakedAtTheMovingFriction) {
  Bed bed(onTheMoon(), {Vec3(0, 0, restingHeight())});
  setVelocity(bed, 0, Vec3(0.1, 0, 0));
  ASSERT_EQ(bed.step(kTick_s), StepStatus::kOk);
  const double expected = 0.1 * kKeptByOneContact - 1e-3 * 0.8 * 0.3 * 1.625;
  EXPECT_NEAR(velocity(bed, 0).x(), expected, 1e-6);
}

TEST(Friction, NeverTurnsAVelocityRoundAndEndsAtExactlyZero) {
  Bed bed(onTheMoon(), {Vec3(0, 0, restingHeight())});
  setVelocity(bed, 0, Vec3(0.003, -0.004, 0));
  double before = 0.005;
  int steps = 0;
  while (velocity(bed, 0).norm() > 0) {
    ASSERT_EQ(bed.step(kTick_s), StepStatus::kOk);
    const Vec3 v = velocity(bed, 0);
    ASSERT_LT(v.norm(), before);
    ASSERT_GE(v.x(), 0);
    ASSERT_LE(v.y(), 0);
    before = v.norm();
    ASSERT_LT(++steps, 100);
  }
  // 5 mm/s against 0.39 m/s^2 and a damping of 19 1/s: about 11 steps.
  EXPECT_GT(steps, 8);
  EXPECT_LE(steps, 13);
  const Vec3 stopped = position(bed, 0);
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(bed.step(kTick_s), StepStatus::kOk);
  }
  EXPECT_EQ(position(bed, 0), stopped);
}

TEST(Friction, AForceOfTheToolIsLoadAndRaisesNoFriction) {
  // Far from everything: any push moves the particle, however large mu_hat is.
  BedParameters parameters = frictionless();
  parameters.soil.mu_hat = 10;
  Bed bed(parameters, {Vec3(0, 0, 0.06)});
  push(bed, 0, Vec3(1e-6, 0, 0));
  ASSERT_EQ(bed.step(kTick_s), StepStatus::kOk);
  EXPECT_NEAR(velocity(bed, 0).x(), 1e-9 / kMass_kg, 1e-12);
}

// --- damping, gravity -----------------------------------------------------------------------------------------------

TEST(Damping, ContactsBrakeTheAbsoluteVelocity) {
  // Two that just overlap fly side by side: one contact each, and (20) leaves 1 / (1 + dt c / m) of v in every step.
  Bed bed(frictionless(), {Vec3(0, 0, 0.05), Vec3(0, 0, 0.05 + 0.01399)});
  for (const std::size_t i : {0, 1}) {
    setVelocity(bed, i, Vec3(0.5, 0, 0));
  }
  for (int step = 1; step <= 10; ++step) {
    ASSERT_EQ(bed.step(kTick_s), StepStatus::kOk);
    for (const std::size_t i : {0, 1}) {
      ASSERT_NEAR(velocity(bed, i).x(), 0.5 * std::pow(kKeptByOneContact, step), 2e-6) << step;
    }
  }
}

TEST(Damping, UsesTheStepThatIsReallyTaken) {
  Bed bed(frictionless(), {Vec3(0, 0, 0.05), Vec3(0, 0, 0.05 + 0.01399)});
  setVelocity(bed, 0, Vec3(0.5, 0, 0));
  ASSERT_EQ(bed.step(2e-3), StepStatus::kOk);
  // c = k 2 ms / 2 doubles and so does dt: dt c / m = 4 * 0.0189479.
  EXPECT_NEAR(velocity(bed, 0).x(), 0.5 / (1 + 4 * 0.0189479), 1e-6);
}

TEST(Gravity, FreeFallIsTheParabolaOfTheSemiImplicitStepInEveryDirection) {
  for (const Vec3& g : {Vec3(0, 0, -1.625), Vec3(1, -2, 3), Vec3(-9.81, 0, 0), Vec3(0, 0, 0)}) {
    BedParameters parameters = onTheMoon();
    parameters.gravity_m_s2 = g;
    parameters.width_m = parameters.length_m = 2;
    const Vec3 start(0.1, -0.2, 0.5);
    Bed bed(parameters, {start});
    for (int n = 1; n <= 100; ++n) {
      ASSERT_EQ(bed.step(kTick_s), StepStatus::kOk);
    }
    // v_n = n g dt, x_n = x_0 + g dt^2 n (n + 1) / 2; a hundred roundings of 3e-8 m.
    EXPECT_LT((velocity(bed, 0) - 0.1 * g).norm(), 1e-6 * (1 + g.norm()));
    EXPECT_LT((position(bed, 0) - start - 1e-6 * 5050 * g).norm(), 3e-6);
  }
}

// --- trouble --------------------------------------------------------------------------------------------------------

TEST(Bed, SaysWhenItsNumbersAreNumbersNoMore) {
  for (const double force : {std::nan(""), std::numeric_limits<double>::infinity(), 1e38}) {
    Bed bed(onTheMoon());
    push(bed, 100, Vec3(0, force, 0));
    EXPECT_EQ(bed.step(kTick_s), StepStatus::kNotFinite) << force;
    EXPECT_NE(bed.step(kTick_s), StepStatus::kOk) << "and it does not get better";
  }
}

TEST(Bed, SaysWhenItHasCollapsedOntoItself) {
  BedParameters parameters = onTheMoon();
  Bed bed(parameters);
  // All particles fly to one point: x_i + v_i dt = the middle. 256 in one place have more neighbours than any list.
  BedState state = bed.state();
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    state.velocity[i] = {-1000 * state.position[i].x, -1000 * state.position[i].y, 20 - 1000 * state.position[i].z, 0};
  }
  bed.restore(state);
  StepStatus status = StepStatus::kOk;
  for (int i = 0; i < 3 && status == StepStatus::kOk; ++i) {
    status = bed.step(kTick_s);
  }
  EXPECT_EQ(status, StepStatus::kCollapsed);
}

TEST(Bed, EveryStatusHasAText) {
  EXPECT_STREQ(text(StepStatus::kOk), "ok");
  EXPECT_NE(std::string(text(StepStatus::kNotFinite)), text(StepStatus::kCollapsed));
}

TEST(Bed, ABedWithoutParticlesStepsQuietly) {
  Bed bed(onTheMoon(), std::vector<Vec3>{});
  EXPECT_EQ(bed.step(kTick_s), StepStatus::kOk);
  EXPECT_EQ(bed.energy(), 0);
  EXPECT_EQ(bed.largestSpeed(), 0);
}

TEST(Bed, EnergyIsTheSumOfItsKinds) {
  // m g z + m v^2 / 2 of two particles; no contact.
  Bed bed(onTheMoon(), {Vec3(0, 0, 0.05), Vec3(0.03, 0, 0.02)});
  setVelocity(bed, 0, Vec3(0, 0.3, 0.4));
  EXPECT_NEAR(bed.energy(), kWeight_n * 0.07 + kMass_kg * 0.125, 1e-9);
  EXPECT_NEAR(bed.largestSpeed(), 0.5, 1e-7);
  EXPECT_NEAR(bed.surfaceHeight(), 0.057, 1e-8);
}

TEST(Bed, ContactEnergyIsTheWorkOfItsForces) {
  // A pair released without damping to speak of (1 us steps): what contact energy it loses becomes motion.
  Bed bed(frictionless(), {Vec3(0, 0, 0.05), Vec3(0, 0, 0.0625)});
  const double before = bed.energy();
  EXPECT_GT(before, 1e-6);
  for (int i = 0; i < 3000; ++i) {
    ASSERT_EQ(bed.step(1e-6), StepStatus::kOk);
  }
  const double moving = kMass_kg * velocity(bed, 0).squaredNorm();
  EXPECT_GT(moving, 0.1 * before);
  // The damping of 1 us steps (c = k dt / 2) eats c v / F = 1e-4 of it at most; float positions drift by 3000 roundings
  // of 2e-9 m in a worst case that never happens.
  EXPECT_NEAR(bed.energy(), before, 1e-3 * before);
}

}  // namespace
}  // namespace haptolith
