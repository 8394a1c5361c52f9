#include "haptolith/core/median.h"

#include <gmock/gmock.h>

#include <cmath>

namespace haptolith {
namespace {

TEST(Median, IsTheMiddleOneOrTheMeanOfTheMiddleTwo) {
  EXPECT_EQ(median({3}), 3);
  EXPECT_EQ(median({5, 1, 3}), 3);
  EXPECT_EQ(median({4, 1, 2, 100}), 3);
  EXPECT_EQ(median({2, 2, 2, 2}), 2);
  EXPECT_TRUE(std::isnan(median({})));
}

}  // namespace
}  // namespace haptolith
