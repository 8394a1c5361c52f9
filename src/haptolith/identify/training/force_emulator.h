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

/// Measured force in each window of a movement; empty if the tool was not in place.
using MeasuredForces = std::vector<std::optional<Vec3>>;

/// Emulator of the force of soil on a tool along one movement, as a function of the soil's state, with the scatter of
/// specimens and of kinds of soil. Fitted to a training.
///
///     y = asinh(F / g / s),    y = quadratic of the state + e,    e ~ N(0, S)
///
/// F is a component of a mean force over two windows, s its scale. Only components that are significant in most of the
/// soils are used: at least half a newton on the Moon, and an eighth of the force.
class ForceEmulator {
 public:
  /// @param left_out  index of a run that is left out. @throws InvalidParameter for fewer than 20 runs, as StrengthMap,
  /// or if the tool does not touch soil.
  explicit ForceEmulator(const Training& training, std::optional<std::size_t> left_out = {});

  /// Returns the number of force components of the entire movement.
  [[nodiscard]] std::size_t size() const noexcept { return features_.size(); }

  /// Number of windows per force component, half a second; and the first window of a component. Components are in the
  /// order of their windows.
  static constexpr std::size_t kBlock = 2;
  [[nodiscard]] std::size_t windowOf(Eigen::Index number) const {
    return features_[static_cast<std::size_t>(number)].window;
  }

  /// Measured components, with their indices.
  struct Observed {
    std::vector<Eigen::Index> which;
    Eigen::VectorXd values;
  };
  [[nodiscard]] Observed observed(const MeasuredForces& forces, double gravity_m_s2) const;

  /// Whether any of the components exceeds the noise of the training, 0.05 N under its gravity and proportional to
  /// gravity otherwise. Forces of soil are several times as large.
  [[nodiscard]] bool isAboveNoise(const MeasuredForces& forces, double gravity_m_s2) const;

  /// Returns the expected components, one row per state.
  [[nodiscard]] Eigen::MatrixXd expected(const Eigen::MatrixXd& states) const;
  [[nodiscard]] const Eigen::MatrixXd& covariance() const noexcept { return covariance_; }

  /// Returns peak angles, in deg, of undisturbed soil in these states, by the training, without scatter.
  [[nodiscard]] Eigen::VectorXd peakAngles(const Eigen::MatrixXd& states) const;

  [[nodiscard]] const StrengthMap& strengths() const noexcept { return strengths_; }

 private:
  struct Feature {
    std::size_t window;  ///< first window of two
    int axis;
    double scale;  ///< s
  };
  void chooseFeatures(const Training& training);

  StrengthMap strengths_;
  double gravity_m_s2_;  ///< gravity of the training
  std::vector<Feature> features_;
  std::optional<Ridge> fit_, peak_;
  Eigen::MatrixXd covariance_;
};

/// Returns the state of a run's soil by the map.
[[nodiscard]] SoilState stateOf(const TrainingRun& run, const StrengthMap& strengths);

/// Returns the state of a run's soil by its simulated shear test, which must exist; without cohesion if its particles
/// have none.
[[nodiscard]] SoilState measuredState(const TrainingRun& run);

/// Returns the forces of all windows of a run, from a sensor with noise of SD `noise_n` per window.
[[nodiscard]] MeasuredForces measuredForces(const TrainingRun& run, double noise_n = 0, std::uint64_t seed = 1);

}  // namespace haptolith
