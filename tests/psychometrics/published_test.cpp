// Fits that others have published, found again. The answers are in tests/data.

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "haptolith/psychometrics/fit.h"

#include "../source_dir.h"

namespace haptolith {
namespace {

/// The cases of tests/data/`name`, whose columns are case,x,k,n.
std::map<std::string, std::vector<Level>> casesIn(const std::string& name) {
  std::ifstream file(sourceDir() / "tests" / "data" / name);
  EXPECT_TRUE(file) << name;
  std::map<std::string, std::vector<Level>> cases;
  std::string line;
  while (std::getline(file, line)) {
    if (line.starts_with('#') || line.starts_with("case,")) {
      continue;
    }
    std::istringstream cells(line);
    std::string name_of_case, x, k, n;
    std::getline(cells, name_of_case, ',');
    std::getline(cells, x, ',');
    std::getline(cells, k, ',');
    std::getline(cells, n, ',');
    cases[name_of_case].push_back({std::stod(x), std::stod(k), std::stod(n)});
  }
  return cases;
}

void expectInterval(const Interval& found, const Interval& published, double share, const std::string& what) {
  const double within = share * (published.high - published.low);
  EXPECT_NEAR(found.low, published.low, within) << what;
  EXPECT_NEAR(found.high, published.high, within) << what;
}

TEST(PublishedFits, TwoAlternativesOfPsignifitsFirstExample) {
  const Fit fit = fitPsychometric(casesIn("psychometric_cases.csv").at("2afc-classic"),
                                  {.design = Design::kForcedChoice, .simulations = 0});
  EXPECT_NEAR(fit.threshold.value, 0.00464485, 0.01 * 0.00464485);
  EXPECT_NEAR(fit.width.value, 0.00468384, 0.01 * 0.00468384);
  EXPECT_EQ(fit.guess.value, 0.5);
  EXPECT_EQ(fit.n_trials, 13 * 90);
}

TEST(PublishedFits, YesAndNoWithFreeAsymptotes) {
  const Fit fit = fitPsychometric(casesIn("psychometric_cases.csv").at("yesno-norm"), {.simulations = 0});
  EXPECT_NEAR(fit.threshold.value, 0.897274, 0.01 * 0.897274);
  EXPECT_NEAR(fit.width.value, 1.434103, 0.01 * 1.434103);
  EXPECT_NEAR(fit.deviance, 4.81048, 0.01 * 4.81048);
  EXPECT_NEAR(fit.lapse.value, 0, 1e-4);
  EXPECT_NEAR(fit.guess.value, 0, 1e-4);
  EXPECT_NEAR(fit.threshold.interval.low, 0.68505, 0.1 * 0.68505);
  EXPECT_NEAR(fit.threshold.interval.high, 1.06949, 0.1 * 1.06949);
  EXPECT_NEAR(fit.width.interval.low, 0.58189, 0.1 * 0.58189);
  EXPECT_NEAR(fit.width.interval.high, 2.11543, 0.1 * 2.11543);
}

/// Values that psignifit's consistency tests store of a fit: MAP, 95 % intervals, deviance. On the axis: ln x where
/// logarithmic.
struct Published {
  const char* name;
  Sigmoid sigmoid;
  Design design;
  bool log_axis;
  double threshold;
  Interval threshold_interval;
  double width;
  Interval width_interval;
  double lapse;
  Interval lapse_interval;
  double deviance;
};

// If the width is above 3 R, the prior's end, or the posterior is bimodal (width of 2afc-weibull), the published
// numbers are still met.
const std::vector<Published> kPublished{
    {"2afc-weibull",
     Sigmoid::kWeibull,
     Design::kForcedChoice,
     true,
     0.941412,
     {0.400534, 1.221723},
     0.326461,
     {0.317846, 3.347888},
     0.069052,
     {0.007364, 0.186267},
     4.958078},
    {"2afc-logistic",
     Sigmoid::kLogistic,
     Design::kForcedChoice,
     false,
     1.189541,
     {0.739360, 1.449513},
     1.345906,
     {0.336170, 3.108797},
     0,
     {0.002338, 0.183234},
     4.125011},
    {"2afc-norm",
     Sigmoid::kNorm,
     Design::kForcedChoice,
     false,
     0.912425,
     {0.262169, 1.217157},
     1.480736,
     {0.452573, 3.414210},
     0,
     {0.001077, 0.137875},
     8.458944},
    {"yesno-logistic",
     Sigmoid::kLogistic,
     Design::kYesNo,
     false,
     0.879924,
     {0.579511, 1.130245},
     2.056311,
     {0.901187, 3.100920},
     0,
     {0.002441, 0.221776},
     7.585689},
    {"yesno-weibull",
     Sigmoid::kWeibull,
     Design::kYesNo,
     true,
     1.114878,
     {0.910069, 1.256188},
     1.030743,
     {0.418650, 1.716640},
     0.045567,
     {0.009993, 0.230164},
     7.643658},
    {"equal-gumbel",
     Sigmoid::kGumbel,
     Design::kEqualAsymptote,
     false,
     0.941119,
     {0.729826, 1.101926},
     1.896847,
     {0.691020, 2.839765},
     0,
     {0.001979, 0.176181},
     2.184751},
    {"equal-norm",
     Sigmoid::kNorm,
     Design::kEqualAsymptote,
     false,
     0.865828,
     {0.737369, 0.988792},
     0.756807,
     {0.378983, 1.341060},
     0.021428,
     {0.00419, 0.10851},  // psignifit has 0.007307 to 0.109952, from 20 values of the rate; this is a dense sum
     12.952176},
    {"equal-lognorm",
     Sigmoid::kNorm,
     Design::kEqualAsymptote,
     true,
     0.919538,
     {0.777207, 1.098326},
     1.546341,
     {0.336351, 2.197624},
     0,
     {0.003234, 0.185143},
     7.090176},
};

class PublishedFit : public testing::TestWithParam<Published> {};

TEST_P(PublishedFit, IsFoundAgain) {
  const Published& published = GetParam();
  const Fit fit = fitPsychometric(
      casesIn("psychometric_published.csv").at(published.name),
      {.sigmoid = published.sigmoid, .design = published.design, .log_axis = published.log_axis, .simulations = 0});
  const auto place = [&](double x) { return toAxis(fit.function, x); };
  EXPECT_NEAR(place(fit.threshold.value), published.threshold, 0.01 * published.threshold);
  EXPECT_NEAR(fit.width.value, published.width, 0.01 * published.width);
  EXPECT_NEAR(fit.lapse.value, published.lapse, 0.001);
  EXPECT_NEAR(fit.deviance, published.deviance, 0.01 * published.deviance);
  EXPECT_NEAR(fit.overdispersion.value, 0, 1e-3);
  expectInterval({place(fit.threshold.interval.low), place(fit.threshold.interval.high)}, published.threshold_interval,
                 0.02, "threshold");
  expectInterval(fit.width.interval, published.width_interval, 0.02, "width");
  expectInterval(fit.lapse.interval, published.lapse_interval, 0.03, "lapse");
}

INSTANTIATE_TEST_SUITE_P(PublishedFits, PublishedFit, testing::ValuesIn(kPublished), [](const auto& published) {
  std::string name;
  for (const char letter : std::string(published.param.name)) {
    name += letter == '-' ? '_' : letter;
  }
  return name;
});

}  // namespace
}  // namespace haptolith
