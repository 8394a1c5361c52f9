// Intervals of all parameters against sums over dense grids in Python: dense_sum.py.

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "haptolith/psychometrics/fit.h"

namespace haptolith {
namespace {

struct DenseCase {
  std::string name;
  FitOptions options;
  std::vector<double> positive;  // answers of 10 to each stimulus
  Interval threshold, width, lapse, overdispersion;
};

const std::vector<DenseCase> kCases{
    {"Student3afc",
     {.sigmoid = Sigmoid::kStudent, .design = Design::kForcedChoice, .alternatives = 3, .simulations = 0},
     {3, 4, 2, 5, 4, 7, 8, 9, 8, 10},
     {0.86839, 1.28745},
     {0.41036, 3.39918},
     {0.00262, 0.18109},
     {0.00207, 0.21969}},
    {"Gumbel2afc",
     {.sigmoid = Sigmoid::kGumbel, .design = Design::kForcedChoice, .simulations = 0},
     {5, 6, 4, 5, 7, 6, 8, 10, 9, 10},
     {0.80823, 1.38582},
     {0.31357, 2.73019},
     {0.00226, 0.15039},
     {0.00209, 0.22442}},
};

void expectEnds(const Interval& found, const Interval& dense, const char* what) {
  const double within = 0.01 * (dense.high - dense.low);
  EXPECT_NEAR(found.low, dense.low, within) << what;
  EXPECT_NEAR(found.high, dense.high, within) << what;
}

class DenseSum : public testing::TestWithParam<DenseCase> {};

TEST_P(DenseSum, HasTheSameIntervals) {
  const std::vector<double> stimuli{0.25, 0.417, 0.583, 0.75, 0.917, 1.083, 1.25, 1.417, 1.583, 1.75};
  std::vector<Level> levels;
  for (std::size_t i = 0; i < stimuli.size(); ++i) {
    levels.push_back({stimuli[i], GetParam().positive[i], 10});
  }
  const Fit fit = fitPsychometric(levels, GetParam().options);
  expectEnds(fit.threshold.interval, GetParam().threshold, "threshold");
  expectEnds(fit.width.interval, GetParam().width, "width");
  expectEnds(fit.lapse.interval, GetParam().lapse, "lapse");
  expectEnds(fit.overdispersion.interval, GetParam().overdispersion, "overdispersion");
}

INSTANTIATE_TEST_SUITE_P(Cases, DenseSum, testing::ValuesIn(kCases),
                         [](const auto& of_case) { return of_case.param.name; });

}  // namespace
}  // namespace haptolith
