#include "haptolith/bed/measure/contact_load.h"

#include <gtest/gtest.h>

#include "haptolith/bed/bed.h"
#include "haptolith/soil/contact_law.h"

namespace haptolith {
namespace {

TEST(ContactLoad, IsTheSumOfWhatNeighboursPressWith) {
  BedParameters bed;
  const auto r = static_cast<float>(bed.soil.radius_m);
  const ContactLaw law = makeContactLaw(bed.soil);
  // Three in a row: the middle one is pressed from both sides. The fourth only attracts, the fifth is alone.
  const std::vector<Float4> positions{
      {-1.9F * r, 0, 0.05F, 0}, {0, 0, 0.05F, 0}, {1.95F * r, 0, 0.05F, 0}, {0, 2.05F * r, 0.05F, 0}, {0, 0, 0.12F, 0}};
  const std::vector<float> loads = contactLoads(bed, positions);
  const double left = contactForce(law, 1.9 * bed.soil.radius_m);
  const double right = contactForce(law, 1.95 * bed.soil.radius_m);
  ASSERT_EQ(loads.size(), 5U);
  EXPECT_NEAR(loads[0], left, 1e-4 * left);
  EXPECT_NEAR(loads[1], left + right, 1e-4 * left);
  EXPECT_NEAR(loads[2], right, 1e-4 * right);
  EXPECT_EQ(loads[3], 0);
  EXPECT_EQ(loads[4], 0);
}

TEST(ContactLoad, GoesRoundAPeriodicBoxAndKnowsLargerParticles) {
  BedParameters bed;
  bed.soil.friction = FrictionModel::kContact;
  bed.soil.size_spread = 0.2;
  bed.periodic_x = true;
  const double r = bed.soil.radius_m;
  const auto edge = static_cast<float>(bed.width_m / 2);
  const auto excess = static_cast<float>(0.1 * r);
  const std::vector<Float4> positions{{edge - static_cast<float>(r), 0, 0.05F, excess},
                                      {-edge + static_cast<float>(r), 0, 0.05F, 0}};
  const std::vector<float> loads = contactLoads(bed, positions);
  const double expected = contactForce(makeContactLaw(bed.soil), 1.9 * r);
  EXPECT_NEAR(loads[0], expected, 1e-3 * expected);
  EXPECT_NEAR(loads[1], expected, 1e-3 * expected);
}

TEST(ContactLoad, OfTwoSizesIsThatOfTheSizeBetweenAndTheSameForBoth) {
  BedParameters bed;
  bed.soil.friction = FrictionModel::kContact;
  bed.grading.fine_radius_m = bed.soil.radius_m / 4;
  const double r = bed.soil.radius_m;
  const auto grain = [&](double x_m, double of_r) {
    return Float4{static_cast<float>(x_m), 0, 0.05F, static_cast<float>((of_r - 1) * r)};
  };
  // Coarse against fine, fine against fine, each pressed by 3 % of the radius between them; the last touches none.
  const double between = 2 * r * (r / 4) / (r + r / 4);
  const double mixed_m = 1.25 * r - 0.03 * between;
  const double fine_m = 0.5 * r - 0.03 * r / 4;
  const std::vector<float> loads = contactLoads(
      bed, std::vector<Float4>{grain(0, 1), grain(mixed_m, 0.25), grain(mixed_m + fine_m, 0.25), grain(-2.5 * r, 0.5)});
  const double mixed = contactForce(makeContactLaw(rescaled(bed.soil, between)), 1.97 * between);
  const double fine = contactForce(makeContactLaw(rescaled(bed.soil, r / 4)), 1.97 * r / 4);
  EXPECT_NEAR(loads[0], mixed, 1e-3 * mixed);
  EXPECT_NEAR(loads[1], mixed + fine, 1e-3 * mixed);
  EXPECT_NEAR(loads[2], fine, 1e-3 * fine);
  EXPECT_EQ(loads[3], 0);
}

TEST(ContactLoad, GrowsWithDepthInABedAtRest) {
  BedParameters parameters;
  parameters.start = BedStart::kPacked;
  parameters.depth_m = 0.09;
  const Bed bed(parameters);
  const std::vector<Float4> positions(bed.state().position.begin(),
                                      bed.state().position.begin() + static_cast<std::ptrdiff_t>(bed.particles()));
  const std::vector<float> loads = contactLoads(parameters, positions);
  double low = 0;
  double high = 0;
  for (std::size_t i = 0; i < loads.size(); ++i) {
    (positions[i].z < 0.045F ? low : high) += static_cast<double>(loads[i]);
  }
  EXPECT_GT(low, 1.5 * high);
}

}  // namespace
}  // namespace haptolith
