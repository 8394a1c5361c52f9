#include "haptolith/study/run/simulated_rig.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "haptolith/core/error.h"

#include "a_study.h"

namespace haptolith {
namespace {

constexpr ExplorationOptions kStir{.motion = HandMotion::kStir, .rounds = 1};

const Stimulus& levelNamed(const StudyBlock& block, std::string_view name) {
  return *std::ranges::find(block.levels, name, &Stimulus::name);
}

TEST(SimulatedRig, FeelsTheStimulusThatIsShown) {
  const StudyProtocol protocol = loadProtocolText(kTwoBlocks, "two.toml");
  const StudyBlock& friction = protocol.blocks[0];
  SimulatedRig rig(protocol, kStir);
  rig.show(friction, friction.reference);
  ASSERT_TRUE(rig.ready());
  rig.feel();
  const TrialSummary summary = rig.rest();
  EXPECT_EQ(summary.mean_force_n, explore(sceneOf(protocol, friction, friction.reference), kStir).summary.mean_force_n);

  rig.show(friction, levelNamed(friction, "P1"));
  rig.feel();
  EXPECT_GT(rig.rest().mean_force_n, 1.1 * summary.mean_force_n);
}

TEST(SimulatedRig, ExploresAnewEachTime) {
  const StudyProtocol protocol = loadProtocolText(kTwoBlocks, "two.toml");
  SimulatedRig rig(protocol, kStir);
  SimulatedRig same(protocol, kStir);
  double before_n = 0;
  for (int trial = 0; trial < 3; ++trial) {
    for (SimulatedRig* each : {&rig, &same}) {
      each->show(protocol.blocks[0], protocol.blocks[0].reference);
      each->feel();
    }
    const double felt_n = rig.rest().mean_force_n;
    EXPECT_EQ(same.rest().mean_force_n, felt_n);
    EXPECT_NE(felt_n, before_n);
    before_n = felt_n;
  }
}

TEST(SimulatedRig, RefusesHandsThatCannotExplore) {
  const StudyProtocol protocol = loadProtocolText(kTwoBlocks, "two.toml");
  EXPECT_THROW(SimulatedRig(protocol, {.motion = HandMotion::kPoses}), InvalidParameter);
}

// The rod of a built-in protocol lies flat on the soil when it stirs, and is felt by chance.
TEST(SimulatedRig, RefusesAtOnceAHandThatStaysAboveTheSoil) {
  const ProtocolText text = findProtocol("buried-stone");
  const StudyProtocol protocol = loadProtocolText(text.text, text.name);
  try {
    const SimulatedRig rig(protocol, kStir);
    FAIL() << "taken";
  } catch (const InvalidParameter& error) {
    EXPECT_NE(std::string(error.what()).find("stir, which moves the tool"), std::string::npos) << error.what();
  }
  EXPECT_NO_THROW(SimulatedRig(protocol, {.motion = HandMotion::kPress}));
  for (const char* name : {"icra2021", "icra2021-friction", "icra2021-gravity"}) {
    const ProtocolText other = findProtocol(name);
    EXPECT_NO_THROW(SimulatedRig(loadProtocolText(other.text, other.name), kStir)) << name;
  }
}

}  // namespace
}  // namespace haptolith
