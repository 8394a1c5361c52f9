#include "haptolith/soil/layers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "haptolith/core/error.h"
#include "haptolith/soil/lunar_density.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

constexpr double kMoon = 1.625;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

SoilParameters stiffPreset(std::string_view name) {
  SoilParameters soil = findPreset(name).soil;
  soil.stiffness_n_m = kInfinity;
  return soil;
}

struct HandSums {
  double mass, a_min, h;
};

HandSums handSums(const SoilParameters& soil) {
  const double r = soil.radius_m;
  const double ratio = soil.rho0_kg_m3 / soil.rho_max_kg_m3;
  const double a_min = r * std::sqrt(8.0 / 3 * ratio * ratio + 4.0 / 3);
  return {4 * std::sqrt(2.0) * soil.rho0_kg_m3 * r * r * r, a_min, soil.gamma_nm / (2 * r - a_min)};
}

TEST(Layers, SurfaceSpacingIsTheCloseLattice) {
  EXPECT_NEAR(layerSpacing(stiffPreset("P3"), kMoon, 0), 0.0114309521, 1e-9);  // 2 sqrt(2/3) 7 mm
}

TEST(Layers, SpacingBalancesTheWeightAbove) {
  for (const Preset& preset : presets()) {
    const SoilParameters soil = stiffPreset(preset.name);
    const auto [mass, a_min, h] = handSums(soil);
    for (const int n : {1, 2, 10, 60, 1000}) {
      const double b = layerSpacing(soil, kMoon, n);
      const double a = std::sqrt(b * b + 4 * soil.radius_m * soil.radius_m / 3);
      const double load = n * mass * kMoon / 3;
      EXPECT_NEAR(b / a * (soil.gamma_nm / (a - a_min) - h), load, 1e-9 * load) << preset.name << ", layer " << n;
    }
  }
}

TEST(Layers, SpacingIsARootOfTheQuartic) {
  // (paper 10): the balance multiplied out and squared.
  for (const Preset& preset : presets()) {
    const SoilParameters soil = stiffPreset(preset.name);
    const auto [mass, a_min, h] = handSums(soil);
    for (const int n : {1, 10, 60}) {
      const double b = layerSpacing(soil, kMoon, n);
      const double load = n * mass * kMoon / 3;
      const double a_squared = b * b + 4 * soil.radius_m * soil.radius_m / 3;
      const double left = std::pow(b * (soil.gamma_nm + h * a_min) - a_squared * load, 2);
      const double right = a_squared * std::pow(b * h - a_min * load, 2);
      EXPECT_NEAR(left, right, 1e-7 * std::abs(left));
    }
  }
}

TEST(Layers, SpacingStaysBetweenTheDensestAndTheLoosestLattice) {
  for (const Preset& preset : presets()) {
    const SoilParameters soil = stiffPreset(preset.name);
    const double loosest = layerSpacing(soil, kMoon, 0);
    const double densest = loosest * soil.rho0_kg_m3 / soil.rho_max_kg_m3;
    for (const int n : {1, 100, 100000, 100000000}) {
      EXPECT_LT(layerSpacing(soil, kMoon, n), loosest);
      EXPECT_GE(layerSpacing(soil, kMoon, n), densest);
    }
  }
}

TEST(Layers, DepthAndDensityFollowFromTheSpacings) {
  const SoilParameters soil = stiffPreset("P4");
  const auto layers = layersToDepth(soil, kMoon, 0.3);
  double depth = layerSpacing(soil, kMoon, 0) / 2;
  for (std::size_t n = 0; n < layers.size(); ++n) {
    const int layer = static_cast<int>(n);
    const double b = layerSpacing(soil, kMoon, layer);
    const double next = layerSpacing(soil, kMoon, layer + 1);
    depth += n == 0 ? 0 : b;
    EXPECT_EQ(layers[n].layer, layer);
    EXPECT_DOUBLE_EQ(layers[n].spacing_m, b);
    EXPECT_NEAR(layers[n].depth_m, depth, 1e-12);
    EXPECT_NEAR(layers[n].density_kg_m3,
                4 * std::sqrt(2.0) * soil.radius_m * soil.rho0_kg_m3 / (std::sqrt(3.0) * (b + next)), 1e-9);
  }
}

TEST(Layers, CoverTheDepthWithoutGapsAndNoFurther) {
  const auto layers = layersToDepth(stiffPreset("P4"), kMoon, 0.3);
  EXPECT_EQ(layers.front().top_m, 0);
  for (std::size_t n = 1; n < layers.size(); ++n) {
    EXPECT_EQ(layers[n].top_m, layers[n - 1].bottom_m);
    EXPECT_NEAR(layers[n].top_m, (layers[n - 1].depth_m + layers[n].depth_m) / 2, 1e-15);
  }
  EXPECT_LT(layers.back().top_m, 0.3);
  EXPECT_GE(layers.back().bottom_m, 0.3);
}

TEST(Layers, EachHoldsTheMassOfOneMacroparticlePerCell) {
  // density x height = m / (2 sqrt(3) R^2), the same for every layer (paper 2).
  const SoilParameters soil = stiffPreset("P5");
  const double per_area = handSums(soil).mass / (2 * std::sqrt(3.0) * soil.radius_m * soil.radius_m);
  const auto layers = layersToDepth(soil, kMoon, 0.6);
  for (std::size_t n = 1; n < layers.size(); ++n) {
    EXPECT_NEAR(layers[n].density_kg_m3 * (layers[n].bottom_m - layers[n].top_m), per_area, 1e-9);
  }
}

TEST(BulkDensity, NeverDecreasesWithDepth) {
  for (const Preset& preset : presets()) {
    for (const SoilParameters& soil : {preset.soil, stiffPreset(preset.name)}) {
      const auto layers = layersToDepth(soil, kMoon, 0.6);
      for (std::size_t n = 1; n < layers.size(); ++n) {
        EXPECT_GE(layers[n].density_kg_m3, layers[n - 1].density_kg_m3);
      }
    }
  }
}

TEST(BulkDensity, HasTheRecomputedBandMeans) {
  const double expected[6][4]{{1481, 1571, 1733, 1652}, {1481, 1564, 1723, 1644}, {1485, 1562, 1715, 1638},
                              {1485, 1560, 1726, 1643}, {1502, 1569, 1732, 1650}, {1488, 1553, 1730, 1642}};
  for (std::size_t i = 0; i < 6; ++i) {
    const auto layers = layersToDepth(stiffPreset(presets()[i].name), kMoon, 0.6);
    for (std::size_t j = 0; j < 4; ++j) {
      const MeasuredBand& band = measuredBands()[j];
      EXPECT_NEAR(bandMeanDensity(layers, band.top_m, band.bottom_m), expected[i][j], 1) << presets()[i].name;
    }
  }
}

TEST(BulkDensity, OfEveryPresetAgreesWithTheMoon) {
  for (const Preset& preset : presets()) {
    const auto layers = layersToDepth(stiffPreset(preset.name), kMoon, 0.6);
    for (const MeasuredBand& band : measuredBands()) {
      EXPECT_NEAR(bandMeanDensity(layers, band.top_m, band.bottom_m), band.density_kg_m3, band.tolerance_kg_m3)
          << preset.name;
    }
  }
}

TEST(BulkDensity, WithoutGravityIsTheSurfaceDensity) {
  const auto layers = layersToDepth(stiffPreset("P3"), 0, 0.6);
  EXPECT_NEAR(layers.back().density_kg_m3, 1330, 1e-9);
}

TEST(BulkDensity, GrowsWithGravity) {
  const auto moon = layersToDepth(stiffPreset("P3"), kMoon, 0.6);
  const auto earth = layersToDepth(stiffPreset("P3"), 9.807, 0.6);
  EXPECT_GT(bandMeanDensity(earth, 0, 0.6), bandMeanDensity(moon, 0, 0.6) + 50);
}

TEST(FiniteStiffness, IsSofterInDeepLayersAndTheSameInShallowOnes) {
  for (const char* name : {"P1", "P2", "P3"}) {
    const SoilParameters soft = findPreset(name).soil;
    EXPECT_DOUBLE_EQ(layerSpacing(soft, kMoon, 3), layerSpacing(stiffPreset(name), kMoon, 3));
    EXPECT_LT(layerSpacing(soft, kMoon, 50), 0.97 * layerSpacing(stiffPreset(name), kMoon, 50));
  }
}

TEST(FiniteStiffness, ManyTimesLargerIsAsGoodAsInfinite) {
  SoilParameters soil = stiffPreset("P3");
  const double infinite = layerSpacing(soil, kMoon, 60);
  soil.stiffness_n_m = 1e12;
  EXPECT_DOUBLE_EQ(layerSpacing(soil, kMoon, 60), infinite);
}

TEST(FiniteStiffness, BalancesTheWeightOnTheLine) {
  const SoilParameters soil = findPreset("P1").soil;
  const auto [mass, a_min, h] = handSums(soil);
  const double a_thr = a_min + std::sqrt(soil.gamma_nm / 100);
  const double b = layerSpacing(soil, kMoon, 55);
  const double a = std::hypot(b, 2 * soil.radius_m / std::sqrt(3.0));
  ASSERT_LT(a, a_thr);
  const double force = soil.gamma_nm / (a_thr - a_min) - h + 100 * (a_thr - a);
  EXPECT_NEAR(b / a * force, 55 * mass * kMoon / 3, 1e-12);
}

TEST(FiniteStiffness, ThatCannotCarryTheLoadFailsInWords) {
  const SoilParameters soil = findPreset("P1").soil;
  EXPECT_THROW(static_cast<void>(layerSpacing(soil, 9.807, 60)), Failure);
  EXPECT_THROW(static_cast<void>(layersToDepth(soil, 9.807, 0.6)), Failure);
}

TEST(LinearModel, BalancesTheWeight) {
  const SoilParameters soil = findPreset("P1").soil;
  const auto layers = linearLayersToDepth(soil, kMoon, 0.6);
  const double load = 20 * handSums(soil).mass * kMoon / 3;
  const double b = layers[20].spacing_m;
  const double a = std::hypot(b, 2 * soil.radius_m / std::sqrt(3.0));
  EXPECT_NEAR(b / a * 100 * (2 * soil.radius_m - a), load, 1e-12);
}

TEST(LinearModel, IsTooLooseNearTheSurface) {
  // Why the paper discards it (paper, Fig. 2).
  const auto layers = linearLayersToDepth(findPreset("P1").soil, kMoon, 0.6);
  EXPECT_LT(bandMeanDensity(layers, 0, 0.15), 1500 - 50);
}

TEST(LinearModel, NeedsAFiniteStiffness) {
  EXPECT_THROW(static_cast<void>(linearLayersToDepth(stiffPreset("P1"), kMoon, 0.6)), InvalidParameter);
}

TEST(BandMean, IsExactForConstantDensityAndPartOfALayer) {
  const auto layers = layersToDepth(stiffPreset("P3"), kMoon, 0.6);
  const Layer& layer = layers[10];
  EXPECT_NEAR(bandMeanDensity(layers, layer.top_m + 0.002, layer.top_m + 0.005), layer.density_kg_m3, 1e-9);
  EXPECT_NEAR(bandMeanDensity(layers, layer.depth_m, layer.depth_m + layers[11].spacing_m),
              (layer.density_kg_m3 + layers[11].density_kg_m3) / 2, 0.1);
}

TEST(BandMean, RefusesBandsThatAreEmptyOrNotCovered) {
  const auto layers = layersToDepth(stiffPreset("P3"), kMoon, 0.3);
  EXPECT_THROW(static_cast<void>(bandMeanDensity(layers, 0.1, 0.1)), InvalidParameter);
  EXPECT_THROW(static_cast<void>(bandMeanDensity(layers, 0, 0.6)), InvalidParameter);
  EXPECT_THROW(static_cast<void>(bandMeanDensity(layers, -0.1, 0.1)), InvalidParameter);
  EXPECT_THROW(static_cast<void>(bandMeanDensity({}, 0, 0.1)), InvalidParameter);
}

TEST(Layers, RefuseNonsense) {
  SoilParameters soil = stiffPreset("P3");
  EXPECT_THROW(static_cast<void>(layerSpacing(soil, -1.6, 3)), InvalidParameter);
  EXPECT_THROW(static_cast<void>(layerSpacing(soil, std::nan(""), 3)), InvalidParameter);
  EXPECT_THROW(static_cast<void>(layerSpacing(soil, kMoon, -1)), InvalidParameter);
  for (const double depth : {0.0, -0.1, std::nan(""), kInfinity, 1e6}) {
    EXPECT_THROW(static_cast<void>(layersToDepth(soil, kMoon, depth)), InvalidParameter);
  }
  soil.radius_m = 0;
  EXPECT_THROW(static_cast<void>(layerSpacing(soil, kMoon, 3)), InvalidParameter);
  EXPECT_THROW(static_cast<void>(layersToDepth(soil, kMoon, 0.6)), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
