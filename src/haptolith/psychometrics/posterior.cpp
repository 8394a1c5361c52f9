#include "haptolith/psychometrics/posterior.h"

#include <algorithm>
#include <cmath>

#include "haptolith/psychometrics/likelihood.h"

namespace haptolith {

namespace {

using Sizes = std::array<int, kParameters>;
using Supports = std::array<Support, kParameters>;

// What is less dense than the best point by more than this (e^-9 = 1.2e-4) is left out of the last grid.
constexpr double kNegligible = 9;
constexpr Sizes kCoarse{17, 17, 6, 6, 5};
constexpr Sizes kNuisance{41, 41, 9, 9, 7};  // where other parameters are summed over their whole support
constexpr int kRounds = 3;                   // of coarse grids, each over what the one before has left

Supports wholeSupport(const Model& model) {
  Supports supports;
  for (int i = 0; i < kParameters; ++i) {
    supports[i] = model.support(i);
  }
  return supports;
}

Sizes fineSizes(const Model& model) {
  const GridSizes& grid = model.options().grid;
  if (model.freeParameters() == 1) {
    return {grid.alone, grid.alone, grid.alone, grid.alone, grid.alone};
  }
  return {grid.threshold, grid.width, grid.asymptotes, grid.asymptotes, grid.overdispersion};
}

/// How the values of a grid lie.
enum class Spacing {
  kEven,
  kLogarithmic,  ///< of the Weber fraction, which has no scale of its own
  kQuadratic     ///< dense at the lower end, where rates and eta are most probable
};

Spacing spacingOf(const Model& model, int parameter) {
  if (parameter == kScale) {
    return isWeber(model.options().sigmoid) ? Spacing::kLogarithmic : Spacing::kEven;
  }
  return parameter == kThreshold ? Spacing::kEven : Spacing::kQuadratic;
}

std::vector<double> gridOf(const Support& support, int size, Spacing spacing) {
  if (support.isFixed()) {
    return {support.low};
  }
  std::vector<double> values(static_cast<std::size_t>(size));
  for (int i = 0; i < size; ++i) {
    const double share = double(i) / (size - 1);
    const double place = spacing == Spacing::kQuadratic ? share * share : share;
    values[i] = spacing == Spacing::kLogarithmic ? support.low * std::pow(support.high / support.low, place)
                                                 : support.low + (support.high - support.low) * place;
  }
  values.back() = support.high;
  return values;
}

/// What each value of a grid stands for in the trapezoidal rule; 1 of a fixed parameter.
std::vector<double> trapezoidWeights(const std::vector<double>& values) {
  if (values.size() == 1) {
    return {1};
  }
  std::vector<double> weights(values.size());
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double half = (values[i] - values[i - 1]) / 2;
    weights[i - 1] += half;
    weights[i] += half;
  }
  return weights;
}

/// Adds the log-likelihood of the levels at each eta to `sums`.
void addLogLikelihoods(const std::vector<Level>& levels, const std::vector<double>& psi,
                       const std::vector<double>& etas, double* sums) {
  for (std::size_t e = 0; e < etas.size(); ++e) {
    double sum = 0;
    for (std::size_t i = 0; i < levels.size(); ++i) {
      sum += logLikelihood(levels[i].k, levels[i].n, psi[i], etas[e]);
    }
    sums[e] += sum;
  }
}

class GridSum {
 public:
  GridSum(const Model& model, const Supports& supports, const Sizes& sizes) : model_(model) {
    std::size_t points = 1;
    for (int i = 0; i < kParameters; ++i) {
      posterior_.values[i] = gridOf(supports[i], sizes[i], spacingOf(model, i));
      points *= posterior_.values[i].size();
      for (const double value : posterior_.values[i]) {
        log_priors_[i].push_back(model.logPrior(i, value));
      }
    }
    log_density_.resize(points);
  }

  /// Takes these values of one parameter instead of the grid's, without a prior.
  void prescribe(int parameter, const std::vector<double>& values) {
    posterior_.values[parameter] = values;
    log_priors_[parameter].assign(values.size(), 0);
    std::size_t points = 1;
    for (const std::vector<double>& of_one : posterior_.values) {
      points *= of_one.size();
    }
    log_density_.assign(points, 0);
  }

  /// Fills in ln(likelihood times prior) at every point.
  void evaluate() {
    const auto& [thresholds, scales, lapses, guesses, etas] = posterior_.values;
    const std::vector<Level>& levels = model_.levels();
    std::vector<double> shape(levels.size());
    std::vector<double> psi(levels.size());
    std::size_t at = 0;
    for (std::size_t t = 0; t < thresholds.size(); ++t) {
      for (std::size_t s = 0; s < scales.size(); ++s) {
        setShape(thresholds[t], scales[s], shape);
        for (std::size_t l = 0; l < lapses.size(); ++l) {
          for (std::size_t g = 0; g < guesses.size(); ++g) {
            const double guess = model_.guessAt({0, 0, lapses[l], guesses[g], 0});
            for (std::size_t i = 0; i < levels.size(); ++i) {
              psi[i] = guess + (1 - guess - lapses[l]) * shape[i];
            }
            const double prior =
                log_priors_[kThreshold][t] + log_priors_[kScale][s] + log_priors_[kLapse][l] + log_priors_[kGuess][g];
            for (std::size_t e = 0; e < etas.size(); ++e) {
              log_density_[at + e] = prior + log_priors_[kOverdispersion][e];
            }
            addLogLikelihoods(levels, psi, etas, &log_density_[at]);
            at += etas.size();
          }
        }
      }
    }
  }

  /// The part of the support that holds all that is not negligible, by a cell more on either side.
  [[nodiscard]] Supports narrowed() const {
    const double most = *std::ranges::max_element(log_density_);
    Supports supports;
    for (int i = 0; i < kParameters; ++i) {
      const std::vector<double>& values = posterior_.values[i];
      std::size_t first = values.size();
      std::size_t last = 0;
      for (std::size_t at = 0; at < log_density_.size(); ++at) {
        if (log_density_[at] > most - kNegligible) {
          const std::size_t place = indexOf(at, i);
          first = std::min(first, place);
          last = std::max(last, place);
        }
      }
      supports[i] = {values[first == 0 ? 0 : first - 1], values[std::min(last + 1, values.size() - 1)]};
    }
    return supports;
  }

  /// The sums over the grid.
  [[nodiscard]] Posterior summed() && {
    std::array<std::vector<double>, kParameters> weights;
    for (int i = 0; i < kParameters; ++i) {
      weights[i] = trapezoidWeights(posterior_.values[i]);
      posterior_.marginals[i].assign(posterior_.values[i].size(), 0);
    }
    const auto best = std::ranges::max_element(log_density_);
    const double most = *best;
    double sum = 0;
    std::size_t at = 0;
    for (double& density : log_density_) {
      density = std::exp(density - most);
      for (int i = 0; i < kParameters; ++i) {
        density *= weights[i][indexOf(at, i)];
      }
      sum += density;
      ++at;
    }
    const auto best_at = static_cast<std::size_t>(best - log_density_.begin());
    posterior_.mass = std::move(log_density_);
    for (std::size_t point = 0; point < posterior_.mass.size(); ++point) {
      posterior_.mass[point] /= sum;
      for (int i = 0; i < kParameters; ++i) {
        const std::size_t place = indexOf(point, i);
        posterior_.marginals[i][place] += posterior_.mass[point] / weights[i][place];
      }
    }
    posterior_.best = pointOf(posterior_, best_at);
    posterior_.log_evidence = most + std::log(sum);
    return std::move(posterior_);
  }

 private:
  void setShape(double threshold, double scale, std::vector<double>& shape) const {
    const PsychometricFunction function = model_.functionAt({threshold, scale, 0, 0, 0});
    std::size_t i = 0;
    for (const Level& level : model_.levels()) {
      shape[i++] = sigmoidAt(function, level.x);
    }
  }

  [[nodiscard]] std::size_t indexOf(std::size_t point, int parameter) const noexcept {
    for (int i = kParameters - 1; i > parameter; --i) {
      point /= posterior_.values[i].size();
    }
    return point % posterior_.values[parameter].size();
  }

  const Model& model_;
  Posterior posterior_;
  std::array<std::vector<double>, kParameters> log_priors_;
  std::vector<double> log_density_;
};

}  // namespace

Posterior posteriorOf(const Model& model) {
  Supports supports = wholeSupport(model);
  for (int round = 0; round < kRounds; ++round) {
    GridSum coarse(model, supports, kCoarse);
    coarse.evaluate();
    supports = coarse.narrowed();
  }
  GridSum fine(model, supports, fineSizes(model));
  fine.evaluate();
  return std::move(fine).summed();
}

std::vector<double> marginalLikelihood(const Model& model, int parameter, const std::vector<double>& values) {
  GridSum grid(model, wholeSupport(model), kNuisance);
  grid.prescribe(parameter, values);
  grid.evaluate();
  Posterior posterior = std::move(grid).summed();
  std::vector<double> likelihood = std::move(posterior.marginals[parameter]);
  const double most = *std::ranges::max_element(likelihood);
  for (double& value : likelihood) {
    value /= most;
  }
  return likelihood;
}

ParameterPoint pointOf(const Posterior& posterior, std::size_t index) {
  ParameterPoint point;
  for (int i = kParameters - 1; i >= 0; --i) {
    const std::size_t size = posterior.values[i].size();
    point[i] = posterior.values[i][index % size];
    index /= size;
  }
  return point;
}

Interval credibleInterval(const Posterior& posterior, int parameter, double confidence) {
  const std::vector<double>& values = posterior.values[parameter];
  if (values.size() == 1) {
    return {values.front(), values.front()};
  }
  // The distribution function between the points of the grid is taken as straight.
  const std::vector<double>& density = posterior.marginals[parameter];
  std::vector<double> cumulated{0};
  for (std::size_t i = 1; i < values.size(); ++i) {
    cumulated.push_back(cumulated.back() + (density[i - 1] + density[i]) / 2 * (values[i] - values[i - 1]));
  }
  const auto percentile = [&](double share) {
    const double wanted = share * cumulated.back();
    const auto above = std::ranges::lower_bound(cumulated, wanted);
    const auto i = std::clamp<std::ptrdiff_t>(above - cumulated.begin(), 1, std::ssize(values) - 1);
    const double step = cumulated[i] - cumulated[i - 1];
    return values[i - 1] + (values[i] - values[i - 1]) * (step > 0 ? (wanted - cumulated[i - 1]) / step : 0);
  };
  return {percentile((1 - confidence) / 2), percentile((1 + confidence) / 2)};
}

Interval percentileInterval(std::vector<WeightedValue> values, double confidence) {
  std::ranges::sort(values, {}, &WeightedValue::value);
  double total = 0;
  for (const WeightedValue& it : values) {
    total += it.mass;
  }
  // Half of a value's mass lies below it.
  const auto percentile = [&](double share) {
    double below = 0;
    double place_before = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double place = below + values[i].mass / 2;
      if (place >= share * total) {
        const double step = place - place_before;
        const double back = step > 0 ? (place - share * total) / step : 0;
        return i == 0 ? values[i].value : values[i].value - back * (values[i].value - values[i - 1].value);
      }
      below += values[i].mass;
      place_before = place;
    }
    return values.back().value;
  };
  return {percentile((1 - confidence) / 2), percentile((1 + confidence) / 2)};
}

std::vector<ParameterPoint> drawsOf(const Posterior& posterior, int count) {
  std::vector<ParameterPoint> draws;
  double cumulated = 0;
  for (std::size_t i = 0; i < posterior.mass.size(); ++i) {
    cumulated += posterior.mass[i];
    while (std::ssize(draws) < count && (double(draws.size()) + 0.5) / count < cumulated) {
      draws.push_back(pointOf(posterior, i));
    }
  }
  return draws;
}

}  // namespace haptolith
