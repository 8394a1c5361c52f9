#include "haptolith/identify/check/soil_check.h"

#include <gmock/gmock.h>

#include "haptolith/identify/training/training_file.h"

#include "../source_dir.h"
#include "made_up_training.h"

namespace haptolith {
namespace {

// Soils that the training has not seen, each sheared, some with a stone in the way: `haptolith identify evaluate`.
TEST(SoilCheck, HiddenSoilsAreTold) {
  const Training hidden = readTraining(sourceDir() / "tests/data/identify-hidden.json");
  const SoilCheck check(probeTraining(), hidden);
  ASSERT_GE(check.soils().size(), 20U);
  const std::vector<CheckedNumber> numbers = check.numbers(false);
  // With 12 other noises and zero errors of the sensor: 1.6 to 2.2 degrees, 36 to 51 Pa, 26 to 32 %, 2.1 to 3.0
  // degrees, with standard deviations of 0.2, 4.2, 1.6 and 0.25.
  EXPECT_LE(numbers[0].median_error, 2.5) << "degrees of friction angle";
  EXPECT_LE(numbers[1].median_error, 56) << "Pa of cohesion";
  EXPECT_LE(numbers[2].median_error, 34) << "% of cohesion of 250 Pa and more; docs/reports/identification.md has 29";
  EXPECT_LE(numbers[3].median_error, 3.4) << "degrees of soil-tool friction";
  double held = 0;
  for (const std::size_t i : {0U, 1U, 3U}) {
    held += check.numbers()[i].held_share / 3;
    EXPECT_GE(check.numbers()[i].held_share, 0.8) << numbers[i].name;
  }
  EXPECT_NEAR(held, 0.9, 0.05) << "of all, with those that have stones in them";
}

TEST(SoilCheck, NeedsSoilsWhoseStrengthIsKnown) {
  const Training training = MadeUpSoil(0.1).training(30);
  Training hidden = training;
  hidden.runs.front().strength.reset();
  EXPECT_THROW(SoilCheck(training, hidden), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
