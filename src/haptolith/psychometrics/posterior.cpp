#include "haptolith/psychometrics/posterior.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "haptolith/core/assert.h"
#include "haptolith/psychometrics/gauss_rule.h"
#include "haptolith/psychometrics/likelihood.h"
#include "haptolith/psychometrics/optimum.h"
#include "haptolith/psychometrics/profile.h"

namespace haptolith {

namespace {

using AxisSizes = std::array<int, kParameters>;
using AxisSupports = std::array<Support, kParameters>;

// Log density below the best point (e^-9 = 1.2e-4) at which points are left out of the last grid.
constexpr double kNegligibleMass = 9;
constexpr std::size_t kHumps = 3;  // peaks of the posterior that the search starts from
constexpr AxisSizes kCoarseGrid{17, 17, 6, 6, 5};
// Grid sizes for the likelihood's peaks, which can be between any two stimuli if the function is narrow.
constexpr AxisSizes kPosteriorPeaks{49, 12, 4, 4, 1};
constexpr double kRounding = 1e-12;  // max. relative difference of equal values
constexpr int kRounds = 3;           // rounds of coarse grids, each over the remaining range

AxisSupports wholeSupport(const Model& model) {
  AxisSupports supports;
  for (int i = 0; i < kParameters; ++i) {
    supports[i] = model.support(i);
  }
  return supports;
}

AxisSizes fineSizes(const Model& model) {
  const GridSizes& grid = model.options().grid;
  if (model.freeParameters() == 1) {
    return {grid.alone, grid.alone, grid.alone, grid.alone, grid.alone};
  }
  return {grid.threshold, grid.width, grid.asymptotes, grid.asymptotes, grid.overdispersion};
}

/// Whether a parameter's axis is logarithmic, as for the Weber fraction, which has no natural scale.
bool isLogarithmic(const Model& model, int parameter) {
  return parameter == kScale && isWeber(model.options().sigmoid);
}

double between(const GridAxis& axis, double share) {
  HAPTO_ASSERT(share >= 0 && share <= 1);
  const auto& [low, high] = axis.range;
  return axis.logarithmic ? low * std::pow(high / low, share) : low + (high - low) * share;
}

/// Returns values over the range; for rates and eta denser at the lower end, where they are most probable.
GridAxis coarseAxis(const Support& range, int size, bool logarithmic, bool dense_below) {
  GridAxis axis{.range = range, .logarithmic = logarithmic};
  if (range.isFixed()) {
    axis.values = {range.low};
    return axis;
  }
  axis.values.reserve(static_cast<std::size_t>(size));
  for (int i = 0; i < size; ++i) {
    const double share = double(i) / (size - 1);
    axis.values.push_back(between(axis, dense_below ? share * share : share));
  }
  axis.values.back() = range.high;
  return axis;
}

/// Returns a Gauss-Legendre rule over the range, or over its logarithm.
GridAxis gaussAxis(const Support& range, int size, bool logarithmic) {
  GridAxis axis{.range = range, .logarithmic = logarithmic};
  if (range.isFixed()) {
    axis.values = {range.low};
    axis.weights = {1};
    return axis;
  }
  const GaussRule& rule = gaussRule(size);
  const double half = (logarithmic ? std::log(range.high / range.low) : range.high - range.low) / 2;
  axis.values.reserve(rule.places.size());
  axis.weights.reserve(rule.places.size());
  for (std::size_t i = 0; i < rule.places.size(); ++i) {
    axis.values.push_back(between(axis, (1 + rule.places[i]) / 2));
    axis.weights.push_back(half * rule.weights[i] * (logarithmic ? axis.values.back() : 1));
  }
  return axis;
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

using PosteriorAxes = std::array<GridAxis, kParameters>;

PosteriorAxes coarseAxes(const Model& model, const AxisSupports& supports, const AxisSizes& sizes = kCoarseGrid) {
  PosteriorAxes axes;
  for (int i = 0; i < kParameters; ++i) {
    const bool dense_below = i != kThreshold && i != kScale;
    axes[i] = coarseAxis(supports[i], sizes[i], isLogarithmic(model, i), dense_below);
  }
  return axes;
}

PosteriorAxes gaussAxes(const Model& model, const AxisSupports& supports, const AxisSizes& sizes) {
  PosteriorAxes axes;
  for (int i = 0; i < kParameters; ++i) {
    axes[i] = gaussAxis(supports[i], sizes[i], isLogarithmic(model, i));
  }
  return axes;
}

/// Point of a grid.
struct DensePoint {
  ParameterPoint point = {};
  double log_density = 0;
};

/// Values of ln(likelihood times prior) on a grid.
class PosteriorGrid {
 public:
  PosteriorGrid(const Model& model, PosteriorAxes axes) : model_(model), axes_(std::move(axes)) {
    std::size_t points = 1;
    for (int i = 0; i < kParameters; ++i) {
      points *= axes_[i].values.size();
      log_priors_[i].reserve(axes_[i].values.size());
      for (const double value : axes_[i].values) {
        log_priors_[i].push_back(model.logPrior(i, value));
      }
    }
    log_density_.resize(points);
    evaluate();
  }

  /// Returns the part of the grid with all points denser than `least`, plus one cell on either side; empty if there are
  /// none.
  [[nodiscard]] std::optional<AxisSupports> narrowed(double least) const {
    Indices first{};
    Indices last{};
    bool is_any = false;
    forEachPoint([&](std::size_t at, const Indices& place) {
      if (log_density_[at] >= least) {
        for (int i = 0; i < kParameters; ++i) {
          first[i] = is_any ? std::min(first[i], place[i]) : place[i];
          last[i] = std::max(last[i], place[i]);
        }
        is_any = true;
      }
    });
    if (!is_any) {
      return std::nullopt;
    }
    AxisSupports supports;
    for (int i = 0; i < kParameters; ++i) {
      const std::vector<double>& values = axes_[i].values;
      supports[i] = {values[first[i] == 0 ? 0 : first[i] - 1], values[std::min(last[i] + 1, values.size() - 1)]};
    }
    return supports;
  }

  [[nodiscard]] const GridAxis& axis(int parameter) const noexcept { return axes_[parameter]; }

  /// Returns the densest point of each pair of threshold and width.
  [[nodiscard]] std::vector<DensePoint> densestOfPairs() const {
    const std::size_t pairs = axes_[kThreshold].values.size() * axes_[kScale].values.size();
    const std::size_t block = log_density_.size() / pairs;  // the other parameters vary faster
    std::vector<DensePoint> densest(pairs);
    forEachPoint([&](std::size_t at, const Indices& place) {
      DensePoint& of_pair = densest[at / block];
      if (at % block == 0 || log_density_[at] > of_pair.log_density) {
        of_pair.log_density = log_density_[at];
        for (int i = 0; i < kParameters; ++i) {
          of_pair.point[i] = axes_[i].values[place[i]];
        }
      }
    });
    return densest;
  }

  /// Returns the sums over the grid.
  [[nodiscard]] Posterior summed() && {
    const auto best = std::ranges::max_element(log_density_);
    const double most = *best;
    Posterior posterior{.axes = std::move(axes_)};
    for (int i = 0; i < kParameters; ++i) {
      posterior.marginals[i].assign(posterior.axes[i].values.size(), 0);
    }
    const auto best_at = static_cast<std::size_t>(best - log_density_.begin());
    double sum = 0;
    forEachPoint(posterior.axes, [&](std::size_t at, const Indices& place) {
      double& mass = log_density_[at];
      mass = std::exp(mass - most);
      for (int i = 0; i < kParameters; ++i) {
        mass *= posterior.axes[i].weights[place[i]];
      }
      sum += mass;
      for (int i = 0; i < kParameters; ++i) {
        posterior.marginals[i][place[i]] += mass;
      }
    });
    posterior.mass = std::move(log_density_);
    for (double& mass : posterior.mass) {
      mass /= sum;
    }
    for (std::vector<double>& marginal : posterior.marginals) {
      for (double& mass : marginal) {
        mass /= sum;
      }
    }
    posterior.best = pointOf(posterior, best_at);
    posterior.log_evidence = most + std::log(sum);
    return posterior;
  }

 private:
  using Indices = std::array<std::size_t, kParameters>;

  template <class Visit>
  static void forEachPoint(const PosteriorAxes& axes, const Visit& visit) {
    std::size_t points = 1;
    for (const GridAxis& axis : axes) {
      points *= axis.values.size();
    }
    Indices place{};
    for (std::size_t at = 0; at < points; ++at) {
      visit(at, place);
      for (int i = kParameters - 1; i >= 0 && ++place[i] == axes[i].values.size(); --i) {
        place[i] = 0;
      }
    }
  }

  template <class Visit>
  void forEachPoint(const Visit& visit) const {
    forEachPoint(axes_, visit);
  }

  void evaluate() {
    const std::vector<Level>& levels = model_.levels();
    const std::vector<double>& etas = axes_[kOverdispersion].values;
    std::vector<double> shape(levels.size());
    std::vector<double> psi(levels.size());
    forEachPoint([&](std::size_t at, const Indices& place) {
      const auto value = [&](int i) { return axes_[i].values[place[i]]; };
      if (place[kOverdispersion] > 0) {
        return;  // already computed with the first eta
      }
      if (place[kLapse] == 0 && place[kGuess] == 0) {
        setShape(value(kThreshold), value(kScale), shape);
      }
      const double guess = model_.guessAt({0, 0, value(kLapse), value(kGuess), 0});
      for (std::size_t i = 0; i < levels.size(); ++i) {
        psi[i] = guess + (1 - guess - value(kLapse)) * shape[i];
      }
      double prior = 0;
      for (int i = 0; i < kOverdispersion; ++i) {
        prior += log_priors_[i][place[i]];
      }
      for (std::size_t e = 0; e < etas.size(); ++e) {
        log_density_[at + e] = prior + log_priors_[kOverdispersion][e];
      }
      addLogLikelihoods(levels, psi, etas, &log_density_[at]);
    });
  }

  void setShape(double threshold, double scale, std::vector<double>& shape) const {
    const PsychometricFunction function = model_.functionAt({threshold, scale, 0, 0, 0});
    std::size_t i = 0;
    for (const Level& level : model_.levels()) {
      shape[i++] = sigmoidAt(function, level.x);
    }
  }

  const Model& model_;
  PosteriorAxes axes_;
  std::array<std::vector<double>, kParameters> log_priors_;
  std::vector<double> log_density_;
};

/// Returns the local maxima of a grid over thresholds and widths, the densest first.
std::vector<DensePoint> peaksOf(const PosteriorGrid& grid) {
  const std::vector<DensePoint> densest = grid.densestOfPairs();
  const std::ptrdiff_t widths = std::ssize(grid.axis(kScale).values);
  const std::ptrdiff_t thresholds = std::ssize(densest) / widths;
  const auto is_peak = [&](std::ptrdiff_t t, std::ptrdiff_t w) {
    for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(t - 1, 0); i <= std::min(t + 1, thresholds - 1); ++i) {
      for (std::ptrdiff_t j = std::max<std::ptrdiff_t>(w - 1, 0); j <= std::min(w + 1, widths - 1); ++j) {
        if (densest[i * widths + j].log_density > densest[t * widths + w].log_density) {
          return false;
        }
      }
    }
    return true;
  };
  std::vector<DensePoint> peaks;
  for (std::ptrdiff_t t = 0; t < thresholds; ++t) {
    for (std::ptrdiff_t w = 0; w < widths; ++w) {
      if (is_peak(t, w)) {
        peaks.push_back(densest[t * widths + w]);
      }
    }
  }
  std::ranges::stable_sort(peaks, std::ranges::greater{}, &DensePoint::log_density);
  return peaks;
}

std::vector<ParameterPoint> firstPoints(const std::vector<DensePoint>& peaks, std::size_t count) {
  std::vector<ParameterPoint> points;
  points.reserve(std::min(count, peaks.size()));
  for (const DensePoint& peak : std::span(peaks).first(std::min(count, peaks.size()))) {
    points.push_back(peak.point);
  }
  return points;
}

/// Returns a box outside of which the posterior's density is below its maximum by a factor of at least e^depth. Coarse
/// grids find all of its peaks; the profile finds a ridge between the points of a grid.
AxisSupports boxOf(const Model& model, double depth) {
  AxisSupports supports = wholeSupport(model);
  const PosteriorGrid whole(model, coarseAxes(model, supports));
  const std::vector<ParameterPoint> peaks = firstPoints(peaksOf(whole), kHumps);
  const Optimum best = optimumNear(model, peaks, {.objective = Objective::kPosterior});
  const double least = best.log_density - depth;
  std::optional<AxisSupports> box = whole.narrowed(least);
  for (int round = 1; box && round < kRounds; ++round) {
    box = PosteriorGrid(model, coarseAxes(model, *box)).narrowed(least);
  }
  const Profile profile(model, Objective::kPosterior, best, depth);
  for (int i = 0; i < kParameters; ++i) {
    const Support around = profile.around(static_cast<Parameter>(i));
    supports[i] = box ? Support{std::min(around.low, (*box)[i].low), std::max(around.high, (*box)[i].high)} : around;
  }
  return supports;
}

}  // namespace

Posterior posteriorOf(const Model& model) {
  return PosteriorGrid(model, gaussAxes(model, boxOf(model, kNegligibleMass), fineSizes(model))).summed();
}

std::vector<ParameterPoint> likelihoodPeaks(const Model& model, int count) {
  constexpr double kSomeOverdispersion = 0.1;
  Model flat = model;
  for (int i = 0; i < kParameters; ++i) {
    flat = flat.withFlatPrior(i, model.support(i));
  }
  AxisSupports supports = wholeSupport(model);
  if (!supports[kOverdispersion].isFixed()) {
    supports[kOverdispersion] = {kSomeOverdispersion, kSomeOverdispersion};
  }
  PosteriorAxes axes = coarseAxes(flat, supports, kPosteriorPeaks);
  axes[kScale] = coarseAxis(supports[kScale], kPosteriorPeaks[kScale], true, false);
  return firstPoints(peaksOf(PosteriorGrid(flat, std::move(axes))), static_cast<std::size_t>(count));
}

ParameterPoint pointOf(const Posterior& posterior, std::size_t index) {
  HAPTO_ASSERT(index < posterior.mass.size());
  ParameterPoint point;
  for (int i = kParameters - 1; i >= 0; --i) {
    const std::size_t size = posterior.axes[i].values.size();
    point[i] = posterior.axes[i].values[index % size];
    index /= size;
  }
  return point;
}

Interval credibleInterval(const Posterior& posterior, int parameter, double confidence) {
  HAPTO_ASSERT(confidence >= 0 && confidence < 1);  // 0: the median
  HAPTO_ASSERT(parameter >= 0 && parameter < kParameters);
  const GridAxis& axis = posterior.axes[parameter];
  if (axis.range.isFixed()) {
    return {axis.range.low, axis.range.high};
  }
  const GaussDistribution distribution(posterior.marginals[parameter]);
  const auto percentile = [&](double share) { return between(axis, (1 + distribution.percentile(share)) / 2); };
  return {percentile((1 - confidence) / 2), percentile((1 + confidence) / 2)};
}

Interval percentileInterval(std::vector<WeightedValue> values, double confidence) {
  HAPTO_ASSERT(confidence >= 0 && confidence < 1);  // 0: the median
  HAPTO_ASSERT(!values.empty());
  std::ranges::sort(values, {}, &WeightedValue::value);
  std::vector<WeightedValue> distinct;
  double total = 0;
  for (const WeightedValue& it : values) {
    total += it.mass;
    if (!distinct.empty() && it.value - distinct.back().value <= kRounding * std::abs(it.value)) {
      distinct.back().mass += it.mass;
    } else {
      distinct.push_back(it);
    }
  }
  const auto percentile = [&](double share) {
    double below = 0;
    double place_before = 0;
    for (std::size_t i = 0; i < distinct.size(); ++i) {
      const double place = below + distinct[i].mass / 2;
      if (place >= share * total) {
        const double step = place - place_before;
        const double back = step > 0 ? (place - share * total) / step : 0;
        return i == 0 ? distinct[i].value : distinct[i].value - back * (distinct[i].value - distinct[i - 1].value);
      }
      below += distinct[i].mass;
      place_before = place;
    }
    return distinct.back().value;
  };
  return {percentile((1 - confidence) / 2), percentile((1 + confidence) / 2)};
}

std::vector<ParameterPoint> drawsOf(const Posterior& posterior, int count) {
  HAPTO_ASSERT(count > 0);
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
