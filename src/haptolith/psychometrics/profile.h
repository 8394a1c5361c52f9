#pragma once

#include <vector>

#include "haptolith/psychometrics/fit.h"
#include "haptolith/psychometrics/model.h"
#include "haptolith/psychometrics/optimum.h"
#include "haptolith/psychometrics/psychometric_function.h"

namespace haptolith {

/// Profile likelihood (or posterior density): ranges of quantities within which its logarithm, maximised over the other
/// parameters, is at most `depth` below the maximum.
class Profile {
 public:
  /// @param starts  starting points of searches, in addition to the best point.
  Profile(const Model& model, Objective objective, const Optimum& best, double depth,
          std::vector<ParameterPoint> starts = {});

  /// Returns the range of a parameter, to within 0.3 % of its distance from the best point; if it is fixed, its value.
  [[nodiscard]] Interval of(Parameter parameter) const;
  /// Returns the range of the JND or the Weber fraction, if it depends on both threshold and width.
  [[nodiscard]] Interval of(Derived derived) const;

  /// Returns a range that contains that of a parameter, at most 1.5 times as far from the best point.
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

/// Returns the depth of a profile likelihood at the ends of a confidence interval.
///
/// It is half the quantile of chi-square with one degree of freedom. A free overdispersion has the role of a
/// regression's variance, estimated from m levels minus p other free parameters. Then it is m/2 ln(1 + t^2/(m - p)),
/// with Student's quantile t of m - p degrees of freedom; this is exact for a regression with normal errors.
[[nodiscard]] double confidenceDepth(const Model& model);

}  // namespace haptolith
