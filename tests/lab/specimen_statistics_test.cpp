#include "haptolith/lab/report/specimen_statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace haptolith {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::vector<Finding> specimens(const std::vector<double>& numbers,
                               const std::optional<Range>& accepted = Range{40, 44}) {
  std::vector<Finding> all;
  all.reserve(numbers.size());
  for (const double number : numbers) {
    all.push_back({"friction angle", "42 ± 2°", number, "°", 1, accepted});
  }
  return all;
}

TEST(OverSeeds, ShowsMeanAndStandardDeviation) {
  const ReportValue value = overSeeds(specimens({40, 42, 44}));
  EXPECT_EQ(value.text, "42.0 ± 2.0°");
  EXPECT_EQ(value.verdict, Verdict::kPass);
}

TEST(OverSeeds, ScatterIsOfThoseThatHaveANumber) {
  const Scatter scatter = scatterOf({40, kNone, 42, 44});
  EXPECT_EQ(scatter.mean, 42);
  EXPECT_EQ(scatter.sd, 2);
  EXPECT_EQ(scatter.specimens, 3U);
  EXPECT_TRUE(std::isnan(scatterOf({40}).sd));
  EXPECT_TRUE(std::isnan(scatterOf({kNone}).mean));
  EXPECT_EQ(scatterOf({}).specimens, 0U);
}

TEST(OverSeeds, OneSeedHasNoSpread) {
  EXPECT_EQ(overSeeds(specimens({41.94})).text, "41.9°");
  EXPECT_EQ(overSeeds(specimens({-0.04})).text, "0.0°");
}

TEST(OverSeeds, TheMeanIsJudgedAndNotEachSpecimen) {
  EXPECT_EQ(overSeeds(specimens({39, 45})).verdict, Verdict::kPass);
  EXPECT_EQ(overSeeds(specimens({43, 47})).verdict, Verdict::kFail);
  EXPECT_EQ(overSeeds(specimens({43, 47}, {})).verdict, Verdict::kInfo);
}

TEST(OverSeeds, ASpecimenWithoutANumberIsToldAndFails) {
  const ReportValue some = overSeeds(specimens({41, kNone, 43}));
  EXPECT_EQ(some.text, "42.0 ± 1.4° (none with 1 of 3 seeds)");
  EXPECT_EQ(some.verdict, Verdict::kFail);
  const ReportValue none = overSeeds(specimens({kNone, kNone}));
  EXPECT_EQ(none.text, "none");
  EXPECT_EQ(none.verdict, Verdict::kFail);
}

}  // namespace
}  // namespace haptolith
