// Beds with grains of several sizes: the law between them, what is conserved, and how such a bed begins.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "haptolith/bed/bed.h"
#include "haptolith/bed/critical_step.h"
#include "haptolith/bed/measure/surface_height.h"
#include "haptolith/core/error.h"
#include "haptolith/soil/contact_law.h"

namespace haptolith {
namespace {

SoilParameters testSoil() {
  SoilParameters soil;
  soil.gamma_nm = 6e-5;
  soil.rho0_kg_m3 = 1400;
  soil.rho_max_kg_m3 = 1801.4;
  soil.friction = FrictionModel::kContact;
  soil.stiffness_n_m = 3000;
  soil.contact_friction = 0.35;
  soil.contact_cohesion_n = 0.25;
  soil.size_spread = 0.15;
  return soil;
}

BedParameters gradedBox(double fine_radius_m = 1.75e-3) {
  BedParameters bed;
  bed.soil = testSoil();
  bed.width_m = bed.length_m = 0.09;
  bed.start = BedStart::kRain;
  bed.particles = 130;
  bed.grading.fine_radius_m = fine_radius_m;
  bed.grading.fine_width_m = bed.grading.fine_length_m = 0.02;
  bed.grading.fine_depth_m = std::max(0.012, 4 * fine_radius_m);
  return bed;
}

/// A grain of a class and exactly its size.
Float4 grain(const BedParameters& bed, int grain_class, const Vec3& at) {
  const double r = bed.soil.radius_m;
  return {static_cast<float>(at.x()), static_cast<float>(at.y()), static_cast<float>(at.z()),
          static_cast<float>((GrainClasses::scale(grain_class) - 1) * r)};
}

/// Groups of 16 far from each other, except the placed ones.
std::vector<Float4> withOnly(const BedParameters& bed, const std::vector<std::vector<Float4>>& of_class) {
  std::vector<Float4> grains;
  for (std::size_t c = 0; c < of_class.size(); ++c) {
    for (std::size_t i = 0; i < 16; ++i) {
      grains.push_back(i < of_class[c].size()
                           ? of_class[c][i]
                           : grain(bed, static_cast<int>(c),
                                   {0.05 * (1.0 + static_cast<double>(i)), 0.3 + 0.2 * static_cast<double>(c), 1}));
    }
  }
  return grains;
}

BedParameters space() {
  BedParameters bed = gradedBox();
  bed.width_m = bed.length_m = 4;
  bed.gravity_m_s2 = {0, 0, 0};
  bed.sleep = false;
  return bed;
}

TEST(GrainClasses, AreToldApartByTheirSizeHoweverWideItSpreads) {
  for (const double spread : {0.0, 0.3}) {
    const GrainClasses classes(7e-3, 4);
    for (int c = 0; c < 4; ++c) {
      for (const double of_mean : {1 - spread, 1.0, 1 + spread}) {
        const double radius_m = of_mean * GrainClasses::scale(c) * 7e-3;
        EXPECT_EQ(classes.of(static_cast<float>(radius_m - 7e-3)), c) << radius_m;
      }
    }
  }
  EXPECT_EQ(GrainClasses(7e-3, 1).of(-6.9e-3F), 0);  // all alike
}

TEST(GradedBed, TellsHowManyGrainsOfWhichClassFollowOneAnother) {
  const BedParameters parameters = space();
  std::vector<Float4> grains = withOnly(parameters, {{}, {}, {}});
  grains.resize(grains.size() - 5);
  const std::vector<Bed::GrainRun> runs = Bed(parameters, grains).grainRuns();
  ASSERT_EQ(runs.size(), 3U);
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_EQ(runs[c].grain_class, static_cast<int>(c));
    EXPECT_EQ(runs[c].count, c < 2 ? 16U : 11U);
  }
  const Bed alike(BedParameters{});
  ASSERT_EQ(alike.grainRuns().size(), 1U);
  EXPECT_EQ(alike.grainRuns()[0].count, alike.particles());
}

TEST(GradedBed, TwoGrainsPushEachOtherLikeTwoOfTheSizeBetween) {
  const BedParameters parameters = space();
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      const double ra = GrainClasses::scale(a) * 7e-3;
      const double rb = GrainClasses::scale(b) * 7e-3;
      const double between = 2 * ra * rb / (ra + rb);
      const ContactLaw law = makeContactLaw(rescaled(parameters.soil, between));
      for (const double gap : {-0.06, -0.01, 0.1, 0.3}) {  // in the radius between
        const double gap_m = gap * between;
        std::vector<std::vector<Float4>> placed(3);
        placed[static_cast<std::size_t>(a)].push_back(grain(parameters, a, {0, 0, 0.5}));
        placed[static_cast<std::size_t>(b)].push_back(grain(parameters, b, {0, ra + rb + gap_m, 0.5}));
        Bed bed(parameters, withOnly(parameters, placed));
        const double dt_s = 1e-5;
        ASSERT_EQ(bed.step(dt_s), StepStatus::kOk);
        const std::size_t first = kGroup * static_cast<std::size_t>(a);
        const std::size_t second = kGroup * static_cast<std::size_t>(b) + (a == b ? 1 : 0);
        const double mass_a = macroparticleMass(rescaled(parameters.soil, ra));
        const double mass_b = macroparticleMass(rescaled(parameters.soil, rb));
        const double push_a = -mass_a * bed.state().velocity[first].y / dt_s;
        const double push_b = mass_b * bed.state().velocity[second].y / dt_s;
        const double expected = contactForce(law, 2 * between + gap_m);
        EXPECT_NEAR(push_a, expected, 2e-4 * std::abs(expected) + 2e-5 * law.stiffness_n_m * between) << a << b << gap;
        EXPECT_NEAR(push_a, push_b, 1e-6 * std::abs(push_a)) << a << b << gap;
      }
    }
  }
}

TEST(GradedBed, MomentumStaysInACloudThatCollides) {
  BedParameters parameters = space();
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<Float4> grains;
  const auto apart = [&](const Float4& g) {
    return std::ranges::none_of(grains, [&](const Float4& other) {
      return std::hypot(g.x - other.x, g.y - other.y, g.z - other.z) < 0.95 * (14e-3 + g.w + other.w);
    });
  };
  for (int c = 0; c < 3; ++c) {
    for (int i = 0; i < 48;) {
      const Vec3 at = 0.05 * Vec3(unit(random), unit(random), unit(random));
      const Float4 g = grain(parameters, c, at + Vec3(0, 0, 1));
      if (apart(g)) {
        grains.push_back(g);
        ++i;
      }
    }
  }
  Bed bed(parameters, grains);
  BedState state = bed.state();
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    Float4& v = state.velocity[i];
    const Float4& p = state.position[i];
    v = {static_cast<float>(-4 * p.x + 0.05 * unit(random)), static_cast<float>(-4 * p.y),
         static_cast<float>(-4 * (p.z - 1)), 0};
  }
  bed.restore(state);
  const auto momentum = [&] {
    Vec3 sum = Vec3::Zero();
    double size = 0;
    for (std::size_t i = 0; i < bed.particles(); ++i) {
      const Float4& v = bed.state().velocity[i];
      const double mass = bed.mass() * GrainClasses::scale(3 * bed.classOf(i));
      sum += mass * Vec3(v.x, v.y, v.z);
      size += mass * Vec3(v.x, v.y, v.z).norm();
    }
    return std::pair(sum, size);
  };
  const double still = Bed(parameters, grains).energy();
  const auto [before, size] = momentum();
  const double energy = bed.energy();
  const double dt_s = 1e-3 / substepsFor(parameters, 0);
  double highest = energy;
  for (int k = 0; k < 3000; ++k) {
    ASSERT_EQ(bed.step(dt_s), StepStatus::kOk);
    highest = std::max(highest, k % 100 == 0 ? bed.energy() : highest);
  }
  EXPECT_LT((momentum().first - before).norm(), 2e-6 * size);
  const double given = energy - still;
  EXPECT_LE(highest - energy, 1e-3 * given);
  EXPECT_LT(bed.energy(), energy - 0.3 * given);  // they did collide
}

TEST(GradedBed, BeginsWithFineGrainsWhereTheyAreWantedAndAtRest) {
  const BedParameters parameters = gradedBox();
  const Bed bed(parameters);
  std::array<int, 3> grains{};
  double fine_elsewhere = 0;
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    const int c = bed.classOf(i);
    ++grains[static_cast<std::size_t>(c)];
    const Float4& p = bed.state().position[i];
    fine_elsewhere += c == 2 && std::max(std::abs(p.x), std::abs(p.y)) > 0.0135F ? 1 : 0;
  }
  EXPECT_GT(grains[0], 40);
  EXPECT_GT(grains[1], 60);
  EXPECT_GT(grains[2], 60);
  // Further away than a diameter: settling without friction mixes a little, 0.14 to 0.29 of them with 14 seeds.
  EXPECT_LT(fine_elsewhere, 0.4 * grains[2]);
  EXPECT_EQ(grains[0] % 16, 0);
  EXPECT_EQ(grains[1] % 16, 0);
}

/// Soil sinks where sizes are joined, where it slumps to bare walls, and when cohesion draws it together: a bed of
/// A bed of several sizes, 45 mm deep, was once 26 mm deep and continued to sink.
TEST(GradedBed, LiesAsHighAsItsSoilWithoutFinerGrainsAndStays) {
  BedParameters parameters = gradedBox(3.5e-3);
  parameters.start = BedStart::kSettled;
  parameters.depth_m = 0.04;
  parameters.width_m = parameters.length_m = 0.12;
  parameters.grading.fine_width_m = parameters.grading.fine_length_m = 0.05;
  parameters.grading.fine_depth_m = 0.02;
  BedParameters coarse = parameters;
  coarse.grading = {};
  Bed bed(parameters);
  const double height_m = meanSurfaceHeight(bed);
  EXPECT_NEAR(height_m, meanSurfaceHeight(Bed(coarse)), 0.35 * parameters.soil.radius_m);
  EXPECT_GT(bed.heldParticles(), 0U);
  const double dt_s = parameters.tick_s / substepsFor(parameters, 0);
  for (int i = 0; i < 2000; ++i) {
    ASSERT_EQ(bed.step(dt_s), StepStatus::kOk);
  }
  EXPECT_NEAR(meanSurfaceHeight(bed), height_m, 0.005 * parameters.soil.radius_m);
}

TEST(GradedBed, StaysAtRestAndGainsNothing) {
  const BedParameters parameters = gradedBox(3.5e-3);
  Bed bed(parameters);
  const double dt_s = 1e-3 / substepsFor(parameters, 0);
  const double before = bed.energy();
  double highest = before;
  for (int k = 0; k < 10000; ++k) {
    ASSERT_EQ(bed.step(dt_s), StepStatus::kOk);
    highest = std::max(highest, k % 500 == 0 ? bed.energy() : highest);
  }
  EXPECT_LT(bed.largestSpeed(), 1e-5);
  EXPECT_LT(highest - before, 1e-7);  // up to 5e-8 with 14 seeds; a grain lifted by its radius takes 15 times this
}

TEST(GradedBed, IsTheSameForAnyNumberOfThreadsAndGoesOnFromASavedState) {
  BedParameters parameters = gradedBox(3.5e-3);
  Bed one(parameters);
  parameters.threads = 3;
  Bed three(parameters);
  const double dt_s = 1e-3 / substepsFor(parameters, 0);
  const auto shake = [&](Bed& bed, int steps) {
    for (int k = 0; k < steps; ++k) {
      bed.setGravity({k % 200 < 100 ? 3.0 : -3.0, 0, -1.6});
      ASSERT_EQ(bed.step(dt_s), StepStatus::kOk);
    }
  };
  shake(one, 600);
  shake(three, 600);
  EXPECT_EQ(stateHash(one.state()), stateHash(three.state()));
  const BedState saved = deserialiseBedState(serialise(one.state()));
  shake(one, 300);
  three.restore(saved);
  shake(three, 300);
  EXPECT_EQ(stateHash(one.state()), stateHash(three.state()));
}

TEST(GradedBed, RefusesWhatIsNoChainOfHalvesOrDoesNotFit) {
  const auto refused = [](auto change) {
    BedParameters bed = gradedBox();
    change(bed);
    try {
      validate(bed);
      return std::string();
    } catch (const InvalidParameter& error) {
      return std::string(error.what());
    }
  };
  EXPECT_EQ(refused([](BedParameters&) {}), "");
  EXPECT_NE(refused([](BedParameters& b) { b.grading.fine_radius_m = 2e-3; }).find("halved"), std::string::npos);
  EXPECT_NE(refused([](BedParameters& b) { b.grading.fine_radius_m = 7e-3 / 16; }), "");
  EXPECT_NE(refused([](BedParameters& b) { b.grading.fine_radius_m = -1; }), "");
  EXPECT_NE(refused([](BedParameters& b) { b.grading.fine_width_m = 0.2; }).find("fine_width_m"), std::string::npos);
  EXPECT_NE(refused([](BedParameters& b) { b.grading.fine_x_m = 0.05; }).find("fine_width_m"), std::string::npos);
  EXPECT_NE(refused([](BedParameters& b) { b.grading.fine_depth_m = 0; }).find("fine_depth_m"), std::string::npos);
  EXPECT_NE(refused([](BedParameters& b) { b.soil.friction = FrictionModel::kIcra2021; }).find("friction"),
            std::string::npos);
}

}  // namespace
}  // namespace haptolith
