#include "haptolith/lab/tests/free_fall.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string_view>

#include "haptolith/core/error.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

LabConditions withContactFriction() {
  LabConditions conditions;
  conditions.soil.friction = FrictionModel::kContact;
  conditions.soil.stiffness_n_m = 1000;
  return conditions;
}

TEST(FreeFallTest, WhatRubsOnlyAgainstItselfFallsFreely) {
  for (const double cohesion : {0.0, 0.02}) {
    for (const double spread : {0.0, 0.1}) {
      LabConditions conditions = withContactFriction();
      conditions.soil.contact_cohesion_n = cohesion;
      conditions.soil.size_spread = spread;
      const FreeFallResult result = freeFallTest(conditions);
      EXPECT_GT(result.particles, 100U);
      EXPECT_NEAR(result.acceleration_ratio, 1, 1e-3) << cohesion << " " << spread;
      EXPECT_NEAR(result.trace.rows.back()[1], 0.3, 1e-3);
    }
  }
}

TEST(FreeFallTest, OnEarthToo) {
  LabConditions conditions = withContactFriction();
  conditions.gravity_m_s2 = 9.81;
  EXPECT_NEAR(freeFallTest(conditions).acceleration_ratio, 1, 1e-3);
}

TEST(FreeFallTest, Icra2021FrictionHoldsAClumpInEmptySpace) {
  LabConditions conditions;
  conditions.soil = findPreset("P4").soil;
  const FreeFallResult result = freeFallTest(conditions);
  EXPECT_LT(std::abs(result.acceleration_ratio), 0.1);
  EXPECT_LT(result.trace.rows.back()[1], 0.1 * 0.3);  // measured: 7 mm of 300 mm
}

TEST(FreeFallTest, RefusesNonsense) {
  LabConditions conditions = withContactFriction();
  EXPECT_THROW((void)freeFallTest(conditions, {.ball_radii = 1}), InvalidParameter);
  EXPECT_THROW((void)freeFallTest(conditions, {.fall_m = -1}), InvalidParameter);
  conditions.gravity_m_s2 = 0;
  EXPECT_THROW((void)freeFallTest(conditions), InvalidParameter);
}

TEST(FreeFallTest, StopsWhenItsCallerWantsItTo) {
  LabConditions conditions = withContactFriction();
  conditions.progress = [](std::string_view, double) { return false; };
  EXPECT_THROW((void)freeFallTest(conditions), Failure);
}

}  // namespace
}  // namespace haptolith
