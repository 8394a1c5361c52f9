#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "haptolith/core/math/random.h"
#include "haptolith/identify/training/force_emulator.h"
#include "haptolith/identify/training/soil_sample.h"

namespace haptolith {

/// Soil that follows a simple law, so that training takes no time: a plate is pressed at two depths, and a blade drawn
/// at two depths and two rakes.
class MadeUpSoil {
 public:
  static constexpr std::size_t kWindows = 28;

  explicit MadeUpSoil(double scatter) : scatter_(scatter) {}

  static MeasuredStrength strengthOf(const SoilParameters& soil) {
    const double stress_pa = soil.contact_cohesion_n / (soil.radius_m * soil.radius_m);
    const double angle_deg = 20 + 45 * soil.contact_friction;
    return {{angle_deg, 0.1 * stress_pa}, {angle_deg + 4, 0.15 * stress_pa}};
  }

  [[nodiscard]] WindowForces forces(const SoilState& soil, double gravity_m_s2, std::uint64_t seed) const {
    std::mt19937_64 random(seed);
    WindowForces all;
    for (std::size_t window = 0; window < kWindows; window += 2) {
      const double chance = std::exp(scatter_ * std::numbers::sqrt3 * uniformSigned(random));
      const Vec3 force_n = chance * force(soil, gravity_m_s2, window / 4);
      all.push_back(force_n);
      all.push_back(force_n);
    }
    return all;
  }

  /// @param gravity_m_s2  of the world where it learns.
  [[nodiscard]] Training training(int soils, double gravity_m_s2 = 1.625) const {
    Training made{ToolMovement({{0, {}}, {0.25 * kWindows + 0.01, {{0.1, 0, 0}, Quat::Identity()}}}),
                  "made up",
                  gravity_m_s2,
                  {},
                  4.0 / 3};
    for (int i = 1; i <= soils; ++i) {
      TrainingRun run;
      run.number = static_cast<std::uint64_t>(i);
      run.sample = soilSample(run.number);
      run.strength = strengthOf(run.sample.soil);
      run.forces = forces(state(run), gravity_m_s2, run.number);
      made.runs.push_back(run);
    }
    return made;
  }

  static SoilState state(const TrainingRun& run) {
    const ShearStrength strength = strengthOf(run.sample.soil).residual;
    return {strength.angle_deg, strength.cohesion_pa, run.sample.tool_friction};
  }

 private:
  static Vec3 force(const SoilState& soil, double gravity_m_s2, std::size_t place) {
    const double phi = soil.friction_angle_deg * std::numbers::pi / 180;
    const double passive = std::pow(std::tan(std::numbers::pi / 4 + phi / 2), 2);
    const double weight_pa_m = 1500 * gravity_m_s2;
    if (place < 3) {  // pressed
      const double depth_m = place == 0 ? 0.006 : 0.014;
      const double n_q = passive * std::exp(std::numbers::pi * std::tan(phi));
      return {0, 0, 0.002 * (soil.cohesion_pa * (n_q - 1) / std::tan(phi) + weight_pa_m * depth_m * n_q)};
    }
    const double depth_m = place % 2 == 0 ? 0.02 : 0.035;
    const double rake = place < 5 ? std::numbers::pi / 2 : std::numbers::pi / 3;
    const double draft_n = 0.08 * depth_m *
                           (weight_pa_m * depth_m / 2 * passive + 2 * soil.cohesion_pa * std::sqrt(passive)) *
                           (place < 5 ? 1 : 0.8 + 0.1 * std::tan(phi));
    return {-draft_n, 0, draft_n / std::tan(rake + std::atan(soil.tool_friction))};
  }

  double scatter_;
};

}  // namespace haptolith
