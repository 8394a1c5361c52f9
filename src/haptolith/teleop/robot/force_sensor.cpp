#include "haptolith/teleop/robot/force_sensor.h"

#include <cmath>

#include "haptolith/core/math/random.h"

namespace haptolith {

namespace {

constexpr int kTareReadings = 500;  // half a second: it leaves a twentieth of the noise

Vec3 deviates(std::mt19937_64& random) {
  const double x = nearlyNormal(random);
  const double y = nearlyNormal(random);
  return {x, y, nearlyNormal(random)};
}

void approach(const Wrench& target, double share, Wrench& wrench) noexcept {
  wrench.force_n += share * (target.force_n - wrench.force_n);
  wrench.torque_nm += share * (target.torque_nm - wrench.torque_nm);
}

Vec3 within(double full_scale, const Vec3& v) noexcept {
  return v.cwiseMax(-full_scale).cwiseMin(full_scale);
}

void requireEach(const char* key, const Vec3& v, const Range& range) {
  for (const double value : v) {
    requireInRange(key, value, range);
  }
}

}  // namespace

void validate(const ForceSensorParameters& sensor) {
  using Ranges = ForceSensorRanges;
  requireInRange("noise_n", sensor.noise_n, Ranges::noise);
  requireInRange("noise_nm", sensor.noise_nm, Ranges::noise);
  requireEach("bias_n", sensor.bias_n, Ranges::bias_n);
  requireEach("bias_nm", sensor.bias_nm, Ranges::bias_nm);
  requireInRange("drift_n_s", sensor.drift_n_s, Ranges::drift_s);
  requireInRange("drift_nm_s", sensor.drift_nm_s, Ranges::drift_s);
  requireInRange("lag_s", sensor.lag_s, Ranges::lag_s);
  requireInRange("full_scale_n", sensor.full_scale_n, Ranges::full_scale);
  requireInRange("full_scale_nm", sensor.full_scale_nm, Ranges::full_scale);
  requireInRange("tool_mass_kg", sensor.tool_mass_kg, Ranges::mass_kg);
  requireInRange("told_mass_kg", sensor.told_mass_kg, Ranges::mass_kg);
  requireEach("centre_of_mass_m", sensor.centre_of_mass_m, Ranges::centre_of_mass_m);
}

ForceSensor::ForceSensor(const ForceSensorParameters& parameters, const Vec3& gravity_m_s2, double tick_s)
    : parameters_(parameters), gravity_m_s2_(gravity_m_s2), tick_s_(tick_s), random_(parameters.seed) {
  validate(parameters_);
  tare();
}

void ForceSensor::tare() noexcept {
  taring_ = kTareReadings;
  sum_ = {};
}

/// Wrench of the attached mass, at this orientation and acceleration.
Wrench ForceSensor::carried(double mass_kg, const Quat& orientation, const Vec3& acceleration_m_s2) const noexcept {
  Wrench load;
  load.add(mass_kg * (gravity_m_s2_ - acceleration_m_s2), orientation * parameters_.centre_of_mass_m);
  return load;
}

Wrench ForceSensor::read(const Wrench& soil, const Movement& tool) noexcept {
  const bool first = readings_ == 0;
  const Vec3 acceleration_m_s2 = first ? Vec3(Vec3::Zero()) : Vec3((tool.twist.linear_m_s - last_m_s_) / tick_s_);
  last_m_s_ = tool.twist.linear_m_s;
  const double share = first || parameters_.lag_s == 0 ? 1 : -std::expm1(-tick_s_ / parameters_.lag_s);
  Wrench load = carried(parameters_.tool_mass_kg, tool.pose.orientation, acceleration_m_s2);
  load.add(soil);
  approach(load, share, smooth_);
  approach(carried(parameters_.told_mass_kg, tool.pose.orientation, acceleration_m_s2), share, told_smooth_);

  const double time_s = static_cast<double>(readings_++) * tick_s_;
  const auto raw = [&](const Vec3& load_of, const Vec3& bias, double drift_s, double noise, double full_scale) {
    return within(full_scale, load_of + bias + Vec3::Constant(drift_s * time_s) + noise * deviates(random_));
  };
  const ForceSensorParameters& p = parameters_;
  const Vec3 force_n = raw(smooth_.force_n, p.bias_n, p.drift_n_s, p.noise_n, p.full_scale_n);
  const Vec3 torque_nm = raw(smooth_.torque_nm, p.bias_nm, p.drift_nm_s, p.noise_nm, p.full_scale_nm);
  const Wrench net{force_n - told_smooth_.force_n, torque_nm - told_smooth_.torque_nm};
  if (taring_ > 0) {
    sum_.add(net);
    if (--taring_ == 0) {
      zero_ = {sum_.force_n / kTareReadings, sum_.torque_nm / kTareReadings};
    }
    return {};
  }
  return {net.force_n - zero_.force_n, net.torque_nm - zero_.torque_nm};
}

}  // namespace haptolith
