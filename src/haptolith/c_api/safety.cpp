// The safety layer alone, for hosts with their own loop and device.

#include <fmt/format.h>
#include <haptolith/haptolith.h>

#include <limits>
#include <memory>
#include <utility>

#include "haptolith/c_api/errors.h"
#include "haptolith/c_api/handles.h"
#include "haptolith/c_api/values.h"
#include "haptolith/haptics/loop_parameters.h"
#include "haptolith/haptics/safety/safety_layer.h"
#include "haptolith/haptics/tick_record.h"
#include "haptolith/scene_file/scene_file.h"

struct hapto_safety : haptolith::library::HandleOf<haptolith::SafetyLayer> {
  static constexpr std::uint32_t kKind = 0x48615361;
};

using namespace haptolith;
using namespace haptolith::library;

static_assert(HAPTO_SAFETY_LATE == static_cast<int>(kTickLate) &&
              HAPTO_SAFETY_ZEROED == static_cast<int>(kTickForceZeroed) &&
              HAPTO_SAFETY_SATURATED == static_cast<int>(kTickForceSaturated) &&
              HAPTO_SAFETY_RATE_LIMITED == static_cast<int>(kTickForceRateLimited) &&
              HAPTO_SAFETY_SOFT_START == static_cast<int>(kTickSoftStart) &&
              HAPTO_SAFETY_DAMPED == static_cast<int>(kTickPassivityDamped) &&
              HAPTO_SAFETY_SOFT_STOP == static_cast<int>(kTickSoftStop));
static_assert(HAPTO_DEVICE_LIVE == static_cast<int>(DeviceState::kLive) &&
              HAPTO_DEVICE_STALE == static_cast<int>(DeviceState::kStale) &&
              HAPTO_DEVICE_LOST == static_cast<int>(DeviceState::kLost) &&
              HAPTO_DEVICE_FINISHED == static_cast<int>(DeviceState::kFinished));

std::int32_t hapto_device_limits_init(hapto_device_limits* out) {
  if (out == nullptr) {
    return wrongArgument(HAPTO_NULL, "out");
  }
  const DeviceLimits ideal;
  *out = {.size = sizeof *out,
          .turns = ideal.turns ? 1 : 0,
          .shows_force = ideal.shows_force ? 1 : 0,
          .grips = ideal.grips ? 1 : 0,
          .delay_known = ideal.delay_known ? 1 : 0,
          .simulated = 0,
          .max_force_n = ideal.max_force_n,
          .max_torque_nm = ideal.max_torque_nm,
          .max_gripper_force_n = ideal.max_gripper_force_n,
          .max_force_rate_n_s = ideal.max_force_rate_n_s,
          .max_torque_rate_nm_s = ideal.max_torque_rate_nm_s,
          .max_gripper_rate_n_s = ideal.max_gripper_rate_n_s,
          .max_stiffness_n_m = ideal.max_stiffness_n_m,
          .max_stiffness_nm_rad = ideal.max_stiffness_nm_rad,
          .damping_n_s_m = ideal.damping_n_s_m,
          .turn_rad = {},
          .workspace_centre_m = {},
          .workspace_radius_m = ideal.workspace_radius_m,
          .rate_hz = ideal.rate_hz,
          .delay_s = ideal.delay_s,
          .resolution_m = ideal.resolution_m};
  return HAPTO_OK;
}

std::int32_t hapto_safety_create(const hapto_device_limits* declared, const char* const* overrides, std::uint32_t count,
                                 double tick_s, double stiffness_n_m, hapto_safety** out) {
  if (declared == nullptr || out == nullptr) {
    return wrongArgument(HAPTO_NULL, declared == nullptr ? "limits" : "out");
  }
  if (sizeStatus(declared) != HAPTO_OK) {
    return wrongArgument(HAPTO_WRONG_SIZE, "limits");
  }
  return guarded([&] {
    constexpr Range kStiffness_n_m{1e-3, 1e7};
    requireInRange("tick_s", tick_s, LoopRanges::tick_s);
    requireInRange("stiffness_n_m", stiffness_n_m, kStiffness_n_m);
    SceneFile rest = changed(SceneFile(), texts(overrides, count));
    const SafetyParameters safety = std::exchange(rest.handling.safety, {});
    if (!(rest == SceneFile())) {
      throw InvalidParameter("overrides", fmt::format("{} keys", count), "keys of [safety] only");
    }
    *out = Places<hapto_safety>::take(
        std::make_unique<SafetyLayer>(safety, limits(*declared), declared->simulated != 0, stiffness_n_m, tick_s));
    return HAPTO_OK;
  });
}

std::int32_t hapto_safety_step(hapto_safety* safety, const hapto_device_input* told, std::int32_t late,
                               hapto_device_output* inout) {
  const std::int32_t sizes = sizeStatus(told) != HAPTO_OK ? sizeStatus(told) : sizeStatus(inout);
  if (sizes != HAPTO_OK) {
    return sizes;
  }
  const Claim claim(safety);
  if (claim.status() != HAPTO_OK) {
    return claim.status();
  }
  claim->check(input(taken(*told)), {.late = late != 0});
  const DeviceOutput shown = claim->step(output(taken(*inout)));
  inout->wrench = wrench(shown.wrench);
  inout->gripper_force_n = shown.gripper_force_n;
  return HAPTO_OK;
}

std::int32_t hapto_safety_get_info(const hapto_safety* safety, hapto_safety_info* out) {
  if (const std::int32_t status = sizeStatus(out); status != HAPTO_OK) {
    return status;
  }
  const Claim claim(safety);
  if (claim.status() != HAPTO_OK) {
    return claim.status();
  }
  give({.size = 0,
        .trips = claim->trips(),
        .flags = claim->flags(),
        .reserved = 0,
        .trip = claim->trip() == SafetyTrip::kNone ? "" : text(claim->trip()),
        .injected_j = claim->passivity().injected()},
       *out);
  return HAPTO_OK;
}

std::int32_t hapto_safety_stop(hapto_safety* safety) {
  const Claim claim(safety);
  if (claim.status() != HAPTO_OK) {
    return claim.status();
  }
  claim->stop();
  return HAPTO_OK;
}

std::int32_t hapto_safety_destroy(hapto_safety* safety) {
  Claim claim(safety);
  if (claim.status() != HAPTO_OK) {
    return wrongArgument(claim.status(), "safety");
  }
  claim.destroy();
  return HAPTO_OK;
}
