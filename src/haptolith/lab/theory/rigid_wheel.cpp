#include "haptolith/lab/theory/rigid_wheel.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

constexpr Range kWheelSlip{-1, 0.99};

void validate(const RigidWheel& wheel, double slip) {
  const Range positive{0, 1e12, Ends::kOpenBelow};
  requireInRange("radius_m", wheel.radius_m, positive);
  requireInRange("width_m", wheel.width_m, positive);
  requireInRange("modulus", wheel.modulus, positive);
  requireInRange("exponent", wheel.exponent, {0.05, 5});
  requireInRange("friction_angle_rad", wheel.friction_angle_rad, {0, std::numbers::pi / 3});
  requireInRange("cohesion_pa", wheel.cohesion_pa, {0, 1e6});
  requireInRange("shear_modulus_m", wheel.shear_modulus_m, positive);
  requireInRange("peak_angle_ratio", wheel.peak_angle_ratio, {0, 1, Ends::kOpenBelow});
  requireInRange("peak_angle_slip", wheel.peak_angle_slip, {0, 1});
  requireInRange("slip", slip, kWheelSlip);
}

/// Stress on the rim.
struct RimStress {
  double normal_pa = 0, shear_pa = 0;  ///< shear > 0 drives the wheel
};

class Rim {
 public:
  Rim(const RigidWheel& wheel, double slip, double sinkage_m)
      : wheel_(wheel),
        travel_over_rim_(travelOverRim(slip)),
        entry_(std::acos(1 - sinkage_m / wheel.radius_m)),
        peak_(std::fmin(wheel.peak_angle_ratio + wheel.peak_angle_slip * std::abs(slip), 0.99) * entry_) {}

  [[nodiscard]] double entry() const noexcept { return entry_; }
  [[nodiscard]] double peak() const noexcept { return peak_; }

  [[nodiscard]] RimStress at(double theta) const noexcept {
    const double in_front = theta >= peak_ ? theta : entry_ - theta * (entry_ - peak_) / peak_;
    const double depth_m = std::fmax(0.0, wheel_.radius_m * (std::cos(in_front) - std::cos(entry_)));
    RimStress stress{.normal_pa = wheel_.modulus * std::pow(depth_m, wheel_.exponent)};
    const double j_m = wheel_.radius_m * slide(theta);
    const double limit_pa = wheel_.cohesion_pa + stress.normal_pa * std::tan(wheel_.friction_angle_rad);
    stress.shear_pa = std::copysign(limit_pa * -std::expm1(-std::abs(j_m) / wheel_.shear_modulus_m), j_m);
    return stress;
  }

 private:
  /// Returns j / r.
  [[nodiscard]] double slide(double theta) const noexcept {
    const double travelled = std::sin(entry_) - std::sin(theta);
    return std::isinf(travel_over_rim_) ? -std::numeric_limits<double>::infinity()
                                        : entry_ - theta - travel_over_rim_ * travelled;
  }

  const RigidWheel& wheel_;
  double travel_over_rim_;
  double entry_, peak_;
};

/// Adds Simpson's rule over a part of the rim.
void integrate(const Rim& rim, const RigidWheel& wheel, double from, double to, WheelForces& sum) {
  constexpr int kIntervals = 400;
  const double step = (to - from) / kIntervals;
  for (int i = 0; i <= kIntervals; ++i) {
    const double theta = from + i * step;
    const double weight = (i == 0 || i == kIntervals ? 1 : i % 2 == 1 ? 4 : 2) * step / 3;
    const RimStress stress = rim.at(theta);
    const double area_m2 = weight * wheel.radius_m * wheel.width_m;
    sum.vertical_n += area_m2 * (stress.normal_pa * std::cos(theta) + stress.shear_pa * std::sin(theta));
    sum.drawbar_n += area_m2 * (stress.shear_pa * std::cos(theta) - stress.normal_pa * std::sin(theta));
    sum.torque_nm += area_m2 * wheel.radius_m * stress.shear_pa;
  }
}

}  // namespace

double travelOverRim(double slip) {
  requireInRange("slip", slip, kWheelSlip);
  if (slip >= 0) {
    return 1 - slip;
  }
  return slip == -1 ? std::numeric_limits<double>::infinity() : 1 / (1 + slip);
}

WheelForces rigidWheelForces(const RigidWheel& wheel, double slip, double sinkage_m) {
  validate(wheel, slip);
  requireInRange("sinkage_m", sinkage_m, {0, wheel.radius_m, Ends::kOpen});
  const Rim rim(wheel, slip, sinkage_m);
  WheelForces forces{.sinkage_m = sinkage_m};
  integrate(rim, wheel, 0, rim.peak(), forces);
  integrate(rim, wheel, rim.peak(), rim.entry(), forces);
  return forces;
}

WheelForces rigidWheelUnderLoad(const RigidWheel& wheel, double slip, double load_n) {
  validate(wheel, slip);
  requireInRange("load_n", load_n, {0, 1e12, Ends::kOpenBelow});
  constexpr double kDeepest = 0.999;  // fraction of r
  constexpr int kSteps = 200;
  // The first sinkage that suffices: a braked wheel may carry less when it is deeper.
  double above_m = 0;
  double below_m = 0;
  for (int i = 1; i <= kSteps && below_m == 0; ++i) {
    const double sinkage_m = kDeepest * wheel.radius_m * i / kSteps;
    if (rigidWheelForces(wheel, slip, sinkage_m).vertical_n >= load_n) {
      below_m = sinkage_m;
    } else {
      above_m = sinkage_m;
    }
  }
  if (below_m == 0) {
    const double most_n = rigidWheelForces(wheel, slip, kDeepest * wheel.radius_m).vertical_n;
    throw InvalidParameter("load_n", fmt::format("{:g}", load_n),
                           fmt::format("less than {:.3g}, which the wheel carries in this soil", most_n));
  }
  constexpr int kHalvings = 50;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle_m = (above_m + below_m) / 2;
    (rigidWheelForces(wheel, slip, middle_m).vertical_n < load_n ? above_m : below_m) = middle_m;
  }
  return rigidWheelForces(wheel, slip, below_m);
}

}  // namespace haptolith
