#include "haptolith/bed/measure/double_step.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "haptolith/bed/critical_step.h"

namespace haptolith {
namespace {

/// A heap of 216 particles that have fallen for a while: they slide, stick and are pressed together.
BedParameters heap(double cohesion_n) {
  BedParameters bed;
  bed.soil.friction = FrictionModel::kContact;
  bed.soil.contact_friction = 0.3;
  bed.soil.contact_cohesion_n = cohesion_n;
  bed.gravity_m_s2 = {0, 0, -9.81};
  bed.width_m = bed.length_m = 0.2;
  return bed;
}

std::vector<Vec3> cube() {
  std::vector<Vec3> centres;
  for (int i = 0; i < 216; ++i) {
    centres.emplace_back(0.0145 * (i % 6) - 0.036, 0.0145 * (i / 6 % 6) - 0.036 + 1e-4 * (i % 7),
                         0.008 + 0.0145 * (i / 36));
  }
  return centres;
}

TEST(DoubleStep, DiffersFromTheKernelsByRounding) {
  for (const double cohesion_n : {0.0, 0.02}) {
    const BedParameters parameters = heap(cohesion_n);
    Bed bed(parameters, cube());
    ASSERT_TRUE(hasDoubleStep(bed));
    const double dt_s = parameters.tick_s / substepsFor(parameters.soil, 0, parameters.tick_s, parameters.max_substeps);
    const double weight_n = bed.mass() * 9.81;
    for (int look = 0; look < 5; ++look) {
      for (int step = 0; step < 400; ++step) {
        ASSERT_EQ(bed.step(dt_s), StepStatus::kOk);
      }
      const StepError error = compareWithDouble(bed, dt_s);
      EXPECT_GT(error.particles, 50U);
      EXPECT_GT(error.force_n, 0.3 * weight_n) << "they are pressed together";
      EXPECT_LT(error.error_n, 2e-4 * error.force_n) << "cohesion " << cohesion_n << ", look " << look;
      EXPECT_GT(error.error_n, 0);
    }
  }
}

TEST(DoubleStep, KnowsWhichBedsItDoesNotKnow) {
  BedParameters parameters = heap(0);
  parameters.soil.friction = FrictionModel::kIcra2021;
  EXPECT_FALSE(hasDoubleStep(Bed(parameters, cube())));
}

}  // namespace
}  // namespace haptolith
