#pragma once

#include <array>
#include <span>
#include <vector>

#include "haptolith/psychometrics/fit.h"
#include "haptolith/psychometrics/levels.h"
#include "haptolith/psychometrics/psychometric_function.h"

namespace haptolith {

/// Parameters of a fit, in the order of their grid.
enum Parameter { kThreshold, kScale, kLapse, kGuess, kOverdispersion };
inline constexpr int kParameters = 5;

/// Values of all parameters. kThreshold is its place on the axis (x or ln x); kScale is the width, or for weber
/// sigmoids the Weber fraction x84/x50 - 1.
using ParameterPoint = std::array<double, kParameters>;

/// Range of a parameter. It is fixed if both ends are equal.
struct Support {
  double low = 0;
  double high = 0;

  [[nodiscard]] bool isFixed() const noexcept { return low == high; }
};

/// Model of one fit: data, free parameters and priors.
///
/// Priors, with R the range of the levels on the axis and d the least distance between two of them (psignifit's,
/// Schuett et al. 2016; docs/reference/psychometrics.md):
/// - threshold: flat over the range, falling to 0 as a cosine over R/2 on either side;
/// - width: flat from 2 d to R, rising as a cosine from d and falling to 3 R;
/// - Weber fraction v of weber sigmoids: 1/v^2, which is flat in the sensitivity 1/v; for widths from d/4 to 3 R;
/// - lapse and guess rate: Beta(1, 10) up to 1/2, for weber sigmoids Beta(1, 60); eta: Beta(1, 10).
class Model {
 public:
  /// @throws InvalidParameter for invalid options or levels, alone or in combination.
  Model(std::span<const Level> levels, const FitOptions& options);

  [[nodiscard]] const std::vector<Level>& levels() const noexcept { return levels_; }
  [[nodiscard]] const Support& support(int parameter) const noexcept { return supports_[parameter]; }
  [[nodiscard]] const FitOptions& options() const noexcept { return options_; }
  [[nodiscard]] bool isLogarithmic() const noexcept { return log_axis_; }
  [[nodiscard]] int freeParameters() const noexcept;

  /// Returns the width on the axis for a value of kScale.
  [[nodiscard]] double widthOf(double scale) const noexcept;
  /// Inverts widthOf().
  [[nodiscard]] double scaleOf(double width) const noexcept;
  /// Returns the guess rate at a point: its value, the lapse rate or 1/n, by design.
  [[nodiscard]] double guessAt(const ParameterPoint& point) const noexcept;
  [[nodiscard]] PsychometricFunction functionAt(const ParameterPoint& point) const noexcept;

  /// Returns the logarithm of the parameter's prior density; 0 if it is fixed, minus infinity outside its support.
  [[nodiscard]] double logPrior(int parameter, double value) const noexcept;
  [[nodiscard]] double logPrior(const ParameterPoint& point) const noexcept;
  [[nodiscard]] double logLikelihood(const ParameterPoint& point) const noexcept;

  /// Returns a model with a flat prior (logarithm 0) of one parameter over `support`.
  [[nodiscard]] Model withFlatPrior(int parameter, const Support& support) const;
  /// Returns a model with other responses to the same stimuli and unchanged priors.
  [[nodiscard]] Model withAnswers(std::vector<Level> levels) const;

 private:
  void setAxis();
  void setSupports();
  void normaliseWidthPrior();
  [[nodiscard]] double widthPriorShape(double width) const noexcept;

  std::vector<Level> levels_;
  FitOptions options_;
  bool log_axis_ = false;
  double first_ = 0, last_ = 0;  // range of the levels on the axis
  double least_distance_ = 0;    // min. distance on the axis
  double width_prior_integral_ = 1;
  std::array<Support, kParameters> supports_;
  std::array<bool, kParameters> flat_ = {};  // parameters without a prior
};

}  // namespace haptolith
