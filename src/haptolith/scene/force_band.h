#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "haptolith/soil/soil_parameters.h"

namespace haptolith {

/// Range of the magnitude of a force, in N.
struct ForceRange {
  double low_n = 0, high_n = 0;
};

/// Soil force on a tool, averaged over some ticks.
struct MeanForce {
  double force_n = 0;   ///< mean magnitude
  double contacts = 0;  ///< trace of the contact stiffness over k_tool, as Scene::contactStiffness(): number of
                        ///< particles that resist
};

/// Force f of one particle, its weight and cohesion: f = m g + F_c, in N. May be called in the tick.
[[nodiscard]] double particleForce(const SoilParameters& soil, double gravity_m_s2) noexcept;

/// Range of the mean force of another specimen of the soil with particles half as large, for the same movement over
/// 0.25 s, with a probability of 90 %. With particleForce() f, N = F / f and the contacts c:
///
///     F (B + S / (1 + N / (P c))) + A f +- g sqrt((M^2 + K^2 / (c + 1)) F^2 + (L f)^2).
///
/// S: coarse particles meet a flat tool later, where each contact carries little. g = (k / (E R))^(2/3), at least 1:
/// stiff contacts, known for k / R of 0.43 (E) and 3.4 MPa. The numbers were fitted to random beds and movements
/// (docs/reports/trust.md). It does not include the difference between simulated and real soil.
/// Empty for soil with ICRA 2021 friction. May be called in the tick.
[[nodiscard]] std::optional<ForceRange> forceRange(const MeanForce& mean, const SoilParameters& soil,
                                                   double gravity_m_s2) noexcept;

/// Mean over the last 0.25 s. Functions may be called in the tick.
class RecentForce {
 public:
  static constexpr double kWindow_s = 0.25;

  /// @param tick_s  length of a tick.
  explicit RecentForce(double tick_s) noexcept;

  /// Adds the values of a tick.
  void add(const MeanForce& tick) noexcept;
  /// Forgets all ticks.
  void restart() noexcept { ticks_ = 0; }
  /// Empty before a whole window.
  [[nodiscard]] std::optional<MeanForce> mean() const noexcept;

 private:
  static constexpr std::size_t kParts = 25;

  std::size_t ticks_per_part_;
  std::array<MeanForce, kParts> sums_{};  ///< sums over parts of the window, round and round
  std::size_t ticks_ = 0;
};

}  // namespace haptolith
