#include "haptolith/psychometrics/levels.h"

#include <gmock/gmock.h>

#include <cmath>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

TEST(Levels, AnswersToTheSameStimulusAreAddedUpInAscendingOrder) {
  const std::vector<Level> levels = pooled(std::vector<Level>{{2, 1, 3}, {1, 0, 1}, {2, 2, 2}, {3, 0, 0}});
  ASSERT_EQ(levels.size(), 2u);
  EXPECT_EQ(levels[0].x, 1);
  EXPECT_EQ(levels[1].k, 3);
  EXPECT_EQ(levels[1].n, 5);
}

TEST(Levels, ParticipantsArePooledAsOnePerson) {
  const std::vector<std::vector<Level>> two{{{1, 1, 3}, {2, 3, 3}}, {{1, 0, 3}}};
  const std::vector<Level> levels = pooled(two);
  ASSERT_EQ(levels.size(), 2u);
  EXPECT_EQ(levels[0].k, 1);
  EXPECT_EQ(levels[0].n, 6);
}

TEST(Levels, ImpossibleCountsAreRefused) {
  for (const Level& level : {Level{1, 4, 3}, Level{1, -1, 3}, Level{1, 0.5, 3}, Level{1, 1, 2.5}, Level{1, 0, -1},
                             Level{std::nan(""), 1, 2}}) {
    EXPECT_THROW((void)pooled(std::vector{level}), InvalidParameter);
  }
}

}  // namespace
}  // namespace haptolith
