#include "haptolith/lab/tests/cone.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "haptolith/core/error.h"

#include "small_soil.h"

namespace haptolith {
namespace {

const ConeOptions kSmall{.base_diameter_m = 0.03,
                         .max_depth_m = 0.06,
                         .speed_m_s = 0.08,
                         .bed_width_diameters = 4,
                         .below_diameters = 1,
                         .window_m = 6e-3,
                         .points = 30};

TEST(ConeTest, MeetsResistanceThatGrowsWithDepth) {
  const ConeResult cone = coneTest(coarseSand(6e-3), kSmall);
  ASSERT_EQ(cone.curve.size(), 31U);
  EXPECT_EQ(cone.curve.front().depth_m, 0);
  EXPECT_NEAR(cone.curve.back().depth_m, 0.06, 1e-12);
  EXPECT_GT(cone.gradient_pa_m, 0);
  // Many times the soil's own pressure at that depth, rho g z, as bearing capacity has it.
  EXPECT_GT(cone.curve[25].resistance_pa, 5 * cone.bulk_density_kg_m3 * 9.807 * 0.05);

  double sum = 0;
  for (const ConePoint& point : cone.curve) {
    sum += point.resistance_pa;
  }
  EXPECT_NEAR(cone.cone_index_pa, sum / 31, 1e-6 * cone.cone_index_pa);
  const double area = std::numbers::pi / 4 * 0.03 * 0.03;
  EXPECT_NEAR(cone.trace.rows[10][1], cone.curve[10].resistance_pa * area, 1e-9);
}

TEST(ConeTest, RefusesNonsense) {
  const std::vector<std::function<void(ConeOptions&)>> nonsense = {
      [](ConeOptions& cone) { cone.base_diameter_m = 0.01; },  // narrower than a particle
      [](ConeOptions& cone) { cone.cone_angle_rad = 30; },     // degrees
      [](ConeOptions& cone) { cone.max_depth_m = 0; },
      [](ConeOptions& cone) { cone.speed_m_s = std::nan(""); },
      [](ConeOptions& cone) { cone.friction = -1; },
      [](ConeOptions& cone) { cone.bed_width_diameters = 1; },
      [](ConeOptions& cone) { cone.below_diameters = 0; },
      [](ConeOptions& cone) { cone.window_m = 1; },
      [](ConeOptions& cone) { cone.points = 1; },
  };
  for (std::size_t i = 0; i < nonsense.size(); ++i) {
    ConeOptions options = kSmall;
    nonsense[i](options);
    EXPECT_THROW(static_cast<void>(coneTest(coarseSand(6e-3), options)), InvalidParameter) << i;
  }
}

TEST(ConeTest, IsDrawnWithItsIndex) {
  ConeResult cone;
  cone.curve = {{0, 1000}, {0.05, 4000}, {0.1, 7000}};
  cone.cone_index_pa = 4000;
  cone.gradient_pa_m = 6e4;
  const auto file = std::filesystem::path(testing::TempDir()) / "cone.svg";
  std::filesystem::remove(file);  // left by an earlier run
  drawCone(file, cone, "a soil");
  std::ifstream stream(file);
  const std::string svg{std::istreambuf_iterator<char>(stream), {}};
  EXPECT_NE(svg.find("cone index 4 kPa"), std::string::npos);
  EXPECT_NE(svg.find("gradient 60 kPa/m"), std::string::npos);
}

}  // namespace
}  // namespace haptolith
