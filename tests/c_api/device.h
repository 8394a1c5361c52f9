#pragma once

#include <haptolith/haptolith.h>

#include <atomic>
#include <cmath>
#include <limits>

namespace haptolith::library {

/// A device of the caller's: a hand that stirs, as far as `tick` goes.
struct OwnDevice {
  int reads = 0, writes = 0;
  hapto_device_output last{};
  double strongest_n = 0;
  std::atomic<int> let_go{0}, taken_up{0};
  double height_m = 0;  ///< added to where the hand would be
  bool nan = false;     ///< report NaN
  std::int32_t state = HAPTO_DEVICE_LIVE;

  static OwnDevice& of(void* user) { return *static_cast<OwnDevice*>(user); }

  static void read(void* user, hapto_device_input* out) {
    OwnDevice& self = of(user);
    const double t = 1e-3 * self.reads++;
    const double speed = 2 * M_PI * 0.5;
    out->pose.position_m[0] = 0.015 * std::sin(speed * t);
    out->pose.position_m[1] = 0;
    out->pose.position_m[2] = self.nan ? std::numeric_limits<double>::quiet_NaN() : self.height_m;
    out->twist.linear_m_s[0] = 0.015 * speed * std::cos(speed * t);
    out->state = self.state;
  }
  static void write(void* user, const hapto_device_output* force) {
    OwnDevice& self = of(user);
    ++self.writes;
    self.last = *force;
    const double* f = force->wrench.force_n;
    self.strongest_n = std::fmax(self.strongest_n, std::sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]));
  }
  static void letGo(void* user) { ++of(user).let_go; }
  static void takeUp(void* user) { ++of(user).taken_up; }

  [[nodiscard]] hapto_device handle(bool simulated) {
    hapto_device device{};
    device.size = sizeof device;
    device.user = this;
    device.name = "own";
    hapto_device_limits_init(&device.limits);
    device.limits.simulated = simulated ? 1 : 0;
    device.limits.max_force_n = 12;
    device.limits.workspace_radius_m = 0.2;
    device.read = read;
    device.write = write;
    device.let_go = letGo;
    device.take_up = takeUp;
    return device;
  }
};

}  // namespace haptolith::library
