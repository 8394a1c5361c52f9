#include "haptolith/psychometrics/optimum.h"

#include <nlopt.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace haptolith {

namespace {

constexpr int kMostEvaluations = 4000;
constexpr double kFirstStep = 0.02;    // fraction of a parameter's support
constexpr double kImpossible = 1e300;  // replaces infinity, because NLopt requires finite numbers

/// Free parameters, each scaled to 0...1 over its support; kScale by its logarithm.
class FreeParameters {
 public:
  FreeParameters(const Model& model, const ParameterPoint& start, const std::optional<Pin>& pin)
      : model_(model), point_(start), pin_(pin) {
    for (int i = 0; i < kParameters; ++i) {
      if (!model.support(i).isFixed() && !(pin && pin->parameter == i)) {
        free_.push_back(i);
      }
    }
  }

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
      const double value = i == kScale ? low * std::pow(high / low, shares[j]) : low + (high - low) * shares[j];
      point[i] = std::clamp(value, low, high);
    }
    if (pin_) {
      point[pin_->parameter] = pin_->value(point);
    }
    return point;
  }

 private:
  const Model& model_;
  ParameterPoint point_;
  const std::optional<Pin>& pin_;
  std::vector<int> free_;
};

struct Task {
  const Model* model;
  const FreeParameters* parameters;
  Objective objective;
};

bool isInSupport(const Model& model, const ParameterPoint& point) noexcept {
  for (int i = 0; i < kParameters; ++i) {
    const auto& [low, high] = model.support(i);
    if (!(low <= point[i] && point[i] <= high)) {
      return false;
    }
  }
  return true;
}

double logDensity(const Model& model, const ParameterPoint& point, Objective objective) noexcept {
  if (!isInSupport(model, point)) {
    return -std::numeric_limits<double>::infinity();
  }
  return model.logLikelihood(point) + (objective == Objective::kPosterior ? model.logPrior(point) : 0);
}

double shortfall(const std::vector<double>& shares, std::vector<double>& /*gradient*/, void* data) {
  const Task& task = *static_cast<const Task*>(data);
  const double value = -logDensity(*task.model, task.parameters->point(shares), task.objective);
  return std::isfinite(value) ? value : kImpossible;
}

ParameterPoint optimumFrom(const Model& model, const ParameterPoint& start, const Search& wanted) {
  const FreeParameters parameters(model, start, wanted.pin);
  std::vector<double> shares = parameters.shares();
  if (shares.empty()) {
    return parameters.point(shares);
  }
  Task task{&model, &parameters, wanted.objective};
  nlopt::opt search(nlopt::LN_SBPLX, static_cast<unsigned>(shares.size()));
  search.set_min_objective(shortfall, &task);
  search.set_lower_bounds(0);
  search.set_upper_bounds(1);
  search.set_initial_step(kFirstStep);
  search.set_xtol_abs(wanted.tolerance);
  search.set_maxeval(kMostEvaluations);
  double least = 0;
  try {
    search.optimize(shares, least);
  } catch (const nlopt::roundoff_limited&) {  // limit of numerical precision; `shares` is the best point
  }
  return parameters.point(shares);
}

}  // namespace

Optimum optimumNear(const Model& model, std::span<const ParameterPoint> starts, const Search& search) {
  std::optional<Optimum> best;
  for (const ParameterPoint& start : starts) {
    const ParameterPoint found = optimumFrom(model, start, search);
    const double log_density = logDensity(model, found, search.objective);
    if (!best || log_density > best->log_density) {
      best = {found, log_density};
    }
  }
  return best.value_or(Optimum{});
}

}  // namespace haptolith
