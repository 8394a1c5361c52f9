// A few settings of the sweep in docs/reports/stability.md: benchmarks/stability.

#include "stability.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>

#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

constexpr double kHarmless_j = 1e-3;

struct NamedHand {
  HoldingHand hand;
};

void PrintTo(const NamedHand& named, std::ostream* out) {
  *out << named.hand.name;
}

class Stability : public testing::TestWithParam<NamedHand> {
 protected:
  static StabilityResult measure(StabilityCase setting) {
    BedParameters bed;
    bed.soil = findPreset("P1").soil;  // the stickiest: the worst in the sweep
    static const LyingSoil kAtRest = settled(bed);
    setting.hand = GetParam().hand;
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

INSTANTIATE_TEST_SUITE_P(Grips, Stability,
                         testing::Values(NamedHand{kStiffHand}, NamedHand{kLooseHand}, NamedHand{kNoHand},
                                         NamedHand{kOpeningHand}));

/// A device behind a socket: its delay and noise are unknown.
class UnknownDevice : public Stability {
 protected:
  static StabilityCase unknown(int delay_ticks, double step_m, double noise_m) {
    StabilityCase setting;
    setting.handle_kg = 0.1;
    setting.delay_ticks = delay_ticks;
    setting.declared_ticks = 10;
    setting.step_m = step_m;
    setting.noise_m = noise_m;
    setting.resolution_m = 1e-4;
    setting.coupling = CouplingKind::kVirtual;
    return setting;
  }
};

TEST_P(UnknownDevice, GivesAHandNoEnergyWhateverItsDelayStepsAndNoise) {
  for (const int delay : {0, 10}) {  // benchmarks/stability --unknown has the others
    for (const double noise_m : {0.0, 1e-4}) {
      const StabilityResult result = measure(unknown(delay, 6e-5, noise_m));
      EXPECT_LT(result.injected_j, kHarmless_j) << delay << " ms, noise of " << noise_m;
      EXPECT_LT(result.vibration_m, 0.2e-3) << delay << " ms, noise of " << noise_m;
    }
  }
}

TEST_P(UnknownDevice, LosesNoForceWhereNothingShakes) {
  for (const double step_m : {0.0, 6e-5}) {
    const StabilityResult result = measure(unknown(0, step_m, 0));
    StabilityCase without = unknown(0, step_m, 0);
    without.passivity = false;
    EXPECT_GT(result.held_n, 0.95 * measure(without).held_n) << step_m;
  }
}

INSTANTIATE_TEST_SUITE_P(Grips, UnknownDevice,
                         testing::Values(NamedHand{kLightHands[0]}, NamedHand{kLightHands[1]},
                                         NamedHand{kLightHands[2]}, NamedHand{kLightHands[3]}));

/// 15 mm deep in contact soil on Earth, or dropped onto it: the worst of benchmarks/stability --released.
TEST(ReleasedHandle, GetsLittleWorkFromAForceOfUnknownDelay) {
  BedParameters bed;
  bed.soil = findPreset("P6").soil;
  bed.soil.friction = FrictionModel::kContact;
  bed.soil.stiffness_n_m = 3000;
  bed.gravity_m_s2 = {0, 0, -9.81};
  const LyingSoil lying = settled(bed);
  double most_j = 0, most_without_j = 0;
  for (const HoldingHand& hand : kReleasedHands) {
    for (const int delay : {0, 5, 10}) {
      StabilityCase setting{.hand = hand, .delay_ticks = delay, .declared_ticks = 10, .resolution_m = 1e-4};
      setting.handle_kg = 0.1;
      setting.coupling = CouplingKind::kVirtual;
      most_j = std::max(most_j, measureStability(bed, lying, setting).after_release_j);
      setting.passivity = false;
      most_without_j = std::max(most_without_j, measureStability(bed, lying, setting).after_release_j);
    }
  }
  EXPECT_LT(most_j, 5e-3);
  EXPECT_GT(most_without_j, 8e-3) << "or this could not fail";
}

using StabilityWithout = Stability;

TEST_P(StabilityWithout, TheControllerALateForceShakesTheHand) {  // or the tests above could not fail
  EXPECT_GT(measure({.delay_ticks = 5, .passivity = false}).injected_j, 10 * kHarmless_j);
}

INSTANTIATE_TEST_SUITE_P(Grips, StabilityWithout, testing::Values(NamedHand{kStiffHand}));

}  // namespace
}  // namespace haptolith
