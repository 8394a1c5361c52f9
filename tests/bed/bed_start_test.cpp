#include "haptolith/bed/start/bed_start.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "haptolith/bed/bed.h"
#include "haptolith/core/error.h"
#include "haptolith/soil/contact_law.h"
#include "haptolith/soil/layers.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

BedParameters p4() {
  BedParameters bed;
  bed.soil = findPreset("P4").soil;
  return bed;
}

/// Heights of the layers, lowest first: centres within half a micrometre count as one height.
std::vector<double> heightsOf(const std::vector<Vec3>& centres) {
  std::vector<double> heights;
  for (const Vec3& centre : centres) {
    heights.push_back(centre.z());
  }
  std::ranges::sort(heights);
  const auto same = [](double a, double b) { return b - a < 5e-7; };
  heights.erase(std::unique(heights.begin(), heights.end(), same), heights.end());
  return heights;
}

void expectInsideWalls(const std::vector<Vec3>& centres, const BedParameters& bed, double gap_m) {
  for (const Vec3& c : centres) {
    EXPECT_LE(std::abs(c.x()), bed.width_m / 2 - gap_m);
    EXPECT_LE(std::abs(c.y()), bed.length_m / 2 - gap_m);
    EXPECT_GT(c.z(), 0.5 * bed.soil.radius_m);
  }
}

double nearestNeighbour(const std::vector<Vec3>& centres, std::size_t i) {
  double nearest = 1;
  for (std::size_t j = 0; j < centres.size(); ++j) {
    nearest = i == j ? nearest : std::min(nearest, (centres[i] - centres[j]).norm());
  }
  return nearest;
}

TEST(CountStart, ThePapersSceneHas256InThreeLayersInsideTheWalls) {
  for (const Preset& preset : presets()) {
    SCOPED_TRACE(preset.name);
    BedParameters bed;
    bed.soil = preset.soil;
    const std::vector<Vec3> centres = startingCentres(bed);
    ASSERT_EQ(centres.size(), 256U);
    const std::vector<double> heights = heightsOf(centres);
    ASSERT_EQ(heights.size(), 3U);
    expectInsideWalls(centres, bed, bed.soil.radius_m - 1e-8);
    // The floor carries three layers; above, the analysis's spacings under one and two layers, raised by the squeeze.
    const double weight = macroparticleMass(bed.soil) * 1.625;
    EXPECT_NEAR(heights[0], distanceAtForce(makeContactLaw(bed.soil), 3 * weight) / 2, 1e-12);
    EXPECT_GT(heights[1] - heights[0], layerSpacing(bed.soil, 1.625, 2) - 1e-12);
    EXPECT_GT(heights[2] - heights[1], heights[1] - heights[0]);
    EXPECT_LT(heights[2] - heights[1], 1.15 * layerSpacing(bed.soil, 1.625, 1));
    const auto in_layer = [&](double height) {
      return std::ranges::count_if(centres, [&](const Vec3& c) { return std::abs(c.z() - height) < 1e-6; });
    };
    EXPECT_GE(in_layer(heights[0]), 80);
    EXPECT_GE(in_layer(heights[1]), 75);
    EXPECT_GE(in_layer(heights[2]), 75);
  }
}

TEST(CountStart, NobodyIsCloserThanTheSqueezeAllows) {
  const BedParameters bed = p4();
  const std::vector<Vec3> centres = startingCentres(bed);
  for (std::size_t i = 0; i < centres.size(); ++i) {
    const double nearest = nearestNeighbour(centres, i);
    EXPECT_GT(nearest, 0.88 * 2 * bed.soil.radius_m);
    EXPECT_LT(nearest, 2 * bed.soil.radius_m);  // every particle has a support
  }
}

TEST(CountStart, GivesExactlyTheNumberAskedFor) {
  for (const int particles : {200, 230, 240, 250, 256, 260}) {
    BedParameters bed = p4();
    bed.particles = particles;
    try {
      EXPECT_EQ(startingCentres(bed).size(), static_cast<std::size_t>(particles));
    } catch (const InvalidParameter& error) {
      ADD_FAILURE() << particles << ": " << error.what();
    }
  }
}

TEST(CountStart, TooManyParticlesAreRefusedWithTheRange) {
  BedParameters bed = p4();
  bed.particles = 400;
  try {
    (void)startingCentres(bed);
    FAIL() << "400 particles of 7 mm do not fit into three layers of 126 mm x 126 mm";
  } catch (const InvalidParameter& error) {
    EXPECT_EQ(error.key(), "particles");
    EXPECT_EQ(error.value(), "400");
    EXPECT_THAT(error.what(), testing::HasSubstr("at most about 2"));  // two hundred and some
    EXPECT_THAT(error.what(), testing::HasSubstr("in 3 layers"));
  }
}

TEST(CountStart, TooManyAreRefusedSoonInALargeBoxToo) {
  BedParameters bed = p4();
  bed.width_m = bed.length_m = 3;
  bed.particles = 1'000'000;  // three layers of this box hold about 140 000
  EXPECT_THROW((void)startingCentres(bed), InvalidParameter);
}

TEST(CountStart, TooFewForTheLayersAreRefused) {
  BedParameters bed = p4();
  bed.particles = 100;
  try {
    (void)startingCentres(bed);
    FAIL();
  } catch (const InvalidParameter& error) {
    EXPECT_EQ(error.key(), "layers");
    EXPECT_THAT(error.what(), testing::HasSubstr("fewer"));
  }
}

TEST(PackedStart, LayersStandAtTheAnalysisSpacing) {
  BedParameters bed = p4();
  bed.start = BedStart::kPacked;
  bed.depth_m = 0.2;
  const std::vector<Vec3> centres = startingCentres(bed);
  const std::vector<double> heights = heightsOf(centres);
  const int layers = static_cast<int>(heights.size());
  ASSERT_GT(layers, 15);
  for (int n = 1; n < layers; ++n) {  // n layers above
    const std::size_t lower = heights.size() - 1 - static_cast<std::size_t>(n);
    EXPECT_NEAR(heights[lower + 1] - heights[lower], layerSpacing(bed.soil, 1.625, n), 1e-12) << n;
  }
  expectInsideWalls(centres, bed, bed.soil.radius_m - 1e-8);
  // The bed is as high as asked for, to within half a layer.
  EXPECT_NEAR(heights.back() + bed.soil.radius_m, 0.2, 0.6 * layerSpacing(bed.soil, 1.625, 1));
}

TEST(PackedStart, NeighboursInALayerTouchAndLayersOverlapAsTheAnalysisSays) {
  BedParameters bed = p4();
  bed.start = BedStart::kPacked;
  bed.depth_m = 0.1;
  const std::vector<Vec3> centres = startingCentres(bed);
  const double r = bed.soil.radius_m;
  for (std::size_t i = 0; i < centres.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3 apart = centres[i] - centres[j];
      if (std::abs(apart.z()) < 1e-6) {
        EXPECT_GE(apart.norm(), 2 * r - 1e-12);
      } else if (std::abs(apart.z()) < 2 * r &&
                 apart.head<2>().norm() < 1.2 * r) {  // one rests on the other: (paper 5) sideways
        EXPECT_NEAR(apart.head<2>().norm(), 2 * r / std::sqrt(3.0), 1e-12);
      }
    }
  }
}

TEST(PackedStart, WeightlessLayersKeepTheSurfaceSpacing) {
  BedParameters bed = p4();
  bed.start = BedStart::kPacked;
  bed.gravity_m_s2 = Vec3::Zero();
  const std::vector<double> heights = heightsOf(startingCentres(bed));
  for (std::size_t i = 1; i < heights.size(); ++i) {
    EXPECT_NEAR(heights[i] - heights[i - 1], 2 * std::sqrt(2.0 / 3) * bed.soil.radius_m, 1e-12);
  }
}

TEST(PackedStart, MoreParticlesThanAnyoneCanComputeAreRefused) {
  BedParameters bed = p4();
  bed.start = BedStart::kPacked;
  bed.width_m = bed.length_m = 10;
  bed.depth_m = 1;  // fifty million of 7 mm
  EXPECT_THROW((void)startingCentres(bed), InvalidParameter);
}

TEST(RainStart, DropsApartInsideTheWallsAndDependsOnTheSeedAlone) {
  BedParameters bed = p4();
  bed.start = BedStart::kRain;
  bed.particles = 300;
  const std::vector<Vec3> centres = startingCentres(bed);
  ASSERT_EQ(centres.size(), 300U);
  expectInsideWalls(centres, bed, bed.soil.radius_m - 1e-8);
  for (std::size_t i = 0; i < centres.size(); ++i) {
    EXPECT_GT(nearestNeighbour(centres, i), 2 * bed.soil.radius_m);  // no particle starts pressed into another
  }
  EXPECT_EQ(startingCentres(bed), centres);
  bed.seed = 2;
  EXPECT_NE(startingCentres(bed), centres);
}

TEST(Sandbox, HasRoomForAboutAsManyAsAskedFor) {
  for (const double radius_m : {0.002, 0.007}) {
    for (const int particles : {1000, 20'000}) {
      BedParameters bed;
      bed.soil.radius_m = radius_m;
      const BedParameters sandbox = withRoomFor(particles, bed);
      EXPECT_NEAR(static_cast<double>(startingCentres(sandbox).size()) / particles, 1, 0.15);
      EXPECT_LE(sandbox.depth_m, 0.12);
    }
  }
}

}  // namespace
}  // namespace haptolith
