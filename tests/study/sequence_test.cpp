#include "haptolith/study/protocol/sequence.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <set>
#include <vector>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::Le;

constexpr std::uint64_t kSeed = 20261121;

/// A block of `levels` levels at 1, 2, ... and the reference at 0.5; only its design counts here.
StudyBlock aBlock(std::size_t levels, int repeats) {
  StudyBlock block{.name = "a", .reference = {.name = "r", .value = 0.5}, .repeats = repeats};
  for (std::size_t i = 0; i < levels; ++i) {
    block.levels.push_back({.name = std::to_string(i), .value = static_cast<double>(i + 1)});
  }
  return block;
}

StudyProtocol aProtocol(std::size_t blocks, const StudyBlock& block, BlockOrder order = BlockOrder::kFixed) {
  return {.order = order, .blocks = std::vector<StudyBlock>(blocks, block)};
}

std::vector<PlannedTrial> trialsOf(const StudyBlock& block, int participant = 1, std::uint64_t seed = kSeed) {
  return sequenceFor(aProtocol(1, block), seed, participant).at(0).trials;
}

std::vector<std::size_t> levelsOf(const std::vector<PlannedTrial>& trials, TrialKind kind) {
  std::vector<std::size_t> levels;
  for (const PlannedTrial& trial : trials) {
    if (trial.kind == kind) {
      levels.push_back(trial.level);
    }
  }
  return levels;
}

TEST(Sequence, ShowsEachLevelAsOftenAsAsked) {
  for (int participant = 1; participant <= 20; ++participant) {
    std::vector<std::size_t> levels = levelsOf(trialsOf(aBlock(5, 3), participant), TrialKind::kMain);
    std::ranges::sort(levels);
    EXPECT_THAT(levels, ElementsAre(0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4));
  }
}

TEST(Sequence, IsTheSameForTheSameSeedAndParticipant) {
  const StudyProtocol protocol = aProtocol(2, aBlock(5, 3), BlockOrder::kRandom);
  const auto once = sequenceFor(protocol, kSeed, 3);
  const auto again = sequenceFor(protocol, kSeed, 3);
  ASSERT_EQ(once.size(), again.size());
  for (std::size_t i = 0; i < once.size(); ++i) {
    EXPECT_EQ(once[i].block, again[i].block);
    EXPECT_EQ(once[i].trials, again[i].trials);
  }
}

/// Running studies depend on it: a sequence that changes with the program would continue elsewhere.
TEST(Sequence, StaysWhatItHasBeen) {
  StudyBlock block = aBlock(5, 1);
  block.task = TaskKind::kRandomOrder;
  const std::vector<PlannedTrial> trials = trialsOf(block, 1, 1);
  EXPECT_THAT(levelsOf(trials, TrialKind::kMain), ElementsAre(3, 0, 4, 2, 1));
  EXPECT_EQ(trials[0].seed, 2717717093065536U);
}

TEST(Sequence, DiffersBetweenParticipantsBlocksAndStudies) {
  const auto levels = [](const PlannedBlock& block) { return levelsOf(block.trials, TrialKind::kMain); };
  const StudyProtocol protocol = aProtocol(2, aBlock(6, 4));
  const auto one = sequenceFor(protocol, kSeed, 1);
  EXPECT_NE(levels(one[0]), levels(one[1]));
  EXPECT_NE(levels(one[0]), levels(sequenceFor(protocol, kSeed, 2)[0]));
  EXPECT_NE(levels(one[0]), levels(sequenceFor(protocol, kSeed + 1, 1)[0]));
}

TEST(Sequence, PutsEachLevelInEachPlaceAboutEquallyOften) {
  constexpr int kParticipants = 6000;
  std::map<std::size_t, int> first, last;
  for (int participant = 1; participant <= kParticipants; ++participant) {
    const std::vector<PlannedTrial> trials = trialsOf(aBlock(6, 1), participant);
    ++first[trials.front().level];
    ++last[trials.back().level];
  }
  for (std::size_t level = 0; level < 6; ++level) {
    EXPECT_NEAR(first[level], 1000, 150);  // five standard deviations
    EXPECT_NEAR(last[level], 1000, 150);
  }
}

TEST(Sequence, GivesEveryTrialAnotherSeedBelowTheLargest) {
  std::set<std::uint64_t> seeds;
  std::size_t trials = 0;
  const StudyProtocol protocol = aProtocol(3, aBlock(5, 20));
  for (int participant = 1; participant <= 10; ++participant) {
    for (const PlannedBlock& block : sequenceFor(protocol, kSeed, participant)) {
      for (const PlannedTrial& trial : block.trials) {
        EXPECT_LT(trial.seed, std::uint64_t{1} << 53);
        seeds.insert(trial.seed);
        ++trials;
      }
    }
  }
  EXPECT_EQ(trials, 3000U);
  EXPECT_EQ(seeds.size(), trials);
}

// --- order within a trial
// ---------------------------------------------------------------------------------------------

TEST(Sequence, HasTheReferenceFirstWhereThatIsTheTask) {
  StudyBlock block = aBlock(5, 4);
  block.practice_trials = block.catch_trials = 4;
  for (const PlannedTrial& trial : trialsOf(block)) {
    EXPECT_FALSE(trial.test_first);
  }
}

TEST(Sequence, HasTheTestFirstInHalfOfTheTrialsOfEachLevel) {
  for (const TaskKind task : {TaskKind::kRandomOrder, TaskKind::kTwoInterval}) {
    for (const int repeats : {2, 3, 5, 8}) {
      StudyBlock block = aBlock(5, repeats);
      block.task = task;
      for (int participant = 1; participant <= 10; ++participant) {
        std::map<std::size_t, int> balance;
        int whole = 0;
        for (const PlannedTrial& trial : trialsOf(block, participant)) {
          balance[trial.level] += trial.test_first ? 1 : -1;
          whole += trial.test_first ? 1 : -1;
        }
        for (const auto& [level, difference] : balance) {
          EXPECT_EQ(std::abs(difference), repeats % 2) << "level " << level;
        }
        EXPECT_LE(std::abs(whole), repeats % 2);
      }
    }
  }
}

TEST(Sequence, DoesNotTellTheOrderByTheLevelOrByThePlace) {
  StudyBlock block = aBlock(5, 3);
  block.task = TaskKind::kRandomOrder;
  std::map<std::size_t, int> of_level;
  int of_the_first = 0;
  constexpr int kParticipants = 2000;
  for (int participant = 1; participant <= kParticipants; ++participant) {
    const std::vector<PlannedTrial> trials = trialsOf(block, participant);
    of_the_first += trials.front().test_first ? 1 : 0;
    for (const PlannedTrial& trial : trials) {
      of_level[trial.level] += trial.test_first ? 1 : 0;
    }
  }
  EXPECT_NEAR(of_the_first, kParticipants / 2, 120);  // five standard deviations
  for (const auto& [level, count] : of_level) {
    EXPECT_NEAR(count, 3 * kParticipants / 2, 120) << "level " << level;
  }
}

// --- practice and catch trials
// ----------------------------------------------------------------------------------------

TEST(Sequence, BeginsWithPracticeOfLevelsInTurn) {
  StudyBlock block = aBlock(5, 3);
  block.practice_trials = 7;
  const std::vector<PlannedTrial> trials = trialsOf(block);
  ASSERT_EQ(trials.size(), 7U + 15U);
  for (std::size_t i = 0; i < trials.size(); ++i) {
    EXPECT_EQ(trials[i].kind, i < 7 ? TrialKind::kPractice : TrialKind::kMain);
  }
  const std::vector<std::size_t> levels = levelsOf(trials, TrialKind::kPractice);
  for (std::size_t level = 0; level < 5; ++level) {
    EXPECT_GE(std::ranges::count(levels, level), 1);
    EXPECT_LE(std::ranges::count(levels, level), 2);
  }
}

TEST(Sequence, MixesCatchTrialsOfTheFarthestLevelAmongTheOthers) {
  StudyBlock block = aBlock(5, 3);
  block.practice_trials = 2;
  block.catch_trials = 4;
  std::set<std::size_t> places;
  for (int participant = 1; participant <= 200; ++participant) {
    const std::vector<PlannedTrial> trials = trialsOf(block, participant);
    ASSERT_EQ(trials.size(), 2U + 15U + 4U);
    EXPECT_THAT(levelsOf(trials, TrialKind::kCatch), ElementsAre(4, 4, 4, 4));
    EXPECT_EQ(trials[2].kind, TrialKind::kMain);
    EXPECT_EQ(trials.back().kind, TrialKind::kMain);
    for (std::size_t i = 0; i < trials.size(); ++i) {
      if (trials[i].kind == TrialKind::kCatch) {
        places.insert(i);
      }
    }
  }
  EXPECT_EQ(places.size(), 21U - 2U - 2U);  // anywhere but the first and last of the main ones
}

TEST(Sequence, ShowsEachCatchLevelEquallyOften) {
  StudyBlock block = aBlock(5, 3);
  block.catch_trials = 6;
  block.catch_levels = {{.name = "little", .value = 0.1}, {.name = "much", .value = 9}};
  block.practice_trials = 2;
  block.practice_levels = {{.name = "very much", .value = 99}};
  for (int participant = 1; participant <= 20; ++participant) {
    const std::vector<PlannedTrial> trials = trialsOf(block, participant);
    EXPECT_THAT(levelsOf(trials, TrialKind::kCatch), testing::UnorderedElementsAre(0, 0, 0, 1, 1, 1));
    for (const PlannedTrial& trial : trials) {
      const bool is_a_level =
          std::ranges::find(block.levels, testOf(block, trial).name, &Stimulus::name) != block.levels.end();
      EXPECT_EQ(is_a_level, trial.kind == TrialKind::kMain);
      EXPECT_EQ(testOf(block, trial).name == "very much", trial.kind == TrialKind::kPractice);
    }
  }
}

TEST(Sequence, PlansEveryRoundOfPracticeThatMayBeNeeded) {
  StudyBlock block = aBlock(5, 3);
  block.practice_trials = 4;
  const std::vector<PlannedTrial> one_round = trialsOf(block);
  block.practice_rounds = 3;
  const std::vector<PlannedTrial> three_rounds = trialsOf(block);
  ASSERT_EQ(three_rounds.size(), 3U * 4U + 15U);
  EXPECT_TRUE(std::equal(one_round.begin(), one_round.begin() + 4, three_rounds.begin()));
  EXPECT_EQ(three_rounds[11].kind, TrialKind::kPractice);
  EXPECT_EQ(three_rounds[12].kind, TrialKind::kMain);
}

TEST(Sequence, LetsProceduresDrawOtherwiseForEachParticipantBlockAndStudy) {
  std::set<std::uint64_t> seeds;
  for (int participant = 1; participant <= 40; ++participant) {
    for (std::size_t block = 0; block < 2; ++block) {
      seeds.insert({procedureSeed(kSeed, participant, block), procedureSeed(kSeed + 1, participant, block)});
    }
  }
  EXPECT_EQ(seeds.size(), 160U);
  EXPECT_EQ(procedureSeed(kSeed, 3, 1), procedureSeed(kSeed, 3, 1));
}

TEST(Sequence, LeavesTheMainTrialsOfAdaptiveBlocksToTheProcedure) {
  StudyBlock block = aBlock(5, 3);
  block.procedure = ProcedureKind::kStaircase;
  block.staircase.most_trials = 30;
  block.practice_trials = 2;
  block.catch_trials = 3;
  const std::vector<PlannedTrial> trials = trialsOf(block);
  ASSERT_EQ(trials.size(), 5U);
  EXPECT_EQ(trials[1].kind, TrialKind::kPractice);
  for (std::size_t i = 2; i < 5; ++i) {
    EXPECT_EQ(trials[i].kind, TrialKind::kCatch);
    EXPECT_GE(trials[i].before_main, i == 2 ? 1 : trials[i - 1].before_main);
    EXPECT_LT(trials[i].before_main, 30);
  }
}

TEST(Sequence, BalancesTheOrderOfAdaptiveTrialsInPairs) {
  StudyBlock block = aBlock(5, 3);
  block.procedure = ProcedureKind::kQuestPlus;
  block.task = TaskKind::kTwoInterval;
  const StudyProtocol protocol = aProtocol(1, block);
  int first_of_pairs = 0;
  std::set<std::uint64_t> seeds;
  for (int n = 0; n < 400; n += 2) {
    const PlannedTrial one = adaptiveTrial(protocol, 0, kSeed, 1, n, 3);
    const PlannedTrial other = adaptiveTrial(protocol, 0, kSeed, 1, n + 1, 2);
    EXPECT_EQ(one.level, 3U);
    EXPECT_NE(one.test_first, other.test_first);
    EXPECT_EQ(one, adaptiveTrial(protocol, 0, kSeed, 1, n, 3));
    first_of_pairs += one.test_first ? 1 : 0;
    seeds.insert({one.seed, other.seed});
  }
  EXPECT_NEAR(first_of_pairs, 100, 35);  // five standard deviations
  EXPECT_EQ(seeds.size(), 400U);
}

// --- order of the blocks
// ----------------------------------------------------------------------------------------------

TEST(Sequence, LetsHalfOfTheParticipantsStartWithEachOfTwoBlocks) {
  const StudyProtocol protocol = aProtocol(2, aBlock(5, 3), BlockOrder::kLatinSquare);
  int with_the_first = 0;
  for (int participant = 1; participant <= 8; ++participant) {
    const auto sequence = sequenceFor(protocol, kSeed, participant);
    EXPECT_NE(sequence[0].block, sequence[1].block);
    with_the_first += sequence[0].block == 0 ? 1 : 0;
  }
  EXPECT_EQ(with_the_first, 4);
}

TEST(Sequence, KeepsTheTrialsOfABlockWhereverItStands) {
  const auto fixed = sequenceFor(aProtocol(2, aBlock(5, 3)), kSeed, 2);
  const auto turned = sequenceFor(aProtocol(2, aBlock(5, 3), BlockOrder::kLatinSquare), kSeed, 2);
  ASSERT_EQ(turned[0].block, 1U);
  EXPECT_EQ(turned[0].trials, fixed[1].trials);
}

TEST(Sequence, DrawsTheOrderOfBlocks) {
  std::map<std::size_t, int> first;
  const StudyProtocol protocol = aProtocol(3, aBlock(2, 1), BlockOrder::kRandom);
  for (int participant = 1; participant <= 3000; ++participant) {
    ++first[sequenceFor(protocol, kSeed, participant)[0].block];
  }
  for (std::size_t block = 0; block < 3; ++block) {
    EXPECT_NEAR(first[block], 1000, 130);  // five standard deviations
  }
}

TEST(Sequence, RefusesAParticipantWithoutANumber) {
  EXPECT_THROW((void)sequenceFor(aProtocol(1, aBlock(2, 1)), kSeed, 0), InvalidParameter);
}

TEST(WilliamsDesign, HasEachBlockInEachPlaceAndAfterEachOtherEquallyOften) {
  for (std::size_t count = 1; count <= 9; ++count) {
    const auto rows = williamsDesign(count);
    const std::size_t squares = count % 2 == 0 || count == 1 ? 1 : 2;
    ASSERT_EQ(rows.size(), squares * count);
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> in_place, after;
    for (const std::vector<std::size_t>& row : rows) {
      ASSERT_EQ(row.size(), count);
      for (std::size_t i = 0; i < count; ++i) {
        ++in_place[{i, row[i]}];
        if (i > 0) {
          ++after[{row[i - 1], row[i]}];
        }
      }
    }
    EXPECT_EQ(in_place.size(), count * count);
    EXPECT_EQ(after.size(), count * (count - 1));
    for (const auto& [which, times] : in_place) {
      EXPECT_EQ(times, squares);
    }
    for (const auto& [which, times] : after) {
      EXPECT_EQ(times, squares) << count << " blocks";
    }
  }
}

TEST(NextNumber, GivesTheRowThatIsLeastUsedByThoseWhoStay) {
  const ProtocolText text = findProtocol("icra2021");
  const StudyProtocol icra2021 = loadProtocolText(text.text, text.name);
  EXPECT_EQ(nextNumber(icra2021, {}, 0), 1);
  EXPECT_EQ(nextNumber(icra2021, std::array{1}, 1), 2);
  EXPECT_EQ(nextNumber(icra2021, std::array{1, 2}, 2), 3);
  EXPECT_EQ(nextNumber(icra2021, std::array{1}, 2), 4) << "the second withdrew: its order comes again";
  EXPECT_EQ(nextNumber(icra2021, std::array{1, 4}, 4), 5);
  StudyProtocol fixed = icra2021;
  fixed.order = BlockOrder::kFixed;
  EXPECT_EQ(nextNumber(fixed, std::array{1}, 2), 3);
}

}  // namespace
}  // namespace haptolith
