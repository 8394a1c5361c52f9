#include "haptolith/lab/theory/straight_line.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

TEST(StraightLine, OfPointsOnALineIsThatLineWithoutError) {
  const std::vector<double> x{1, 2, 4, 8};
  const std::vector<double> y{5, 7, 11, 19};
  const StraightLine line = fitStraightLine(x, y);
  EXPECT_DOUBLE_EQ(line.slope, 2);
  EXPECT_DOUBLE_EQ(line.intercept, 3);
  EXPECT_NEAR(line.slope_se, 0, 1e-14);
  EXPECT_NEAR(line.intercept_se, 0, 1e-14);
  EXPECT_DOUBLE_EQ(line.at(10), 23);
}

TEST(StraightLine, HasTheErrorsOneWorksOutByHand) {
  // Slope 1/2 about the mean (1, 2/3), intercept 1/6; residuals -1/6, 1/3, -1/6, so s^2 = 1/6 with one degree of
  // freedom.
  const std::vector<double> x{0, 1, 2};
  const std::vector<double> y{0, 1, 1};
  const StraightLine line = fitStraightLine(x, y);
  EXPECT_DOUBLE_EQ(line.slope, 0.5);
  EXPECT_NEAR(line.intercept, 1.0 / 6, 1e-15);
  EXPECT_NEAR(line.residual_sd, std::sqrt(1.0 / 6), 1e-15);
  EXPECT_NEAR(line.slope_se, std::sqrt(1.0 / 12), 1e-15);
  EXPECT_NEAR(line.intercept_se, std::sqrt(5.0 / 36), 1e-15);
}

TEST(StraightLine, RefusesTooFewPointsAndOneX) {
  const std::vector<double> two{1, 2};
  const std::vector<double> three{1, 2, 3};
  const std::vector<double> same{1, 1, 1};
  const std::vector<double> broken{1, std::nan(""), 3};
  EXPECT_THROW(static_cast<void>(fitStraightLine(two, two)), InvalidParameter);
  EXPECT_THROW(static_cast<void>(fitStraightLine(three, two)), InvalidParameter);
  EXPECT_THROW(static_cast<void>(fitStraightLine(same, three)), InvalidParameter);
  EXPECT_THROW(static_cast<void>(fitStraightLine(three, broken)), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
