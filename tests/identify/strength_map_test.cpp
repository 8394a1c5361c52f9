#include "haptolith/identify/training/strength_map.h"

#include <gmock/gmock.h>

#include "haptolith/identify/training/training_file.h"

#include "made_up_training.h"

namespace haptolith {
namespace {

SoilParameters soilOf(double friction, double cohesion_n) {
  SoilParameters soil = rescaled(lunarContacts(), 6e-3);
  soil.contact_friction = friction;
  soil.contact_cohesion_n = cohesion_n;
  return soil;
}

TEST(StrengthMap, FindsALawAgain) {
  const StrengthMap map(MadeUpSoil(0).training(60).runs);
  for (const double friction : {0.2, 0.35, 0.5}) {
    for (const double cohesion_n : {0.01, 0.1, 0.4}) {
      const SoilParameters soil = soilOf(friction, cohesion_n);
      const MeasuredStrength truth = MadeUpSoil::strengthOf(soil);
      EXPECT_NEAR(map.of(soil).angle_deg, truth.residual.angle_deg, 0.3);
      EXPECT_NEAR(map.of(soil).cohesion_pa, truth.residual.cohesion_pa, 0.05 * truth.residual.cohesion_pa);
      EXPECT_NEAR(map.of(soil, SoilStrength::kPeak).angle_deg, truth.peak.angle_deg, 0.3);
    }
  }
}

TEST(StrengthMap, GivesContactsForAStrength) {
  const StrengthMap map(probeTraining().runs);
  for (const ShearStrength wanted : {ShearStrength{30, 100}, {35, 170}, {42, 500}}) {
    const ShearStrength given = map.of(map.with(soilOf(0.4, 0.1), wanted));
    EXPECT_NEAR(given.angle_deg, wanted.angle_deg, 0.01);
    EXPECT_NEAR(given.cohesion_pa, wanted.cohesion_pa, 0.01);
  }
  const SoilParameters sand = map.with(soilOf(0.4, 0.1), {33, 0});
  EXPECT_EQ(sand.contact_cohesion_n, 0);
  EXPECT_EQ(map.of(sand).cohesion_pa, 0);
  EXPECT_NEAR(map.of(sand).angle_deg, 33, 0.01);
}

TEST(StrengthMap, OfTheProbeAgreesWithWhatWasMeasured) {
  const StrengthMap map(probeTraining().runs);
  EXPECT_LT(map.angleScatter(), 2);
  EXPECT_LT(map.cohesionScatter(), 0.35);
}

TEST(StrengthMap, NeedsSoilsThatWereSheared) {
  std::vector<TrainingRun> runs = MadeUpSoil(0).training(40).runs;
  for (TrainingRun& run : runs) {
    run.strength.reset();
  }
  EXPECT_THROW(StrengthMap{runs}, InvalidParameter);
}

}  // namespace
}  // namespace haptolith
