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

TEST(Levels, WithinAToleranceAreTakenTogetherAtTheirMean) {
  // 1.04 is within 0.05 of the first, 1.06 is not, though it is within 0.05 of the second.
  const std::vector<Level> levels =
      pooledWithin(std::vector<Level>{{1, 1, 1}, {1.04, 0, 3}, {1.06, 1, 1}, {0.97, 1, 1}, {5, 0, 0}}, 0.05);
  ASSERT_EQ(levels.size(), 2u);
  EXPECT_NEAR(levels[0].x, (1 + 3 * 1.04 + 0.97) / 5, 1e-12);
  EXPECT_EQ(levels[0].k, 2);
  EXPECT_EQ(levels[0].n, 5);
  EXPECT_EQ(levels[1].x, 1.06);
  EXPECT_THROW((void)pooledWithin(std::vector<Level>{{1, 1, 1}}, -0.1), InvalidParameter);
}

TEST(Levels, OfWhichTheFirstComesFirstDecides) {
  const std::vector<Level> upward = pooledWithin(std::vector<Level>{{1, 0, 1}, {1.04, 0, 1}, {1.08, 0, 1}}, 0.05);
  const std::vector<Level> from_middle = pooledWithin(std::vector<Level>{{1.04, 0, 1}, {1, 0, 1}, {1.08, 0, 1}}, 0.05);
  EXPECT_EQ(upward.size(), 2u);
  EXPECT_EQ(from_middle.size(), 1u);
}

TEST(Levels, ImpossibleCountsAreRefused) {
  for (const Level& level : {Level{1, 4, 3}, Level{1, -1, 3}, Level{1, 0.5, 3}, Level{1, 1, 2.5}, Level{1, 0, -1},
                             Level{std::nan(""), 1, 2}, Level{1, 1, 1.1e9}, Level{1e61, 1, 2}}) {
    EXPECT_THROW((void)pooled(std::vector{level}), InvalidParameter);
  }
}

TEST(Levels, ThatDifferByRoundingAreOne) {
  const std::vector<Level> levels = pooled(std::vector<Level>{{0.1 + 0.2, 1, 3}, {0.3, 2, 4}, {0.3001, 1, 1}});
  ASSERT_EQ(levels.size(), 2U);
  EXPECT_EQ(levels[0].x, 0.3);
  EXPECT_EQ(levels[0].k, 3);
  EXPECT_EQ(levels[0].n, 7);
  EXPECT_THROW((void)pooled(std::vector<Level>{{1, 1, 6e8}, {1, 1, 6e8}}), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
