#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "haptolith/identify/movement_part.h"
#include "haptolith/identify/soil_belief.h"

namespace haptolith {

/// How wide 90 % intervals are, or may be.
struct SoilWidths {
  double friction_angle_deg = 0, cohesion_pa = 0, tool_friction_angle_deg = 0;
};
inline constexpr std::array kWidths{&SoilWidths::friction_angle_deg, &SoilWidths::cohesion_pa,
                                    &SoilWidths::tool_friction_angle_deg};
[[nodiscard]] SoilWidths widthsOf(const SoilBelief& belief);
/// Whether none is wider than it may be.
[[nodiscard]] bool isNarrow(const SoilWidths& widths, const SoilWidths& wanted) noexcept;

/// What a part of a movement that has not been made yet is expected to tell.
struct PartGain {
  std::size_t part = 0;  ///< of those that were given
  double bits = 0;       ///< of information about friction angle, cohesion and tool friction together
  double bits_s = 0;     ///< for each second that it takes
  SoilWidths widths;     ///< the mean of what is expected afterwards
};

/// Whether a part was made: at least half of the numbers that it tells were measured.
[[nodiscard]] bool isMeasured(const MovementPart& part, const ForceEmulator& emulator, const MeasuredForces& forces);

/// Expected gains of all parts that are not measured, that of the most bits a second first. A part's gain is the mutual
/// information of the state theta and of its numbers y, given what was measured (Lindley, Ann. Math. Stat. 27, 1956):
///
///     E over theta, y of  sum over states of  w' ln(w' / w)
///
/// w are the weights of the present belief, w' those that it has after y. 64 theta are drawn from the belief, and y for
/// each from the emulator's normal distribution, given theta and the numbers that were measured, for these scatter
/// together. Takes some hundredths of a second for each part. The same on every run.
[[nodiscard]] std::vector<PartGain> expectedGains(const std::vector<MovementPart>& parts, const ForceEmulator& emulator,
                                                  double temper, const MeasuredForces& forces, double gravity_m_s2,
                                                  const SoilPrior& prior = {});

/// The part to be made next: of those that are expected to make an interval that is too wide narrower by kHelps of
/// itself, the one that tells the most a second. None: nothing is too wide, or nothing would help.
[[nodiscard]] std::optional<PartGain> nextPart(const std::vector<PartGain>& gains, const SoilWidths& now,
                                               const SoilWidths& wanted);
inline constexpr double kHelps = 0.05;

}  // namespace haptolith
