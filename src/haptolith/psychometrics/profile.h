#pragma once

#include <vector>

#include "haptolith/psychometrics/fit.h"
#include "haptolith/psychometrics/model.h"
#include "haptolith/psychometrics/optimum.h"
#include "haptolith/psychometrics/psychometric_function.h"

namespace haptolith {

/// The ranges of quantities within which, whatever the other parameters are, the likelihood (or the posterior's
/// density) stays near its maximum: its logarithm falls by no more than `depth`.
class Profile {
 public:
  /// @param starts  where searches begin besides the best point.
  Profile(const Model& model, Objective objective, const Optimum& best, double depth,
          std::vector<ParameterPoint> starts = {});

  /// Of a parameter, to within 0.3 % of its distance from the best point; where it is fixed, its value.
  [[nodiscard]] Interval of(Parameter parameter) const;
  /// Of the JND or the Weber fraction, where threshold and width decide it together.
  [[nodiscard]] Interval of(Derived derived) const;

  /// A range that holds that of a parameter and is no more than half again as far from the best point.
  [[nodiscard]] Support around(Parameter parameter) const;

 private:
  struct Quantity;
  [[nodiscard]] double end(const Quantity& quantity, double best, double bound) const;
  [[nodiscard]] double endBeyond(const Quantity& quantity, double best, double bound) const;
  [[nodiscard]] bool isNear(const Quantity& quantity, double value, std::vector<ParameterPoint>& starts) const;

  const Model& model_;
  Objective objective_;
  Optimum best_;
  double depth_;
  std::vector<ParameterPoint> starts_;
};

/// The depth of a profile of the likelihood at the ends of a confidence interval.
///
/// It is half the quantile of chi-square with one degree of freedom. Where the overdispersion is free, that has the
/// part of a regression's variance, which is known from m levels less p other free parameters: m/2 ln(1 + t^2/(m - p)),
/// with Student's quantile t of m - p degrees of freedom, is exact for a regression with normal errors.
[[nodiscard]] double confidenceDepth(const Model& model);

}  // namespace haptolith
