#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "haptolith/identify/movement_part.h"
#include "haptolith/identify/soil_belief.h"

namespace haptolith {

/// Actual or permitted widths of 90 % intervals.
struct SoilWidths {
  double friction_angle_deg = 0, cohesion_pa = 0, tool_friction_angle_deg = 0;
};
inline constexpr std::array kWidths{&SoilWidths::friction_angle_deg, &SoilWidths::cohesion_pa,
                                    &SoilWidths::tool_friction_angle_deg};
[[nodiscard]] SoilWidths widthsOf(const SoilBelief& belief);
/// Whether no width exceeds the wanted one.
[[nodiscard]] bool isNarrow(const SoilWidths& widths, const SoilWidths& wanted) noexcept;

/// Expected information gain of a part that has not been made yet.
struct PartGain {
  std::size_t part = 0;  ///< index of the part
  double bits = 0;       ///< information about friction angle, cohesion and tool friction together
  double bits_s = 0;     ///< information per second of its duration
  SoilWidths widths;     ///< mean expected widths afterwards
};

/// Whether a part was made: at least half of its numbers were measured.
[[nodiscard]] bool isMeasured(const MovementPart& part, const ForceEmulator& emulator, const MeasuredForces& forces);

/// Returns the expected gains of all unmeasured parts, in descending order of bits per second. The gain of a part is
/// the mutual information of the state theta and its numbers y, given the measured numbers (Lindley, Ann. Math. Stat.
/// 27, 1956):
///
///     E over theta, y of  sum over states of  w' ln(w' / w)
///
/// w are the weights of the current belief, w' those after y. 64 theta are drawn from the belief. For each, y is drawn
/// from the emulator's normal distribution, given theta and the measured numbers, because their scatter is correlated.
/// Takes a few hundredths of a second per part. Deterministic.
[[nodiscard]] std::vector<PartGain> expectedGains(const std::vector<MovementPart>& parts, const ForceEmulator& emulator,
                                                  double temper, const MeasuredForces& forces, double gravity_m_s2,
                                                  const SoilPrior& prior = {});

/// Returns the next part: the one with most bits per second of those that are expected to narrow an interval that is
/// too wide by the fraction kHelps. Empty: no interval is too wide, or no part helps.
[[nodiscard]] std::optional<PartGain> nextPart(const std::vector<PartGain>& gains, const SoilWidths& now,
                                               const SoilWidths& wanted);
inline constexpr double kHelps = 0.05;

}  // namespace haptolith
