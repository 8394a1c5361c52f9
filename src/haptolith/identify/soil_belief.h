#pragma once

#include <cstddef>

#include "haptolith/identify/belief_sample.h"
#include "haptolith/identify/training/force_emulator.h"

namespace haptolith {

/// Posterior belief about a soil from forces.
struct SoilBelief {
  SoilEstimate friction_angle_deg;       ///< residual phi
  SoilEstimate peak_angle_deg;           ///< peak angle of the training's kinds of soil with this residual strength
  SoilEstimate cohesion_pa;              ///< residual c
  SoilEstimate tool_friction_angle_deg;  ///< delta
  std::size_t numbers = 0;               ///< number of force components used
  double samples = 0;                    ///< effective sample size
  /// Squared distance from the emulator over its scatter, per number: 1 is normal. Above kStrange no soil of the
  /// training explains the forces.
  double misfit = 0;
};
inline constexpr double kStrange = 2.5;

/// Returns the belief from a sample of states.
[[nodiscard]] SoilBelief beliefOf(const BeliefSample& sample, const ForceEmulator& emulator, double gravity_m_s2);
/// Returns the belief from forces by Bayes' rule as in SoilIdentifier; without forces, that of the prior.
[[nodiscard]] SoilBelief beliefOf(const MeasuredForces& forces, const ForceEmulator& emulator, double temper,
                                  double gravity_m_s2, const SoilPrior& prior = {});

/// Max. width of an identified quantity's interval, over the prior width; otherwise the forces are not informative
/// about it.
inline constexpr double kIdentifiedShare = 0.7;
[[nodiscard]] bool isIdentified(const SoilEstimate& estimate, const Range& before) noexcept;

/// Identifies a soil from its forces.
///
/// Bayes' rule with a uniform prior over the box of `prior`, the likelihood of SoilLikelihood and the sampling of
/// believed(). Forces of a part of the movement suffice. T is such that 90 % intervals contain 90 % of the training's
/// soils, each left out of the emulator's training (LeaveOneOut). Deterministic. Takes about 10 ms.
class SoilIdentifier {
 public:
  /// @throws as ForceEmulator. Takes half a minute if the training does not contain T yet.
  explicit SoilIdentifier(const Training& training);

  /// @throws InvalidParameter when none of the windows was measured, when no force in them is above the noise of the
  /// training's sensor, or when forces are opposite to those of soil on this tool.
  [[nodiscard]] SoilBelief identify(const MeasuredForces& forces, double gravity_m_s2,
                                    const SoilPrior& prior = {}) const;

  [[nodiscard]] const ForceEmulator& emulator() const noexcept { return emulator_; }
  [[nodiscard]] double temper() const noexcept { return temper_; }

 private:
  ForceEmulator emulator_;
  double temper_;
};

/// Result for a soil of the training that was left out.
struct LeftOutSoil {
  SoilState truth;
  SoilBelief belief;
};

/// Leave-one-out identification of each sheared soil of a training, with emulators trained on the others.
class LeaveOneOut {
 public:
  /// @throws as ForceEmulator.
  explicit LeaveOneOut(const Training& training);

  [[nodiscard]] std::vector<LeftOutSoil> with(double temper) const;

  /// Returns the T for which 90 % of the intervals of friction angle, cohesion and tool friction together contain the
  /// true number; 1 to 32.
  [[nodiscard]] double calibratedTemper() const;

 private:
  const Training& training_;
  std::vector<std::size_t> sheared_;
  std::vector<ForceEmulator> others_;  ///< emulators, each trained without one of these
};

/// Whether the interval contains the number.
[[nodiscard]] constexpr bool holds(const SoilEstimate& estimate, double truth) noexcept {
  constexpr double kRounding = 1e-9;
  return estimate.low <= truth + kRounding && truth <= estimate.high;
}

}  // namespace haptolith
