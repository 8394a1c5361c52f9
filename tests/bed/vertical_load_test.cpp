#include "haptolith/bed/measure/vertical_load.h"

#include <gtest/gtest.h>

namespace haptolith {
namespace {

BedParameters periodicSoil() {
  BedParameters bed;
  bed.soil = rescaled(bed.soil, 8e-3);
  bed.soil.friction = FrictionModel::kContact;
  bed.soil.size_spread = 0.15;
  bed.start = BedStart::kSettled;
  bed.width_m = bed.length_m = 0.12;
  bed.periodic_x = bed.periodic_y = true;
  bed.depth_m = 0.08;
  return bed;
}

// Geostatic stress: without walls, soil at rest carries just what lies above, at each level.
TEST(VerticalLoad, IsTheWeightAbove) {
  const Bed bed(periodicSoil());
  for (const double height_m : {0.01, 0.02, 0.03, 0.04, 0.05, 0.06}) {
    const VerticalLoad load = verticalLoad(bed, height_m);
    EXPECT_GT(load.weight_n, 0);
    EXPECT_NEAR(load.carried_n / load.weight_n, 1, 0.01) << height_m;
  }
  EXPECT_GT(verticalLoad(bed, 0.02).weight_n, 1.5 * verticalLoad(bed, 0.05).weight_n);
  EXPECT_EQ(verticalLoad(bed, 1).weight_n, 0);
}

// Particles that have just begun to fall carry nothing yet.
TEST(VerticalLoad, IsNotThereInFreeFall) {
  BedParameters parameters = periodicSoil();
  parameters.start = BedStart::kPacked;
  std::vector<Vec3> apart;
  for (int i = 0; i < 5; ++i) {
    apart.emplace_back(0, 0, 0.02 + 0.02 * i);
  }
  const VerticalLoad load = verticalLoad(Bed(parameters, apart), 0.05);
  EXPECT_EQ(load.carried_n, 0);
  EXPECT_NEAR(load.weight_n, 3 * macroparticleMass(parameters.soil) * 1.625, 1e-9);
}

}  // namespace
}  // namespace haptolith
