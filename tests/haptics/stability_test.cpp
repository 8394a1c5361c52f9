// A few settings of the sweep in docs/safety.md: benchmarks/stability.

#include "stability.h"

#include <gtest/gtest.h>

#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

constexpr double kHarmless_j = 1e-3;

class Stability : public testing::TestWithParam<Grip> {
 protected:
  static StabilityResult measure(StabilityCase setting) {
    BedParameters bed;
    bed.soil = findPreset("P1").soil;  // the stickiest: the worst in the sweep
    static const std::vector<Vec3> kAtRest = settled(bed);
    setting.grip = GetParam();
    return measureStability(bed, kAtRest, setting);
  }
};

TEST_P(Stability, TheControllerKeepsALateDirectForceFromGivingEnergy) {
  for (const int delay : {0, 2, 5}) {
    const StabilityResult result = measure({.delay_ticks = delay});
    EXPECT_LT(result.injected_j, kHarmless_j) << delay << " ms";
    EXPECT_EQ(result.end, LoopEnd::kRunning) << delay << " ms";
  }
}

TEST_P(Stability, AVirtualCouplingNeedsNoController) {
  for (const int delay : {0, 5}) {
    const StabilityResult result =
        measure({.delay_ticks = delay, .coupling = CouplingKind::kVirtual, .passivity = false});
    EXPECT_LT(result.injected_j, 1e-2 * kHarmless_j) << delay << " ms";
  }
}

INSTANTIATE_TEST_SUITE_P(Grips, Stability, testing::Values(Grip::kStiff, Grip::kLoose, Grip::kNone, Grip::kLetsGo));

using StabilityWithout = Stability;

TEST_P(StabilityWithout, TheControllerALateForceShakesTheHand) {  // or the tests above could not fail
  EXPECT_GT(measure({.delay_ticks = 5, .passivity = false}).injected_j, 10 * kHarmless_j);
}

INSTANTIATE_TEST_SUITE_P(Grips, StabilityWithout, testing::Values(Grip::kStiff));

}  // namespace
}  // namespace haptolith
