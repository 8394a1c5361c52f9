#include "haptolith/psychometrics/optimum.h"

#include <nlopt.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace haptolith {

namespace {

constexpr double kTolerance = 1e-7;  // of a parameter's support
constexpr int kMostEvaluations = 4000;
constexpr double kFirstStep = 0.02;    // of a parameter's support
constexpr double kImpossible = 1e300;  // for what minus infinity would be: NLopt wants numbers

/// The free parameters, each scaled to 0...1 over its support; the scale by its logarithm.
class FreeParameters {
 public:
  explicit FreeParameters(const Model& model, const ParameterPoint& start) : model_(model), point_(start) {
    for (int i = 0; i < kParameters; ++i) {
      if (!model.support(i).isFixed()) {
        free_.push_back(i);
      }
    }
  }

  [[nodiscard]] unsigned count() const noexcept { return static_cast<unsigned>(free_.size()); }

  [[nodiscard]] std::vector<double> shares() const {
    std::vector<double> shares;
    for (const int i : free_) {
      const auto& [low, high] = model_.support(i);
      const double share =
          i == kScale ? std::log(point_[i] / low) / std::log(high / low) : (point_[i] - low) / (high - low);
      shares.push_back(std::clamp(share, 0.0, 1.0));
    }
    return shares;
  }

  [[nodiscard]] ParameterPoint point(const std::vector<double>& shares) const {
    ParameterPoint point = point_;
    for (std::size_t j = 0; j < free_.size(); ++j) {
      const int i = free_[j];
      const auto& [low, high] = model_.support(i);
      point[i] = i == kScale ? low * std::pow(high / low, shares[j]) : low + (high - low) * shares[j];
    }
    return point;
  }

 private:
  const Model& model_;
  ParameterPoint point_;
  std::vector<int> free_;
};

struct Task {
  const Model* model;
  const FreeParameters* parameters;
  Objective objective;
};

double shortfall(const std::vector<double>& shares, std::vector<double>& /*gradient*/, void* data) {
  const Task& task = *static_cast<const Task*>(data);
  const ParameterPoint point = task.parameters->point(shares);
  double value = -task.model->logLikelihood(point);
  if (task.objective == Objective::kPosterior) {
    value -= task.model->logPrior(point);
  }
  return std::isfinite(value) ? value : kImpossible;
}

}  // namespace

ParameterPoint optimumNear(const Model& model, const ParameterPoint& start, Objective objective) {
  const FreeParameters parameters(model, start);
  if (parameters.count() == 0) {
    return start;
  }
  Task task{&model, &parameters, objective};
  nlopt::opt search(nlopt::LN_SBPLX, parameters.count());
  search.set_min_objective(shortfall, &task);
  search.set_lower_bounds(0);
  search.set_upper_bounds(1);
  search.set_initial_step(kFirstStep);
  search.set_xtol_abs(kTolerance);
  search.set_maxeval(kMostEvaluations);
  std::vector<double> shares = parameters.shares();
  double least = 0;
  try {
    search.optimize(shares, least);
  } catch (const nlopt::roundoff_limited&) {  // as near as numbers allow; `shares` holds the best
  }
  return parameters.point(shares);
}

}  // namespace haptolith
