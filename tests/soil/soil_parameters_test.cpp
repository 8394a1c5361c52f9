#include "haptolith/soil/soil_parameters.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "haptolith/core/error.h"
#include "haptolith/soil/contact_law.h"
#include "haptolith/soil/layers.h"
#include "haptolith/soil/presets.h"
#include "haptolith/soil/strength.h"

namespace haptolith {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(SoilParameters, MassFillsTheCloseLattice) {
  SoilParameters soil;
  soil.radius_m = 0.5;
  soil.rho0_kg_m3 = 1000;
  soil.rho_max_kg_m3 = 1500;
  EXPECT_NEAR(macroparticleMass(soil), 707.10678, 1e-5);  // 4 sqrt(2) / 8 * 1000
}

TEST(SoilParameters, NonsenseIsRefusedByName) {
  const auto refuses = [](const SoilNumber& number, double value) {
    SoilParameters soil;
    soil.*number.member = value;
    try {
      validate(soil);
      ADD_FAILURE() << number.key << " = " << value << " passed";
    } catch (const InvalidParameter& error) {
      EXPECT_EQ(error.key(), number.key);
      EXPECT_THAT(error.what(), testing::HasSubstr("must be"));
    }
  };
  for (const SoilNumber& number : kSoilNumbers) {
    refuses(number, std::nan(""));
    refuses(number, -kInfinity);
    refuses(number, number.valid.lowest - 1e-6);
    if (number.valid.ends != Ends::kClosed) {
      refuses(number, number.valid.lowest);
    }
    if (std::isfinite(number.valid.highest)) {
      refuses(number, 1.01 * number.valid.highest);
    }
  }
  const auto* density = std::ranges::find(kSoilNumbers, "rho_max_kg_m3", &SoilNumber::key);
  refuses(*density, SoilParameters().rho0_kg_m3);
}

TEST(SoilNumbers, HaveEveryPlaceOfAStoredFormatOnce) {
  const auto every_place_once = [](int SoilNumber::*place) {
    const std::vector<SoilNumber> numbers = soilNumbersBy(place);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      EXPECT_EQ(numbers[i].*place, static_cast<int>(i) + 1) << numbers[i].key;
    }
    return numbers.size();
  };
  EXPECT_EQ(every_place_once(&SoilNumber::tile_place), kSoilNumbers.size());
  EXPECT_LT(every_place_once(&SoilNumber::training_place), kSoilNumbers.size());
}

TEST(SoilParameters, ASpringSofterThanTheHyperbolaIsRefused) {
  SoilParameters soil;
  soil.stiffness_n_m = 1;
  EXPECT_THROW(static_cast<void>(makeContactLaw(soil)), InvalidParameter);
}

TEST(RescaledSoil, KeepsStressAtEqualRelativeOverlap) {
  const SoilParameters soil = findPreset("P3").soil;
  for (const double radius : {0.5e-3, 3e-3, 20e-3}) {
    const SoilParameters other = rescaled(soil, radius);
    const ContactLaw law = makeContactLaw(soil);
    const ContactLaw other_law = makeContactLaw(other);
    for (const double overlap : {-0.15, -0.05, 0.05, 0.1, 0.2, 0.3}) {  // both branches, and attraction
      const double stress = contactForce(law, 2 * soil.radius_m * (1 - overlap)) / std::pow(soil.radius_m, 2);
      const double other_stress = contactForce(other_law, 2 * radius * (1 - overlap)) / (radius * radius);
      EXPECT_NEAR(other_stress, stress, 1e-9 * std::abs(stress) + 1e-9);
    }
    EXPECT_NEAR(cohesion(other), cohesion(soil), 1e-6);
  }
}

TEST(RescaledSoil, HasTheSameDensityUnderTheSameWeight) {
  // Layer n of the big soil and layer 4n of one a quarter its size carry the same stress.
  const SoilParameters soil = findPreset("P3").soil;
  const SoilParameters fine = rescaled(soil, soil.radius_m / 4);
  for (const int n : {1, 5, 20, 60}) {
    EXPECT_NEAR(layerSpacing(fine, 1.625, 4 * n) * 4, layerSpacing(soil, 1.625, n), 1e-12);
  }
}

TEST(RescaledSoil, HasTheSameBandMeans) {
  const SoilParameters soil = findPreset("P3").soil;
  const auto layers = layersToDepth(soil, 1.625, 0.6);
  const auto fine = layersToDepth(rescaled(soil, 1e-3), 1.625, 0.6);
  EXPECT_NEAR(bandMeanDensity(fine, 0, 0.6), bandMeanDensity(layers, 0, 0.6), 2);
  EXPECT_NEAR(bandMeanDensity(fine, 0.3, 0.6), bandMeanDensity(layers, 0.3, 0.6), 2);
}

}  // namespace
}  // namespace haptolith
