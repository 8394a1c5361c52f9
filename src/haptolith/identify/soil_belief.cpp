#include "haptolith/identify/soil_belief.h"

#include <Eigen/Cholesky>
#include <boost/math/special_functions/erf.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <thread>

#include "haptolith/core/error.h"
#include "haptolith/core/in_parallel.h"

namespace haptolith {

namespace {

constexpr Eigen::Index kStates = 8192;
constexpr double kFreedom = 6;  ///< nu
constexpr double kLeastSamples = 60, kEnoughSamples = 1000;
constexpr int kMostRounds = 4;

double degrees(double radians) {
  return radians * 180 / std::numbers::pi;
}

/// Number `index` of van der Corput's sequence in a base, 0 to 1 without its ends.
double digitsReversed(Eigen::Index index, int base) {
  double value = 0, digit = 1;
  for (Eigen::Index rest = index + 1; rest > 0; rest /= base) {
    digit /= base;
    value += digit * static_cast<double>(rest % base);
  }
  return value;
}

/// Points in the unit cube, evenly (Halton 1960).
const Eigen::MatrixXd& haltonPoints() {
  static const Eigen::MatrixXd kPoints = [] {
    constexpr std::array kBases{2, 3, 5};
    Eigen::MatrixXd made(kStates, 3);
    for (Eigen::Index i = 0; i < kStates; ++i) {
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        made(i, axis) = digitsReversed(i, kBases[static_cast<std::size_t>(axis)]);
      }
    }
    return made;
  }();
  return kPoints;
}

const Eigen::MatrixXd& normalPoints() {
  static const Eigen::MatrixXd kPoints =
      haltonPoints().unaryExpr([](double share) { return std::numbers::sqrt2 * boost::math::erf_inv(2 * share - 1); });
  return kPoints;
}

/// States, and the logarithms of their weights.
struct Weighted {
  Eigen::MatrixXd states;
  Eigen::VectorXd logarithms;

  /// Of a sum of 1; flatter when `power` is below 1.
  [[nodiscard]] Eigen::VectorXd weights(double power = 1) const {
    Eigen::VectorXd shares = (power * (logarithms.array() - logarithms.maxCoeff())).exp();
    return shares / shares.sum();
  }
};

double countOf(const Eigen::VectorXd& weights) {
  return 1 / weights.squaredNorm();
}

/// The likelihood of what was observed.
class Likelihood {
 public:
  Likelihood(const ForceEmulator& emulator, const ForceEmulator::Observed& observed, double temper)
      : emulator_(emulator),
        observed_(observed),
        temper_(temper),
        root_(emulator.covariance()(observed.which, observed.which)) {}

  /// Logarithms of it for states, one in a row.
  [[nodiscard]] Eigen::VectorXd of(const Eigen::MatrixXd& states) const {
    const auto p = static_cast<double>(observed_.values.size());
    return -(kFreedom + p) / 2 / temper_ * (squares(states).array() / kFreedom).log1p();
  }
  /// d' S^-1 d
  [[nodiscard]] Eigen::VectorXd squares(const Eigen::MatrixXd& states) const {
    Eigen::MatrixXd apart =
        (emulator_.expected(states)(Eigen::all, observed_.which).rowwise() - observed_.values.transpose()).transpose();
    root_.matrixL().solveInPlace(apart);
    return apart.colwise().squaredNorm().transpose();
  }

 private:
  const ForceEmulator& emulator_;
  const ForceEmulator::Observed& observed_;
  double temper_;
  Eigen::LLT<Eigen::MatrixXd> root_;
};

Weighted overBox(const Likelihood& likelihood, const SoilPrior& prior) {
  const Eigen::RowVector3d from = lowest(prior), size = highest(prior).transpose() - from;
  Weighted sample;
  sample.states = (haltonPoints().array().rowwise() * size.array()).matrix().rowwise() + from;
  sample.logarithms = likelihood.of(sample.states);
  return sample;
}

/// Sampled again where the first sample has its weight, so that enough of it counts.
Weighted again(const Likelihood& likelihood, const Weighted& first, const SoilPrior& prior) {
  double power = 1;
  Eigen::VectorXd weights = first.weights();
  while (countOf(weights) < kLeastSamples) {
    power *= 0.7;
    weights = first.weights(power);
  }
  const Eigen::RowVector3d mean = weights.transpose() * first.states;
  const Eigen::MatrixXd apart = first.states.rowwise() - mean;
  constexpr double kWider = 1.5;
  const Eigen::Vector3d box = highest(prior) - lowest(prior);
  Eigen::Matrix3d covariance = kWider * apart.transpose() * weights.asDiagonal() * apart;
  covariance.diagonal() += 1e-5 * box.cwiseAbs2();
  const Eigen::LLT<Eigen::Matrix3d> root(covariance);

  Weighted sample;
  sample.states = (normalPoints() * root.matrixU().toDenseMatrix()).rowwise() + mean;
  sample.logarithms = likelihood.of(sample.states) + normalPoints().rowwise().squaredNorm() / 2;
  const Eigen::RowVector3d from = lowest(prior), to = highest(prior);
  for (Eigen::Index i = 0; i < kStates; ++i) {
    if ((sample.states.row(i).array() < from.array()).any() || (sample.states.row(i).array() > to.array()).any()) {
      sample.logarithms[i] = -std::numeric_limits<double>::infinity();
    }
  }
  return sample;
}

/// Quantiles of 5, 50 and 95 %.
Estimate estimateOf(const Eigen::VectorXd& values, const Eigen::VectorXd& weights) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(values.size()));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](Eigen::Index i) { return values[i]; });
  Estimate estimate;
  double sum = 0;
  for (const Eigen::Index i : order) {
    const double before = sum;
    sum += weights[i];
    const auto passes = [&](double share) { return before < share && sum >= share; };
    estimate.low = passes(0.05) ? values[i] : estimate.low;
    estimate.middle = passes(0.5) ? values[i] : estimate.middle;
    estimate.high = passes(0.95) ? values[i] : estimate.high;
  }
  return estimate;
}

SoilBelief identifyWith(const ForceEmulator& emulator, double temper, const MeasuredForces& forces, double gravity_m_s2,
                        const SoilPrior& prior) {
  const ForceEmulator::Observed observed = emulator.observed(forces, gravity_m_s2);
  if (observed.which.empty()) {
    throw InvalidParameter("forces", "of no window", "some where the tool is in soil");
  }
  const Likelihood likelihood(emulator, observed, temper);
  Weighted sample = overBox(likelihood, prior);
  for (int round = 0; round < kMostRounds && (round == 0 || countOf(sample.weights()) < kEnoughSamples); ++round) {
    sample = again(likelihood, sample, prior);
  }
  const Eigen::VectorXd weights = sample.weights();
  Eigen::VectorXd cohesion_pa(kStates), angle_deg(kStates);
  for (Eigen::Index i = 0; i < kStates; ++i) {
    const SoilState state = soilState(sample.states.row(i).transpose(), gravity_m_s2);
    cohesion_pa[i] = state.cohesion_pa;
    angle_deg[i] = degrees(std::atan(state.tool_friction));
  }
  SoilBelief belief;
  belief.friction_angle_deg = estimateOf(sample.states.col(0), weights);
  belief.peak_angle_deg = estimateOf(emulator.peakAngles(sample.states), weights);
  belief.cohesion_pa = estimateOf(cohesion_pa, weights);
  belief.tool_friction_angle_deg = estimateOf(angle_deg, weights);
  belief.numbers = observed.which.size();
  belief.samples = countOf(weights);
  belief.misfit = likelihood.squares(sample.states).minCoeff() / static_cast<double>(observed.which.size());
  return belief;
}

}  // namespace

bool isIdentified(const Estimate& estimate, const Range& before) noexcept {
  return estimate.high - estimate.low <= kIdentifiedShare * 0.9 * (before.highest - before.lowest);
}

SoilIdentifier::SoilIdentifier(const Training& training)
    : emulator_(training), temper_(training.temper ? *training.temper : LeaveOneOut(training).calibratedTemper()) {}

SoilBelief SoilIdentifier::identify(const MeasuredForces& forces, double gravity_m_s2, const SoilPrior& prior) const {
  return identifyWith(emulator_, temper_, forces, gravity_m_s2, prior);
}

LeaveOneOut::LeaveOneOut(const Training& training) : training_(training) {
  (void)ForceEmulator(training);  // that there are enough
  for (std::size_t i = 0; i < training.runs.size(); ++i) {
    if (training.runs[i].strength) {
      sheared_.push_back(i);
      others_.emplace_back(training, i);
    }
  }
}

std::vector<LeftOutSoil> LeaveOneOut::with(double temper) const {
  constexpr double kNoise_n = 0.05;
  std::vector<LeftOutSoil> soils(others_.size());
  const auto threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  inParallel(soils.size(), threads, [&](std::size_t i) {
    const TrainingRun& run = training_.runs[sheared_[i]];
    soils[i] = {measuredState(run), identifyWith(others_[i], temper, measuredForces(run, kNoise_n, run.number),
                                                 training_.gravity_m_s2, {})};
  });
  return soils;
}

double LeaveOneOut::calibratedTemper() const {
  constexpr double kWanted = 0.9;
  const auto held = [&](double logarithm) {
    double count = 0;
    const std::vector<LeftOutSoil> soils = with(std::exp(logarithm));
    for (const auto& [truth, belief] : soils) {
      count += holds(belief.friction_angle_deg, truth.friction_angle_deg) ? 1 : 0;
      count += holds(belief.cohesion_pa, truth.cohesion_pa) ? 1 : 0;
      count += holds(belief.tool_friction_angle_deg, degrees(std::atan(truth.tool_friction))) ? 1 : 0;
    }
    return count / (3 * static_cast<double>(soils.size()));
  };
  double low = 0, high = std::log(32.0);
  for (int step = 0; step < 7; ++step) {
    const double middle = (low + high) / 2;
    (held(middle) < kWanted ? low : high) = middle;
  }
  return std::exp(high);
}

}  // namespace haptolith
