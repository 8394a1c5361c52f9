#include "haptolith/haptics/safety/safety_layer.h"

#include <algorithm>
#include <cmath>

#include "haptolith/core/assert.h"
#include "haptolith/haptics/tick_record.h"
#include "haptolith/haptics/wrench_filter.h"

namespace haptolith {

namespace {

/// Tolerance at the edge of the workspace: rounding of a position or of the radius does not
/// count as leaving it.
constexpr double kBeyondWorkspace = 1.01;

bool isFinite(const DeviceInput& input) noexcept {
  return input.pose.position_m.allFinite() && isUnit(input.pose.orientation) && input.twist.linear_m_s.allFinite() &&
         input.twist.angular_rad_s.allFinite() && std::isfinite(input.gripper_open);
}

bool isFinite(const DeviceOutput& output) noexcept {
  return output.wrench.force_n.allFinite() && output.wrench.torque_nm.allFinite() &&
         std::isfinite(output.gripper_force_n);
}

/// From `from` towards `to`, but no further than `furthest`.
Vec3 stepTowards(const Vec3& from, const Vec3& to, double furthest) noexcept {
  HAPTO_ASSERT(furthest >= 0);
  const Vec3 way = to - from;
  const double length = way.norm();
  return length > furthest ? Vec3(from + way * (furthest / length)) : to;
}

/// An s-curve: without a kink at either end.
double smooth(double share) noexcept {
  HAPTO_ASSERT(share >= 0 && share <= 1);
  return share * share * (3 - 2 * share);
}

}  // namespace

const char* text(SafetyTrip trip) noexcept {
  switch (trip) {
    case SafetyTrip::kNone: return "none";
    case SafetyTrip::kDeviceNotFinite: return "the device's pose or velocity is NaN or infinite";
    case SafetyTrip::kStale: return "the device has stopped sending new readings";
    case SafetyTrip::kLost: return "the device is disconnected";
    case SafetyTrip::kWorkspace: return "the hand left the workspace";
    case SafetyTrip::kMissedDeadlines: return "too many deadlines in a row were missed";
    case SafetyTrip::kHeartbeat: return "the loop did not respond in time";
    case SafetyTrip::kForceNotFinite: return "the force is NaN or infinite";
    case SafetyTrip::kImplausible: return "the device reported an impossibly fast movement";
  }
  return "";
}

SafetyLayer::SafetyLayer(const SafetyParameters& parameters, const DeviceLimits& limits, bool simulated,
                         double storage_n_m, double tick_s)
    : limits_(limits),
      simulated_(simulated),
      damps_(parameters.passivity),
      tick_s_(tick_s),
      soft_start_s_(simulated ? 0 : parameters.soft_start_s),
      soft_stop_s_(simulated ? 0 : parameters.soft_stop_s),
      max_missed_deadlines_(parameters.max_missed_deadlines),
      recovery_ticks_(static_cast<int>(std::lround(parameters.recovery_s / tick_s))),
      plausibility_(limits.rate_hz, tick_s),
      passivity_({.stiffness_n_m = storage_n_m,
                  .delay_s = limits.delay_s,
                  .delay_known = limits.delay_known,
                  .resolution_m = limits.resolution_m},
                 tick_s),
      soft_start_(soft_start_s_ == 0 ? 1 : 0) {
  validate(parameters);
  limits_.max_force_n = std::min(limits.max_force_n, parameters.max_force_n);
  limits_.max_torque_nm = std::min(limits.max_torque_nm, parameters.max_torque_nm);
}

void SafetyLayer::check(const DeviceInput& input, const LoopHealth& health) noexcept {
  just_tripped_ = just_recovered_ = false;
  misses_ = health.late ? misses_ + 1 : 0;
  const SafetyTrip now = reason(input, health);
  if (now != SafetyTrip::kNone) {
    releaseForce(now);
  } else if (trip_ != SafetyTrip::kNone && ++well_for_ > recovery_ticks_) {
    trip_ = SafetyTrip::kNone;
    just_recovered_ = true;
    restart();
  }
  if (trip_ == SafetyTrip::kNone) {
    begun_ = true;
    passivity_.observe(input.pose, held_soil_);
  }
}

SafetyTrip SafetyLayer::reason(const DeviceInput& input, const LoopHealth& health) noexcept {
  if (input.state == DeviceState::kLost) {
    return SafetyTrip::kLost;
  }
  if (input.state == DeviceState::kStale) {
    return SafetyTrip::kStale;
  }
  if (!isFinite(input)) {
    return SafetyTrip::kDeviceNotFinite;
  }
  const bool plausible = simulated_ || plausibility_.observe(input);
  if ((input.pose.position_m - limits_.workspace_centre_m).norm() > kBeyondWorkspace * limits_.workspace_radius_m) {
    return SafetyTrip::kWorkspace;
  }
  if (health.heartbeat_lost) {
    return SafetyTrip::kHeartbeat;
  }
  if (!plausible) {
    return SafetyTrip::kImplausible;
  }
  return !simulated_ && misses_ > max_missed_deadlines_ ? SafetyTrip::kMissedDeadlines : SafetyTrip::kNone;
}

/// A reason that follows from the first one does not replace it, but that the device is gone: it does not come back.
void SafetyLayer::releaseForce(SafetyTrip why) noexcept {
  if (trip_ == SafetyTrip::kNone) {
    trip_ = why;
    just_tripped_ = begun_;
    trips_ += begun_ ? 1 : 0;
  } else if (why == SafetyTrip::kLost) {
    trip_ = why;
  }
  well_for_ = 0;
}

void SafetyLayer::restart() noexcept {
  soft_start_.set(soft_start_s_ == 0 ? 1 : 0);
  plausibility_.restart();
  passivity_.restart();
  held_ = {};
  held_weight_ = held_soil_ = {};
}

DeviceOutput SafetyLayer::step(const DeviceOutput& rendered, const Wrench& weight) noexcept {
  flags_ = stopping_ ? kTickSoftStop : 0U;
  if (!isFinite(rendered) || !isFinite(DeviceOutput{weight})) {
    releaseForce(SafetyTrip::kForceNotFinite);
  }
  if (trip_ != SafetyTrip::kNone) {
    flags_ |= kTickForceZeroed;
    held_ = {};
    held_weight_ = held_soil_ = {};
    return held_;
  }
  startOrStopSoftly();
  DeviceOutput wanted = limited(rendered);
  Wrench wanted_weight = haptolith::limited(weight, limits_);
  if (soft_start_.share() <
      1) {  // a share of what is limited: else ten times too much would be all there is within a third
    const double share = smooth(soft_start_.share());
    wanted.wrench = {share * wanted.wrench.force_n, share * wanted.wrench.torque_nm};
    wanted.gripper_force_n *= share;
    wanted_weight = {share * wanted_weight.force_n, share * wanted_weight.torque_nm};
    flags_ |= kTickSoftStart;
  }
  wanted = dampedForPassivity(wanted);
  held_weight_ = {stepTowards(held_weight_.force_n, wanted_weight.force_n, tick_s_ * limits_.max_force_rate_n_s),
                  stepTowards(held_weight_.torque_nm, wanted_weight.torque_nm, tick_s_ * limits_.max_torque_rate_nm_s)};
  if (!held_weight_.isZero()) {
    wanted.wrench.add(held_weight_);
    wanted = limited(wanted);
  }
  held_ = reachable(wanted);
  held_soil_ = {held_.wrench.force_n - held_weight_.force_n, held_.wrench.torque_nm - held_weight_.torque_nm};
  return held_;
}

/// Reduces and damps the output when the hand was given too much energy.
DeviceOutput SafetyLayer::dampedForPassivity(DeviceOutput wanted) noexcept {
  if (const double share = damps_ ? passivity_.softening() : 1; share < 1) {
    wanted.wrench = {share * wanted.wrench.force_n, share * wanted.wrench.torque_nm};
    wanted.gripper_force_n *= share;
    flags_ |= kTickPassivityDamped;
  }
  if (const Wrench damping = passivity_.damping(); damps_ && !damping.isZero()) {
    wanted.wrench.add(damping);
    wanted = limited(wanted);
    flags_ |= kTickPassivityDamped;
  }
  if (const double share = damps_ ? passivity_.affordable(wanted.wrench) : 1; share < 1) {
    wanted.wrench = {share * wanted.wrench.force_n, share * wanted.wrench.torque_nm};
    flags_ |= kTickPassivityDamped;
  }
  return wanted;
}

bool SafetyLayer::stopped() const noexcept {
  if (!stopping_ || soft_stop_s_ == 0 || trip_ != SafetyTrip::kNone) {
    return stopping_;
  }
  // With a limited rate of force, it still decreases when no output is requested any more.
  return soft_start_.share() == 0 && held_.wrench.force_n.norm() <= tick_s_ * limits_.max_force_rate_n_s &&
         held_.wrench.torque_nm.norm() <= tick_s_ * limits_.max_torque_rate_nm_s;
}

void SafetyLayer::startOrStopSoftly() noexcept {
  if (stopping_ && soft_stop_s_ > 0) {
    soft_start_.fall(tick_s_, soft_stop_s_);
  } else if (!stopping_ && soft_start_.share() < 1) {
    soft_start_.rise(tick_s_, soft_start_s_);
  }
}

/// Limits the output to the device's range; directions stay.
DeviceOutput SafetyLayer::limited(const DeviceOutput& wanted) noexcept {
  const double finger_n = limits_.max_gripper_force_n;
  DeviceOutput can{haptolith::limited(wanted.wrench, limits_), std::clamp(wanted.gripper_force_n, -finger_n, finger_n)};
  if (can.wrench.force_n != wanted.wrench.force_n || can.wrench.torque_nm != wanted.wrench.torque_nm ||
      can.gripper_force_n != wanted.gripper_force_n) {
    flags_ |= kTickForceSaturated;
  }
  return can;
}

/// As far from what the hand feels now towards `wanted` as a tick may go.
DeviceOutput SafetyLayer::reachable(const DeviceOutput& wanted) noexcept {
  const double finger_n = tick_s_ * limits_.max_gripper_rate_n_s;
  DeviceOutput next{
      {stepTowards(held_.wrench.force_n, wanted.wrench.force_n, tick_s_ * limits_.max_force_rate_n_s),
       stepTowards(held_.wrench.torque_nm, wanted.wrench.torque_nm, tick_s_ * limits_.max_torque_rate_nm_s)},
      std::clamp(wanted.gripper_force_n, held_.gripper_force_n - finger_n, held_.gripper_force_n + finger_n)};
  if (next.wrench.force_n != wanted.wrench.force_n || next.wrench.torque_nm != wanted.wrench.torque_nm ||
      next.gripper_force_n != wanted.gripper_force_n) {
    flags_ |= kTickForceRateLimited;
  }
  return next;
}

}  // namespace haptolith
