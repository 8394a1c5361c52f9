#include "made_up.h"

#include <bit>
#include <cmath>
#include <initializer_list>
#include <limits>

namespace haptolith {

RecordingHeader madeUpHeader() {
  return {.scene_file = "# A scene\n[bed]\nwidth_mm = 80\n",
          .title = "Gräben auf dem Mond",
          .program_version = "1.2.3",
          .instruction_set = "AVX2",
          .arithmetic = "fused",
          .device = "virtual hand",
          .device_limits = limitsText({}, true),
          .host = "bench",
          .started_utc = "2026-01-02T03:04:05Z",
          .seed = 0xFEDC'BA98'7654'3210,
          .threads = 2,
          .hashed_parts = 16,
          .start_tick = 7,
          .tick_s = 0.001};
}

TickRecord madeUpTick(std::uint64_t n) {
  double next = static_cast<double>(n) + 0.1;
  const auto number = [&next] { return next = next * 1.0625 + 1.0 / 3; };
  const auto vector = [&] {
    const double x = number(), y = number(), z = number();
    return Vec3(x, y, z);
  };
  const auto pose = [&] {
    const Vec3 position_m = vector();
    const double w = number(), x = number(), y = number(), z = number();
    return Pose{position_m, Quat(w, x, y, z)};
  };
  const auto wrench = [&] {
    const Vec3 force_n = vector();
    return Wrench{force_n, vector()};
  };
  TickRecord tick;
  tick.time_s = static_cast<double>(n) * 0.001;
  tick.device.pose = pose();
  tick.device.twist.linear_m_s = vector();
  tick.device.twist.angular_rad_s = vector();
  tick.device.gripper_open = number();
  tick.device.buttons = static_cast<std::uint32_t>(n * 2654435761U);
  tick.device.state = static_cast<DeviceState>(n % 4);
  tick.scene_T_tool = pose();
  tick.soil = wrench();
  tick.rendered = {.wrench = wrench(), .gripper_force_n = number()};
  tick.sent = {.wrench = wrench(), .gripper_force_n = number()};
  tick.injected_j = number();
  tick.quick_injected_j = number();
  tick.tick_us = number();
  tick.late_us = number();
  tick.state_hash = n * 0x9E37'79B9'7F4A'7C15;
  tick.flags = static_cast<std::uint32_t>(n % 64);
  tick.trip = static_cast<std::uint8_t>(n % 251);
  using Limits = std::numeric_limits<double>;
  const double odd[] = {Limits::quiet_NaN(), -Limits::infinity(), -0.0, Limits::denorm_min(),
                        std::bit_cast<double>(0x7FF8'0000'0000'1234)};
  tick.soil.force_n.y() = odd[n % std::size(odd)];
  return tick;
}

ParticleFrame madeUpFrame(std::uint64_t n, std::size_t particles) {
  ParticleFrame frame{.time_s = static_cast<double>(n) * 0.033, .tick = n * 33, .position_m = {}};
  for (std::size_t i = 0; i < particles; ++i) {
    const float at = static_cast<float>(i) + 0.01F * static_cast<float>(n);
    frame.position_m.push_back({at, -at, 1 / (at + 1)});
  }
  return frame;
}

std::vector<std::uint64_t> bitsOf(const TickRecord& tick) {
  std::vector<std::uint64_t> bits;
  const auto numbers = [&](std::initializer_list<double> values) {
    for (const double value : values) {
      bits.push_back(std::bit_cast<std::uint64_t>(value));
    }
  };
  const auto vector = [&](const Vec3& v) { numbers({v.x(), v.y(), v.z()}); };
  const auto pose = [&](const Pose& p) {
    vector(p.position_m);
    numbers({p.orientation.w(), p.orientation.x(), p.orientation.y(), p.orientation.z()});
  };
  const auto wrench = [&](const Wrench& w) {
    vector(w.force_n);
    vector(w.torque_nm);
  };
  numbers({tick.time_s});
  pose(tick.device.pose);
  vector(tick.device.twist.linear_m_s);
  vector(tick.device.twist.angular_rad_s);
  numbers({tick.device.gripper_open});
  bits.insert(bits.end(), {tick.device.buttons, static_cast<std::uint64_t>(tick.device.state)});
  pose(tick.scene_T_tool);
  wrench(tick.soil);
  wrench(tick.rendered.wrench);
  numbers({tick.rendered.gripper_force_n});
  wrench(tick.sent.wrench);
  numbers({tick.sent.gripper_force_n, tick.injected_j, tick.tick_us, tick.late_us});
  bits.insert(bits.end(), {tick.state_hash, tick.flags, tick.trip});
  return bits;
}

}  // namespace haptolith
