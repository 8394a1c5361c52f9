#include "haptolith/session/soil_sliders.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "haptolith/core/error.h"
#include "haptolith/soil/presets.h"
#include "haptolith/soil/strength.h"

namespace haptolith {
namespace {

double valueOf(const SoilParameters& soil, std::string_view key) {
  const auto sliders = slidersOf(soil);
  const auto at = std::ranges::find(sliders, key, &SoilSlider::key);
  return at == sliders.end() ? std::nan("") : at->value;
}

TEST(SoilSliders, ThePapersSoilHasTheFrictionAngleAndCohesionOfItsEquations) {
  for (const Preset& preset : presets()) {
    const double mu = std::sqrt(6.0) * preset.soil.mu_hat;
    EXPECT_NEAR(valueOf(preset.soil, "friction_angle_deg"), std::atan(mu) * 180 / std::numbers::pi, 1e-9);
    EXPECT_NEAR(valueOf(preset.soil, "cohesion_pa"), cohesion(preset.soil), 1e-9);
  }
}

TEST(SoilSliders, AMovedSliderShowsWhatItWasMovedTo) {
  const SoilParameters soil = findPreset("P3").soil;
  EXPECT_NEAR(valueOf(withSlider(soil, "friction_angle_deg", 25), "friction_angle_deg"), 25, 1e-9);
  EXPECT_NEAR(valueOf(withSlider(soil, "cohesion_pa", 300), "cohesion_pa"), 300, 1e-9);
}

TEST(SoilSliders, FrictionLeavesCohesionAlone) {  // although (paper 18) has friction in it
  const SoilParameters soil = findPreset("P3").soil;
  const double before = valueOf(soil, "cohesion_pa");
  EXPECT_NEAR(valueOf(withSlider(soil, "friction_angle_deg", 20), "cohesion_pa"), before, 1e-6 * before);
}

TEST(SoilSliders, PairwiseSoilHasThoseOfItsContacts) {
  SoilParameters soil = findPreset("P3").soil;
  soil.friction = FrictionModel::kPairwise;
  soil.contact_friction = 0.4;
  soil.contact_cohesion_n = 0.002;
  EXPECT_DOUBLE_EQ(valueOf(soil, "contact_friction"), 0.4);
  EXPECT_DOUBLE_EQ(valueOf(soil, "contact_cohesion_mn"), 2);
  EXPECT_DOUBLE_EQ(withSlider(soil, "contact_cohesion_mn", 3.5).contact_cohesion_n, 0.0035);
  EXPECT_DOUBLE_EQ(withSlider(soil, "contact_friction", 0).contact_friction, 0);
}

TEST(SoilSliders, EveryValueIsWithinItsOwnRange) {
  for (const Preset& preset : presets()) {
    for (const FrictionModel friction : {FrictionModel::kPaper, FrictionModel::kPairwise}) {
      SoilParameters soil = preset.soil;
      soil.friction = friction;
      for (const SoilSlider& slider : slidersOf(soil)) {
        EXPECT_LE(slider.low, slider.value) << slider.key;
        EXPECT_LE(slider.value, slider.high) << slider.key;
        validate(withSlider(soil, slider.key, slider.low));
        validate(withSlider(soil, slider.key, slider.high));
      }
    }
  }
}

TEST(SoilSliders, WhatIsNotThereOrOutOfRangeIsRefused) {
  const SoilParameters soil = findPreset("P3").soil;
  EXPECT_THROW((void)withSlider(soil, "contact_friction", 0.5), InvalidParameter);
  EXPECT_THROW((void)withSlider(soil, "colour", 0.5), InvalidParameter);
  EXPECT_THROW((void)withSlider(soil, "friction_angle_deg", 90), InvalidParameter);
  EXPECT_THROW((void)withSlider(soil, "cohesion_pa", std::nan("")), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
