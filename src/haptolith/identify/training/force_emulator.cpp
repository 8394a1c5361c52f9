#include "haptolith/identify/training/force_emulator.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "haptolith/core/error.h"
#include "haptolith/core/math/random.h"
#include "haptolith/core/statistics.h"

namespace haptolith {

namespace {

constexpr std::size_t kBlock = ForceEmulator::kBlock;
constexpr std::size_t kLeastRuns = 20;
constexpr double kEmulatorLambda = 0.5;
constexpr double kEmulatorNoise_n = 0.05;  ///< sensor noise of a window, added to the training
constexpr std::array kAxes{0, 1, 2};
constexpr Eigen::Index kTerms = 9;

/// Returns the mean over a block; empty: part of it was not measured.
std::optional<Vec3> blockMean(const MeasuredForces& forces, std::size_t window) {
  Vec3 sum_n = Vec3::Zero();
  for (std::size_t i = window; i < window + kBlock; ++i) {
    if (i >= forces.size() || !forces[i]) {
      return std::nullopt;
    }
    sum_n += *forces[i];
  }
  return Vec3(sum_n / static_cast<double>(kBlock));
}

/// Returns linear and quadratic terms.
Eigen::MatrixXd terms(const Eigen::MatrixXd& states) {
  // Centred, so that linear and quadratic terms are independent.
  const Eigen::RowVector3d middle(35, -2, 0.4);
  const Eigen::RowVector3d spread(7, 0.9, 0.17);
  const Eigen::ArrayXXd z = (states.rowwise() - middle).array().rowwise() / spread.array();
  Eigen::MatrixXd columns(states.rows(), kTerms);
  const auto phi = z.col(0), cohesion = z.col(1), tool = z.col(2);
  columns << phi, cohesion, tool, phi.square(), cohesion.square(), tool.square(), phi * cohesion, phi * tool,
      cohesion * tool;
  return columns;
}

}  // namespace

SoilState stateOf(const TrainingRun& run, const StrengthMap& strengths) {
  const ShearStrength strength = strengths.of(run.sample.soil);
  return {strength.angle_deg, strength.cohesion_pa, run.sample.tool_friction};
}

SoilState measuredState(const TrainingRun& run) {
  const ShearStrength& residual = run.strength->residual;
  const bool coheres = run.sample.soil.contact_cohesion_n > 0;
  return {residual.angle_deg, coheres ? std::max(0.0, residual.cohesion_pa) : 0, run.sample.tool_friction};
}

MeasuredForces measuredForces(const TrainingRun& run, double noise_n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  MeasuredForces forces;
  for (const Vec3& force_n : run.forces) {
    Vec3 measured_n = force_n;
    for (double& component_n : measured_n) {
      component_n += noise_n * nearlyNormal(random);
    }
    forces.emplace_back(measured_n);
  }
  return forces;
}

ForceEmulator::ForceEmulator(const Training& training, std::optional<std::size_t> left_out)
    : strengths_(training.runs), gravity_m_s2_(training.gravity_m_s2) {
  if (training.runs.size() < kLeastRuns) {
    throw InvalidParameter("training", fmt::format("{} soils", training.runs.size()),
                           fmt::format("{} or more", kLeastRuns));
  }
  chooseFeatures(training);
  const auto rows = static_cast<Eigen::Index>(training.runs.size() - (left_out ? 1 : 0));
  Eigen::MatrixXd states(rows, 3), values(rows, static_cast<Eigen::Index>(size()));
  Eigen::VectorXd peaks_deg(rows);
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < training.runs.size(); ++i) {
    if (i != left_out) {
      const TrainingRun& run = training.runs[i];
      states.row(row) = stateVector(stateOf(run, strengths_), training.gravity_m_s2);
      peaks_deg[row] = strengths_.of(run.sample.soil, SoilStrength::kPeak).angle_deg;
      values.row(row++) = observed(measuredForces(run, kEmulatorNoise_n, run.number), training.gravity_m_s2).values;
    }
  }
  fit_.emplace(terms(states), values, kEmulatorLambda);
  peak_.emplace(terms(states), peaks_deg, kEmulatorLambda);
  covariance_ =
      shrunkCovariance(values - expected(states), std::max(5.0, static_cast<double>(rows) - 0.9 * (kTerms + 1)));
}

void ForceEmulator::chooseFeatures(const Training& training) {
  const double least_n = 0.25 * training.gravity_m_s2;  // 0.4 N on the Moon
  const std::size_t windows = training.runs.front().forces.size();
  std::vector<MeasuredForces> forces;
  forces.reserve(training.runs.size());
  for (const TrainingRun& run : training.runs) {
    forces.push_back(measuredForces(run));
  }
  const auto median_over = [&](auto&& of, std::size_t window) {
    std::vector<double> values;
    values.reserve(forces.size());
    for (const MeasuredForces& run : forces) {
      values.push_back(of(*blockMean(run, window)));
    }
    return median(std::move(values));
  };
  for (std::size_t window = 0; window + kBlock <= windows; window += kBlock) {
    const double size_n = median_over([](const Vec3& f) { return f.norm(); }, window);
    for (const int axis : kAxes) {
      const double along_n = median_over([axis](const Vec3& f) { return std::abs(f[axis]); }, window);
      if (size_n >= least_n && along_n >= std::max(0.12 * size_n, least_n / 2)) {
        features_.push_back({window, axis, (0.15 * along_n + 0.05) / training.gravity_m_s2});
      }
    }
  }
  if (features_.empty()) {
    throw InvalidParameter("training", "a movement in the air", "a movement in soil");
  }
}

ForceEmulator::Observed ForceEmulator::observed(const MeasuredForces& forces, double gravity_m_s2) const {
  Observed result;
  std::vector<double> values;
  for (std::size_t i = 0; i < features_.size(); ++i) {
    const Feature& feature = features_[i];
    if (const std::optional<Vec3> mean_n = blockMean(forces, feature.window)) {
      result.which.push_back(static_cast<Eigen::Index>(i));
      values.push_back(std::asinh((*mean_n)[feature.axis] / gravity_m_s2 / feature.scale));
    }
  }
  result.values = Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  return result;
}

bool ForceEmulator::isAboveNoise(const MeasuredForces& forces, double gravity_m_s2) const {
  const double noise_n = kEmulatorNoise_n * gravity_m_s2 / gravity_m_s2_;
  return std::ranges::any_of(features_, [&](const Feature& feature) {
    const std::optional<Vec3> mean_n = blockMean(forces, feature.window);
    return mean_n && mean_n->norm() > noise_n;
  });
}

Eigen::VectorXd ForceEmulator::peakAngles(const Eigen::MatrixXd& states) const {
  return peak_->of(terms(states));
}

Eigen::MatrixXd ForceEmulator::expected(const Eigen::MatrixXd& states) const {
  return fit_->of(terms(states));
}

}  // namespace haptolith
