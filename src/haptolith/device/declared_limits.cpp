#include "haptolith/device/declared_limits.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <utility>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

using LimitsJson = nlohmann::ordered_json;

constexpr std::array<std::pair<const char*, double DeviceLimits::*>, 13> kNumbers{{
    {"max_force_n", &DeviceLimits::max_force_n},
    {"max_torque_nm", &DeviceLimits::max_torque_nm},
    {"max_gripper_force_n", &DeviceLimits::max_gripper_force_n},
    {"max_force_rate_n_s", &DeviceLimits::max_force_rate_n_s},
    {"max_torque_rate_nm_s", &DeviceLimits::max_torque_rate_nm_s},
    {"max_gripper_rate_n_s", &DeviceLimits::max_gripper_rate_n_s},
    {"max_stiffness_n_m", &DeviceLimits::max_stiffness_n_m},
    {"max_stiffness_nm_rad", &DeviceLimits::max_stiffness_nm_rad},
    {"damping_n_s_m", &DeviceLimits::damping_n_s_m},
    {"workspace_radius_m", &DeviceLimits::workspace_radius_m},
    {"rate_hz", &DeviceLimits::rate_hz},
    {"delay_s", &DeviceLimits::delay_s},
    {"resolution_m", &DeviceLimits::resolution_m},
}};
constexpr std::array<std::pair<const char*, bool DeviceLimits::*>, 4> kSwitches{
    {{"turns", &DeviceLimits::turns},
     {"shows_force", &DeviceLimits::shows_force},
     {"grips", &DeviceLimits::grips},
     {"delay_known", &DeviceLimits::delay_known}}};

}  // namespace

std::string limitsText(const DeviceLimits& limits, bool simulated) {
  LimitsJson json{
      {"simulated", simulated}, {"workspace_centre_m", limits.workspace_centre_m}, {"turn_rad", limits.turn_rad}};
  for (const auto& [name, member] : kNumbers) {
    json[name] = limits.*member;  // an infinite one becomes null
  }
  for (const auto& [name, member] : kSwitches) {
    json[name] = limits.*member;
  }
  return json.dump();
}

DeclaredLimits limitsOf(std::string_view text) try {
  const LimitsJson json = LimitsJson::parse(text);
  DeclaredLimits declared;
  declared.simulated = json.at("simulated").get<bool>();
  for (int axis = 0; axis < 3; ++axis) {
    declared.limits.workspace_centre_m[axis] = json.at("workspace_centre_m").at(axis).get<double>();
    declared.limits.turn_rad[axis] = json.at("turn_rad").at(axis).get<double>();
  }
  // Recordings of version 0.1.0 know neither of these: their devices were taken to be exact.
  const auto unknown = [&json](std::string_view name) {
    return !json.contains(name) && (name == "resolution_m" || name == "delay_known");
  };
  for (const auto& [name, member] : kNumbers) {
    if (unknown(name)) {
      continue;
    }
    const LimitsJson& value = json.at(name);
    declared.limits.*member = value.is_null() ? DeviceLimits::kNone : value.get<double>();
  }
  for (const auto& [name, member] : kSwitches) {
    if (!unknown(name)) {
      declared.limits.*member = json.at(name).get<bool>();
    }
  }
  return declared;
} catch (const LimitsJson::exception& error) {
  throw Failure(fmt::format("cannot read the limits of the recorded device: {}", error.what()));
}

}  // namespace haptolith
