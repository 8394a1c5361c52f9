#include "haptolith/identify/next_measurement.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "haptolith/core/math/random.h"

namespace haptolith {

namespace {

constexpr int kDraws = 64;

/// Sorted values, for repeated quantiles.
class Ordered {
 public:
  explicit Ordered(const Eigen::VectorXd& values) : values_(values), order_(static_cast<std::size_t>(values.size())) {
    std::iota(order_.begin(), order_.end(), 0);
    std::ranges::sort(order_, {}, [&](Eigen::Index i) { return values_[i]; });
  }
  /// Returns the width of the 90 % interval with these weights.
  [[nodiscard]] double width(const Eigen::VectorXd& weights) const { return at(0.95, weights) - at(0.05, weights); }

 private:
  [[nodiscard]] double at(double share, const Eigen::VectorXd& weights) const {
    double sum = 0;
    for (const Eigen::Index i : order_) {
      sum += weights[i];
      if (sum >= share) {
        return values_[i];
      }
    }
    return values_[order_.back()];
  }

  Eigen::VectorXd values_;
  std::vector<Eigen::Index> order_;
};

/// Current belief: states, their reported quantities, and the measured numbers.
struct Present {
  const ForceEmulator& emulator;
  double temper;
  const ForceEmulator::Observed& observed;
  BeliefSample sample;
  Eigen::MatrixXd expected;  ///< expected numbers, one row per state
  std::array<Ordered, 3> told;
};

/// Draws states in the order of the sample, in proportion to their weights.
std::vector<Eigen::Index> drawnFrom(const Eigen::VectorXd& weights) {
  std::vector<Eigen::Index> drawn;
  double sum = 0;
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    sum += weights[i];
    while (static_cast<int>(drawn.size()) < kDraws && (static_cast<double>(drawn.size()) + 0.5) / kDraws < sum) {
      drawn.push_back(i);
    }
  }
  return drawn;
}

PartGain gainOf(const MovementPart& part, const Present& present) {
  const std::vector<Eigen::Index> own = numbersOf(part, present.emulator);
  std::vector<Eigen::Index> which, places;  // indices of the measured numbers, and their positions in present.observed
  for (std::size_t i = 0; i < present.observed.which.size(); ++i) {
    if (std::ranges::find(own, present.observed.which[i]) == own.end()) {
      which.push_back(present.observed.which[i]);
      places.push_back(static_cast<Eigen::Index>(i));
    }
  }
  const auto before = static_cast<Eigen::Index>(which.size());
  which.insert(which.end(), own.begin(), own.end());
  const auto numbers = static_cast<Eigen::Index>(which.size());

  // Whitening makes later numbers independent of the measured ones: L^-1 (expected - measured).
  const Eigen::LLT<Eigen::MatrixXd> root(present.emulator.covariance()(which, which));
  Eigen::MatrixXd apart = present.expected(Eigen::all, which).transpose();
  apart.topRows(before).colwise() -= present.observed.values(places);
  root.matrixL().solveInPlace(apart);
  const Eigen::VectorXd known = apart.topRows(before).colwise().squaredNorm().transpose();
  const Eigen::MatrixXd expected = apart.bottomRows(numbers - before);
  const Eigen::VectorXd likelihood = SoilLikelihood::logarithms(known, before, present.temper);

  PartGain gain;
  std::mt19937_64 random(part.first_window + 1);
  for (const Eigen::Index state : drawnFrom(present.sample.weights)) {
    Eigen::VectorXd measured = expected.col(state);
    for (double& number : measured) {
      number += nearlyNormal(random);
    }
    const Eigen::VectorXd squares = known + (expected.colwise() - measured).colwise().squaredNorm().transpose();
    Eigen::ArrayXd change = SoilLikelihood::logarithms(squares, numbers, present.temper) - likelihood;
    change -= change.maxCoeff();
    Eigen::VectorXd weights = present.sample.weights.array() * change.exp();
    const double sum = weights.sum();
    weights /= sum;
    gain.bits += (weights.array() * (change - std::log(sum))).sum() / std::numbers::ln2 / kDraws;
    for (std::size_t i = 0; i < kWidths.size(); ++i) {
      gain.widths.*kWidths[i] += present.told[i].width(weights) / kDraws;
    }
  }
  gain.bits_s = gain.bits / part.movement.duration();
  return gain;
}

}  // namespace

std::optional<PartGain> nextPart(const std::vector<PartGain>& gains, const SoilWidths& now, const SoilWidths& wanted) {
  const auto helps = [&](const PartGain& gain) {
    return std::ranges::any_of(kWidths, [&](double SoilWidths::*width) {
      return now.*width > wanted.*width && gain.widths.*width <= (1 - kHelps) * (now.*width);
    });
  };
  const auto found = std::ranges::find_if(gains, helps);
  return found == gains.end() ? std::nullopt : std::optional(*found);
}

SoilWidths widthsOf(const SoilBelief& belief) {
  return {belief.friction_angle_deg.width(), belief.cohesion_pa.width(), belief.tool_friction_angle_deg.width()};
}

bool isNarrow(const SoilWidths& widths, const SoilWidths& wanted) noexcept {
  return std::ranges::all_of(kWidths, [&](double SoilWidths::*width) { return widths.*width <= wanted.*width; });
}

bool isMeasured(const MovementPart& part, const ForceEmulator& emulator, const MeasuredForces& forces) {
  const std::vector<Eigen::Index> numbers = numbersOf(part, emulator);
  const auto measured = std::ranges::count_if(numbers, [&](Eigen::Index number) {
    const std::size_t window = emulator.windowOf(number);
    return window + 1 < forces.size() && forces[window] && forces[window + 1];
  });
  return 2 * measured >= std::ssize(numbers);
}

std::vector<PartGain> expectedGains(const std::vector<MovementPart>& parts, const ForceEmulator& emulator,
                                    double temper, const MeasuredForces& forces, double gravity_m_s2,
                                    const SoilPrior& prior) {
  const ForceEmulator::Observed observed = emulator.observed(forces, gravity_m_s2);
  BeliefSample sample =
      observed.which.empty() ? believedBefore(prior) : believed(SoilLikelihood(emulator, observed, temper), prior);
  const Eigen::MatrixX3d told = toldOf(sample.states, gravity_m_s2);
  Eigen::MatrixXd expected = emulator.expected(sample.states);
  const Present present{emulator,
                        temper,
                        observed,
                        std::move(sample),
                        std::move(expected),
                        {Ordered(told.col(0)), Ordered(told.col(1)), Ordered(told.col(2))}};
  std::vector<PartGain> gains;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!isMeasured(parts[i], emulator, forces)) {
      gains.push_back(gainOf(parts[i], present));
      gains.back().part = i;
    }
  }
  std::ranges::sort(gains, std::ranges::greater{}, &PartGain::bits_s);
  return gains;
}

}  // namespace haptolith
