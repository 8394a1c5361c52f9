#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "haptolith/identify/training/ridge.h"
#include "haptolith/identify/training/soil_state.h"
#include "haptolith/identify/training/strength_map.h"
#include "haptolith/identify/training/training.h"

namespace haptolith {

/// What was measured in each window of a movement; none where the tool was not where it should have been.
using MeasuredForces = std::vector<std::optional<Vec3>>;

/// What soil does to a tool along one movement, as a function of the soil's state, with the scatter of specimens and of
/// kinds of soil: learned from a training.
///
///     y = asinh(F / g / s),    y = quadratic of the state + e,    e ~ N(0, S)
///
/// F is the component of a mean force over two windows, s a scale of it. Only what the soil does to the tool in most
/// of the soils counts: components of half a newton on the Moon, and an eighth of the force, and more.
class ForceEmulator {
 public:
  /// @param left_out  a run that is not learned from. @throws InvalidParameter when there are fewer than 20 runs, or
  /// where StrengthMap would, or the tool touches soil nowhere.
  explicit ForceEmulator(const Training& training, std::optional<std::size_t> left_out = {});

  /// How many numbers there are for the forces of a whole movement.
  [[nodiscard]] std::size_t size() const noexcept { return features_.size(); }

  /// Windows that make up one number: half a second. And the first of a number's; numbers are in the order of these.
  static constexpr std::size_t kBlock = 2;
  [[nodiscard]] std::size_t windowOf(Eigen::Index number) const {
    return features_[static_cast<std::size_t>(number)].window;
  }

  /// Those of them that were measured, and which they are.
  struct Observed {
    std::vector<Eigen::Index> which;
    Eigen::VectorXd values;
  };
  [[nodiscard]] Observed observed(const MeasuredForces& forces, double gravity_m_s2) const;

  /// Whether any force of those that count is more than the noise that the training is given, 0.05 N under its gravity
  /// and in proportion to another. Forces of soil are several times as large.
  [[nodiscard]] bool isAboveNoise(const MeasuredForces& forces, double gravity_m_s2) const;

  /// What they are expected to be, a row for each of the states.
  [[nodiscard]] Eigen::MatrixXd expected(const Eigen::MatrixXd& states) const;
  [[nodiscard]] const Eigen::MatrixXd& covariance() const noexcept { return covariance_; }

  /// Peak angles, in deg, of undisturbed soil in these states: those of the training's, without their scatter.
  [[nodiscard]] Eigen::VectorXd peakAngles(const Eigen::MatrixXd& states) const;

  [[nodiscard]] const StrengthMap& strengths() const noexcept { return strengths_; }

 private:
  struct Feature {
    std::size_t window;  ///< the first of two
    int axis;
    double scale;  ///< s
  };
  void chooseFeatures(const Training& training);

  StrengthMap strengths_;
  double gravity_m_s2_;  ///< of the training
  std::vector<Feature> features_;
  std::optional<Ridge> fit_, peak_;
  Eigen::MatrixXd covariance_;
};

/// The state of a run's soil, by the map.
[[nodiscard]] SoilState stateOf(const TrainingRun& run, const StrengthMap& strengths);

/// The same as its own shear test has measured it: without cohesion where its grains have none. The run was sheared.
[[nodiscard]] SoilState measuredState(const TrainingRun& run);

/// A run's forces, all of them measured, by a sensor whose noise is `noise_n` in each window.
[[nodiscard]] MeasuredForces measuredForces(const TrainingRun& run, double noise_n = 0, std::uint64_t seed = 1);

}  // namespace haptolith
