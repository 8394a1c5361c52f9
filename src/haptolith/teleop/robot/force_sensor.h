#pragma once

#include <cstdint>
#include <random>

#include "haptolith/core/error.h"
#include "haptolith/core/movement.h"

namespace haptolith {

/// A six-axis force and torque sensor between a robot's wrist and its tool. The defaults are assumed round numbers
/// of the size that makers state for sensors of 100 to 200 N.
struct ForceSensorParameters {
  double noise_n = 0.05, noise_nm = 0.002;  ///< standard deviation of each reading, along each axis
  Vec3 bias_n{0.8, -0.5, 1.2};              ///< that it shows when there is no load
  Vec3 bias_nm{0.02, 0.01, -0.015};
  double drift_n_s = 5e-4, drift_nm_s = 2e-5;  ///< by which the bias grows, along each axis, since the start
  double lag_s = 0.005;                        ///< time constant of its low-pass
  double full_scale_n = 200;                   ///< it shows no more, along each axis
  double full_scale_nm = 10;
  double tool_mass_kg = 0.3;             ///< mass of the attached tool
  double told_mass_kg = 0.29;            ///< assumed mass for the subtraction of its weight
  Vec3 centre_of_mass_m = Vec3::Zero();  ///< tool's centre of mass, tool frame
  std::uint64_t seed = 1;

  [[nodiscard]] bool operator==(const ForceSensorParameters&) const = default;
};

struct ForceSensorRanges {
  static constexpr Range noise{0, 10};
  static constexpr Range bias_n{-1000, 1000};
  static constexpr Range bias_nm{-100, 100};
  static constexpr Range drift_s{-1, 1};
  static constexpr Range lag_s{0, 1};
  static constexpr Range full_scale{0, 1e5, Ends::kOpenBelow};
  static constexpr Range mass_kg{0, 100};
  static constexpr Range centre_of_mass_m{-1, 1};
};

/// @throws InvalidParameter with the key, the value and the valid range.
void validate(const ForceSensorParameters& sensor);

/// Reading of such a sensor for the soil on the tool, scene frame, about the tool's origin:
///
///     raw  = lowpass(soil + m (g - a)) + bias + drift t + noise,         each axis within the full scale
///     told = raw - lowpass(m_told (g - a)) - zero
///     zero = mean(raw - lowpass(m_told (g - a)))         while it is tared
///
/// The robot's own motion is known, so the weight and inertia of the tool are removed except for the error of its
/// mass. One reading per tick; equal seeds give equal readings. Functions may be called in the tick.
class ForceSensor {
 public:
  /// @throws InvalidParameter as validate().
  ForceSensor(const ForceSensorParameters& parameters, const Vec3& gravity_m_s2, double tick_s);

  /// Takes a reading: soil wrench about the tool's origin, site frame. @param soil  the true one. @param tool  its
  /// present movement, site frame.
  [[nodiscard]] Wrench read(const Wrench& soil, const Movement& tool) noexcept;

  /// Forgets its zero, and takes the mean of the readings from now on for it until tared(): the tool has to hang still
  /// in the air meanwhile.
  void tare() noexcept;
  [[nodiscard]] bool tared() const noexcept { return taring_ == 0; }

 private:
  [[nodiscard]] Wrench carried(double mass_kg, const Quat& orientation, const Vec3& acceleration_m_s2) const noexcept;

  ForceSensorParameters parameters_;
  Vec3 gravity_m_s2_;
  double tick_s_;
  std::mt19937_64 random_;
  std::uint64_t readings_ = 0;
  int taring_ = 0;  ///< readings that are still to come
  Wrench smooth_, told_smooth_, zero_, sum_;
  Vec3 last_m_s_ = Vec3::Zero();
};

}  // namespace haptolith
