// Undisturbed beds: they settle, stay at rest, and never have more energy than they were given.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/bed/critical_step.h"
#include "haptolith/bed/start/bed_start.h"
#include "haptolith/core/error.h"
#include "haptolith/soil/layers.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

constexpr double kTick_s = 1e-3;

/// The project's bound for rest: no particle faster than this within 5 s.
constexpr double kAtRest_m_s = 1e-4;

BedParameters p4() {
  BedParameters bed;
  bed.soil = findPreset("P4").soil;
  bed.sleep = false;  // or it would have no chance to creep
  return bed;
}

void run(Bed& bed, int steps) {
  for (int i = 0; i < steps; ++i) {
    ASSERT_EQ(bed.step(kTick_s), StepStatus::kOk) << "step " << i;
  }
}

std::vector<Vec3> centresOf(const Bed& bed) {
  std::vector<Vec3> centres;
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    const Float4& p = bed.state().position[i];
    centres.emplace_back(p.x, p.y, p.z);
  }
  return centres;
}

/// Checks that no particle is through a wall or the floor. A wall's force grows with k, so a centre may be slightly
/// nearer than R.
void expectInside(const Bed& bed) {
  const BedParameters& box = bed.parameters();
  for (const Vec3& c : centresOf(bed)) {
    ASSERT_TRUE(c.allFinite());
    EXPECT_LT(std::abs(c.x()), box.width_m / 2 - 0.5 * box.soil.radius_m);
    EXPECT_LT(std::abs(c.y()), box.length_m / 2 - 0.5 * box.soil.radius_m);
    EXPECT_GT(c.z(), 0.5 * box.soil.radius_m);
  }
}

// --- rest -----------------------------------------------------------------------------------------------------------

TEST(Rest, ThePapersSceneComesToRestWithinFiveSecondsAndDoesNotCreep) {
  for (const Preset& preset : presets()) {
    SCOPED_TRACE(preset.name);
    BedParameters parameters;
    parameters.soil = preset.soil;
    Bed bed(parameters);
    run(bed, 5000);
    EXPECT_LT(bed.largestSpeed(), kAtRest_m_s);
    const std::vector<Vec3> before = centresOf(bed);
    run(bed, 5000);
    const std::vector<Vec3> after = centresOf(bed);
    double furthest = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
      furthest = std::max(furthest, (after[i] - before[i]).norm());
    }
    EXPECT_LT(furthest, 1e-6) << "creep";
    expectInside(bed);
  }
}

TEST(Rest, APackedBedComesToRestOnEveryBody) {
  for (const double g : {0.27, 1.625, 9.807}) {
    SCOPED_TRACE(g);
    BedParameters parameters = p4();
    parameters.gravity_m_s2 = {0, 0, -g};
    parameters.start = BedStart::kPacked;
    parameters.depth_m = 0.1;
    Bed bed(parameters);
    run(bed, 5000);
    EXPECT_LT(bed.largestSpeed(), kAtRest_m_s);
    expectInside(bed);
  }
}

// --- energy ---------------------------------------------------------------------------------------------------------

/// The energy along a run, looked at every step: the largest rise above the least value so far.
double largestRise(Bed& bed, int steps, double dt_s) {
  double least = bed.energy();
  double rise = 0;
  for (int i = 0; i < steps; ++i) {
    EXPECT_EQ(bed.step(dt_s), StepStatus::kOk);
    const double energy = bed.energy();
    rise = std::max(rise, energy - least);
    least = std::min(least, energy);
  }
  return rise;
}

/// Energy that float positions alone can make appear: each of n particles is rounded by up to half a unit in the last
/// place of 0.1 m (4e-9 m) against a contact force of at most 0.1 N on each of its dozen contacts, at random signs.
double roundingEnergy(std::size_t particles) {
  return 4e-9 * 0.1 * 12 * static_cast<double>(particles);
}

TEST(Energy, NeverGrowsInABedThatNobodyTouches) {
  for (const Preset& preset : presets()) {
    SCOPED_TRACE(preset.name);
    BedParameters parameters = p4();
    parameters.soil = preset.soil;
    Bed bed(parameters);
    EXPECT_LT(largestRise(bed, 2000, kTick_s), roundingEnergy(bed.particles()));
  }
}

TEST(Energy, NeverGrowsWhileItRains) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    BedParameters parameters = p4();
    parameters.start = BedStart::kRain;
    parameters.particles = 150;
    parameters.seed = seed;
    Bed bed(parameters, startingCentres(parameters));
    const double start = bed.energy();
    EXPECT_GT(start, 0);
    // A semi-implicit step is exact in energy only on average over an oscillation: while a particle hits another at v,
    // the energy of the contact at the step's end is off by up to F v dt. With 0.3 m/s, 0.05 N: 1.5e-5 J a contact, one
    // at a time for the most part, while the whole bed has 0.04 J.
    EXPECT_LT(largestRise(bed, 3000, kTick_s), 1.5e-5);
    EXPECT_LT(bed.energy(), 0.9 * start);
  }
}

TEST(Energy, OfARandomCrowdNeverExceedsWhatItHadAtFirst) {
  // Deeply overlapping particles burst apart: nothing they do later may hold more than they began with.
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    for (const double mu_hat : {0.0, 0.3}) {
      BedParameters parameters = p4();
      parameters.soil.mu_hat = mu_hat;
      std::mt19937_64 random(seed);
      std::uniform_real_distribution<double> anywhere(-0.055, 0.055);
      std::vector<Vec3> centres;
      for (int i = 0; i < 150; ++i) {
        centres.emplace_back(anywhere(random), anywhere(random), 0.065 + anywhere(random));
      }
      Bed bed(parameters, centres);
      const double start = bed.energy();
      for (int i = 0; i < 1500; ++i) {
        ASSERT_EQ(bed.step(kTick_s), StepStatus::kOk);
        ASSERT_LE(bed.energy(), start * (1 + 1e-6)) << "seed " << seed << ", step " << i;
      }
      expectInside(bed);
    }
  }
}

// --- settling -------------------------------------------------------------------------------------------------------

TEST(Rain, SettlesInsideTheWallsAtASaneDensityAndStaysThere) {
  BedParameters parameters = p4();
  parameters.start = BedStart::kRain;
  parameters.particles = 400;
  double density = 0;
  constexpr int kBeds = 4;
  for (int seed = 1; seed <= kBeds; ++seed) {
    parameters.seed = static_cast<std::uint64_t>(seed);
    Bed bed(parameters);
    EXPECT_EQ(bed.state().step, 0U);
    EXPECT_EQ(bed.largestSpeed(), 0);
    expectInside(bed);
    density += static_cast<double>(bed.particles()) * bed.mass() /
               (parameters.width_m * parameters.length_m * bed.surfaceHeight()) / kBeds;
    run(bed, 5000);
    EXPECT_LT(bed.largestSpeed(), kAtRest_m_s);
    expectInside(bed);
  }
  // Between a loose heap and the densest the law knows. The box is only 9 particles wide, so walls leave gaps, and the
  // highest particle determines the height of the soil: that alone is 4 % from one bed to the next.
  EXPECT_GT(density, 0.7 * parameters.soil.rho0_kg_m3);
  EXPECT_LT(density, parameters.soil.rho_max_kg_m3);
}

TEST(Settle, SaysWhenABedDoesNotComeToRest) {
  Bed bed(p4(), {Vec3(0, 0, 0.9)});
  EXPECT_THROW(bed.settle(kTick_s, 0.5), Failure);
}

TEST(Settle, StopsWhenItsCallerWantsItTo) {
  Bed bed(p4(), {Vec3(0, 0, 0.9)});
  int looks = 0;
  const auto give_up = [&](double time_s, double speed_m_s) {
    EXPECT_GT(time_s, 0);
    EXPECT_GT(speed_m_s, 0);
    return ++looks < 3;
  };
  EXPECT_THROW(bed.settle(kTick_s, 60, give_up), Failure);
  EXPECT_EQ(looks, 3);
}

/// Mass in a band of depth over the band's volume, in kg/m^3. Each particle counts with a height of one layer, on its
/// share of the lattice, 2 sqrt(3) R^2 (paper 2): the walls' gaps are no soil. The surface is half a spacing above the
/// top layer's centres (paper 12).
double bandDensity(const Bed& bed, std::size_t in_a_layer, double top_m, double bottom_m) {
  const SoilParameters& soil = bed.parameters().soil;
  std::vector<double> heights;
  for (const Vec3& centre : centresOf(bed)) {
    heights.push_back(centre.z());
  }
  std::ranges::sort(heights, std::greater{});
  double top_centres = 0;
  for (std::size_t i = 0; i < in_a_layer; ++i) {
    top_centres += heights[i] / static_cast<double>(in_a_layer);
  }
  const double surface = top_centres + layerSpacing(soil, 1.625, 0) / 2;
  const double own_height = layerSpacing(soil, 1.625, 20);
  double particles = 0;
  for (const double height : heights) {
    const double from = std::max(top_m, surface - height - own_height / 2);
    const double to = std::min(bottom_m, surface - height + own_height / 2);
    particles += std::max(0.0, to - from) / own_height;
  }
  const double area = static_cast<double>(in_a_layer) * 2 * std::sqrt(3.0) * soil.radius_m * soil.radius_m;
  return particles * bed.mass() / (area * (bottom_m - top_m));
}

TEST(PackedBed, ADeepBedKeepsTheDensityOfTheAnalysisUnderFriction) {
  // P4 on the Moon, 0.65 m deep on a small footprint that fits the lattice. Friction holds the particles where the
  // analysis puts them. (Settled without friction the same bed sinks by 10 cm: the analysis knows no sideways stress,
  // and a frictionless bed yields sideways until it has some.)
  BedParameters parameters = p4();
  const double r = parameters.soil.radius_m;
  parameters.width_m = 2 * r + 7 * r;                                // rows of 4, each second one shifted by R
  parameters.length_m = 2 * r + (3 + 1.0 / 3) * std::sqrt(3.0) * r;  // 4 rows and the shift of the layers B
  parameters.start = BedStart::kPacked;
  parameters.depth_m = 0.65;
  Bed bed(parameters);
  ASSERT_EQ(bed.particles() % 16, 0U);
  run(bed, 5000);
  EXPECT_LT(bed.largestSpeed(), kAtRest_m_s);
  const std::vector<Layer> analysis = layersToDepth(parameters.soil, 1.625, 0.62);
  for (const auto& [top, bottom] : {std::pair{0.0, 0.15}, {0.0, 0.3}, {0.3, 0.6}, {0.0, 0.6}}) {
    // A particle spread over one height instead of its layer's moves the edge of a band by up to 1 mm: 1 mm of 15
    // cm.
    EXPECT_NEAR(bandDensity(bed, 16, top, bottom), bandMeanDensity(analysis, top, bottom), 10) << top << " " << bottom;
  }
}

}  // namespace
}  // namespace haptolith
