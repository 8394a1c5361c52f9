#include "haptolith/haptics/wrench_filter.h"

#include <cmath>
#include <numbers>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

/// A thousandth of what a hand can feel: well below the noise of any device.
constexpr double kNothing = 1e-6;

void approach(Vec3& output, const Vec3& input, double share) noexcept {
  output += share * (input - output);
  if (input.isZero(0) && output.squaredNorm() < kNothing * kNothing) {
    output.setZero();
  }
}

Vec3 shortened(const Vec3& vector, double longest) noexcept {
  const double length = vector.norm();
  return length > longest ? Vec3(vector * (longest / length)) : vector;
}

}  // namespace

WrenchFilter::WrenchFilter(double cutoff_hz, double tick_s) {
  requireInRange("filter_cutoff_hz", cutoff_hz, {0, 0.5 / tick_s, Ends::kOpenBelow});
  share_ = 1 - std::exp(-2 * std::numbers::pi * cutoff_hz * tick_s);
}

const Wrench& WrenchFilter::step(const Wrench& input) noexcept {
  approach(output_.force_n, input.force_n, share_);
  approach(output_.torque_nm, input.torque_nm, share_);
  return output_;
}

Wrench limited(const Wrench& wrench, const DeviceLimits& limits) noexcept {
  return {shortened(wrench.force_n, limits.max_force_n), shortened(wrench.torque_nm, limits.max_torque_nm)};
}

}  // namespace haptolith
