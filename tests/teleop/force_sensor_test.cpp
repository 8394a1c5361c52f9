#include "haptolith/teleop/robot/force_sensor.h"

#include <gtest/gtest.h>

#include <cmath>

namespace haptolith {
namespace {

constexpr double kTick_s = 1e-3;
const Vec3 kMoon{0, 0, -1.625};

ForceSensorParameters quiet() {
  ForceSensorParameters sensor;
  sensor.noise_n = sensor.noise_nm = 0;
  sensor.drift_n_s = sensor.drift_nm_s = 0;
  return sensor;
}

Movement still(const Quat& orientation = Quat::Identity()) {
  return {{Vec3::Zero(), orientation}, {}};
}

void tare(ForceSensor& sensor) {
  while (!sensor.tared()) {
    (void)sensor.read({}, still());
  }
}

TEST(ForceSensor, TellsNothingOfItsBiasAndItsToolOnceItIsTared) {
  ForceSensorParameters parameters = quiet();
  parameters.told_mass_kg = parameters.tool_mass_kg;
  parameters.centre_of_mass_m = {0.02, 0, 0.01};
  ForceSensor sensor(parameters, kMoon, kTick_s);
  tare(sensor);
  for (int i = 0; i < 100; ++i) {  // also rotated
    const Quat turned(Eigen::AngleAxisd(0.03 * i, Vec3(1, 2, 3).normalized()));
    const Wrench told = sensor.read({}, still(turned));
    EXPECT_LT(told.force_n.norm(), 1e-12);
    EXPECT_LT(told.torque_nm.norm(), 1e-12);
  }
}

TEST(ForceSensor, AWrongMassIsSeenAsSoonAsTheToolTurnsOrHurries) {
  const ForceSensorParameters parameters = quiet();  // 10 g too light
  ForceSensor sensor(parameters, kMoon, kTick_s);
  tare(sensor);
  Movement falling = still();
  Wrench told;
  for (int i = 0; i < 100; ++i) {
    falling.twist.linear_m_s.x() += 2 * kTick_s;  // 2 m/s^2
    told = sensor.read({}, falling);
  }
  EXPECT_NEAR(told.force_n.x(), -0.01 * 2, 1e-6);
  EXPECT_NEAR(told.force_n.z(), 0, 1e-12) << "its weight was in the zero";
}

TEST(ForceSensor, FollowsAStepAsALowPassOfFirstOrder) {
  ForceSensor sensor(quiet(), kMoon, kTick_s);
  tare(sensor);
  for (int tick = 1; tick <= 50; ++tick) {
    const Wrench told = sensor.read({{10, 0, 0}, {0, 0.5, 0}}, still());
    const double share = 1 - std::exp(-tick * kTick_s / 0.005);
    EXPECT_NEAR(told.force_n.x(), 10 * share, 1e-12);
    EXPECT_NEAR(told.torque_nm.y(), 0.5 * share, 1e-12);
  }
}

TEST(ForceSensor, HasTheNoiseAndTheDriftItIsSaidToHave) {
  ForceSensorParameters parameters;
  parameters.noise_n = 0.05;
  parameters.drift_n_s = 0.01;
  ForceSensor sensor(parameters, kMoon, kTick_s);
  tare(sensor);
  constexpr int kReadings = 20000;
  double sum = 0, squares = 0, of_time = 0;
  for (int i = 0; i < kReadings; ++i) {
    const double x = sensor.read({}, still()).force_n.y();
    sum += x;
    of_time += x * (i - 0.5 * kReadings);
    const double without_drift = x - 0.01 * kTick_s * i;
    squares += without_drift * without_drift;
  }
  // Drift for 20 s from the middle of taring on; 5 standard errors.
  EXPECT_NEAR(sum / kReadings, 0.01 * (10 + 0.25), 5 * 0.05 / std::sqrt(kReadings) + 5 * 0.05 / std::sqrt(500));
  EXPECT_NEAR(std::sqrt(squares / kReadings), 0.05, 0.05 * 0.05);
  EXPECT_NEAR(of_time / (std::pow(kReadings, 3) / 12), 0.01 * kTick_s,
              5 * 0.05 * std::sqrt(12 / std::pow(kReadings, 3)));
}

TEST(ForceSensor, ShowsNoMoreThanItsFullScale) {
  ForceSensorParameters parameters = quiet();
  parameters.bias_n = Vec3::Zero();
  parameters.tool_mass_kg = parameters.told_mass_kg = 0;
  ForceSensor sensor(parameters, kMoon, kTick_s);
  tare(sensor);
  Wrench told;
  for (int i = 0; i < 200; ++i) {
    told = sensor.read({{1e4, -1e4, 3}, {1e3, 0, 0}}, still());
  }
  EXPECT_EQ(told.force_n.x(), 200);
  EXPECT_EQ(told.force_n.y(), -200);
  EXPECT_NEAR(told.force_n.z(), 3, 1e-9);
  EXPECT_NEAR(told.torque_nm.x(), 10 - parameters.bias_nm.x(), 1e-9) << "the zero was taken from what it shows";
}

TEST(ForceSensor, RefusesNonsense) {
  ForceSensorParameters parameters;
  parameters.lag_s = -1;
  EXPECT_THROW(ForceSensor(parameters, kMoon, kTick_s), InvalidParameter);
  parameters = {};
  parameters.full_scale_n = 0;
  EXPECT_THROW(validate(parameters), InvalidParameter);
  parameters = {};
  parameters.bias_n.z() = std::nan("");
  EXPECT_THROW(validate(parameters), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
