#include "haptolith/haptics/wrench_filter.h"

#include <cmath>
#include <numbers>

#include "haptolith/core/assert.h"
#include "haptolith/core/error.h"
#include "haptolith/core/math/portable_math.h"
#include "haptolith/core/movement.h"

namespace haptolith {

namespace {

/// A thousandth of what a hand can feel: well below the noise of any device.
constexpr double kNothing = 1e-6;

/// Between movements that a person makes on purpose (below) and the 8 to 25 Hz at which an arm shakes against several
/// contacts (above). Lower, and the force felt in scooping and stirring is off by 10 % and more (at 2 Hz); above 10 Hz
/// a buried shovel begins to shake again.
constexpr double kQuick_hz = 6;

/// Share of the way to its input that a first-order low-pass goes in one tick: the step-invariant discretisation.
double lowPassShare(double cutoff_hz, double tick_s) {
  HAPTO_ASSERT(cutoff_hz > 0 && tick_s > 0);
  return 1 - portable::exp(-2 * std::numbers::pi * cutoff_hz * tick_s);
}

double checkedShare(double cutoff_hz, double tick_s) {
  requireInRange("filter_cutoff_hz", cutoff_hz, {0, 0.5 / tick_s, Ends::kOpenBelow});
  return lowPassShare(cutoff_hz, tick_s);
}

void approach(Vec3& output, const Vec3& input, double share) noexcept {
  HAPTO_ASSERT(share > 0 && share <= 1);
  output += share * (input - output);
  if (input.isZero(0) && output.squaredNorm() < kNothing * kNothing) {
    output.setZero();
  }
}

}  // namespace

WrenchFilter::WrenchFilter(double cutoff_hz, double tick_s) : share_(checkedShare(cutoff_hz, tick_s)) {}

const Wrench& WrenchFilter::step(const Wrench& input, const Vec3& own_change_n) noexcept {
  output_.force_n += own_change_n;
  approach(output_.force_n, input.force_n, share_);
  approach(output_.torque_nm, input.torque_nm, share_);
  return output_;
}

GripFilter::GripFilter(double cutoff_hz, double tick_s) : share_(checkedShare(cutoff_hz, tick_s)) {}

double GripFilter::step(double grip_n) noexcept {
  output_n_ += share_ * (grip_n - output_n_);
  if (grip_n == 0 && output_n_ * output_n_ < kNothing * kNothing) {
    output_n_ = 0;
  }
  return output_n_;
}

QuickMovement::QuickMovement(double tick_s) noexcept : share_(lowPassShare(kQuick_hz, tick_s)) {}

Vec3 QuickMovement::step(const Vec3& velocity_m_s) noexcept {
  slow_m_s_ += share_ * (velocity_m_s - slow_m_s_);
  return velocity_m_s - slow_m_s_;
}

Wrench limited(const Wrench& wrench, const DeviceLimits& limits) noexcept {
  return {atMost(limits.max_force_n, wrench.force_n), atMost(limits.max_torque_nm, wrench.torque_nm)};
}

}  // namespace haptolith
