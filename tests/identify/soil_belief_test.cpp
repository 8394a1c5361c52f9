#include "haptolith/identify/soil_belief.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <string>

#include "made_up_training.h"

namespace haptolith {
namespace {

double angleOf(double friction) {
  return std::atan(friction) * 180 / std::numbers::pi;
}

MeasuredForces all(const WindowForces& forces) {
  return {forces.begin(), forces.end()};
}

class Identified : public testing::Test {
 protected:
  static constexpr double kScatter = 0.1, kGravity = 1.625;
  const MadeUpSoil soils_{kScatter};
  const Training training_ = soils_.training(150);
  const SoilIdentifier identifier_{training_};
  const SoilState moon_{42, 500, 0.36};
};

TEST_F(Identified, SoilIsFoundWithinItsIntervals) {
  const SoilBelief belief = identifier_.identify(all(soils_.forces(moon_, kGravity, 1000)), kGravity);
  EXPECT_NEAR(belief.friction_angle_deg.middle, 42, 3);
  EXPECT_NEAR(belief.cohesion_pa.middle, 500, 100);
  EXPECT_NEAR(belief.tool_friction_angle_deg.middle, angleOf(0.36), 3);
  EXPECT_NEAR(belief.peak_angle_deg.middle - belief.friction_angle_deg.middle, 4, 0.5);
  EXPECT_LT(belief.misfit, kStrange);
  EXPECT_GT(belief.samples, 200);
  EXPECT_TRUE(isIdentified(belief.friction_angle_deg, SoilPrior().friction_angle_deg));
}

// The intervals' own promise: of soils that were not learned from, with T as leaving one out has found it.
TEST_F(Identified, IntervalsHoldWhatTheySay) {
  Training training = training_;
  training.temper.reset();
  const SoilIdentifier calibrated(training);
  constexpr int kSoils = 150;
  int held = 0;
  for (int i = 0; i < kSoils; ++i) {
    TrainingRun run;
    run.sample = soilSample(static_cast<std::uint64_t>(5000 + i));
    const SoilState truth = {MadeUpSoil::strengthOf(run.sample.soil).residual.angle_deg,
                             MadeUpSoil::strengthOf(run.sample.soil).residual.cohesion_pa, run.sample.tool_friction};
    const SoilBelief belief =
        calibrated.identify(all(soils_.forces(truth, kGravity, 7000U + static_cast<unsigned>(i))), kGravity);
    held += holds(belief.friction_angle_deg, truth.friction_angle_deg) ? 1 : 0;
    held += holds(belief.cohesion_pa, truth.cohesion_pa) ? 1 : 0;
    held += holds(belief.tool_friction_angle_deg, angleOf(truth.tool_friction)) ? 1 : 0;
  }
  EXPECT_NEAR(held / (3.0 * kSoils), 0.9, 0.06);
}

TEST_F(Identified, IsTheSameAtEachTry) {
  const MeasuredForces forces = all(soils_.forces(moon_, kGravity, 1000));
  EXPECT_EQ(identifier_.identify(forces, kGravity).cohesion_pa.middle,
            identifier_.identify(forces, kGravity).cohesion_pa.middle);
}

// A blade in soil of 500 Pa on the Moon meets as much over g as in soil of 3000 Pa on the Earth.
TEST_F(Identified, IsAlikeUnderAnotherGravity) {
  const double times = 9.81 / kGravity;
  const SoilState earth{42, 500 * times, 0.36};
  const SoilBelief moon = identifier_.identify(all(soils_.forces(moon_, kGravity, 1)), kGravity);
  const SoilBelief belief = identifier_.identify(all(soils_.forces(earth, 9.81, 1)), 9.81);
  EXPECT_NEAR(belief.friction_angle_deg.middle, moon.friction_angle_deg.middle, 1e-6);
  EXPECT_NEAR(belief.cohesion_pa.middle, moon.cohesion_pa.middle * times, 1e-3);
}

TEST_F(Identified, SandHasNoCohesionForSure) {
  const SoilBelief belief = identifier_.identify(all(soils_.forces({35, 0, 0.4}, kGravity, 3)), kGravity);
  EXPECT_EQ(belief.cohesion_pa.low, 0);
  EXPECT_LT(belief.cohesion_pa.middle, 15);
}

TEST_F(Identified, LessIsKnownFromFewerWindows) {
  MeasuredForces forces = all(soils_.forces(moon_, kGravity, 1000));
  const SoilBelief whole = identifier_.identify(forces, kGravity);
  for (std::size_t i = 0; i < 20; ++i) {
    forces[i].reset();
  }
  const SoilBelief part = identifier_.identify(forces, kGravity);
  EXPECT_LT(part.numbers, whole.numbers);
  EXPECT_GT(part.friction_angle_deg.high - part.friction_angle_deg.low,
            whole.friction_angle_deg.high - whole.friction_angle_deg.low);
  for (std::optional<Vec3>& force : forces) {
    force.reset();
  }
  EXPECT_THROW((void)identifier_.identify(forces, kGravity), InvalidParameter);
}

// A stone in the way: one force is five times what it is in any soil.
TEST_F(Identified, WhatNoSoilDoesIsToldToBeStrange) {
  WindowForces forces = soils_.forces(moon_, kGravity, 1000);
  for (std::size_t window = 16; window < 20; ++window) {
    forces[window] *= 8;
  }
  EXPECT_GT(identifier_.identify(all(forces), kGravity).misfit, kStrange);
}

std::string refusalOf(const SoilIdentifier& identifier, const WindowForces& forces, double gravity_m_s2) {
  try {
    (void)identifier.identify(all(forces), gravity_m_s2);
  } catch (const InvalidParameter& error) {
    return error.what();
  }
  return "identified";
}

TEST_F(Identified, ASensorThatReadsNothingButNoiseIdentifiesNothing) {
  const WindowForces forces = soils_.forces(moon_, kGravity, 1000);
  EXPECT_THAT(refusalOf(identifier_, WindowForces(forces.size(), Vec3::Zero()), kGravity),
              testing::HasSubstr("within the noise of the sensor"));
  EXPECT_THAT(refusalOf(identifier_, WindowForces(forces.size(), Vec3(0.02, 0.02, -0.02)), kGravity),
              testing::HasSubstr("check the columns of the sensor"));
  const SoilState asteroid{42, 500 * 1e-3 / kGravity, 0.36};
  EXPECT_EQ(refusalOf(identifier_, soils_.forces(asteroid, 1e-3, 1000), 1e-3), "identified");
}

TEST_F(Identified, ForcesThatPushTheWrongWayIdentifyNothing) {
  WindowForces forces = soils_.forces(moon_, kGravity, 1000);
  for (Vec3& force_n : forces) {
    force_n = -force_n;
  }
  EXPECT_THAT(refusalOf(identifier_, forces, kGravity),
              testing::HasSubstr("opposite to the force of soil on this tool"));
}

TEST_F(Identified, TooFewSoilsAreRefused) {
  EXPECT_THROW(SoilIdentifier(soils_.training(19)), InvalidParameter);
}

TEST(SoilState, IsItselfAgain) {
  const SoilState state{33, 250, 0.4};
  const SoilState again = soilState(stateVector(state, 3.7), 3.7);
  EXPECT_NEAR(again.friction_angle_deg, 33, 1e-12);
  EXPECT_NEAR(again.cohesion_pa, 250, 1e-9);
  EXPECT_NEAR(again.tool_friction, 0.4, 1e-15);
}

}  // namespace
}  // namespace haptolith
