#include "haptolith/lab/theory/rigid_wheel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

const RigidWheel kUnderWheel{.radius_m = 0.058,
                             .width_m = 0.05,
                             .modulus = 8e5,
                             .exponent = 1.1,
                             .friction_angle_rad = 0.35,
                             .cohesion_pa = 50,
                             .shear_modulus_m = 0.01};

/// Integrates the theory over the height of a point of the rim instead of its angle, by the midpoint rule.
WheelForces overHeight(const RigidWheel& wheel, double slip, double sinkage_m) {
  constexpr int kSlices = 200'000;
  const double r = wheel.radius_m;
  const double entry = std::acos(1 - sinkage_m / r);
  const double peak = (wheel.peak_angle_ratio + wheel.peak_angle_slip * std::abs(slip)) * entry;
  WheelForces sum{.sinkage_m = sinkage_m};
  for (int i = 0; i < kSlices; ++i) {
    // cos(theta) = 1 - u^2, so that equal slices in u are finite where the rim is level.
    const double du = std::sqrt(sinkage_m / r) / kSlices;
    const double u = (i + 0.5) * du;
    const double theta = std::acos(1 - u * u);
    const double d_theta = 2 * u * du / std::sin(theta);
    const double depth_m = theta > peak ? r * (1 - u * u) - r + sinkage_m
                                        : r * std::cos(entry - (entry - peak) * theta / peak) - r + sinkage_m;
    const double sigma = wheel.modulus * std::pow(std::max(depth_m, 0.0), wheel.exponent);
    // Slide of a point: rim against ground, for one unit of rim path per radian.
    const double rim = slip >= 0 ? 1 : 1 + slip;
    const double travel = slip >= 0 ? 1 - slip : 1;
    const double j_m = r * (entry - theta - travel / rim * (std::sin(entry) - std::sin(theta)));
    const double tau = (j_m > 0 ? 1 : -1) * (wheel.cohesion_pa + sigma * std::tan(wheel.friction_angle_rad)) *
                       (1 - std::exp(-std::abs(j_m) / wheel.shear_modulus_m));
    const double area = r * wheel.width_m * d_theta;
    sum.vertical_n += area * (sigma * std::cos(theta) + tau * std::sin(theta));
    sum.drawbar_n += area * (tau * std::cos(theta) - sigma * std::sin(theta));
    sum.torque_nm += area * tau * r;
  }
  return sum;
}

TEST(RigidWheel, EqualsTheSameIntegralOverHeight) {
  for (const double slip : {-0.7, -0.2, 0.0, 0.3, 0.9}) {
    for (const double exponent : {0.7, 1.1, 1.5}) {
      RigidWheel wheel = kUnderWheel;
      wheel.exponent = exponent;
      const WheelForces forces = rigidWheelForces(wheel, slip, 0.018);
      const WheelForces other = overHeight(wheel, slip, 0.018);
      EXPECT_NEAR(forces.vertical_n, other.vertical_n, 2e-3 * other.vertical_n) << slip << " " << exponent;
      EXPECT_NEAR(forces.drawbar_n, other.drawbar_n, 2e-3 * other.vertical_n) << slip << " " << exponent;
      EXPECT_NEAR(forces.torque_nm, other.torque_nm, 2e-3 * other.vertical_n * wheel.radius_m) << slip;
    }
  }
}

TEST(RigidWheel, IsAPlateOnItsSideWithoutFriction) {
  RigidWheel smooth = kUnderWheel;
  smooth.friction_angle_rad = smooth.cohesion_pa = 0;
  smooth.exponent = 1;
  smooth.peak_angle_ratio = 0.001;  // the stress rises to the lowest point
  const WheelForces forces = rigidWheelForces(smooth, 0, 0.01);
  EXPECT_EQ(forces.torque_nm, 0);
  // Horizontal: b integral(k z dz) over the depth.
  EXPECT_NEAR(-forces.drawbar_n, smooth.width_m * smooth.modulus * 0.01 * 0.01 / 2, 2e-3 * -forces.drawbar_n);
}

TEST(RigidWheel, CarriesItsLoadAndUsesMoreWorkThanItGives) {
  for (const double slip : {-0.9, -0.5, 0.0, 0.2, 0.5, 0.9}) {
    const WheelForces forces = rigidWheelUnderLoad(kUnderWheel, slip, 24);
    EXPECT_NEAR(forces.vertical_n, 24, 1e-6) << slip;
    const double travel_over_rim = travelOverRim(slip);
    EXPECT_GE(forces.torque_nm / kUnderWheel.radius_m, forces.drawbar_n * travel_over_rim) << slip;
  }
}

TEST(RigidWheel, PullsMoreTheMoreItSlipsAndIsDraggedWhenLocked) {
  const WheelForces locked = rigidWheelUnderLoad(kUnderWheel, -1, 15);
  const WheelForces towed = rigidWheelUnderLoad(kUnderWheel, -0.1, 15);
  const WheelForces driven = rigidWheelUnderLoad(kUnderWheel, 0.3, 15);
  EXPECT_LT(locked.drawbar_n, towed.drawbar_n);
  EXPECT_LT(towed.drawbar_n, driven.drawbar_n);
  EXPECT_LT(locked.torque_nm, 0);
  EXPECT_GT(driven.torque_nm, 0);
}

TEST(RigidWheel, HasTheSlipOfItsSpeeds) {
  EXPECT_EQ(travelOverRim(0), 1);
  EXPECT_EQ(travelOverRim(0.75), 0.25);
  EXPECT_EQ(travelOverRim(-0.5), 2);
  EXPECT_TRUE(std::isinf(travelOverRim(-1)));
  EXPECT_THROW(static_cast<void>(travelOverRim(1)), InvalidParameter);
  EXPECT_THROW(static_cast<void>(travelOverRim(-1.1)), InvalidParameter);
}

TEST(RigidWheel, RefusesNonsense) {
  EXPECT_THROW(static_cast<void>(rigidWheelForces(kUnderWheel, 0, 0.058)), InvalidParameter);
  EXPECT_THROW(static_cast<void>(rigidWheelForces(kUnderWheel, 0, 0)), InvalidParameter);
  EXPECT_THROW(static_cast<void>(rigidWheelUnderLoad(kUnderWheel, 0, 0)), InvalidParameter);
  EXPECT_THROW(static_cast<void>(rigidWheelUnderLoad(kUnderWheel, 0, 1e6)), InvalidParameter);
  for (double RigidWheel::*quantity : {&RigidWheel::radius_m, &RigidWheel::width_m, &RigidWheel::modulus,
                                       &RigidWheel::exponent, &RigidWheel::shear_modulus_m}) {
    RigidWheel wheel = kUnderWheel;
    wheel.*quantity = 0;
    EXPECT_THROW(static_cast<void>(rigidWheelForces(wheel, 0, 0.01)), InvalidParameter);
  }
}

}  // namespace
}  // namespace haptolith
