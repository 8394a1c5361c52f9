#include "haptolith/identify/belief_sample.h"

#include <boost/math/special_functions/erf.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace haptolith {

namespace {

constexpr Eigen::Index kStates = 8192;
constexpr double kLeastSamples = 60, kEnoughSamples = 1000;
constexpr int kMostRounds = 4;

/// Returns number `index` of van der Corput's sequence in a base, between 0 and 1 (exclusive).
double digitsReversed(Eigen::Index index, int base) {
  double value = 0, digit = 1;
  for (Eigen::Index rest = index + 1; rest > 0; rest /= base) {
    digit /= base;
    value += digit * static_cast<double>(rest % base);
  }
  return value;
}

/// Returns evenly distributed points in the unit cube (Halton 1960).
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

/// States with the logarithms of their weights.
struct Weighted {
  Eigen::MatrixXd states;
  Eigen::VectorXd logarithms;

  /// Returns weights with a sum of 1; flatter for `power` below 1.
  [[nodiscard]] Eigen::VectorXd weights(double power = 1) const {
    Eigen::VectorXd shares = (power * (logarithms.array() - logarithms.maxCoeff())).exp();
    return shares / shares.sum();
  }
};

double countOf(const Eigen::VectorXd& weights) {
  return 1 / weights.squaredNorm();
}

Eigen::MatrixXd statesInBox(const SoilPrior& prior) {
  const Eigen::RowVector3d from = lowest(prior), size = highest(prior).transpose() - from;
  return (haltonPoints().array().rowwise() * size.array()).matrix().rowwise() + from;
}

Weighted overBox(const SoilLikelihood& likelihood, const SoilPrior& prior) {
  Weighted sample;
  sample.states = statesInBox(prior);
  sample.logarithms = likelihood.of(sample.states);
  return sample;
}

/// Resamples in the region of high weight, so that the effective sample size suffices.
Weighted again(const SoilLikelihood& likelihood, const Weighted& first, const SoilPrior& prior) {
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

}  // namespace

SoilLikelihood::SoilLikelihood(const ForceEmulator& emulator, const ForceEmulator::Observed& observed, double temper)
    : emulator_(emulator),
      observed_(observed),
      temper_(temper),
      root_(emulator.covariance()(observed.which, observed.which)) {}

Eigen::VectorXd SoilLikelihood::of(const Eigen::MatrixXd& states) const {
  return logarithms(squares(states), observed_.values.size(), temper_);
}

Eigen::VectorXd SoilLikelihood::squares(const Eigen::MatrixXd& states) const {
  Eigen::MatrixXd apart =
      (emulator_.expected(states)(Eigen::all, observed_.which).rowwise() - observed_.values.transpose()).transpose();
  root_.matrixL().solveInPlace(apart);
  return apart.colwise().squaredNorm().transpose();
}

Eigen::VectorXd SoilLikelihood::logarithms(const Eigen::VectorXd& squares, Eigen::Index numbers, double temper) {
  const auto p = static_cast<double>(numbers);
  return -(kFreedom + p) / 2 / temper * (squares.array() / kFreedom).log1p();
}

BeliefSample believed(const SoilLikelihood& likelihood, const SoilPrior& prior) {
  Weighted sample = overBox(likelihood, prior);
  for (int round = 0; round < kMostRounds && (round == 0 || countOf(sample.weights()) < kEnoughSamples); ++round) {
    sample = again(likelihood, sample, prior);
  }
  return {std::move(sample.states), sample.weights()};
}

BeliefSample believedBefore(const SoilPrior& prior) {
  return {statesInBox(prior), Eigen::VectorXd::Constant(kStates, 1.0 / static_cast<double>(kStates))};
}

Eigen::MatrixX3d toldOf(const Eigen::MatrixXd& states, double gravity_m_s2) {
  Eigen::MatrixX3d told(states.rows(), 3);
  for (Eigen::Index i = 0; i < states.rows(); ++i) {
    const SoilState state = soilState(states.row(i).transpose(), gravity_m_s2);
    told.row(i) << state.friction_angle_deg, state.cohesion_pa, std::atan(state.tool_friction) * 180 / std::numbers::pi;
  }
  return told;
}

SoilEstimate estimateOf(const Eigen::VectorXd& values, const Eigen::VectorXd& weights) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(values.size()));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](Eigen::Index i) { return values[i]; });
  SoilEstimate estimate;
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

}  // namespace haptolith
