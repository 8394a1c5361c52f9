#include "haptolith/psychometrics/group.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "haptolith/core/error.h"
#include "haptolith/psychometrics/model.h"
#include "haptolith/psychometrics/posterior.h"

namespace haptolith {

namespace {

constexpr int kPlaces = 301;  // of a participant's parameter
constexpr int kMeans = 121;   // of the population
constexpr int kSpreads = 61;  // between people
// Half-normal priors of the spread between people keep a few answers from leaving it open: of ln(Weber fraction) or
// ln(width) a factor of e^0.5 = 1.6 between people is usual; of thresholds a quarter of the stimuli's range.
constexpr double kUsualLogSpread = 0.5;
constexpr double kUsualThresholdSpread = 1.0 / 8;  // of the support, which is twice that range
constexpr double kMostSpread = 0.5;                // of the parameter's whole range

/// Evenly spaced places, and each participant's likelihood at them.
struct Likelihoods {
  std::vector<double> places;
  std::vector<std::vector<double>> of_participants;  // largest 1
};

double normalBelow(double z) noexcept {
  return std::erfc(-z / std::numbers::sqrt2) / 2;
}

/// The share of a normal distribution in the cell about each place; those at the ends reach on.
std::vector<double> normalShares(const std::vector<double>& places, double mean, double spread) {
  std::vector<double> shares;
  double below = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const bool last = i + 1 == places.size();
    const double edge = last ? 0 : (places[i] + places[i + 1]) / 2;
    const double up_to = last ? 1 : normalBelow((edge - mean) / spread);
    shares.push_back(up_to - below);
    below = up_to;
  }
  return shares;
}

std::vector<double> evenPlaces(double low, double high, int count) {
  std::vector<double> places(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    places[i] = low + (high - low) * i / (count - 1);
  }
  return places;
}

/// Sums over means and spreads of the population.
class Hierarchy {
 public:
  Hierarchy(const Likelihoods& likelihoods, double usual_spread) : likelihoods_(likelihoods) {
    const double low = likelihoods.places.front();
    const double high = likelihoods.places.back();
    const std::vector<double> means = evenPlaces(low, high, kMeans);
    const double most_spread = std::min(kMostSpread * (high - low), 4 * usual_spread);
    for (int i = 0; i < kSpreads; ++i) {
      // The middles of cells: a spread of nothing is no place of the grid.
      const double spread = most_spread * (i + 0.5) / kSpreads;
      for (const double mean : means) {
        points_.push_back({mean, spread, normalShares(likelihoods.places, mean, spread)});
      }
    }
    weigh(usual_spread);
  }

  [[nodiscard]] std::vector<WeightedValue> means() const { return values(&Point::mean); }
  [[nodiscard]] std::vector<WeightedValue> spreads() const { return values(&Point::spread); }

  /// A participant's parameter: their likelihood times what the group says, over all means and spreads.
  [[nodiscard]] std::vector<WeightedValue> participant(std::size_t which) const {
    const std::vector<double>& likelihood = likelihoods_.of_participants[which];
    std::vector<WeightedValue> result;
    for (const double place : likelihoods_.places) {
      result.push_back({place, 0});
    }
    for (const Point& point : points_) {
      const double scale = point.mass / integral(likelihood, point.shares);
      for (std::size_t i = 0; i < result.size(); ++i) {
        result[i].mass += scale * likelihood[i] * point.shares[i];
      }
    }
    return result;
  }

 private:
  struct Point {
    double mean, spread;
    std::vector<double> shares;
    double mass = 0;
  };

  static double integral(const std::vector<double>& likelihood, const std::vector<double>& shares) {
    double sum = 1e-300;  // nobody is impossible
    for (std::size_t i = 0; i < likelihood.size(); ++i) {
      sum += likelihood[i] * shares[i];
    }
    return sum;
  }

  void weigh(double usual_spread) {
    std::vector<double> logs;
    for (const Point& point : points_) {
      const double spreads = point.spread / usual_spread;
      double sum = -spreads * spreads / 2;
      for (const std::vector<double>& likelihood : likelihoods_.of_participants) {
        sum += std::log(integral(likelihood, point.shares));
      }
      logs.push_back(sum);
    }
    const double most = *std::ranges::max_element(logs);
    double total = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      points_[i].mass = std::exp(logs[i] - most);
      total += points_[i].mass;
    }
    for (Point& point : points_) {
      point.mass /= total;
    }
  }

  [[nodiscard]] std::vector<WeightedValue> values(double Point::*field) const {
    std::vector<WeightedValue> result;
    for (const Point& point : points_) {
      result.push_back({point.*field, point.mass});
    }
    return result;
  }

  const Likelihoods& likelihoods_;
  std::vector<Point> points_;
};

template <class ToUnit>
Estimate estimateOf(const std::vector<WeightedValue>& values, double confidence, const ToUnit& to_unit) {
  const Interval interval = percentileInterval(values, confidence);
  return {to_unit(percentileInterval(values, 0).low), {to_unit(interval.low), to_unit(interval.high)}};
}

/// The population of one parameter. `to_place` is where the normal distribution lives, `to_value` its inverse.
template <class ToPlace, class ToValue>
Population populationOf(const std::vector<Model>& models, Parameter parameter, double confidence,
                        const ToPlace& to_place, const ToValue& to_value) {
  double low = to_place(models.front().support(parameter).low);
  double high = to_place(models.front().support(parameter).high);
  for (const Model& model : models) {
    low = std::min(low, to_place(model.support(parameter).low));
    high = std::max(high, to_place(model.support(parameter).high));
  }
  Likelihoods likelihoods{.places = evenPlaces(low, high, kPlaces), .of_participants = {}};
  std::vector<double> values;
  for (const double place : likelihoods.places) {
    values.push_back(to_value(place));
  }
  for (const Model& model : models) {
    likelihoods.of_participants.push_back(marginalLikelihood(model, parameter, values));
  }
  const Hierarchy hierarchy(likelihoods, parameter == kScale ? kUsualLogSpread : kUsualThresholdSpread * (high - low));
  Population population;
  population.median = estimateOf(hierarchy.means(), confidence, to_value);
  population.spread = estimateOf(hierarchy.spreads(), confidence, [](double spread) { return spread; });
  for (std::size_t i = 0; i < models.size(); ++i) {
    population.participants.push_back(estimateOf(hierarchy.participant(i), confidence, to_value));
  }
  return population;
}

}  // namespace

GroupFit fitGroup(std::span<const std::vector<Level>> participants, const FitOptions& options) {
  if (participants.empty()) {
    throw InvalidParameter("participants", "none", "one or more");
  }
  GroupFit group;
  group.pooled = fitPsychometric(pooled(participants), options);
  std::vector<Model> models;
  for (const std::vector<Level>& levels : participants) {
    group.participants.push_back(fitPsychometric(levels, options));
    models.emplace_back(levels, options);
  }
  const auto logarithm = [](double value) { return std::log(value); };
  const auto exponential = [](double place) { return std::exp(place); };
  group.scale = populationOf(models, kScale, options.confidence, logarithm, exponential);
  if (!options.threshold) {
    const auto same = [](double place) { return place; };
    const PsychometricFunction& axis = group.pooled.function;
    group.threshold = populationOf(models, kThreshold, options.confidence, same, same);
    const auto in_unit = [&axis](Estimate& estimate) {
      estimate = {fromAxis(axis, estimate.value),
                  {fromAxis(axis, estimate.interval.low), fromAxis(axis, estimate.interval.high)}};
    };
    in_unit(group.threshold->median);
    std::ranges::for_each(group.threshold->participants, in_unit);
  }
  return group;
}

}  // namespace haptolith
