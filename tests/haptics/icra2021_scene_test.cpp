// The scene icra2021 in the hand, a minute long: 256 particles of P4 in a box of 126 mm, the shovel of 50 x 40 x 5 mm.

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "haptolith/device/hand/virtual_hand.h"
#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

struct Outcome {
  std::uint64_t hash = 0;
  double largest_force_n = 0;
  double speed_m_s = 0;
  std::uint64_t list_rebuilds = 0;
};

/// Sixty seconds of a motion, the last five or more with the hand away.
Outcome minuteOf(HandMotion motion, HandCompliance compliance) {
  BedParameters bed;
  bed.soil = findPreset("P4").soil;
  Scene scene(bed, {});
  HandParameters hand_parameters;
  hand_parameters.motion = motion;
  hand_parameters.compliance = compliance;
  hand_parameters.surface_m = scene.bed().surfaceHeight();
  hand_parameters.period_s = 5;
  hand_parameters.active_s = 55;  // eleven rounds, then 5 s in which everything has to settle
  VirtualHand hand(hand_parameters, bed.tick_s);
  LoopParameters loop_parameters;
  loop_parameters.real_time = false;
  loop_parameters.duration_s = 60;
  HapticLoop loop(scene, hand, loop_parameters, false);
  const std::atomic<bool> stop{false};
  EXPECT_EQ(loop.run(stop), LoopEnd::kDuration);
  EXPECT_EQ(loop.statistics().ticks(), 60'000U);

  const double half_width = bed.width_m / 2;
  for (std::size_t i = 0; i < scene.bed().particles(); ++i) {
    const Float4& p = scene.bed().state().position[i];
    // NaN is outside too. Spheres overlap walls by a millimetre or two where they are pressed.
    EXPECT_TRUE(std::abs(p.x) < half_width && std::abs(p.y) < half_width && p.z > 0 && p.z < 0.3)
        << "particle " << i << " is lost at " << p.x << " " << p.y << " " << p.z;
  }
  return {scene.hash(), loop.statistics().forceN().max(), scene.bed().largestSpeed(), scene.bed().listRebuilds()};
}

class Icra2021Scene : public testing::TestWithParam<HandMotion> {};

TEST_P(Icra2021Scene, AMinuteLosesNobodyComesToRestAndIsTheSameTwice) {
  const Outcome first = minuteOf(GetParam(), HandCompliance::kArm);
  RecordProperty("largest_force_mn", static_cast<int>(1e3 * first.largest_force_n));
  RecordProperty("list_rebuilds", static_cast<int>(first.list_rebuilds));
  EXPECT_LT(first.speed_m_s, 1e-4) << "5 s after the hand has left";
  EXPECT_GT(first.largest_force_n, 0.05) << "the hand felt nothing";
  EXPECT_LE(first.largest_force_n, 12 + 1e-9);
  EXPECT_GT(first.list_rebuilds, 2000U);
  const Outcome second = minuteOf(GetParam(), HandCompliance::kArm);
  EXPECT_EQ(first.hash, second.hash);
}

INSTANTIATE_TEST_SUITE_P(Motions, Icra2021Scene, testing::Values(HandMotion::kScoop, HandMotion::kStir),
                         [](const auto& motion) { return motion.param == HandMotion::kScoop ? "Scoop" : "Stir"; });

TEST(Icra2021SceneHeldRigid, AMinuteOfStirringLosesNobody) {
  const Outcome outcome = minuteOf(HandMotion::kStir, HandCompliance::kRigid);
  EXPECT_LT(outcome.speed_m_s, 1e-4);
}

}  // namespace
}  // namespace haptolith
