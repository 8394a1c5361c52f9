#include "haptolith/lab/tests/shear.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "haptolith/core/error.h"

#include "lab_soils.h"

namespace haptolith {
namespace {

/// A cell so small that a test takes seconds; its strength scatters by some degrees.
ShearOptions smallCell() {
  return {.normal_stresses_pa = {500, 1000, 2000},
          .width_diameters = 8,
          .length_diameters = 6,
          .height_diameters = 6,
          .strain = 3,
          .residual_from = 1.5};
}

double degrees(double radians) {
  return radians * 180 / std::numbers::pi;
}

TEST(Shear, StrengthGrowsWithContactFrictionAndStress) {
  LabConditions conditions{.soil = testSoil(0.2, 0)};
  const ShearResult smooth = shearTest(conditions, smallCell());
  conditions.soil = testSoil(0.5, 0);
  const ShearResult rough = shearTest(conditions, smallCell());
  EXPECT_NEAR(degrees(smooth.residual.friction_angle_rad), 26, 6);
  EXPECT_NEAR(degrees(rough.residual.friction_angle_rad), 43, 8);
  for (const ShearPointResult& point : rough.points) {
    EXPECT_GT(point.peak_pa, point.residual_pa);  // dense soil has a peak
    EXPECT_GT(point.residual_pa, 0.5 * point.normal_pa);
  }
}

TEST(Shear, TheUpperPlateCarriesItsLoad) {
  const ShearResult result = shearTest({.soil = testSoil(0.35, 0)}, smallCell());
  for (std::size_t i = 0; i < result.points.size(); ++i) {
    EXPECT_NEAR(result.points[i].normal_pa / smallCell().normal_stresses_pa[i], 1, 0.02);
  }
}

TEST(Shear, CohesionOfContactsIsCohesionOfTheSoil) {
  const ShearResult cohesive = shearTest({.soil = testSoil(0.35, 0.3)}, smallCell());
  EXPECT_GT(cohesive.residual.cohesion_pa, 300);
  EXPECT_GT(cohesive.peak.cohesion_pa, 500);
}

TEST(Shear, GrainsOfTwoSizesMixedAreAboutAsStrongAndDenseAsOne) {
  ShearOptions one = smallCell();
  one.strain = 1.6;
  one.residual_from = 1;
  ShearOptions mixed = one;
  mixed.grain_classes = 2;
  const LabConditions conditions{.soil = testSoil(0.35, 0.2)};
  const ShearResult of_one = shearTest(conditions, one);
  const ShearResult of_two = shearTest(conditions, mixed);
  // In such small cells angle and cohesion vary by ten degrees and by half; the stress does not.
  const auto residual_pa = [](const ShearResult& result) {
    double sum = 0;
    for (const ShearPointResult& point : result.points) {
      sum += point.residual_pa;
    }
    return sum;
  };
  EXPECT_NEAR(residual_pa(of_two) / residual_pa(of_one), 1, 0.15);
  EXPECT_NEAR(of_two.bulk_density_kg_m3 / of_one.bulk_density_kg_m3, 1, 0.06);
  for (const ShearPointResult& point : of_two.points) {
    EXPECT_NEAR(point.normal_pa, mixed.normal_stresses_pa[static_cast<std::size_t>(&point - of_two.points.data())],
                0.03 * point.normal_pa);
  }
  mixed.grain_classes = 5;
  EXPECT_THROW((void)shearTest(conditions, mixed), InvalidParameter);
}

TEST(Shear, Icra2021FrictionTransmitsAlmostNothing) {
  // (paper 14) acts against space: particles exert no tangential force on each other, so the plate barely drags them.
  LabConditions conditions{.soil = testSoil(0.5, 0)};
  conditions.soil.friction = FrictionModel::kIcra2021;
  conditions.soil.attraction_ratio = 1;
  conditions.soil.mu_hat = 0.35;
  const ShearResult icra2021 = shearTest(conditions, smallCell());
  EXPECT_LT(degrees(icra2021.residual.friction_angle_rad), 20);
}

TEST(Shear, IsTheSameForAnyNumberOfThreads) {
  LabConditions conditions{.soil = testSoil(0.3, 0)};
  ShearOptions options = smallCell();
  options.strain = 0.4;
  options.residual_from = 0.2;
  const ShearResult one = shearTest(conditions, options);
  conditions.threads = 3;
  const ShearResult three = shearTest(conditions, options);
  for (std::size_t i = 0; i < one.points.size(); ++i) {
    EXPECT_EQ(one.points[i].residual_pa, three.points[i].residual_pa);
  }
}

TEST(Shear, EndsWhenAskedTo) {
  LabConditions conditions{.soil = testSoil(0.3, 0)};
  int calls = 0;
  conditions.progress = [&calls](std::string_view, double share) {
    EXPECT_GE(share, 0);
    EXPECT_LE(share, 1);
    return ++calls < 20;
  };
  EXPECT_THROW((void)shearTest(conditions, smallCell()), Failure);
}

TEST(Shear, RefusesNonsense) {
  const LabConditions conditions{.soil = testSoil(0.3, 0)};
  const auto refused = [&](auto change) {
    ShearOptions options = smallCell();
    change(options);
    EXPECT_THROW((void)shearTest(conditions, options), InvalidParameter);
  };
  refused([](ShearOptions& o) { o.normal_stresses_pa = {500, 500, 500}; });
  refused([](ShearOptions& o) { o.normal_stresses_pa = {500, 1000}; });
  refused([](ShearOptions& o) { o.normal_stresses_pa = {0, 500, 1000}; });
  refused([](ShearOptions& o) { o.width_diameters = 2; });
  refused([](ShearOptions& o) { o.residual_from = o.strain; });
  refused([](ShearOptions& o) { o.inertial_number = 1; });
}

TEST(Shear, DrawsItsCurvesAndLines) {
  ShearResult result;
  for (const double normal_pa : {500.0, 1000.0, 2000.0}) {
    ShearPointResult point;
    point.normal_pa = normal_pa;
    point.peak_pa = 0.9 * normal_pa;
    point.residual_pa = 0.7 * normal_pa;
    for (int i = 0; i < 20; ++i) {
      point.trace.rows.push_back({1e-3 * i, 0.7 * normal_pa, normal_pa, 0.1});
    }
    result.points.push_back(point);
  }
  result.peak.friction_angle_rad = std::atan(0.9);
  result.residual.friction_angle_rad = std::atan(0.7);
  for (const char* extension : {".svg", ".png"}) {
    const std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("haptolith_shear_" + std::to_string(getpid()) + extension);
    drawShear(path, result, "a soil");
    EXPECT_GT(std::filesystem::file_size(path), 5000U);
    std::filesystem::remove(path);
  }
}

TEST(ShearMemory, SimulatesEqualTestsOnceAlsoForSeveralThreads) {
  ShearMemory memory;
  std::atomic<int> simulated = 0;
  const auto simulate = [&] {
    ++simulated;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return ShearResult{.points = {}, .peak = {}, .residual = {}, .bulk_density_kg_m3 = 1500};
  };
  LabConditions conditions;
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] { EXPECT_EQ(memory.get(conditions, {}, simulate).bulk_density_kg_m3, 1500); });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  EXPECT_EQ(simulated, 1);
  const auto simulates_again = [&](const auto& change) {
    LabConditions other = conditions;
    ShearOptions options;
    change(other, options);
    const int before = simulated;
    (void)memory.get(other, options, simulate);
    return simulated == before + 1;
  };
  EXPECT_TRUE(simulates_again([](LabConditions& c, ShearOptions&) { c.seed = 2; }));
  EXPECT_TRUE(simulates_again([](LabConditions& c, ShearOptions&) { c.gravity_m_s2 = 9.807; }));
  EXPECT_TRUE(simulates_again([](LabConditions& c, ShearOptions&) { c.soil.contact_friction = 0.123; }));
  EXPECT_TRUE(simulates_again([](LabConditions&, ShearOptions& o) { o.strain = 3; }));
  EXPECT_FALSE(simulates_again([](LabConditions& c, ShearOptions&) { c.threads = 2; }))
      << "results do not depend on it";
}

TEST(ShearMemory, ForgetsATestThatFailed) {
  ShearMemory memory;
  EXPECT_THROW((void)memory.get({}, {}, []() -> ShearResult { throw Failure("interrupted"); }), Failure);
  EXPECT_EQ(
      memory.get({}, {}, [] { return ShearResult{.points = {}, .peak = {}, .residual = {}, .bulk_density_kg_m3 = 7}; })
          .bulk_density_kg_m3,
      7);
}

}  // namespace
}  // namespace haptolith
