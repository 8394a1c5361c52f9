#include "haptolith/core/error.h"

#include <gmock/gmock.h>

#include <limits>

namespace haptolith {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(InvalidParameter, SaysWhichKeyWhatValueAndWhatWouldBeValid) {
  const InvalidParameter error("depth_m", "0.7", "0 to 0.6");
  EXPECT_STREQ(error.what(), "depth_m = 0.7 is not valid: must be 0 to 0.6");
  EXPECT_EQ(error.key(), "depth_m");
  EXPECT_EQ(error.value(), "0.7");
  EXPECT_EQ(error.valid(), "0 to 0.6");
}

TEST(RefusedAction, ReportsItsMessageAlone) {
  const RefusedAction refused("undo", "nothing to undo: the bed has not been changed");
  EXPECT_STREQ(refused.what(), "nothing to undo: the bed has not been changed");
  EXPECT_EQ(refused.key(), "undo");
  const InvalidParameter& wrong_use = refused;  // equal exit status and error code of the library
  EXPECT_STREQ(wrong_use.what(), refused.what());
}

TEST(Range, IsWrittenAsAPersonWouldSayIt) {
  EXPECT_EQ((Range{0, 0.6}.text()), "0 to 0.6");
  EXPECT_EQ((Range{0, 0.6, Ends::kOpen}.text()), "> 0 and < 0.6");
  EXPECT_EQ((Range{0, 0.6, Ends::kOpenBelow}.text()), "> 0 and <= 0.6");
  EXPECT_EQ((Range{0, kInfinity}.text()), ">= 0");
  EXPECT_EQ((Range{0, kInfinity, Ends::kOpen}.text()), "> 0");
  EXPECT_EQ((Range{-kInfinity, 5}.text()), "<= 5");
  EXPECT_EQ(Range{}.text(), "a finite number");
}

TEST(Range, ContainsItsEndsOnlyWhenTheyAreClosed) {
  const Range closed{1, 2};
  EXPECT_TRUE(closed.contains(1));
  EXPECT_TRUE(closed.contains(2));
  EXPECT_FALSE(closed.contains(2.0000001));
  const Range open{1, 2, Ends::kOpen};
  EXPECT_FALSE(open.contains(1));
  EXPECT_FALSE(open.contains(2));
  EXPECT_TRUE(open.contains(1.5));
  const Range open_below{1, 2, Ends::kOpenBelow};
  EXPECT_FALSE(open_below.contains(1));
  EXPECT_TRUE(open_below.contains(2));
}

TEST(RequireInRange, GivesTheValueBack) {
  EXPECT_EQ(requireInRange("mass_kg", 0.5, {0, 1}), 0.5);
}

TEST(RequireInRange, RefusesWhatLiesOutside) {
  EXPECT_THROW(requireInRange("mass_kg", -0.1, {0, 1}), InvalidParameter);
  EXPECT_THROW(requireInRange("mass_kg", 1.1, {0, 1}), InvalidParameter);
}

TEST(RequireInRange, RefusesNanAndInfinityEvenWithoutLimits) {
  EXPECT_THROW(requireInRange("mass_kg", kNan, Range{}), InvalidParameter);
  EXPECT_THROW(requireInRange("mass_kg", kInfinity, Range{}), InvalidParameter);
  EXPECT_THROW(requireInRange("mass_kg", -kInfinity, Range{}), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
