#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "haptolith/identify/training/force_emulator.h"
#include "haptolith/identify/training/soil_state.h"

namespace haptolith {

/// Estimate with its 90 % credible interval: quantiles of 5, 50 and 95 %.
struct SoilEstimate {
  double low = 0, middle = 0, high = 0;

  [[nodiscard]] double width() const noexcept { return high - low; }
};

/// Likelihood of the observed forces, with heavy tails as in Student's t,
///
///     L = (1 + d' S^-1 d / nu)^(-(nu + p) / (2 T)),    d = y - expected,    nu = 6
class SoilLikelihood {
 public:
  /// Keeps references to `emulator` and `observed`.
  SoilLikelihood(const ForceEmulator& emulator, const ForceEmulator::Observed& observed, double temper);

  /// Returns its logarithms for states, one per row.
  [[nodiscard]] Eigen::VectorXd of(const Eigen::MatrixXd& states) const;
  /// Returns d' S^-1 d for states, one per row.
  [[nodiscard]] Eigen::VectorXd squares(const Eigen::MatrixXd& states) const;

  /// Returns ln L from d' S^-1 d of `numbers` numbers.
  [[nodiscard]] static Eigen::VectorXd logarithms(const Eigen::VectorXd& squares, Eigen::Index numbers, double temper);

 private:
  static constexpr double kFreedom = 6;  ///< nu

  const ForceEmulator& emulator_;
  const ForceEmulator::Observed& observed_;
  double temper_;
  Eigen::LLT<Eigen::MatrixXd> root_;
};

/// States, one per row, with weights of sum 1.
struct BeliefSample {
  Eigen::MatrixXd states;
  Eigen::VectorXd weights;
};

/// Returns a sample of the prior, and of the posterior. Importance sampling takes 8192 states of a Halton sequence over
/// the box, then as many from the normal distribution fitted to these, until the effective sample size is a thousand.
/// Deterministic.
[[nodiscard]] BeliefSample believedBefore(const SoilPrior& prior);
[[nodiscard]] BeliefSample believed(const SoilLikelihood& likelihood, const SoilPrior& prior);

/// Returns the reported quantities, one row per state: friction angle in deg, cohesion in Pa, angle of tool friction in
/// deg.
[[nodiscard]] Eigen::MatrixX3d toldOf(const Eigen::MatrixXd& states, double gravity_m_s2);

/// Returns the weighted quantiles of values.
[[nodiscard]] SoilEstimate estimateOf(const Eigen::VectorXd& values, const Eigen::VectorXd& weights);

}  // namespace haptolith
