#include <gmock/gmock.h>

#include <cmath>
#include <vector>

#include "haptolith/identify/training/force_emulator.h"
#include "haptolith/identify/training/training_file.h"

namespace haptolith {
namespace {

/// The error with which a number of each soil is read from its row of others by a ridge that all other soils have
/// taught, over that of taking the mean of these.
double errorOverSpread(const Eigen::MatrixXd& rows, const Eigen::VectorXd& truth, double lambda) {
  double squares = 0, spread = 0;
  const Eigen::Index last = rows.rows() - 1;
  for (Eigen::Index out = 0; out <= last; ++out) {
    std::vector<Eigen::Index> others;
    for (Eigen::Index i = 0; i <= last; ++i) {
      if (i != out) {
        others.push_back(i);
      }
    }
    const Eigen::VectorXd taught = truth(others);
    const Ridge ridge(rows(others, Eigen::all), taught, lambda);
    squares += std::pow(ridge.of(rows.row(out))(0, 0) - truth[out], 2);
    spread += std::pow(taught.mean() - truth[out], 2);
  }
  return std::sqrt(squares / spread);
}

// docs/reports/identification.md: even where a soil's strength is known, its forces, and those while the pressed plate
// is lifted, do not determine the adhesion to the tool as a fraction of its cohesion; the same regression estimates
// friction on the tool.
TEST(Adhesion, IsNotToldByForcesOfTheProbe) {
  constexpr double kNoise_n = 0.05;
  constexpr std::size_t kLifts[]{6, 7, 20, 21};
  const Training& training = probeTraining();
  const ForceEmulator emulator(training);
  std::vector<const TrainingRun*> cohering;
  for (const TrainingRun& run : training.runs) {
    if (run.sample.soil.contact_cohesion_n > 0) {
      cohering.push_back(&run);
    }
  }
  const auto soils = static_cast<Eigen::Index>(cohering.size()), numbers = static_cast<Eigen::Index>(emulator.size());
  Eigen::MatrixXd rows(soils, numbers + 4 + 3);
  Eigen::VectorXd share(soils), friction(soils);
  for (Eigen::Index i = 0; i < soils; ++i) {
    const TrainingRun& run = *cohering[static_cast<std::size_t>(i)];
    const MeasuredForces forces = measuredForces(run, kNoise_n, run.number);
    rows.row(i).head(numbers) = emulator.observed(forces, training.gravity_m_s2).values;
    for (std::size_t lift = 0; lift < 4; ++lift) {
      rows(i, numbers + static_cast<Eigen::Index>(lift)) = forces[kLifts[lift]]->z();
    }
    rows.row(i).tail<3>() = stateVector(stateOf(run, emulator.strengths()), training.gravity_m_s2);
    share[i] = run.sample.tool_adhesion_n / run.sample.soil.contact_cohesion_n;
    friction[i] = run.sample.tool_friction;
  }
  for (const double lambda : {1.0, 10.0, 50.0, 300.0}) {
    const double error = errorOverSpread(rows, share, lambda);
    EXPECT_GT(error, 1) << "lambda " << lambda
                        << ": it is better told than by its mean; docs/reports/identification.md says not";
    EXPECT_LT(error, 1.6) << lambda;
  }
  EXPECT_LT(errorOverSpread(rows.leftCols(numbers), friction, 10), 0.7);
}

}  // namespace
}  // namespace haptolith
