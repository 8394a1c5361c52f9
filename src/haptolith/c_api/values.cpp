#include "haptolith/c_api/values.h"

#include <fmt/format.h>

#include "haptolith/device/device_parameters.h"

namespace haptolith::library {

DeviceLimits limits(const hapto_device_limits& declared) {
  if (sizeStatus(&declared) != HAPTO_OK) {
    throw InvalidParameter("limits.size", fmt::format("{}", declared.size), fmt::format("{}", sizeof declared));
  }
  const auto not_negative = [](const char* key, double value) {  // infinity is valid, and means no limit
    if (!(value >= 0)) {
      throw InvalidParameter(fmt::format("limits.{}", key), fmt::format("{}", value), ">= 0, or infinite for no limit");
    }
    return value;
  };
  const auto finite = [](const char* key, const double(&v)[3]) {
    if (!vec(v).allFinite()) {
      throw InvalidParameter(fmt::format("limits.{}", key), fmt::format("{} {} {}", v[0], v[1], v[2]), "finite");
    }
    return vec(v);
  };
  return {.max_force_n = not_negative("max_force_n", declared.max_force_n),
          .max_torque_nm = not_negative("max_torque_nm", declared.max_torque_nm),
          .max_gripper_force_n = not_negative("max_gripper_force_n", declared.max_gripper_force_n),
          .max_force_rate_n_s = not_negative("max_force_rate_n_s", declared.max_force_rate_n_s),
          .max_torque_rate_nm_s = not_negative("max_torque_rate_nm_s", declared.max_torque_rate_nm_s),
          .max_gripper_rate_n_s = not_negative("max_gripper_rate_n_s", declared.max_gripper_rate_n_s),
          .max_stiffness_n_m = not_negative("max_stiffness_n_m", declared.max_stiffness_n_m),
          .max_stiffness_nm_rad = not_negative("max_stiffness_nm_rad", declared.max_stiffness_nm_rad),
          .damping_n_s_m = requireInRange("limits.damping_n_s_m", declared.damping_n_s_m, {0, 1e4}),
          .turn_rad = finite("turn_rad", declared.turn_rad),
          .workspace_centre_m = finite("workspace_centre_m", declared.workspace_centre_m),
          .workspace_radius_m = not_negative("workspace_radius_m", declared.workspace_radius_m),
          .rate_hz = requireInRange("limits.rate_hz", declared.rate_hz, {1, 1e5}),
          .delay_s = requireInRange("limits.delay_s", declared.delay_s, DeviceRanges::delay_s),
          .delay_known = declared.delay_known != 0,
          .resolution_m =
              requireInRange("limits.resolution_m", declared.resolution_m, {0, DeviceRanges::resolution_m.highest}),
          .turns = declared.turns != 0,
          .shows_force = declared.shows_force != 0,
          .grips = declared.grips != 0};
}

std::vector<std::string> texts(const char* const* list, std::uint32_t count) {
  if (list == nullptr && count > 0) {
    throw InvalidParameter("overrides", "NULL", fmt::format("an array of {} texts", count));
  }
  std::vector<std::string> texts;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (list[i] == nullptr) {
      throw InvalidParameter(fmt::format("overrides[{}]", i), "NULL", "a text, table.key=value");
    }
    texts.emplace_back(list[i]);
  }
  return texts;
}

std::int32_t handOut(std::string_view bytes, void* out, std::uint64_t capacity, std::uint64_t* needed) noexcept {
  if (needed != nullptr) {
    *needed = bytes.size();
  }
  if (capacity < bytes.size()) {
    return failed(HAPTO_TOO_SMALL, hapto_status_text(HAPTO_TOO_SMALL), "capacity");
  }
  if (out == nullptr) {
    return wrongArgument(HAPTO_NULL, "buffer");
  }
  std::memcpy(out, bytes.data(), bytes.size());
  return HAPTO_OK;
}

std::string_view textOrNothing(const char* text) noexcept {
  return text == nullptr ? std::string_view() : std::string_view(text);
}

}  // namespace haptolith::library
