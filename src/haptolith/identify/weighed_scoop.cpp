#include "haptolith/identify/weighed_scoop.h"

#include <boost/math/distributions/students_t.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "haptolith/core/statistics.h"

namespace haptolith {

namespace {

constexpr int kBatches = 10;
constexpr double kLeastTime_s = 0.5, kStill_m = 1e-3, kStill_rad = std::numbers::pi / 180;
constexpr std::ptrdiff_t kLeastWeighings = 100;

struct HeldForce {
  Uncertain force_n;
  double middle_s = 0;
};

HeldForce heldForce(std::span<const MeasuredSample> samples, const char* key, const Range& time_s) {
  const auto from = std::ranges::lower_bound(samples, time_s.lowest, {}, &MeasuredSample::time_s);
  const auto to = std::ranges::upper_bound(samples, time_s.highest, {}, &MeasuredSample::time_s);
  const std::string when = fmt::format("{:g},{:g}", time_s.lowest, time_s.highest);
  constexpr double kEnd_s = 0.1;
  if (!samples.empty() &&
      (time_s.lowest < samples.front().time_s - kEnd_s || time_s.highest > samples.back().time_s + kEnd_s)) {
    throw InvalidParameter(
        key, when,
        fmt::format("within the measured time: {:g} to {:g} s", samples.front().time_s, samples.back().time_s));
  }
  if (time_s.highest - time_s.lowest < kLeastTime_s || to - from < kLeastWeighings) {
    throw InvalidParameter(key, when, fmt::format("at least half a second with {} measured forces", kLeastWeighings));
  }
  const std::span<const MeasuredSample> held(from, to);
  if (std::ranges::any_of(held, [&](const MeasuredSample& sample) {
        return (sample.pose.position_m - held.front().pose.position_m).norm() > kStill_m ||
               sample.pose.orientation.angularDistance(held.front().pose.orientation) > kStill_rad;
      })) {
    throw InvalidParameter(key, when, "a time in which the tool is held still, within 1 mm and 1 degree");
  }
  std::array<double, kBatches> means_n{};
  for (std::size_t batch = 0; batch < kBatches; ++batch) {
    const std::size_t begin = batch * held.size() / kBatches, end = (batch + 1) * held.size() / kBatches;
    for (const MeasuredSample& sample : held.subspan(begin, end - begin)) {
      means_n[batch] += sample.force_n.z() / static_cast<double>(end - begin);
    }
  }
  return {{mean(means_n), standardDeviation(means_n) / std::sqrt(kBatches)}, (time_s.lowest + time_s.highest) / 2};
}

/// Returns the 95 % quantile of Student's t.
double quantile95(double freedom) {
  return boost::math::quantile(boost::math::students_t(freedom), 0.95);
}

void requireApart(const Range& full_s, const char* key, const Range& empty_s) {
  if (full_s.lowest <= empty_s.highest && empty_s.lowest <= full_s.highest) {
    throw InvalidParameter(key, fmt::format("{:g},{:g}", empty_s.lowest, empty_s.highest),
                           fmt::format("at another time than --full-s, {:g},{:g}", full_s.lowest, full_s.highest));
  }
}

}  // namespace

ScoopMass weighScoop(std::span<const MeasuredSample> samples, const ScoopWeighing& weighing, double gravity_m_s2) {
  requireApart(weighing.full_s, "--empty-s", weighing.empty_s);
  if (weighing.empty_again_s) {
    requireApart(weighing.full_s, "--empty-again-s", *weighing.empty_again_s);
  }
  const HeldForce empty = heldForce(samples, "--empty-s", weighing.empty_s);
  const HeldForce full = heldForce(samples, "--full-s", weighing.full_s);
  double zero_n = empty.force_n.value, drift_n = weighing.drift_n_s * std::abs(full.middle_s - empty.middle_s);
  // Sum of squared errors, and of their squares over the degrees of freedom (Welch and Satterthwaite).
  double variance = std::pow(full.force_n.error, 2), fourth = std::pow(full.force_n.error, 4) / (kBatches - 1);
  const auto add = [&](double error_n) {
    variance += std::pow(error_n, 2);
    fourth += std::pow(error_n, 4) / (kBatches - 1);
  };
  if (weighing.empty_again_s) {
    const HeldForce again = heldForce(samples, "--empty-again-s", *weighing.empty_again_s);
    const double share = (full.middle_s - empty.middle_s) / (again.middle_s - empty.middle_s);
    requireInRange("--empty-again-s: full-s as a share of the time between both", share, {0, 1});
    zero_n += share * (again.force_n.value - empty.force_n.value);
    add(share * again.force_n.error);
    add((1 - share) * empty.force_n.error);
    drift_n *= std::sqrt(1 - share);  // reduction for a random walk with a fixed end point
  } else {
    add(empty.force_n.error);
  }
  const double freedom = fourth > 0 ? variance * variance / fourth : kBatches - 1;
  return {{(zero_n - full.force_n.value) / gravity_m_s2, std::hypot(std::sqrt(variance), drift_n) / gravity_m_s2},
          freedom};
}

SoilEstimate massOf(const ScoopMass& scoop) {
  const double half_kg = quantile95(scoop.freedom) * scoop.mass_kg.error;
  return {scoop.mass_kg.value - half_kg, scoop.mass_kg.value, scoop.mass_kg.value + half_kg};
}

void requireMeasurable(const ScoopMass& scoop) {
  const auto [low_kg, middle_kg, high_kg] = massOf(scoop);
  if (high_kg <= 0) {
    throw Failure(fmt::format("the full scoop is lighter than the empty scoop, by {:.3g} g: are the times swapped?",
                              -1e3 * middle_kg));
  }
  if (low_kg <= 0) {
    throw Failure(
        fmt::format("the mass is not measurable: {:.3g} to {:.3g} g (90 %) includes 0; hold the scoop still for "
                    "longer, or lift more soil",
                    1e3 * low_kg, 1e3 * high_kg));
  }
}

SoilEstimate densityOf(const ScoopMass& scoop, const Uncertain& volume_m3) {
  requireInRange("volume_m3", volume_m3.value, kScoopVolume_m3);
  requireMeasurable(scoop);
  requireInRange("volume_m3: its error over itself", volume_m3.error / volume_m3.value, {0, 0.5});
  const double t = quantile95(scoop.freedom);
  const auto& [m, m_error] = scoop.mass_kg;
  const auto& [v, v_error] = volume_m3;
  // (m - rho V)^2 = t^2 (s_m^2 + rho^2 s_V^2)
  const double a = v * v - t * t * v_error * v_error, b = m * v, c = m * m - t * t * m_error * m_error;
  const double root = std::sqrt(std::max(0.0, b * b - a * c));
  return {(b - root) / a, m / v, (b + root) / a};
}

}  // namespace haptolith
