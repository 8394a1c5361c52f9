#include "haptolith/psychometrics/group/hierarchy.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/stop_asked.h"
#include "haptolith/psychometrics/posterior.h"

namespace haptolith {

namespace {

using Sizes = std::array<int, kHyperParameters>;
using Supports = std::array<Support, kHyperParameters>;

constexpr Sizes kCoarse{11, 5, 11, 5, 4};
constexpr Sizes kQuick{15, 7, 15, 7, 6};
constexpr Sizes kThorough{21, 11, 21, 11, 9};
constexpr int kMostRounds = 8;    // rounds of coarse grids, each over the remaining range
constexpr double kSettled = 0.8;  // remaining fraction of every support at which the rounds end
// Log density below the best point (e^-9 = 1.2e-4) at which points are left out of the next grid.
constexpr double kNegligible = 9;
constexpr double kImpossibleGroup = 1e-300;  // lower bound, because no participant's responses alone exclude a point
constexpr int kHierarchyDraws = 400;
constexpr int kQuickPlaces = 31;  // values of a table
constexpr int kThoroughPlaces = 61;
constexpr double kNegligibleInTable = 12;
constexpr int kTableRounds = 2;    // rounds of narrowing a table
constexpr int kPerCell = 16;       // finer values per cell of a marginal
constexpr int kDifferences = 201;  // about twenty per standard deviation

double normalBelow(double z) noexcept {
  return std::erfc(-z / std::numbers::sqrt2) / 2;
}

/// Returns the integral of the normal distribution function of this mean and spread up to x.
double integralBelow(double x, double mean, double spread) noexcept {
  if (spread <= 0) {
    return std::max(x - mean, 0.0);
  }
  const double z = (x - mean) / spread;
  const double density = std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi);
  return (x - mean) * normalBelow(z) + spread * density;
}

/// Returns, for each mean and spread (rows; the spread varies faster), the weights of evenly spaced values in the
/// expectation of a function that is linear between them and constant beyond.
Eigen::MatrixXd normalWeights(const std::vector<double>& means, const std::vector<double>& spreads,
                              const std::vector<double>& values) {
  const auto count = std::ssize(values);
  Eigen::MatrixXd weights = Eigen::MatrixXd::Ones(std::ssize(means) * std::ssize(spreads), count);
  if (count == 1) {
    return weights;
  }
  const double step = values[1] - values[0];
  Eigen::VectorXd below(count);
  Eigen::Index row = 0;
  for (const double mean : means) {
    for (const double spread : spreads) {
      for (Eigen::Index i = 0; i < count; ++i) {
        below[i] = integralBelow(values[i], mean, spread) / step;
      }
      double slope_before = 0;  // slope of `below`: fraction of the population below the centre of a cell
      for (Eigen::Index i = 0; i < count; ++i) {
        const double slope = i + 1 < count ? below[i + 1] - below[i] : 1;
        weights(row, i) = slope - slope_before;
        slope_before = slope;
      }
      ++row;
    }
  }
  return weights;
}

/// Returns values of the shared parameter; dense at the lower end, where rates are most probable.
std::vector<double> sharedValues(const Support& support, int count) {
  std::vector<double> values = evenly({0, 1}, count);
  for (double& value : values) {
    value = support.low + (support.high - support.low) * (support.low > 0 ? value : value * value);
  }
  return values;
}

std::array<std::vector<double>, kHyperParameters> gridOf(const Supports& supports, const Sizes& sizes) {
  std::array<std::vector<double>, kHyperParameters> values;
  for (int i = 0; i < kHyperParameters; ++i) {
    values[i] = supports[i].isFixed() ? std::vector{supports[i].low}
                : i == kShared        ? sharedValues(supports[i], sizes[i])
                                      : evenly(supports[i], sizes[i]);
  }
  return values;
}

/// Returns the weights of the trapezoidal rule; 1 for a fixed parameter.
Eigen::ArrayXd trapezoid(const std::vector<double>& values) {
  Eigen::ArrayXd weights = Eigen::ArrayXd::Zero(std::ssize(values));
  for (Eigen::Index i = 1; i < weights.size(); ++i) {
    const double half = (values[i] - values[i - 1]) / 2;
    weights[i - 1] += half;
    weights[i] += half;
  }
  return weights.size() == 1 ? Eigen::ArrayXd::Ones(1) : weights;
}

/// Grid over means, spreads and the shared parameter.
class HyperGrid {
 public:
  HyperGrid(const std::vector<PersonTable>& people, const HierarchyPriors& priors, const Supports& supports,
            const Sizes& sizes)
      : people_(people), values_(gridOf(supports, sizes)) {
    for (int i = 0; i < kHyperParameters; ++i) {
      log_priors_[i] = Eigen::ArrayXd::Zero(std::ssize(values_[i]));
      for (Eigen::Index at = 0; at < log_priors_[i].size() && priors.log_densities[i]; ++at) {
        log_priors_[i][at] = priors.log_densities[i](values_[i][at]);
      }
    }
    setPriors();
    for (std::size_t i = 0; i < people.size(); ++i) {
      throwIfStopped();
      const Person person = personOf(i);
      for (std::size_t s = 0; s < log_density_.size(); ++s) {
        log_density_[s] += integrals(person, s).array().max(kImpossibleGroup).log();
      }
    }
  }

  /// Returns the part of the support with non-negligible density, plus one cell on either side.
  [[nodiscard]] Supports narrowed() const {
    std::array<std::pair<std::size_t, std::size_t>, kHyperParameters> kept;
    for (int i = 0; i < kHyperParameters; ++i) {
      kept[i] = {values_[i].size(), 0};
    }
    const double least = most() - kNegligible;
    forEachPoint([&](const std::array<std::size_t, kHyperParameters>& at, double log_density) {
      for (int i = 0; i < kHyperParameters && log_density > least; ++i) {
        kept[i] = {std::min(kept[i].first, at[i]), std::max(kept[i].second, at[i])};
      }
    });
    Supports supports;
    for (int i = 0; i < kHyperParameters; ++i) {
      const auto [first, last] = kept[i];
      supports[i] = {values_[i][first == 0 ? 0 : first - 1], values_[i][std::min(last + 1, values_[i].size() - 1)]};
    }
    return supports;
  }

  [[nodiscard]] HierarchyPosterior summed(Effort effort) {
    takeMasses();
    HierarchyPosterior posterior;
    std::array<Eigen::ArrayXd, kHyperParameters> sums;
    for (int i = 0; i < kHyperParameters; ++i) {
      sums[i] = Eigen::ArrayXd::Zero(std::ssize(values_[i]));
    }
    posterior.means = Eigen::ArrayXXd::Zero(sums[kFirstMean].size(), sums[kSecondMean].size());
    double cumulated = 0;
    forEachPoint([&](const std::array<std::size_t, kHyperParameters>& at, double mass) {
      cumulated += mass;
      HyperPoint point;
      for (int i = 0; i < kHyperParameters; ++i) {
        sums[i][static_cast<Eigen::Index>(at[i])] += mass;
        point[i] = values_[i][at[i]];
      }
      posterior.means(static_cast<Eigen::Index>(at[kFirstMean]), static_cast<Eigen::Index>(at[kSecondMean])) += mass;
      while (std::ssize(posterior.draws) < kHierarchyDraws &&
             (double(posterior.draws.size()) + 0.5) / kHierarchyDraws < cumulated) {
        posterior.draws.push_back(point);
      }
    });
    for (int i = 0; i < kHyperParameters; ++i) {
      const Eigen::ArrayXd log_density = (sums[i] / trapezoid(values_[i])).log();
      const Eigen::ArrayXd shifted = log_density - log_density.maxCoeff();
      posterior.marginals[i] = {values_[i], {shifted.begin(), shifted.end()}};
    }
    if (effort == Effort::kThorough) {
      sumPeople(posterior);
    }
    return posterior;
  }

 private:
  /// Likelihood of a participant, max. 1, for each value of the shared parameter, and the weights of its values.
  struct Person {
    Eigen::MatrixXd first_weights, second_weights;
    std::vector<Eigen::MatrixXd> likelihoods;
  };

  [[nodiscard]] Person personOf(std::size_t which) const {
    const PersonTable& table = people_[which];
    Person person{normalWeights(values_[kFirstMean], values_[kFirstSpread], table.first),
                  normalWeights(values_[kSecondMean], values_[kSecondSpread], table.second),
                  {}};
    double most = -std::numeric_limits<double>::infinity();
    std::vector<Eigen::ArrayXXd> logs;
    logs.reserve(values_[kShared].size());
    for (const double shared : values_[kShared]) {
      logs.push_back(table.log_likelihood(shared));
      most = std::max(most, logs.back().maxCoeff());
    }
    person.likelihoods.reserve(logs.size());
    for (const Eigen::ArrayXXd& log : logs) {
      person.likelihoods.emplace_back((log - most).exp().matrix());
    }
    return person;
  }

  /// Returns the likelihood of a participant's responses at every mean and spread.
  [[nodiscard]] static Eigen::MatrixXd integrals(const Person& person, std::size_t shared) {
    return (person.first_weights * person.likelihoods[shared]) * person.second_weights.transpose();
  }

  void setPriors() {
    const auto both = [this](int mean, int spread) {
      Eigen::ArrayXd sums(log_priors_[mean].size() * log_priors_[spread].size());
      Eigen::Index at = 0;
      for (const double of_mean : log_priors_[mean]) {
        for (const double of_spread : log_priors_[spread]) {
          sums[at++] = of_mean + of_spread;
        }
      }
      return sums;
    };
    const Eigen::ArrayXd first = both(kFirstMean, kFirstSpread);
    const Eigen::ArrayXd second = both(kSecondMean, kSecondSpread);
    for (const double of_shared : log_priors_[kShared]) {
      log_density_.emplace_back(first.replicate(1, second.size()) + second.transpose().replicate(first.size(), 1) +
                                of_shared);
    }
  }

  [[nodiscard]] double most() const {
    double most = -std::numeric_limits<double>::infinity();
    for (const Eigen::ArrayXXd& density : log_density_) {
      most = std::max(most, density.maxCoeff());
    }
    return most;
  }

  /// Converts log densities to masses with sum 1.
  void takeMasses() {
    std::array<Eigen::ArrayXd, kHyperParameters> weights;
    for (int i = 0; i < kHyperParameters; ++i) {
      weights[i] = trapezoid(values_[i]);
    }
    const double largest = most();
    double total = 0;
    for (std::size_t s = 0; s < log_density_.size(); ++s) {
      log_density_[s] = (log_density_[s] - largest).exp() * weights[kShared][static_cast<Eigen::Index>(s)];
    }
    forEachPoint([&](const std::array<std::size_t, kHyperParameters>& at, double& mass) {
      for (const int i : {kFirstMean, kFirstSpread, kSecondMean, kSecondSpread}) {
        mass *= weights[i][static_cast<Eigen::Index>(at[i])];
      }
      total += mass;
    });
    for (Eigen::ArrayXXd& mass : log_density_) {
      mass /= total;
    }
  }

  void sumPeople(HierarchyPosterior& posterior) const {
    for (std::size_t i = 0; i < people_.size(); ++i) {
      const Person person = personOf(i);
      const auto rows = std::ssize(people_[i].first);
      const auto columns = std::ssize(people_[i].second);
      Eigen::ArrayXXd mass = Eigen::ArrayXXd::Zero(rows, columns);
      Eigen::ArrayXd first = Eigen::ArrayXd::Zero(rows);
      Eigen::ArrayXd second = Eigen::ArrayXd::Zero(columns);
      for (std::size_t s = 0; s < log_density_.size(); ++s) {
        const Eigen::MatrixXd& likelihood = person.likelihoods[s];
        const Eigen::MatrixXd density = log_density_[s] / integrals(person, s).array().max(kImpossibleGroup);
        mass += likelihood.array() * (person.first_weights.transpose() * density * person.second_weights).array();
        first +=
            (likelihood * (person.second_weights.transpose() * log_density_[s].matrix().colwise().sum().transpose()))
                .array();
        second +=
            (likelihood.transpose() * (person.first_weights.transpose() * log_density_[s].matrix().rowwise().sum()))
                .array();
      }
      posterior.people.emplace_back(mass / mass.sum());
      posterior.first_alone.push_back(std::move(first));
      posterior.second_alone.push_back(std::move(second));
    }
  }

  template <class Self, class Visit>
  static void visitPoints(Self& self, const Visit& visit) {
    const std::size_t first_spreads = self.values_[kFirstSpread].size();
    const std::size_t second_spreads = self.values_[kSecondSpread].size();
    for (std::size_t s = 0; s < self.log_density_.size(); ++s) {
      auto& density = self.log_density_[s];
      for (Eigen::Index column = 0; column < density.cols(); ++column) {
        for (Eigen::Index row = 0; row < density.rows(); ++row) {
          const auto first = static_cast<std::size_t>(row);
          const auto second = static_cast<std::size_t>(column);
          visit({first / first_spreads, first % first_spreads, second / second_spreads, second % second_spreads, s},
                density(row, column));
        }
      }
    }
  }

  template <class Visit>
  void forEachPoint(const Visit& visit) const {
    visitPoints(*this, visit);
  }

  template <class Visit>
  void forEachPoint(const Visit& visit) {
    visitPoints(*this, visit);
  }

  const std::vector<PersonTable>& people_;
  std::array<std::vector<double>, kHyperParameters> values_;
  std::array<Eigen::ArrayXd, kHyperParameters> log_priors_;
  std::vector<Eigen::ArrayXXd> log_density_;  // per shared value; masses after takeMasses()
};

/// Returns the second difference of a marginal's logarithm at its i-th value; empty at an end and next to an impossible
/// value.
std::optional<double> bendAt(const std::vector<double>& log, std::ptrdiff_t i) {
  if (i < 1 || i + 1 >= std::ssize(log)) {
    return std::nullopt;
  }
  const double bend = log[i - 1] - 2 * log[i] + log[i + 1];
  return std::isfinite(bend) ? std::optional(bend) : std::nullopt;
}

/// Returns the second differences at both ends of the cell above the i-th value. A missing one equals the other, so the
/// parabola continues. Each is at most a few times the other: otherwise a cliff next to the cell would cause a peak in
/// it, because the overshoot of the Catmull-Rom cubic is proportional to the cliff.
std::array<double, 2> bendsOf(const std::vector<double>& log, std::ptrdiff_t i) {
  constexpr double kStronger = 4;
  const std::optional<double> below = bendAt(log, i);
  const std::optional<double> above = bendAt(log, i + 1);
  const double first = below.value_or(above.value_or(0));
  const double second = above.value_or(first);
  const double most = kStronger * std::min(std::abs(first), std::abs(second));
  return {std::clamp(first, -most, most), std::clamp(second, -most, most)};
}

/// Returns the density between two values, at a fraction of their distance. Its logarithm is the Catmull-Rom cubic,
/// which blends the parabolas through three values each; next to an impossible value the density is linear.
double densityBetween(double log_low, double log_high, const std::array<double, 2>& bends, double fraction) {
  if (!std::isfinite(log_low) || !std::isfinite(log_high)) {
    return std::lerp(std::exp(log_low), std::exp(log_high), fraction);
  }
  const double bend = std::lerp(bends[0], bends[1], fraction);
  return std::exp(std::lerp(log_low, log_high, fraction) - fraction * (1 - fraction) / 2 * bend);
}

/// Resamples the marginal at more values, as masses. Values need not be evenly spaced; a place between two is a
/// fraction of their distance.
std::vector<WeightedValue> finer(const Marginal& marginal) {
  const std::vector<double>& values = marginal.values;
  const std::vector<double>& log = marginal.log_density;
  if (values.size() == 1) {
    return {{values.front(), 1}};
  }
  std::vector<WeightedValue> result;
  result.reserve((values.size() - 1) * kPerCell);
  for (std::ptrdiff_t i = 0; i + 1 < std::ssize(values); ++i) {
    const std::array<double, 2> bends = bendsOf(log, i);
    const double cell = (values[i + 1] - values[i]) / kPerCell;
    for (int j = 0; j < kPerCell; ++j) {
      const double fraction = (j + 0.5) / kPerCell;
      result.push_back(
          {std::lerp(values[i], values[i + 1], fraction), densityBetween(log[i], log[i + 1], bends, fraction) * cell});
    }
  }
  return result;
}

std::vector<double> valuesOf(const Support& support, Effort effort) {
  return support.isFixed() ? std::vector{support.low}
                           : evenly(support, effort == Effort::kThorough ? kThoroughPlaces : kQuickPlaces);
}

/// Returns the range of a table's kept values, plus one cell on either side.
Support narrowed(const std::vector<double>& values, const std::vector<bool>& kept) {
  const auto first = std::ranges::find(kept, true) - kept.begin();
  const auto last = std::ssize(kept) - 1 - (std::find(kept.rbegin(), kept.rend(), true) - kept.rbegin());
  return {values[std::max<std::ptrdiff_t>(first - 1, 0)],
          values[std::min<std::ptrdiff_t>(last + 1, std::ssize(values) - 1)]};
}

}  // namespace

PersonTable closedTable(Support first, Support second, const std::vector<double>& shared, Effort effort,
                        const TableMaker& make) {
  PersonTable table;
  for (int round = 0;; ++round) {
    table.first = valuesOf(first, effort);
    table.second = valuesOf(second, effort);
    table.log_likelihood = make(table.first, table.second);
    if (round == kTableRounds) {
      return table;
    }
    std::vector<bool> rows(table.first.size()), columns(table.second.size());
    for (const double value : shared) {
      const Eigen::ArrayXXd log = table.log_likelihood(value);
      const double least = log.maxCoeff() - kNegligibleInTable;
      for (Eigen::Index row = 0; row < log.rows(); ++row) {
        rows[row] = rows[row] || (log.row(row) >= least).any();
      }
      for (Eigen::Index column = 0; column < log.cols(); ++column) {
        columns[column] = columns[column] || (log.col(column) >= least).any();
      }
    }
    first = narrowed(table.first, rows);
    second = narrowed(table.second, columns);
  }
}

std::vector<double> evenly(const Support& support, int count) {
  std::vector<double> values(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    values[i] = std::lerp(support.low, support.high, double(i) / (count - 1));
  }
  return values;
}

double SpreadPrior::logDensity(double spread) const noexcept {
  const double spreads = spread / usual;
  return std::log(std::sqrt(2 / std::numbers::pi) / usual) - spreads * spreads / 2;
}

double SpreadPrior::bayesFactorOfNone(const Marginal& posterior) const {
  return densityAt(posterior, 0) / std::exp(logDensity(0));
}

HierarchyPosterior hierarchyOf(const std::vector<PersonTable>& people, const HierarchyPriors& priors, Effort effort) {
  Supports supports = priors.supports;
  for (int round = 0; round < kMostRounds; ++round) {
    const Supports before = std::exchange(supports, HyperGrid(people, priors, supports, kCoarse).narrowed());
    if (std::ranges::equal(before, supports, [](const Support& wide, const Support& left) {
          return left.high - left.low >= kSettled * (wide.high - wide.low);
        })) {
      break;
    }
  }
  return HyperGrid(people, priors, supports, effort == Effort::kThorough ? kThorough : kQuick).summed(effort);
}

Estimate estimateOf(const Marginal& marginal, double confidence) {
  const std::vector<WeightedValue> values = finer(marginal);
  return {percentileInterval(values, 0).low, percentileInterval(values, confidence)};
}

double densityAt(const Marginal& marginal, double value) {
  const std::vector<WeightedValue> values = finer(marginal);
  if (values.size() < 2 || value < marginal.values.front() || value > marginal.values.back()) {
    return 0;
  }
  double total = 0;
  for (const WeightedValue& it : values) {
    total += it.mass;
  }
  const auto above = std::ranges::lower_bound(values, value, {}, &WeightedValue::value);
  const auto at = std::min(above - values.begin(), std::ssize(values) - 1);
  const auto cell = static_cast<std::size_t>(at / kPerCell);
  return values[at].mass / total * kPerCell / (marginal.values[cell + 1] - marginal.values[cell]);
}

Marginal differenceOf(const Marginal& first, const Marginal& second) {
  const std::vector<WeightedValue> from = finer(first);
  const std::vector<WeightedValue> to = finer(second);
  const Support support{second.values.front() - first.values.back(), second.values.back() - first.values.front()};
  const double step = (support.high - support.low) / (kDifferences - 1);
  Eigen::ArrayXd mass = Eigen::ArrayXd::Zero(kDifferences);
  for (const WeightedValue& a : from) {
    for (const WeightedValue& b : to) {  // divided between the two neighbouring values
      const double at = std::clamp((b.value - a.value - support.low) / step, 0.0, kDifferences - 1.0);
      const auto below = std::min(static_cast<Eigen::Index>(at), Eigen::Index{kDifferences - 2});
      const double share = at - static_cast<double>(below);
      mass[below] += (1 - share) * a.mass * b.mass;
      mass[below + 1] += share * a.mass * b.mass;
    }
  }
  const Eigen::ArrayXd log = (mass / mass.maxCoeff()).log();
  return {evenly(support, kDifferences), {log.begin(), log.end()}};
}

}  // namespace haptolith
