#pragma once

#include <haptolith/haptolith.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/c_api/errors.h"
#include "haptolith/core/movement.h"
#include "haptolith/device/haptic_device.h"
#include "haptolith/scene/force_band.h"

namespace haptolith::library {

[[nodiscard]] inline Vec3 vec(const double (&v)[3]) noexcept {
  return {v[0], v[1], v[2]};
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

/// NaN where the band is not known.
inline void giveBand(const std::optional<ForceRange>& band, hapto_tool_state& state) noexcept {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  state.force_low_n = band ? band->low_n : kUnknown;
  state.force_high_n = band ? band->high_n : kUnknown;
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

/// @throws InvalidParameter for a struct that is too short, and for limits that no device has.
[[nodiscard]] DeviceLimits limits(const hapto_device_limits& declared);

/// Bytes of a struct's first version, in haptolith 0.2.0; where its last member ended then. Programs built with any
/// header since are served, so members only ever come at the end, and these never change.
template <class Struct>
inline constexpr std::size_t kFirstSize = 0;
#define HAPTO_FIRST_SIZE(Struct, last_member)       \
  template <>                                       \
  inline constexpr std::size_t kFirstSize<Struct> = \
      offsetof(Struct, last_member) + sizeof(Struct::last_member)  // NOLINT(bugprone-macro-parentheses)
HAPTO_FIRST_SIZE(hapto_error, valid);
HAPTO_FIRST_SIZE(hapto_array, data);
HAPTO_FIRST_SIZE(hapto_scene_info, gravity_m_s2);
HAPTO_FIRST_SIZE(hapto_device_limits, resolution_m);
HAPTO_FIRST_SIZE(hapto_device_input, reserved);
HAPTO_FIRST_SIZE(hapto_device_output, gripper_force_n);
HAPTO_FIRST_SIZE(hapto_device, take_up);
HAPTO_FIRST_SIZE(hapto_snapshot, position);
HAPTO_FIRST_SIZE(hapto_safety_info, injected_j);
HAPTO_FIRST_SIZE(hapto_tool_state, stiffness_n_m);

/// HAPTO_OK, HAPTO_NULL or HAPTO_WRONG_SIZE.
template <class Struct>
[[nodiscard]] std::int32_t sizeStatus(const Struct* s) noexcept {
  static_assert(kFirstSize<Struct> > 0, "a struct with a size needs that of its first version");
  return s == nullptr ? HAPTO_NULL : s->size < kFirstSize<Struct> ? HAPTO_WRONG_SIZE : HAPTO_OK;
}

/// A caller's struct as this version has it: members that the caller's version lacks are 0.
/// @param given  whose sizeStatus() is HAPTO_OK.
template <class Struct>
[[nodiscard]] Struct taken(const Struct& given) noexcept {
  Struct whole{};
  std::memcpy(&whole, &given, std::min<std::size_t>(given.size, sizeof whole));
  return whole;
}

/// Fills in a caller's struct as far as both versions have it; its size stays the caller's.
/// @param out  whose sizeStatus() is HAPTO_OK.
template <class Struct>
void give(Struct value, Struct& out) noexcept {
  value.size = out.size;
  std::memcpy(&out, &value, std::min<std::size_t>(out.size, sizeof value));
}

/// @throws InvalidParameter when a text is NULL.
[[nodiscard]] std::vector<std::string> texts(const char* const* list, std::uint32_t count);

/// Hands `bytes` out with the two-step protocol of hapto_scene_get_toml().
[[nodiscard]] std::int32_t handOut(std::string_view bytes, void* out, std::uint64_t capacity,
                                   std::uint64_t* needed) noexcept;

[[nodiscard]] std::string_view textOrNothing(const char* text) noexcept;

}  // namespace haptolith::library
