#include "haptolith/identify/training/digging.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <set>
#include <string_view>

#include "haptolith/identify/training/training_file.h"

namespace haptolith {
namespace {

/// A plate of 30 mm by 30 mm that goes 10 mm down and up again.
ToolMovement shortPress() {
  return ToolMovement({{0, {{0, 0, 0.01}, Quat::Identity()}},
                       {1, {{0, 0, -0.0075}, Quat::Identity()}},
                       {2, {{0, 0, 0.02}, Quat::Identity()}}});
}

const ToolParameters kPlate{.size_m{0.03, 0.03, 0.005}};
const DiggingField kSmall{.width_m = 0.14, .length_m = 0.14, .depth_m = 0.05};

TEST(Digging, MeetsNothingInTheAirAndMoreFurtherDown) {
  const WindowForces forces = digAlong(shortPress(), kPlate, soilSample(1), kSmall);
  ASSERT_EQ(forces.size(), 8U);
  EXPECT_LT(forces[0].norm(), 0.1 * forces[3].norm());
  EXPECT_LT(forces[7].norm(), 0.02) << "in the air";
  EXPECT_GT(forces[3].z(), forces[2].z());
  EXPECT_GT(forces[3].z(), 5 * std::hypot(forces[3].x(), forces[3].y()));
}

TEST(Digging, IsTheSameAtEachTry) {
  EXPECT_EQ(digAlong(shortPress(), kPlate, soilSample(1), kSmall),
            digAlong(shortPress(), kPlate, soilSample(1), kSmall));
}

TEST(Digging, MeetsTheSurfaceSoonerWhereItIsHigher) {
  SoilSample sample = soilSample(1);
  sample.surface_error_m = 2e-3;
  const double higher_n = digAlong(shortPress(), kPlate, sample, kSmall)[1].z();
  sample.surface_error_m = -2e-3;
  EXPECT_GT(higher_n, 1.5 * digAlong(shortPress(), kPlate, sample, kSmall)[1].z()) << "at the first contact";
}

TEST(Digging, EndsWhereNobodyWantsIt) {
  EXPECT_THROW(
      (void)digAlong(shortPress(), kPlate, soilSample(1), kSmall, [](std::string_view, double) { return false; }),
      Failure);
}

// The shipped training matches this program. It was made by other last bits, which grow to forces of another
// realisation.
TEST(ProbeTraining, IsOfThisProgram) {
  const Training& training = probeTraining();
  ASSERT_GE(training.runs.size(), 90U);
  EXPECT_TRUE(training.temper);
  const TrainingRun& stored = training.runs.front();
  const WindowForces forces = digAlong(probeMovement({}), {}, soilSample(stored.number), {.seed = stored.number});
  ASSERT_EQ(forces.size(), stored.forces.size());
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    difference += (forces[i] - stored.forces[i]).squaredNorm();
    size += stored.forces[i].squaredNorm();
  }
  EXPECT_LT(std::sqrt(difference / size), 0.5);
}

TEST(SoilSamples, DifferAndRepeat) {
  for (const std::uint64_t number : {std::uint64_t{5}, hiddenNumber(3)}) {
    EXPECT_EQ(soilSample(number).soil, soilSample(number).soil);
    EXPECT_NE(soilSample(number).soil, soilSample(number + 1).soil);
    EXPECT_NO_THROW(validate(soilSample(number).soil));
  }
  EXPECT_EQ(soilSample(10).stone_size_m, 0);
  EXPECT_EQ(soilSample(hiddenNumber(4)).stone_size_m, 0);
  EXPECT_GT(soilSample(hiddenNumber(5)).stone_size_m, 0);
}

TEST(SoilSamples, NoTrainingHasWhatIsHidden) {
  std::set<std::uint64_t> trained;
  for (std::uint64_t place = 1; place <= 1000; ++place) {
    EXPECT_TRUE(trained.insert(trainingNumber(place)).second);
    EXPECT_EQ(soilSample(trainingNumber(place)).stone_size_m, 0);
  }
  for (std::uint64_t place = 1; place <= 1000; ++place) {
    EXPECT_FALSE(trained.contains(hiddenNumber(place)));
  }
}

}  // namespace
}  // namespace haptolith
