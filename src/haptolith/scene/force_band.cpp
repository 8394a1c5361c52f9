#include "haptolith/scene/force_band.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace haptolith {

namespace {

/// Factor g of the scatter in soil with stiffer contacts than lunar soil has. Fewer particles carry the force there, so
/// it depends more on where each of them lies.
double scatterOfStiffness(const SoilParameters& soil) noexcept {
  constexpr double kLunar_pa = 3000 / 7e-3;  // E
  return std::max(1.0, std::pow(soil.stiffness_n_m / (kLunar_pa * soil.radius_m), 2.0 / 3));
}

}  // namespace

double particleForce(const SoilParameters& soil, double gravity_m_s2) noexcept {
  const double mass_kg = 4.0 / 3 * std::numbers::pi * std::pow(soil.radius_m, 3) * soil.rho0_kg_m3;
  return mass_kg * gravity_m_s2 + soil.contact_cohesion_n;
}

std::optional<ForceRange> forceRange(const MeanForce& mean, const SoilParameters& soil, double gravity_m_s2) noexcept {
  if (soil.friction != FrictionModel::kContact) {
    return std::nullopt;
  }
  constexpr double kFactor = 0.769;      // B
  constexpr double kShallow = 1.408;     // S
  constexpr double kPerContact = 2.124;  // P
  constexpr double kParticles = 1.151;   // A
  constexpr double kRelative = 0.254;    // M
  constexpr double kContact = 0.476;     // K
  constexpr double kLeast = 5.46;        // L
  const double particle_n = particleForce(soil, gravity_m_s2);
  const double scaled_n = kPerContact * mean.contacts * particle_n;
  const double shallow = mean.force_n > 0 ? kShallow * scaled_n / (scaled_n + mean.force_n) : 0;
  const double middle_n = mean.force_n * (kFactor + shallow) + kParticles * particle_n;
  const double relative_squared = kRelative * kRelative + kContact * kContact / (mean.contacts + 1);
  const double half_n = scatterOfStiffness(soil) *
                        std::sqrt(relative_squared * mean.force_n * mean.force_n + std::pow(kLeast * particle_n, 2));
  return ForceRange{std::max(0.0, middle_n - half_n), middle_n + half_n};
}

RecentForce::RecentForce(double tick_s) noexcept
    : ticks_per_part_(static_cast<std::size_t>(std::max(1L, std::lround(kWindow_s / kParts / tick_s)))) {}

void RecentForce::add(const MeanForce& tick) noexcept {
  MeanForce& sum = sums_[ticks_ / ticks_per_part_ % kParts];
  if (ticks_ % ticks_per_part_ == 0) {
    sum = {};
  }
  sum.force_n += tick.force_n;
  sum.contacts += tick.contacts;
  ++ticks_;
}

std::optional<MeanForce> RecentForce::mean() const noexcept {
  if (ticks_ < kParts * ticks_per_part_) {
    return std::nullopt;
  }
  // The part that is being filled replaces the whole of it.
  const std::size_t begun = ticks_ % ticks_per_part_;
  const auto ticks = static_cast<double>((begun == 0 ? kParts : kParts - 1) * ticks_per_part_ + begun);
  MeanForce mean;
  for (const MeanForce& sum : sums_) {
    mean.force_n += sum.force_n / ticks;
    mean.contacts += sum.contacts / ticks;
  }
  return mean;
}

}  // namespace haptolith
