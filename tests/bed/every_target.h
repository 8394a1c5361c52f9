#pragma once

#include <gtest/gtest.h>
#include <hwy/detect_targets.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "haptolith/bed/kernel/simd_target.h"

namespace haptolith {

/// Runs the body once for every instruction set that is compiled in and that this machine has.
class EveryTarget : public testing::Test {
 protected:
  template <class Body>
  void forEachTarget(const Body& body) {
    std::vector<std::string> seen;
    for (std::int64_t targets = hwy::SupportedTargets() & HWY_TARGETS; targets != 0; targets &= targets - 1) {
      hwy::SetSupportedTargetsForTest(targets & -targets);
      SCOPED_TRACE(simdTarget());
      seen.emplace_back(simdTarget());
      body();
      hwy::SetSupportedTargetsForTest(0);
    }
    EXPECT_GE(seen.size(), 1U);
    std::ranges::sort(seen);
    EXPECT_TRUE(std::ranges::adjacent_find(seen) == seen.end()) << "one target was tested twice";
  }

  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
};

}  // namespace haptolith
