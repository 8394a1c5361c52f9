#include "haptolith/bed/kernel/simd_target.h"

#include <gtest/gtest.h>

namespace haptolith {
namespace {

TEST(SimdTarget, HasANameForPeople) {
  EXPECT_EQ(instructionSetName("AVX3"), "AVX-512");
  EXPECT_EQ(instructionSetName("AVX3_DL"), "AVX-512_DL");
  EXPECT_EQ(instructionSetName("AVX2"), "AVX2");
}

}  // namespace
}  // namespace haptolith
