#include "haptolith/lab/theory/earthmoving.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "haptolith/core/error.h"

#include "csv_rows.h"

namespace haptolith {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

const BladeCase kSandAndBlade{.width_m = 1,
                              .depth_m = 0.5,
                              .rake_rad = 60 * kDegree,
                              .density_kg_m3 = 1800,
                              .friction_angle_rad = 35 * kDegree,
                              .tool_friction_rad = 20 * kDegree};

/// F for a given failure plane, independently: the balance of forces on the wedge, with the unknowns F and R, the force
/// that the failure plane hands over at the angle phi to its normal. x is ahead, y up.
double forceOnWedge(const BladeCase& blade, double beta) {
  const double d = blade.depth_m;
  const double surface = d * (1 / std::tan(blade.rake_rad) + 1 / std::tan(beta));
  const Eigen::Vector2d up_the_plane(std::cos(beta), std::sin(beta));
  const Eigen::Vector2d up_the_blade(-std::cos(blade.rake_rad), std::sin(blade.rake_rad));
  const Eigen::Vector2d down(0, -1);
  const Eigen::Vector2d known = down * (blade.density_kg_m3 * blade.gravity_m_s2 * surface * d / 2) +
                                down * blade.surcharge_pa * surface -
                                up_the_plane * (blade.cohesion_pa * d / std::sin(beta)) -
                                up_the_blade * (blade.adhesion_pa * d / std::sin(blade.rake_rad));
  const double push = blade.rake_rad + blade.tool_friction_rad;
  const double plane = beta + blade.friction_angle_rad;
  Eigen::Matrix2d directions;
  directions << std::sin(push), -std::sin(plane),  //
      std::cos(push), std::cos(plane);
  return blade.width_m * directions.inverse().row(0).dot(-known);
}

std::vector<BladeCase> manyCases() {
  std::mt19937 random(7);
  const auto between = [&](double lowest, double highest) {
    return std::uniform_real_distribution(lowest, highest)(random);
  };
  std::vector<BladeCase> cases;
  for (int i = 0; i < 300; ++i) {
    BladeCase blade{.width_m = between(0.01, 2),
                    .depth_m = between(0.005, 1),
                    .rake_rad = between(10, 95) * kDegree,
                    .density_kg_m3 = between(1000, 2000),
                    .gravity_m_s2 = between(0.1, 25),
                    .friction_angle_rad = between(0, 48) * kDegree,
                    .tool_friction_rad = between(0, 30) * kDegree,
                    .cohesion_pa = i % 3 == 0 ? 0 : between(0, 5000),
                    .surcharge_pa = i % 2 == 0 ? 0 : between(0, 5000)};
    blade.adhesion_pa = blade.cohesion_pa * between(0, 1);
    cases.push_back(blade);
  }
  return cases;
}

TEST(Earthmoving, GivesTheWorkedNumbers) {
  const auto rows = csvRows("earthmoving_worked.csv");
  ASSERT_EQ(rows.size(), 5U);
  for (const std::vector<double>& row : rows) {
    BladeCase blade = kSandAndBlade;
    blade.rake_rad = row[0] * kDegree;
    const BladeForce force = earthmovingForce(blade);
    EXPECT_NEAR(force.beta_rad / kDegree, row[1], 0.05) << row[0];
    EXPECT_NEAR(force.n_gamma, row[2], 0.005) << row[0];
    EXPECT_NEAR(force.force_n / 1000, row[3], 0.005) << row[0];
    EXPECT_NEAR(force.draft_n / 1000, row[4], 0.005) << row[0];
    EXPECT_NEAR(force.vertical_n / 1000, row[5], 0.005) << row[0];
  }
}

/// The blade of a row of blade_draft_measured.csv.
BladeCase measuredBlade(const std::vector<double>& row) {
  return {.width_m = row[1],
          .depth_m = row[0],
          .rake_rad = 90 * kDegree,
          .density_kg_m3 = 1440,
          .friction_angle_rad = 35 * kDegree,
          .tool_friction_rad = std::atan(0.29),
          .cohesion_pa = 1000};
}

TEST(Earthmoving, GivesTheDraftsThatOthersWorkedOutForASandWithCohesion) {
  const auto rows = csvRows("blade_draft_measured.csv");
  ASSERT_EQ(rows.size(), 8U);
  for (const std::vector<double>& row : rows) {
    EXPECT_NEAR(earthmovingForce(measuredBlade(row)).draft_n, row[3], 0.05) << row[0] << " x " << row[1];
  }
}

TEST(Earthmoving, IsBelowMeasuredDraftsByAsMuchAsItsDocumentationSays) {
  double sum = 0;
  double most = 0;
  const auto rows = csvRows("blade_draft_measured.csv");
  for (const std::vector<double>& row : rows) {
    const double missing = 1 - earthmovingForce(measuredBlade(row)).draft_n / row[2];
    EXPECT_GT(missing, 0);
    sum += missing;
    most = std::max(most, missing);
  }
  EXPECT_NEAR(sum / double(rows.size()), 0.25, 0.01);
  EXPECT_NEAR(most, 0.42, 0.005);
}

TEST(Earthmoving, IsTheBalanceOfForcesOnTheWedge) {
  for (const BladeCase& blade : manyCases()) {
    const BladeForce force = earthmovingForce(blade);
    const double expected = forceOnWedge(blade, force.beta_rad);
    EXPECT_NEAR(force.force_n, expected, 1e-9 * expected);
  }
}

TEST(Earthmoving, NoOtherFailurePlaneIsWeaker) {
  for (const BladeCase& blade : manyCases()) {
    const BladeForce force = earthmovingForce(blade);
    const double steepest = std::numbers::pi - blade.rake_rad - blade.tool_friction_rad - blade.friction_angle_rad;
    for (int i = 1; i < 1000; ++i) {
      EXPECT_GE(forceOnWedge(blade, steepest * i / 1000), force.force_n * (1 - 1e-12));
    }
  }
}

TEST(Earthmoving, WithoutCohesionScalesWithGravityExactly) {
  const double earth = earthmovingForce(kSandAndBlade).force_n;
  BladeCase elsewhere = kSandAndBlade;
  elsewhere.gravity_m_s2 = 9.81 / 4;
  EXPECT_EQ(earthmovingForce(elsewhere).force_n, earth / 4);
  elsewhere.gravity_m_s2 = 1.625;
  EXPECT_NEAR(earthmovingForce(elsewhere).force_n, earth * 1.625 / 9.81, 1e-9 * earth);
}

TEST(Earthmoving, WithoutCohesionGrowsWithTheSquareOfDepthAndWithWidth) {
  const double once = earthmovingForce(kSandAndBlade).force_n;
  BladeCase twice = kSandAndBlade;
  twice.depth_m *= 2;
  EXPECT_EQ(earthmovingForce(twice).force_n, 4 * once);
  twice.width_m *= 2;
  EXPECT_EQ(earthmovingForce(twice).force_n, 8 * once);
}

TEST(Earthmoving, IsHarderDeeperAndInStrongerSoil) {
  const std::vector<std::function<void(BladeCase&)>> harder = {
      [](BladeCase& blade) { blade.depth_m *= 1.1; },
      [](BladeCase& blade) { blade.density_kg_m3 *= 1.1; },
      [](BladeCase& blade) { blade.friction_angle_rad += kDegree; },
      [](BladeCase& blade) { blade.cohesion_pa += 100; },
      [](BladeCase& blade) { blade.surcharge_pa += 100; },
  };
  for (const BladeCase& blade : manyCases()) {
    for (std::size_t i = 0; i < harder.size(); ++i) {
      BladeCase changed = blade;
      harder[i](changed);
      EXPECT_GT(earthmovingForce(changed).force_n, earthmovingForce(blade).force_n) << i;
    }
  }
}

TEST(Earthmoving, OfASmoothUprightWallIsRankinesPassivePressure) {
  BladeCase wall = kSandAndBlade;
  wall.rake_rad = 90 * kDegree;
  wall.tool_friction_rad = 0;
  wall.cohesion_pa = 500;
  const BladeForce force = earthmovingForce(wall);
  const double k_p = std::pow(std::tan(45 * kDegree + wall.friction_angle_rad / 2), 2);
  EXPECT_NEAR(force.beta_rad, 45 * kDegree - wall.friction_angle_rad / 2, 1e-6);
  EXPECT_NEAR(force.n_gamma, k_p / 2, 1e-9);
  EXPECT_NEAR(force.n_c, 2 * std::sqrt(k_p), 1e-9);
  EXPECT_NEAR(force.n_q, k_p, 1e-9);
  EXPECT_NEAR(force.draft_n, force.force_n, 1e-9 * force.force_n);
  EXPECT_NEAR(force.vertical_n, 0, 1e-9 * force.force_n);
}

TEST(Earthmoving, OfSoilAlmostWithoutWeightFailsHalfwayToTheSteepestPlane) {
  // N_c = cos(phi) / (sin(beta) sin(alpha + delta + phi + beta)), which is least in the interior.
  BladeCase blade = kSandAndBlade;
  blade.gravity_m_s2 = 1e-9;
  blade.cohesion_pa = 1000;
  EXPECT_NEAR(earthmovingForce(blade).beta_rad, (180 - 60 - 20 - 35) / 2.0 * kDegree, 1e-6);
}

TEST(Earthmoving, AdhesionDragsAFlatBladeBackAndLiftsIt) {
  BladeCase sticky = kSandAndBlade;
  sticky.cohesion_pa = 1000;
  BladeForce force = earthmovingForce(sticky);
  const double push = sticky.rake_rad + sticky.tool_friction_rad;
  EXPECT_DOUBLE_EQ(force.draft_n, force.force_n * std::sin(push));
  sticky.adhesion_pa = 1000;
  force = earthmovingForce(sticky);
  EXPECT_NEAR(force.draft_n, force.force_n * std::sin(push) + 500 / std::tan(60 * kDegree), 1e-9);
  EXPECT_NEAR(force.vertical_n, force.force_n * std::cos(push) - 500, 1e-9);
}

TEST(Earthmoving, RefusesNonsense) {
  const std::vector<std::function<void(BladeCase&)>> nonsense = {
      [](BladeCase& blade) { blade.width_m = 0; },
      [](BladeCase& blade) { blade.depth_m = -0.1; },
      [](BladeCase& blade) { blade.rake_rad = 0; },
      [](BladeCase& blade) { blade.rake_rad = 60; },  // degrees
      [](BladeCase& blade) { blade.rake_rad = 125 * kDegree; },
      [](BladeCase& blade) { blade.density_kg_m3 = std::nan(""); },
      [](BladeCase& blade) { blade.gravity_m_s2 = 0; },
      [](BladeCase& blade) { blade.friction_angle_rad = 61 * kDegree; },
      [](BladeCase& blade) { blade.tool_friction_rad = -0.1; },
      [](BladeCase& blade) { blade.cohesion_pa = -1; },
      [](BladeCase& blade) { blade.adhesion_pa = 1; },  // more than the cohesion
      [](BladeCase& blade) { blade.surcharge_pa = std::numeric_limits<double>::infinity(); },
  };
  for (std::size_t i = 0; i < nonsense.size(); ++i) {
    BladeCase blade = kSandAndBlade;
    nonsense[i](blade);
    EXPECT_THROW(static_cast<void>(earthmovingForce(blade)), InvalidParameter) << i;
  }
}

}  // namespace
}  // namespace haptolith
