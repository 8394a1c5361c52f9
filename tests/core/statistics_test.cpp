#include "haptolith/core/statistics.h"

#include <gmock/gmock.h>

#include <cmath>

namespace haptolith {
namespace {

TEST(Statistics, TheMedianIsTheMiddleOneOrTheMeanOfTheMiddleTwo) {
  EXPECT_EQ(median({3}), 3);
  EXPECT_EQ(median({5, 1, 3}), 3);
  EXPECT_EQ(median({4, 1, 2, 100}), 3);
  EXPECT_EQ(median({2, 2, 2, 2}), 2);
  EXPECT_TRUE(std::isnan(median({})));
}

TEST(Statistics, MeanAndStandardDeviationAreThoseOfASample) {
  const std::vector<double> values{2, 4, 4, 4, 5, 5, 7, 9};  // squares about the mean of 5: 32
  EXPECT_EQ(mean(values), 5);
  EXPECT_NEAR(standardDeviation(values), std::sqrt(32.0 / 7), 1e-15);
  EXPECT_EQ(standardDeviation(std::vector<double>{1e9, 1e9}), 0);
  EXPECT_TRUE(std::isnan(mean({})));
  EXPECT_TRUE(std::isnan(standardDeviation(std::vector<double>{1})));
}

TEST(Statistics, QuantilesAreInterpolatedAsInR) {
  const std::vector<double> values{15, 3, 9, 6, 12};
  EXPECT_EQ(quantile(values, 0), 3);
  EXPECT_EQ(quantile(values, 0.5), 9);
  EXPECT_EQ(quantile(values, 1), 15);
  EXPECT_DOUBLE_EQ(quantile(values, 0.1), 4.2);  // quantile(c(3, 6, 9, 12, 15), 0.1)
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

}  // namespace
}  // namespace haptolith
