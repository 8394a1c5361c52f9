#include "haptolith/session/soil_sliders.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "haptolith/core/error.h"
#include "haptolith/scene_file/soil_file.h"
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

TEST(SoilSliders, ContactFrictionSoilHasThoseOfItsContacts) {
  SoilParameters soil = findPreset("P3").soil;
  soil.friction = FrictionModel::kContact;
  soil.contact_friction = 0.4;
  soil.contact_cohesion_n = 0.002;
  EXPECT_DOUBLE_EQ(valueOf(soil, "contact_friction"), 0.4);
  EXPECT_DOUBLE_EQ(valueOf(soil, "contact_cohesion_mn"), 2);
  EXPECT_DOUBLE_EQ(withSlider(soil, "contact_cohesion_mn", 3.5).contact_cohesion_n, 0.0035);
  EXPECT_DOUBLE_EQ(withSlider(soil, "contact_friction", 0).contact_friction, 0);
}

SceneFile sceneWith(const std::string& soil_name) {
  SceneFile scene_file;
  changeSoil(scene_file, soil_name);
  return scene_file;
}

TEST(SoilSliders, ASoilThatWasCalibratedShowsWhatWasMeasuredOfIt) {
  for (const std::string& name : soilNames()) {
    const SceneFile scene_file = sceneWith(name);
    const auto sliders = slidersOf(scene_file.bed.soil, calibrationOf(scene_file));
    ASSERT_EQ(sliders.size(), 2U) << name;
    EXPECT_EQ(sliders[0].key, "friction_angle_deg");
    EXPECT_NEAR(sliders[0].value, findSoil(name).target.friction_angle_deg, 1e-9) << name;
    EXPECT_EQ(sliders[1].key, "cohesion_pa");
    EXPECT_NEAR(sliders[1].value, findSoil(name).target.cohesion_pa, 1e-6) << name;
    for (const SoilSlider& slider : sliders) {
      EXPECT_LE(slider.low, slider.value) << name << slider.key;
      EXPECT_LE(slider.value, slider.high) << name << slider.key;
    }
  }
}

TEST(SoilSliders, ACalibratedSoilTakesDegreesAndPascalsAndKeepsTheOther) {
  for (const std::string& name : soilNames()) {
    const SceneFile scene_file = sceneWith(name);
    const auto calibration = calibrationOf(scene_file);
    const SoilParameters& soil = scene_file.bed.soil;
    const ShearStrength before = calibration->of(soil);
    const SoilSlider angle = slidersOf(soil, calibration)[0];
    for (const double angle_deg : {(angle.low + angle.value) / 2, (angle.value + angle.high) / 2}) {
      const SoilParameters moved = withSlider(soil, "friction_angle_deg", angle_deg, calibration);
      EXPECT_NEAR(calibration->of(moved).angle_deg, angle_deg, 1e-5) << name;
      EXPECT_NEAR(calibration->of(moved).cohesion_pa, before.cohesion_pa, 1e-4 * (1 + before.cohesion_pa)) << name;
      EXPECT_EQ(moved.contact_friction > soil.contact_friction, angle_deg > before.angle_deg) << name;
    }
    const SoilParameters sticky = withSlider(soil, "cohesion_pa", before.cohesion_pa + 200, calibration);
    EXPECT_NEAR(calibration->of(sticky).cohesion_pa, before.cohesion_pa + 200, 1e-4 * (200 + before.cohesion_pa))
        << name;
    EXPECT_NEAR(calibration->of(sticky).angle_deg, before.angle_deg, 1e-5) << name;
    EXPECT_GT(sticky.contact_cohesion_n, soil.contact_cohesion_n) << name;
    EXPECT_EQ(withSlider(soil, "cohesion_pa", 0, calibration).contact_cohesion_n, 0) << name;
    EXPECT_EQ(withSlider(soil, "contact_friction", 0.5, calibration).contact_friction, 0.5) << "as studies set it";
  }
}

TEST(SoilSliders, ACalibrationIsAsGoodForParticlesOfAnotherSize) {
  SceneFile scene_file = sceneWith("lunar-0-15cm");
  scene_file.bed.soil = rescaled(scene_file.bed.soil, 3.5e-3);
  const auto calibration = calibrationOf(scene_file);
  ASSERT_TRUE(calibration);
  EXPECT_NEAR(calibration->of(scene_file.bed.soil).angle_deg, 42, 1e-9);
  EXPECT_NEAR(calibration->of(scene_file.bed.soil).cohesion_pa, 520, 1e-6);
}

TEST(SoilSliders, WhereNothingWasCalibratedContactsAreCalledContacts) {
  SceneFile scene_file;
  EXPECT_FALSE(calibrationOf(scene_file)) << "a preset";
  scene_file = sceneWith("dry-sand");
  scene_file.bed.soil.stiffness_n_m *= 2;
  EXPECT_FALSE(calibrationOf(scene_file)) << "not the soil of that name any more";
  scene_file = sceneWith("dry-sand");
  scene_file.bed.soil.friction = FrictionModel::kIcra2021;
  EXPECT_FALSE(calibrationOf(scene_file));
  SoilParameters soil = findPreset("P3").soil;
  soil.friction = FrictionModel::kContact;
  EXPECT_EQ(slidersOf(soil)[0].label, "contact friction");
  EXPECT_EQ(slidersOf(soil)[1].label, "contact cohesion");
}

TEST(SoilSliders, EveryValueIsWithinItsOwnRange) {
  for (const Preset& preset : presets()) {
    for (const FrictionModel friction : {FrictionModel::kIcra2021, FrictionModel::kContact}) {
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
