#include "haptolith/haptics/loop_parameters.h"

#include <gtest/gtest.h>

#include <limits>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

TEST(LoopParameters, NonsenseIsRefusedByName) {
  EXPECT_NO_THROW(validate(LoopParameters{}));
  const auto refuses = [](const char* key, double LoopParameters::*member, std::initializer_list<double> values) {
    for (const double value : values) {
      LoopParameters loop;
      loop.*member = value;
      try {
        validate(loop);
        ADD_FAILURE() << key << " = " << value << " passed";
      } catch (const InvalidParameter& error) {
        EXPECT_EQ(error.key(), key);
      }
    }
  };
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  refuses("tick_s", &LoopParameters::tick_s, {kNaN, kInfinity, 0, -1e-3, 1});
  refuses("duration_s", &LoopParameters::duration_s, {kNaN, kInfinity, -1});
  refuses("filter_cutoff_hz", &LoopParameters::filter_cutoff_hz, {kNaN, kInfinity, 0, -30, 500.1});
  EXPECT_NO_THROW(validate(LoopParameters{.cpu = 1023}));
  EXPECT_THROW(validate(LoopParameters{.cpu = 1024}), InvalidParameter);
  EXPECT_THROW(validate(LoopParameters{.cpu = -2}), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
