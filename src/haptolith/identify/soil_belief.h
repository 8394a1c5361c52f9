#pragma once

#include <cstddef>

#include "haptolith/identify/belief_sample.h"
#include "haptolith/identify/training/force_emulator.h"

namespace haptolith {

/// What forces tell of a soil.
struct SoilBelief {
  SoilEstimate friction_angle_deg;  ///< phi, residual
  SoilEstimate peak_angle_deg;      ///< of undisturbed soil of the training's kinds that has this residual strength
  SoilEstimate cohesion_pa;         ///< c, residual
  SoilEstimate tool_friction_angle_deg;  ///< delta
  std::size_t numbers = 0;               ///< of forces that were used
  double samples = 0;                    ///< how many of the samples count
  /// How much further from the emulator than its scatter, per number: 1 is usual. More than kStrange: no soil of the
  /// training does this to the tool.
  double misfit = 0;
};
inline constexpr double kStrange = 2.5;

/// What a sample of states says.
[[nodiscard]] SoilBelief beliefOf(const BeliefSample& sample, const ForceEmulator& emulator, double gravity_m_s2);
/// What these forces tell, by Bayes' rule as SoilIdentifier says it; where there are none, what is believed before.
[[nodiscard]] SoilBelief beliefOf(const MeasuredForces& forces, const ForceEmulator& emulator, double temper,
                                  double gravity_m_s2, const SoilPrior& prior = {});

/// An estimate counts as one when its interval is at most so much of the one before anything was measured; otherwise
/// forces have told nothing of it.
inline constexpr double kIdentifiedShare = 0.7;
[[nodiscard]] bool isIdentified(const SoilEstimate& estimate, const Range& before) noexcept;

/// What soil it is, of which these forces are known.
///
/// Bayes' rule over the box of `prior`, evenly, with the likelihood of SoilLikelihood, by the sampling of believed().
/// Forces of a part of the movement will do. T makes 90 % intervals hold 90 % of the training's own soils,
/// each left out of what the emulator learned (calibrate()). The same numbers on every run. Takes some ten
/// milliseconds.
class SoilIdentifier {
 public:
  /// @throws as ForceEmulator. Takes half a minute where the training does not know its T yet.
  explicit SoilIdentifier(const Training& training);

  /// @throws InvalidParameter when none of the windows was measured, when no force in them is above the noise of the
  /// training's sensor, or when forces point the other way than soil pushes this tool.
  [[nodiscard]] SoilBelief identify(const MeasuredForces& forces, double gravity_m_s2,
                                    const SoilPrior& prior = {}) const;

  [[nodiscard]] const ForceEmulator& emulator() const noexcept { return emulator_; }
  [[nodiscard]] double temper() const noexcept { return temper_; }

 private:
  ForceEmulator emulator_;
  double temper_;
};

/// How well a soil of the training is told that was left out of it.
struct LeftOutSoil {
  SoilState truth;
  SoilBelief belief;
};

/// What each soil of a training that was sheared is told to be by what the others have taught.
class LeaveOneOut {
 public:
  /// @throws as ForceEmulator.
  explicit LeaveOneOut(const Training& training);

  [[nodiscard]] std::vector<LeftOutSoil> with(double temper) const;

  /// The T for which 90 % of the intervals hold, of friction angle, cohesion and tool friction together; 1 to 32.
  [[nodiscard]] double calibratedTemper() const;

 private:
  const Training& training_;
  std::vector<std::size_t> sheared_;
  std::vector<ForceEmulator> others_;  ///< without each of these
};

/// Whether the interval holds the number.
[[nodiscard]] constexpr bool holds(const SoilEstimate& estimate, double truth) noexcept {
  constexpr double kRounding = 1e-9;
  return estimate.low <= truth + kRounding && truth <= estimate.high;
}

}  // namespace haptolith
