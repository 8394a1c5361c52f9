#include "haptolith/haptics/safety/plausibility.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace haptolith {
namespace {

constexpr double kTick_s = 1e-3;
constexpr double kRate_hz = 1000;

DeviceInput at(double x_m, double v_m_s = 0) {
  DeviceInput input;
  input.pose.position_m.x() = x_m;
  input.twist.linear_m_s.x() = v_m_s;
  return input;
}

DeviceInput turnedBy(double angle_rad, double w_rad_s = 0) {
  DeviceInput input;
  input.pose.orientation = Eigen::AngleAxisd(angle_rad, Vec3::UnitY());
  input.twist.angular_rad_s.y() = w_rad_s;
  return input;
}

/// After how many ticks of the same input it is found out; 1000 when it is not.
int ticksUntilFoundOut(const DeviceInput& input) {
  Plausibility plausibility(kRate_hz, kTick_s);
  EXPECT_TRUE(plausibility.observe(at(0)));
  for (int tick = 1; tick < 1000; ++tick) {
    if (!plausibility.observe(input)) {
      return tick;
    }
  }
  return 1000;
}

TEST(Plausibility, AJumpIsNoMovementOfAHand) {
  EXPECT_EQ(ticksUntilFoundOut(at(0.05)), 1);
  EXPECT_EQ(ticksUntilFoundOut(at(0.011)), 1);
  EXPECT_EQ(ticksUntilFoundOut(at(0.009)), 1000);
  EXPECT_EQ(ticksUntilFoundOut(turnedBy(std::numbers::pi)), 1);
  EXPECT_EQ(ticksUntilFoundOut(turnedBy(0.11)), 1);
  EXPECT_EQ(ticksUntilFoundOut(turnedBy(0.09)), 1000);
}

TEST(Plausibility, AQuaternionAndItsNegativeAreTheSameTurn) {
  DeviceInput other = turnedBy(0.001);
  other.pose.orientation.coeffs() *= -1;
  EXPECT_EQ(ticksUntilFoundOut(other), 1000);
}

TEST(Plausibility, AVelocityThatNoHandHasIsFoundOutAtOnce) {
  EXPECT_EQ(ticksUntilFoundOut(at(0, 99)), 1);
  EXPECT_EQ(ticksUntilFoundOut(at(0, 3.1)), 1) << "from rest";
  EXPECT_EQ(ticksUntilFoundOut(turnedBy(0, 101)), 1);
  EXPECT_EQ(ticksUntilFoundOut(turnedBy(0, 31)), 1);
}

TEST(Plausibility, AVelocityThatThePoseContradictsIsFoundOut) {
  EXPECT_LE(ticksUntilFoundOut(at(0, 2.9)), 15);
  EXPECT_LE(ticksUntilFoundOut(at(0, 1)), 52);
  EXPECT_LE(ticksUntilFoundOut(at(0, 0.5)), 200);
  EXPECT_EQ(ticksUntilFoundOut(at(0, 0.3)), 1000) << "some devices drift";
  EXPECT_LE(ticksUntilFoundOut(turnedBy(0, 10)), 60);
}

TEST(Plausibility, AVelocityOfTheWrongSignIsFoundOut) {
  Plausibility plausibility(kRate_hz, kTick_s);
  int tick = 0;
  while (plausibility.observe(at(0.5 * kTick_s * tick, -0.5)) && tick < 1000) {
    ++tick;
  }
  EXPECT_LT(tick, 60);
}

/// Fast movements of a hand, to and fro: 2 m/s at most.
double way(double t_s) {
  return 0.1 * std::sin(20 * t_s);
}
double speed(double t_s) {
  return 2 * std::cos(20 * t_s);
}

TEST(Plausibility, NoiseAndStepsOfPositionAreBelieved) {
  std::minstd_rand random(1);  // NOLINT(cert-msc51-cpp)
  std::normal_distribution<double> noise(0, 1e-4);
  Plausibility plausibility(kRate_hz, kTick_s);
  double before_m = 0;
  for (int tick = 0; tick < 20'000; ++tick) {
    const double noisy_m = way(tick * kTick_s) + noise(random);
    const double told_m = 6e-5 * std::round(noisy_m / 6e-5);
    const double v_m_s = tick == 0 ? 0 : (told_m - before_m) / kTick_s;  // the noisiest there is
    before_m = told_m;
    ASSERT_TRUE(plausibility.observe(at(told_m, tick < 2 ? 0 : v_m_s)) || tick < 4) << tick;
  }
}

TEST(Plausibility, PacketsThatComeLateAndTogetherAreBelieved) {
  std::minstd_rand random(2);  // NOLINT(cert-msc51-cpp)
  Plausibility plausibility(kRate_hz, kTick_s);
  double told_s = 0;
  for (int tick = 0; tick < 50'000; ++tick) {
    const double now_s = tick * kTick_s;
    if (random() % 12 == 0 || now_s - told_s > 0.018) {  // 12 ms on average, up to 18
      told_s = now_s;
    }
    ASSERT_TRUE(plausibility.observe(at(way(told_s / 2), speed(told_s / 2) / 2))) << tick;  // up to 1 m/s
  }
}

TEST(Plausibility, ADeviceThatKnowsNoVelocityIsBelieved) {
  Plausibility plausibility(kRate_hz, kTick_s);
  for (int tick = 0; tick < 5000; ++tick) {
    ASSERT_TRUE(plausibility.observe(at(way(tick * kTick_s))));
  }
}

TEST(Plausibility, AfterARestartTheHandMayBeAnywhere) {
  Plausibility plausibility(kRate_hz, kTick_s);
  EXPECT_TRUE(plausibility.observe(at(0)));
  plausibility.restart();
  EXPECT_TRUE(plausibility.observe(at(0.5, 1)));
  EXPECT_FALSE(plausibility.observe(at(0)));
  EXPECT_TRUE(plausibility.observe(at(0))) << "where it is now";
}

}  // namespace
}  // namespace haptolith
