#include "haptolith/lab/theory/resistive_force.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "haptolith/core/error.h"

#include "csv_rows.h"

namespace haptolith {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kPi = std::numbers::pi;

const ResistiveSoil kSand{.density_kg_m3 = 1550, .gravity_m_s2 = 9.81, .internal_friction = 0.6};

ToolParameters boxOf(const Vec3& size_m) {
  ToolParameters tool;
  tool.shape = ToolShape::kBox;
  tool.size_m = size_m;
  return tool;
}

ToolParameters plateOf(double diameter_m) {
  ToolParameters tool;
  tool.shape = ToolShape::kPlate;
  tool.diameter_m = diameter_m;
  tool.thickness_m = diameter_m;
  return tool;
}

/// On a box whose underside is `depth_m` below the surface.
Wrench sinking(const ToolParameters& box, double depth_m, const ResistiveSoil& soil, const Vec3& velocity) {
  return resistiveForce(box, 0, {{0, 0, box.size_m.z() / 2 - depth_m}, Quat::Identity()}, {velocity, Vec3::Zero()},
                        soil);
}

/// The paper's own account of a surface element by angles and in cylindrical components, written apart from the code.
Vec3 byAngles(const Vec3& normal, const Vec3& velocity) {
  const Vec3 level = Vec3(velocity.x(), velocity.y(), 0);
  const Vec3 r = level.normalized();
  const Vec3 theta = Vec3::UnitZ().cross(r);
  const double along = normal.dot(r);
  const double up = normal.z();
  const double tilt = std::acos(up);
  const double beta = along >= 0 ? (up >= 0 ? -tilt : kPi - tilt) : (up >= 0 ? tilt : tilt - kPi);
  const double gamma = (velocity.z() <= 0 ? 1 : -1) * std::acos(velocity.normalized().dot(r));
  const double psi = std::atan(normal.dot(theta) / along);
  const Vec3 alpha = genericResponse({.beta_rad = beta, .gamma_rad = gamma, .psi_rad = psi});
  return alpha.x() * r + alpha.y() * theta + alpha.z() * Vec3::UnitZ();
}

TEST(ResistiveForce, HasThePublishedResponseOfAFlatPlateThatSinksIn) {
  // The sum of the table's numbers for x1 = x2 = x3 = 1; bunkershot3d of github.com/D-sorganization/UpstreamDrift has
  // the same 0.87574, and 2.11 N/cm^3 for sand of 1550 kg/m^3 and 34 degrees where it quotes 2.02 as measured in
  // another sand of 34 degrees.
  const Vec3 alpha = genericResponse({.beta_rad = 0, .gamma_rad = kPi / 2, .psi_rad = 0});
  EXPECT_NEAR(alpha.z(), 0.87574, 1e-9);
  EXPECT_NEAR(alpha.x(), 0, 1e-12);
  EXPECT_NEAR(alpha.y(), 0, 1e-12);
  ResistiveSoil soil = kSand;
  soil.internal_friction = std::tan(34 * kDegree);
  EXPECT_NEAR(resistiveScale(soil) * alpha.z() / 1e6, 2.11, 0.005);
}

TEST(ResistiveForce, IsTheSameByAnglesAndByVectors) {
  for (const Vec3& normal :
       {Vec3(0.3, 0.5, -0.8), Vec3(-0.3, 0.5, -0.8), Vec3(0.3, -0.5, 0.8), Vec3(-0.7, -0.5, 0.2)}) {
    for (const Vec3& velocity : {Vec3(1, 0, 0), Vec3(0.4, -0.6, -0.7), Vec3(-0.5, 0.2, 0.6)}) {
      const Vec3 vectors = genericResponse(normal.normalized(), velocity.normalized());
      EXPECT_LT((vectors - byAngles(normal.normalized(), velocity)).norm(), 1e-12)
          << normal.transpose() << " going " << velocity.transpose();
    }
  }
}

TEST(ResistiveForce, TurnsWithTheToolAboutTheVerticalAndIsMirroredWithIt) {
  const Quat turn(Eigen::AngleAxisd(0.7, Vec3::UnitZ()));
  const auto mirrored = [](const Vec3& vector) { return Vec3(vector.x(), -vector.y(), vector.z()); };
  const Vec3 normal = Vec3(0.3, 0.5, -0.8).normalized();
  const Vec3 velocity = Vec3(0.7, 0.1, -0.4).normalized();
  const Vec3 response = resistiveResponse(normal, velocity, 1e6, 0.3);
  EXPECT_GT(response.norm(), 1e4);
  EXPECT_LT((turn * response - resistiveResponse(turn * normal, turn * velocity, 1e6, 0.3)).norm(), 1e-6);
  EXPECT_LT((mirrored(response) - resistiveResponse(mirrored(normal), mirrored(velocity), 1e6, 0.3)).norm(), 1e-6);
}

TEST(ResistiveForce, LiftsAPlateThatSinksInInProportionToDepthAndArea) {
  const ToolParameters box = boxOf({0.05, 0.04, 0.1});
  const double response = resistiveScale(kSand) * 0.87574;
  for (const double depth_m : {0.01, 0.02, 0.04}) {
    const Wrench wrench = sinking(box, depth_m, kSand, {0, 0, -0.02});
    // The sides rub, and by the fit's own error that is not quite nothing.
    EXPECT_NEAR(wrench.force_n.z() / (response * depth_m * 0.05 * 0.04), 1, 0.01);
    EXPECT_NEAR(wrench.force_n.x(), 0, 1e-9);
    EXPECT_NEAR(wrench.torque_nm.norm(), 0, 1e-6 * wrench.force_n.z());  // the sides' triangles are not symmetric
  }
  const double whole = sinking(box, 0.02, kSand, {0, 0, -1}).force_n.z();
  EXPECT_NEAR(sinking(boxOf({0.1, 0.04, 0.1}), 0.02, kSand, {0, 0, -1}).force_n.z() / whole, 2, 0.01);
}

TEST(ResistiveForce, DragsAnUprightBladeWithTheSquareOfItsDepth) {
  const ToolParameters box = boxOf({2e-3, 0.05, 0.1});
  const Vec3 face = genericResponse(Vec3(1, 0, 0), Vec3(1, 0, 0));
  EXPECT_NEAR(face.x(), -0.2294, 1e-4);  // by hand: f1 n + f2 v, with x1 = x2 = 0 and x3 = -1
  const Wrench wrench = sinking(box, 0.03, kSand, {0.02, 0, 0});
  EXPECT_NEAR(-wrench.force_n.x() / (0.2294 * resistiveScale(kSand) * 0.05 * 0.03 * 0.03 / 2), 1, 0.05);
  EXPECT_GT(wrench.force_n.z(), 0);
  EXPECT_NEAR(wrench.force_n.y(), 0, 1e-9);
  // The middle of a triangle of pressure: a third of the depth above the edge, 0.02 below the surface.
  EXPECT_NEAR(wrench.torque_nm.y() / wrench.force_n.x(), -0.02 - (0.1 / 2 - 0.03), 0.002);
}

TEST(ResistiveForce, IsNothingOutOfTheSoilAndWhereTheSurfaceMovesAway) {
  EXPECT_EQ(resistiveResponse(Vec3(0, 0, -1), Vec3(0.1, 0, 0.3), 1e6, 0.3), Vec3(Vec3::Zero()));
  EXPECT_EQ(resistiveResponse(Vec3(0, 0, -1), Vec3::Zero(), 1e6, 0.3), Vec3(Vec3::Zero()));
  EXPECT_EQ(sinking(boxOf({0.05, 0.04, 0.1}), -0.001, kSand, {0, 0, -1}).force_n, Vec3(Vec3::Zero()));
}

TEST(ResistiveForce, HoldsBackAToolThatIsDrawnOutButLessThanOneThatSinksIn) {
  const ToolParameters box = boxOf({0.05, 0.05, 0.005});
  const double in_n = sinking(box, 0.04, kSand, {0, 0, -1}).force_n.z();
  const double out_n = sinking(box, 0.04, kSand, {0, 0, 1}).force_n.z();
  EXPECT_LT(out_n, 0);
  EXPECT_LT(-out_n, 0.3 * in_n);
}

TEST(ResistiveForce, NeverRubsHarderThanTheSurfaceAllows) {
  for (const double mu_surf : {0.0, 0.05, 0.2}) {
    for (double tilt = 0; tilt < 180; tilt += 7) {
      const Vec3 normal(std::sin(tilt * kDegree), 0, -std::cos(tilt * kDegree));
      const Vec3 response = resistiveResponse(normal, Vec3(1, 0.3, -0.2), 1, mu_surf);
      const double across = std::abs(response.dot(normal));
      const double along = (response - response.dot(normal) * normal).norm();
      EXPECT_LE(along, mu_surf * across + 1e-12);
    }
  }
}

TEST(ResistiveForce, GrowsWithGravityDensityAndTheCubeOfSize) {
  const Twist down{{0, 0, -1}, Vec3::Zero()};
  const auto plate = [&](double size, const ResistiveSoil& soil) {
    return resistiveForce(plateOf(0.06 * size), 0, {{0, 0, 0.01 * size}, Quat::Identity()}, down, soil).force_n.z();
  };
  const double once = plate(1, kSand);
  EXPECT_GT(once, 1);
  ResistiveSoil moon = kSand;
  moon.gravity_m_s2 = 1.625;
  EXPECT_NEAR(plate(1, moon) / once, 1.625 / 9.81, 1e-12);
  ResistiveSoil denser = kSand;
  denser.density_kg_m3 *= 1.3;
  EXPECT_NEAR(plate(1, denser) / once, 1.3, 1e-12);
  EXPECT_NEAR(plate(2, kSand) / once, 8, 1e-9);
}

TEST(ResistiveForce, IsNearWhatPlatesNeededInDrySandThoughItKnowsNothingOfThem) {
  // 1330 kg/m^3 as measured, and the 29 degrees that this sand's heaps show (soils/dry-sand.toml). Measured force rises
  // faster than the theory's straight line, of the larger plate most: 1.7 times the theory at 15 mm.
  const ResistiveSoil sand{.density_kg_m3 = 1330, .gravity_m_s2 = 9.807, .internal_friction = std::tan(29 * kDegree)};
  const auto measured = [](double diameter_mm, double sinkage_mm) {  // mean of what is within half a millimetre
    double sum = 0;
    int count = 0;
    for (const std::vector<double>& row : csvRows("plate_penetration_sand.csv")) {
      if (row[1] == diameter_mm && std::abs(row[3] - sinkage_mm) < 0.5) {
        sum += row[4];
        ++count;
      }
    }
    EXPECT_GT(count, 2);
    return sum / count;
  };
  for (const double diameter_mm : {60.0, 100.0}) {
    for (const double sinkage_mm : {5.0, 10.0, 15.0}) {
      const double diameter_m = diameter_mm / 1000;
      const Pose pose{{0, 0, diameter_m / 2 - sinkage_mm / 1000}, Quat::Identity()};
      const double theory_n =
          resistiveForce(plateOf(diameter_m), 0, pose, {{0, 0, -1}, Vec3::Zero()}, sand).force_n.z();
      const double ratio = theory_n / measured(diameter_mm, sinkage_mm);
      EXPECT_GT(ratio, 0.5) << diameter_mm << " mm at " << sinkage_mm;
      EXPECT_LT(ratio, 1.5) << diameter_mm << " mm at " << sinkage_mm;
    }
  }
}

TEST(ResistiveForce, OnAWheelThatTurnsOnTheSpotDrivesIt) {
  ToolParameters wheel;
  wheel.shape = ToolShape::kCylinder;
  wheel.diameter_m = 0.1;
  wheel.length_m = 0.04;
  // Its axis along y; it turns so that its lowest point goes backwards.
  const Pose pose{{0, 0, 0.03}, Quat(Eigen::AngleAxisd(kPi / 2, Vec3::UnitX()))};
  const Wrench wrench = resistiveForce(wheel, 0, pose, {Vec3::Zero(), {0, 1, 0}}, kSand);
  EXPECT_GT(wrench.force_n.x(), 0);
  EXPECT_LT(wrench.torque_nm.y(), 0);
  EXPECT_NEAR(wrench.force_n.y(), 0, 1e-6 * wrench.force_n.norm());
}

TEST(ResistiveForce, RefusesNonsense) {
  const auto with = [](const std::function<void(ResistiveSoil&)>& change) {
    ResistiveSoil soil = kSand;
    change(soil);
    return resistiveScale(soil);
  };
  EXPECT_THROW(static_cast<void>(with([](ResistiveSoil& soil) { soil.density_kg_m3 = 0; })), InvalidParameter);
  EXPECT_THROW(static_cast<void>(with([](ResistiveSoil& soil) { soil.gravity_m_s2 = -1; })), InvalidParameter);
  EXPECT_THROW(static_cast<void>(with([](ResistiveSoil& soil) { soil.internal_friction = 3; })), InvalidParameter);
  EXPECT_THROW(static_cast<void>(sinking(boxOf({0, 0.05, 0.05}), 0.01, kSand, {0, 0, -1})), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
