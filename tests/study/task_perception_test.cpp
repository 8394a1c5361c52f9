#include "haptolith/study/perception/task_perception.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

/// A study with one block of two levels, its bed packed and its hand quick.
StudyProtocol quick(const char* name, std::initializer_list<std::size_t> levels) {
  const ProtocolText text = findProtocol(name);
  StudyProtocol protocol = loadProtocolText(text.text, text.name);
  protocol.scene.bed.start = BedStart::kPacked;  // at rest at once
  protocol.scene.hand.period_s = 1.5;
  StudyBlock& block = protocol.blocks.front();
  std::vector<Stimulus> kept;
  for (const std::size_t level : levels) {
    kept.push_back(block.levels[level]);
  }
  block.levels = kept;
  return protocol;
}

/// Soil of different heights, and a sphere that is lowered to one height for all.
StudyProtocol heights() {
  StudyProtocol protocol = loadProtocolText(
      "title = 'T'\nscene = 'buried-stone'\n[[block]]\nname = 'a'\nquestion = 'q'\nanswers = ['1', '2']\n"
      "varies = 'soil_depth_mm'\nreference = 40\nlevels = [25, 50]\n",
      "t.toml");
  protocol.scene.bed.start = BedStart::kPacked;
  protocol.scene.hand.surface_m = 0.04;
  protocol.scene.hand.period_s = 1.5;
  return protocol;
}

constexpr TaskOptions kQuick{.repeats = 8, .rounds = 1, .beds = 2};

TEST(TaskPerception, ForceTellsAStoneThatIsNear) {
  const StudyProtocol protocol = quick("buried-stone", {0, 5});
  const TaskPerception task = perceiveTask(protocol, protocol.blocks[0], kQuick);
  ASSERT_EQ(task.levels.size(), 2U);
  EXPECT_EQ(task.hand, HandMotion::kPress);
  EXPECT_DOUBLE_EQ(task.duration_s, 1.5);
  EXPECT_EQ(task.levels[1].name, "23");
  EXPECT_GT(task.levels[1].force.d_prime, 2);
  EXPECT_GT(task.levels[1].force.d_prime, task.levels[0].force.d_prime);
  EXPECT_LE(task.levels[1].force.interval.low, task.levels[1].force.d_prime);
  EXPECT_GE(task.levels[1].force.interval.high, task.levels[1].force.d_prime);
}

TEST(TaskPerception, ThePictureTellsHowHighSoilReaches) {
  const StudyProtocol protocol = heights();
  const TaskPerception task = perceiveTask(protocol, protocol.blocks[0], kQuick);
  EXPECT_GT(task.levels[0].picture.d_prime, 1);
  const auto height = std::ranges::find(task.cues, "height", &TaskCue::name);
  ASSERT_NE(height, task.cues.end());
  EXPECT_TRUE(height->is_seen);
  EXPECT_GT(height->levels[1], height->levels[0] + 15);  // 25 and 50 mm, in whole layers
}

TEST(TaskPerception, IsTheSameForAnyNumberOfThreads) {
  const StudyProtocol protocol = heights();
  TaskOptions options{.repeats = 4, .rounds = 1, .beds = 2};
  const TaskPerception one = perceiveTask(protocol, protocol.blocks[0], options);
  options.threads = 3;
  EXPECT_EQ(perceiveTask(protocol, protocol.blocks[0], options).levels[0].force.d_prime, one.levels[0].force.d_prime);
}

TEST(TaskPerception, RefusesNonsenseAndGivesUpWhenAsked) {
  StudyProtocol protocol = heights();
  const StudyBlock& block = protocol.blocks[0];
  EXPECT_THROW((void)perceiveTask(protocol, block, {.repeats = 3}), InvalidParameter);
  EXPECT_THROW((void)perceiveTask(protocol, block, {.beds = 0}), InvalidParameter);
  EXPECT_THROW((void)perceiveTask(protocol, block, {.perceive = {.observer = {}, .sense_scale = 0}}), InvalidParameter);
  EXPECT_THROW((void)perceiveTask(protocol, block, kQuick, [](double) { return false; }), Failure);
  protocol.scene.hand.motion = HandMotion::kPoses;
  EXPECT_THROW((void)perceiveTask(protocol, block, kQuick), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
