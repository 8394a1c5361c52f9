// A short version of benchmarks/psychometrics/coverage.cpp: simulated studies of the paper's design.

#include <gmock/gmock.h>

#include <array>
#include <random>
#include <vector>

#include "haptolith/psychometrics/fit.h"
#include "haptolith/psychometrics/goodness_of_fit.h"

namespace haptolith {
namespace {

constexpr int kStudies = 200;
constexpr double kAnswers = 24;  // to each level: eight participants, three times

struct Experiment {
  double reference;
  double w;
  std::array<double, 5> levels;
};
constexpr Experiment kFriction{0.835, 0.29, {0.600, 0.648, 0.735, 1.00, 1.21}};
constexpr Experiment kGravity{1.625, 3.31, {0.270, 0.625, 1.314, 3.721, 9.807}};

struct Found {
  double bias = 0;     // relative bias of w
  double covered = 0;  // share of the intervals that hold w
};

Found studiesOf(const Experiment& experiment, double lapse) {
  PsychometricFunction truth = weberFunction(experiment.reference, experiment.w);
  truth.lapse = truth.guess = lapse;
  FitOptions options = weberOptions(experiment.reference);
  options.simulations = 0;
  options.grid.width = 30;
  if (lapse > 0) {
    options.lapse.reset();
  }
  std::vector<Level> levels;
  for (const double x : experiment.levels) {
    levels.push_back({x, 0, kAnswers});
  }
  std::mt19937_64 random(7);
  Found found;
  for (int i = 0; i < kStudies; ++i) {
    const Fit fit = fitPsychometric(simulatedAnswers(levels, truth, random), options);
    found.bias += (fit.w->value / experiment.w - 1) / kStudies;
    const bool holds = fit.w->interval.low <= experiment.w && experiment.w <= fit.w->interval.high;
    found.covered += holds ? 1.0 / kStudies : 0;
  }
  return found;
}

// Over 200 studies the mean w varies by 1.2 % (friction) and 2.1 % (gravity), the coverage by 1.5 %.
void expectSound(const Found& found) {
  EXPECT_NEAR(found.bias, 0, 0.08);
  EXPECT_GE(found.covered, 0.91);
  EXPECT_LE(found.covered, 0.985);
}

TEST(Coverage, OfThePapersFrictionStudy) {
  expectSound(studiesOf(kFriction, 0));
}

TEST(Coverage, OfThePapersGravityStudy) {
  expectSound(studiesOf(kGravity, 0));
}

TEST(Coverage, OfStudiesWithLapses) {
  expectSound(studiesOf(kFriction, 0.02));
  expectSound(studiesOf(kGravity, 0.02));
}

}  // namespace
}  // namespace haptolith
