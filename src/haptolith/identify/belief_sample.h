#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "haptolith/identify/training/force_emulator.h"
#include "haptolith/identify/training/soil_state.h"

namespace haptolith {

/// A number and where it lies by 90 %: quantiles of 5, 50 and 95 %.
struct SoilEstimate {
  double low = 0, middle = 0, high = 0;

  [[nodiscard]] double width() const noexcept { return high - low; }
};

/// The likelihood of what was observed, of Student's t for heavy tails,
///
///     L = (1 + d' S^-1 d / nu)^(-(nu + p) / (2 T)),    d = y - expected,    nu = 6
class SoilLikelihood {
 public:
  /// Of something; it refers to both.
  SoilLikelihood(const ForceEmulator& emulator, const ForceEmulator::Observed& observed, double temper);

  /// Logarithms of it for states, one in a row.
  [[nodiscard]] Eigen::VectorXd of(const Eigen::MatrixXd& states) const;
  /// d' S^-1 d
  [[nodiscard]] Eigen::VectorXd squares(const Eigen::MatrixXd& states) const;

  /// ln L where d' S^-1 d of `numbers` numbers is known.
  [[nodiscard]] static Eigen::VectorXd logarithms(const Eigen::VectorXd& squares, Eigen::Index numbers, double temper);

 private:
  static constexpr double kFreedom = 6;  ///< nu

  const ForceEmulator& emulator_;
  const ForceEmulator::Observed& observed_;
  double temper_;
  Eigen::LLT<Eigen::MatrixXd> root_;
};

/// States, one in a row, and how much each counts: 1 together.
struct BeliefSample {
  Eigen::MatrixXd states;
  Eigen::VectorXd weights;
};

/// What is believed when nothing was measured, and once something was: by importance sampling, 8192 states of a Halton
/// sequence over the box, then as many over the normal distribution that these have shown, until a thousand of them
/// count. The same on every run.
[[nodiscard]] BeliefSample believedBefore(const SoilPrior& prior);
[[nodiscard]] BeliefSample believed(const SoilLikelihood& likelihood, const SoilPrior& prior);

/// What is told of them, in the rows' order: friction angle in deg, cohesion in Pa, angle of tool friction in deg.
[[nodiscard]] Eigen::MatrixX3d toldOf(const Eigen::MatrixXd& states, double gravity_m_s2);

/// Of values that count so much.
[[nodiscard]] SoilEstimate estimateOf(const Eigen::VectorXd& values, const Eigen::VectorXd& weights);

}  // namespace haptolith
