#include "haptolith/soil/calibration.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "haptolith/core/error.h"
#include "haptolith/soil/contact_law.h"
#include "haptolith/soil/layers.h"
#include "haptolith/soil/lunar_density.h"
#include "haptolith/soil/presets.h"
#include "haptolith/soil/strength.h"

namespace haptolith {
namespace {

constexpr double kMoon = 1.625;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

SoilParameters stiff(SoilParameters soil) {
  soil.stiffness_n_m = kInfinity;
  return soil;
}

TEST(DensityRms, OfWeightlessSoilIsItsDistanceFromTheLaw) {
  // Constant 1655 kg/m^3 against the law; the fine layers make the sum an integral.
  SoilParameters soil = stiff(rescaled(SoilParameters{}, 1e-3));
  soil.rho0_kg_m3 = 1655;
  double sum = 0;
  constexpr int kSteps = 6000;
  for (int i = 0; i < kSteps; ++i) {
    sum += std::pow(1655 - lunarBulkDensity(0.6 * (i + 0.5) / kSteps), 2);
  }
  EXPECT_NEAR(lunarDensityRms(soil, 0), std::sqrt(sum / kSteps), 0.1);
}

TEST(Calibration, MeetsFrictionAndCohesion) {
  for (const double friction : {0.6, 0.9, 1.2}) {
    for (const double cohesion_pa : {500.0, 970.0, 2000.0}) {
      const Calibration result = calibrate({.friction_coefficient = friction, .cohesion_pa = cohesion_pa});
      EXPECT_NEAR(frictionCoefficient(result.soil.mu_hat), friction, 1e-12);
      EXPECT_NEAR(cohesion(result.soil), cohesion_pa, 0.005 * cohesion_pa);
      EXPECT_DOUBLE_EQ(result.cohesion_pa, cohesion(result.soil));
      EXPECT_DOUBLE_EQ(result.density_rms_kg_m3, lunarDensityRms(result.soil, kMoon));
    }
  }
}

TEST(Calibration, IsAtLeastAsCloseToTheMoonAsThePaper) {
  for (const Preset& preset : presets()) {
    const Calibration result = calibrate(
        {.friction_coefficient = frictionCoefficient(preset.soil.mu_hat), .cohesion_pa = cohesion(preset.soil)});
    EXPECT_LE(result.density_rms_kg_m3, lunarDensityRms(stiff(preset.soil), kMoon)) << preset.name;
  }
}

TEST(Calibration, AgreesWithTheMeasuredBands) {
  for (const Preset& preset : presets()) {
    const Calibration result = calibrate({.friction_coefficient = preset.friction_coefficient, .cohesion_pa = 970});
    const auto layers = layersToDepth(result.soil, kMoon, 0.6);
    for (const MeasuredBand& band : measuredBands()) {
      EXPECT_NEAR(bandMeanDensity(layers, band.top_m, band.bottom_m), band.density_kg_m3, band.tolerance_kg_m3);
    }
  }
}

TEST(Calibration, IsAMinimum) {
  const Calibration best = calibrate({.friction_coefficient = 0.9, .cohesion_pa = 970});
  for (const double rho0_step : {-2.0, 0.0, 2.0}) {
    for (const double rho_max_step : {-2.0, 0.0, 2.0}) {
      SoilParameters other = best.soil;
      other.rho0_kg_m3 += rho0_step;
      other.rho_max_kg_m3 += rho_max_step;
      other.gamma_nm *= 970 / cohesion(other);
      EXPECT_GE(lunarDensityRms(other, kMoon), best.density_rms_kg_m3 - 1e-6);
    }
  }
}

TEST(Calibration, HoldsForEveryRadius) {
  for (const double radius : {0.5e-3, 2e-3, 20e-3}) {
    const Calibration result = calibrate({.friction_coefficient = 0.9, .cohesion_pa = 970, .radius_m = radius});
    EXPECT_EQ(result.soil.radius_m, radius);
    EXPECT_NEAR(cohesion(result.soil), 970, 0.005 * 970);
    EXPECT_LT(result.density_rms_kg_m3, 15);
  }
}

TEST(Calibration, HoldsForEveryBody) {
  for (const double gravity : {0.270, 9.807}) {
    const Calibration result = calibrate({.friction_coefficient = 0.9, .cohesion_pa = 970, .gravity_m_s2 = gravity});
    EXPECT_NEAR(cohesion(result.soil), 970, 0.005 * 970);
    EXPECT_LT(result.density_rms_kg_m3, 60);
  }
}

TEST(Calibration, UsesAFiniteStiffnessWhenAsked) {
  const Calibration result = calibrate({.friction_coefficient = 0.9, .cohesion_pa = 2000, .stiffness_n_m = 100});
  EXPECT_EQ(result.soil.stiffness_n_m, 100);
  EXPECT_NEAR(cohesion(result.soil), 2000, 0.005 * 2000);
  EXPECT_LT(result.density_rms_kg_m3, 50);
}

TEST(Calibration, GivesASoilThatThePapersStiffnessCanRender) {
  for (const double radius : {1e-3, 7e-3}) {
    for (const double cohesion_pa : {970.0, 20000.0}) {
      SoilParameters soil =
          calibrate({.friction_coefficient = 0.9, .cohesion_pa = cohesion_pa, .radius_m = radius}).soil;
      soil.stiffness_n_m = 100 * radius / 7e-3;
      EXPECT_NO_THROW(static_cast<void>(makeContactLaw(soil)));
    }
  }
}

TEST(Calibration, IsTheSameEveryTime) {
  const CalibrationTarget target{.friction_coefficient = 0.7, .cohesion_pa = 800};
  EXPECT_EQ(calibrate(target).soil.rho0_kg_m3, calibrate(target).soil.rho0_kg_m3);
  EXPECT_EQ(calibrate(target).soil.gamma_nm, calibrate(target).soil.gamma_nm);
}

TEST(Calibration, RefusesTargetsThatCannotBeMet) {
  const double nan = std::nan("");
  const auto refuses = [](const char* key, const CalibrationTarget& target) {
    try {
      static_cast<void>(calibrate(target));
      ADD_FAILURE() << key << " passed";
    } catch (const InvalidParameter& error) {
      EXPECT_EQ(error.key(), key);
    }
  };
  for (const double friction : {-0.5, 0.0, nan, 2.5, kInfinity}) {
    refuses("friction_coefficient", {.friction_coefficient = friction, .cohesion_pa = 970});
  }
  for (const double cohesion_pa : {-970.0, 0.0, nan, 1e6, kInfinity}) {
    refuses("cohesion_pa", {.friction_coefficient = 0.9, .cohesion_pa = cohesion_pa});
  }
  for (const double gravity : {-1.6, 0.0, nan}) {
    refuses("gravity_m_s2", {.friction_coefficient = 0.9, .cohesion_pa = 970, .gravity_m_s2 = gravity});
  }
  for (const double radius : {0.0, 0.4e-3, 21e-3, nan}) {
    refuses("radius_m", {.friction_coefficient = 0.9, .cohesion_pa = 970, .radius_m = radius});
  }
  for (const double stiffness : {0.0, -100.0, nan}) {
    refuses("stiffness_n_m", {.friction_coefficient = 0.9, .cohesion_pa = 970, .stiffness_n_m = stiffness});
  }
}

TEST(Calibration, SaysWhichCohesionCanBeReached) {
  try {
    static_cast<void>(calibrate({.friction_coefficient = 0.01, .cohesion_pa = 970}));
    FAIL();
  } catch (const InvalidParameter& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("must be > 0 and < "));
    EXPECT_THAT(error.what(), testing::HasSubstr("friction_coefficient = 0.01"));
  }
}

}  // namespace
}  // namespace haptolith
