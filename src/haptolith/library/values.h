#pragma once

#include <haptolith/haptolith.h>

#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/movement.h"
#include "haptolith/device/haptic_device.h"
#include "haptolith/library/errors.h"

namespace haptolith::library {

[[nodiscard]] inline Vec3 vec(const double (&v)[3]) noexcept {
  return {v[0], v[1], v[2]};
}

inline void put(const Vec3& v, double (&out)[3]) noexcept {
  Vec3::Map(out) = v;
}

[[nodiscard]] inline Pose pose(const hapto_pose& p) noexcept {
  const auto& q = p.orientation;
  return {vec(p.position_m), Quat(q[0], q[1], q[2], q[3])};
}

[[nodiscard]] inline hapto_pose pose(const Pose& p) noexcept {
  const Quat& q = p.orientation;
  return {{p.position_m.x(), p.position_m.y(), p.position_m.z()}, {q.w(), q.x(), q.y(), q.z()}};
}

[[nodiscard]] inline Twist twist(const hapto_twist& t) noexcept {
  return {vec(t.linear_m_s), vec(t.angular_rad_s)};
}

[[nodiscard]] inline hapto_twist twist(const Twist& t) noexcept {
  return {{t.linear_m_s.x(), t.linear_m_s.y(), t.linear_m_s.z()},
          {t.angular_rad_s.x(), t.angular_rad_s.y(), t.angular_rad_s.z()}};
}

[[nodiscard]] inline hapto_wrench wrench(const Wrench& w) noexcept {
  return {{w.force_n.x(), w.force_n.y(), w.force_n.z()}, {w.torque_nm.x(), w.torque_nm.y(), w.torque_nm.z()}};
}

[[nodiscard]] inline Wrench wrench(const hapto_wrench& w) noexcept {
  return {vec(w.force_n), vec(w.torque_nm)};
}

[[nodiscard]] inline DeviceOutput output(const hapto_device_output& out) noexcept {
  return {wrench(out.wrench), out.gripper_force_n};
}

[[nodiscard]] inline DeviceInput input(const hapto_device_input& in) noexcept {
  const bool known = in.state >= HAPTO_DEVICE_LIVE && in.state <= HAPTO_DEVICE_FINISHED;
  return {.pose = pose(in.pose),
          .twist = twist(in.twist),
          .gripper_open = in.gripper_open,
          .buttons = in.buttons,
          .state = known ? static_cast<DeviceState>(in.state) : DeviceState::kLost};
}

/// @throws InvalidParameter for a struct of another size, and for limits that no device has.
[[nodiscard]] DeviceLimits limits(const hapto_device_limits& declared);

/// HAPTO_OK, HAPTO_NULL or HAPTO_WRONG_SIZE.
template <class Struct>
[[nodiscard]] std::int32_t sizeStatus(const Struct* s) noexcept {
  return s == nullptr ? HAPTO_NULL : s->size != sizeof *s ? HAPTO_WRONG_SIZE : HAPTO_OK;
}

/// @throws InvalidParameter when a text is NULL.
[[nodiscard]] std::vector<std::string> texts(const char* const* list, std::uint32_t count);

/// Hands `bytes` out with the two-step protocol of hapto_scene_get_toml().
[[nodiscard]] std::int32_t handOut(std::string_view bytes, void* out, std::uint64_t capacity,
                                   std::uint64_t* needed) noexcept;

[[nodiscard]] std::string_view textOrNothing(const char* text) noexcept;

}  // namespace haptolith::library
