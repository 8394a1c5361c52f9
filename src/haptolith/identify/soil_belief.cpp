#include "haptolith/identify/soil_belief.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <thread>

#include "haptolith/core/error.h"
#include "haptolith/core/process/in_parallel.h"

namespace haptolith {

namespace {

double degrees(double radians) {
  return radians * 180 / std::numbers::pi;
}

/// Whether the forces as a whole are opposite to those of a soil in the centre of the prior.
bool pushesTheWrongWay(const ForceEmulator::Observed& observed, const ForceEmulator& emulator, const SoilPrior& prior) {
  const Eigen::MatrixXd expected = emulator.expected((lowest(prior) + highest(prior)).transpose() / 2);
  double sum = 0;
  for (Eigen::Index i = 0; i < observed.values.size(); ++i) {
    sum += observed.values[i] * expected(0, observed.which[static_cast<std::size_t>(i)]);
  }
  return sum < 0;
}

}  // namespace

SoilBelief beliefOf(const BeliefSample& sample, const ForceEmulator& emulator, double gravity_m_s2) {
  const Eigen::MatrixX3d told = toldOf(sample.states, gravity_m_s2);
  SoilBelief belief;
  belief.friction_angle_deg = estimateOf(told.col(0), sample.weights);
  belief.peak_angle_deg = estimateOf(emulator.peakAngles(sample.states), sample.weights);
  belief.cohesion_pa = estimateOf(told.col(1), sample.weights);
  belief.tool_friction_angle_deg = estimateOf(told.col(2), sample.weights);
  belief.samples = 1 / sample.weights.squaredNorm();
  return belief;
}

SoilBelief beliefOf(const MeasuredForces& forces, const ForceEmulator& emulator, double temper, double gravity_m_s2,
                    const SoilPrior& prior) {
  const ForceEmulator::Observed observed = emulator.observed(forces, gravity_m_s2);
  if (observed.which.empty()) {
    return beliefOf(believedBefore(prior), emulator, gravity_m_s2);
  }
  const SoilLikelihood likelihood(emulator, observed, temper);
  const BeliefSample sample = believed(likelihood, prior);
  SoilBelief belief = beliefOf(sample, emulator, gravity_m_s2);
  belief.numbers = observed.which.size();
  belief.misfit = likelihood.squares(sample.states).minCoeff() / static_cast<double>(observed.which.size());
  return belief;
}

bool isIdentified(const SoilEstimate& estimate, const Range& before) noexcept {
  return estimate.high - estimate.low <= kIdentifiedShare * 0.9 * (before.highest - before.lowest);
}

SoilIdentifier::SoilIdentifier(const Training& training)
    : emulator_(training), temper_(training.temper ? *training.temper : LeaveOneOut(training).calibratedTemper()) {}

SoilBelief SoilIdentifier::identify(const MeasuredForces& forces, double gravity_m_s2, const SoilPrior& prior) const {
  const ForceEmulator::Observed observed = emulator_.observed(forces, gravity_m_s2);
  if (observed.which.empty()) {
    throw InvalidParameter("windows in which the tool is in soil", "0", "1 or more");
  }
  if (!emulator_.isAboveNoise(forces, gravity_m_s2)) {
    throw InvalidParameter("force where the tool is in soil", "always within the noise of the sensor",
                           "the force of the soil on the tool; check the columns of the sensor and --origin-mm");
  }
  if (pushesTheWrongWay(observed, emulator_, prior)) {
    throw InvalidParameter("force where the tool is in soil", "opposite to the force of soil on this tool",
                           "the force of the soil on the tool, in the axes of the poses; check the sign");
  }
  return beliefOf(forces, emulator_, temper_, gravity_m_s2, prior);
}

LeaveOneOut::LeaveOneOut(const Training& training) : training_(training) {
  (void)ForceEmulator(training);  // checks that there are enough
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
    soils[i] = {measuredState(run),
                beliefOf(measuredForces(run, kNoise_n, run.number), others_[i], temper, training_.gravity_m_s2)};
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
