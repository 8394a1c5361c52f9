#pragma once

#include <haptolith/haptolith.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "device.h"
#include "use.h"

namespace haptolith::library {

/// With the device's zero in the soil, 15 mm below its surface.
inline constexpr const char* kZeroInSoil = "mapping.offset_mm=[0, 0, -15]";

/// A handle that rests, and then goes along the scene's x, from -12 to 12 mm at 80 mm/s. Its device is turned: axes of
/// the scene are those of the device turned by `turn_rad` about z.
struct Sweep {
  static constexpr double kReach_m = 0.012, kSpeed_m_s = 0.08;

  double turn_rad = 0, rests_s = 0.2;

  [[nodiscard]] double duration_s() const { return rests_s + 2 * kReach_m / kSpeed_m_s; }
  /// A direction along the scene's axes x and y, in those of the device.
  [[nodiscard]] std::array<double, 3> inDevice(double x, double y, double z) const {
    const double c = std::cos(turn_rad);
    const double s = std::sin(turn_rad);
    return {c * x + s * y, c * y - s * x, z};
  }
  [[nodiscard]] std::array<double, 3> position(double time_s) const {
    return inDevice(-kReach_m + kSpeed_m_s * std::clamp(time_s - rests_s, 0.0, 2 * kReach_m / kSpeed_m_s), 0, 0);
  }
  [[nodiscard]] std::array<double, 3> velocity(double time_s) const {
    return inDevice(time_s >= rests_s && time_s < duration_s() ? kSpeed_m_s : 0, 0, 0);
  }
};

/// A device of the caller's that makes a Sweep.
struct SweepingDevice {
  Sweep sweep;
  double device_turn_rad = 0;  ///< that it declares
  int reads = 0;
  hapto_device_output last{};

  [[nodiscard]] hapto_device handle() {
    hapto_device device{};
    device.size = sizeof device;
    device.user = this;
    device.name = "sweeping";
    hapto_device_limits_init(&device.limits);
    device.limits.simulated = 1;
    device.limits.max_force_n = 12;
    device.limits.turn_rad[2] = device_turn_rad;
    device.read = [](void* user, hapto_device_input* out) {
      auto& self = *static_cast<SweepingDevice*>(user);
      const double time_s = 1e-3 * self.reads++;
      std::ranges::copy(self.sweep.position(time_s), out->pose.position_m);
      std::ranges::copy(self.sweep.velocity(time_s), out->twist.linear_m_s);
    };
    device.write = [](void* user, const hapto_device_output* force) {
      static_cast<SweepingDevice*>(user)->last = *force;
    };
    return device;
  }
};

/// Expects of the second half of a Sweep, on average, that the soil pushes back along the scene's -x in `soil`, and
/// that `felt` is about the same in the device's axes.
inline void expectPushedBack(std::span<const hapto_tick> ticks, const Sweep& sweep) {
  std::array<double, 3> soil_n{};
  std::array<double, 3> felt_n{};
  int count = 0;
  for (const hapto_tick& tick : ticks) {
    if (tick.time_s > sweep.rests_s + Sweep::kReach_m / Sweep::kSpeed_m_s && tick.time_s <= sweep.duration_s()) {
      ++count;
      for (int axis = 0; axis < 3; ++axis) {
        soil_n[axis] += (tick.soil.force_n[axis] - soil_n[axis]) / count;
        felt_n[axis] += (tick.felt.force_n[axis] - felt_n[axis]) / count;
      }
    }
  }
  EXPECT_GT(count, 100);
  EXPECT_LT(soil_n[0], -0.1) << "scene frame";
  const std::array<double, 3> expected_n = sweep.inDevice(soil_n[0], soil_n[1], soil_n[2]);
  const double tolerance_n = 0.25 * std::hypot(soil_n[0], soil_n[1], soil_n[2]);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(felt_n[axis], expected_n[axis], tolerance_n) << "device frame, axis " << axis;
  }
}

/// Expects that a snapshot has the wrenches of one of these ticks, each in its frame, and `felt` in the scene's axes.
inline void expectWrenchesOfATick(const hapto_snapshot& now, std::span<const hapto_tick> ticks, const Sweep& sweep) {
  const auto tick = std::ranges::find_if(ticks, [&](const hapto_tick& one) {
    return std::ranges::equal(one.soil.force_n, now.soil_wrench.force_n) &&
           std::ranges::equal(one.soil.torque_nm, now.soil_wrench.torque_nm);
  });
  ASSERT_NE(tick, ticks.end());
  EXPECT_NEAR(tick->time_s, now.time_s, 0.0011);
  EXPECT_NE(now.device_wrench.force_n[2], 0);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(now.device_wrench.force_n[axis], tick->felt.force_n[axis]);
    EXPECT_EQ(now.device_wrench.torque_nm[axis], tick->felt.torque_nm[axis]);
  }
  const std::array<double, 3> force_n = sweep.inDevice(now.felt.force_n[0], now.felt.force_n[1], now.felt.force_n[2]);
  const std::array<double, 3> torque_nm =
      sweep.inDevice(now.felt.torque_nm[0], now.felt.torque_nm[1], now.felt.torque_nm[2]);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(now.device_wrench.force_n[axis], force_n[axis], 1e-12) << "felt is the same in the scene's axes";
    EXPECT_NEAR(now.device_wrench.torque_nm[axis], torque_nm[axis], 1e-12);
  }
}

}  // namespace haptolith::library
