#include "haptolith/study/protocol/sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/study/protocol/random_draws.h"

namespace haptolith {

namespace {

/// Random numbers and seeds of one participant in one block.
class Draw {
 public:
  Draw(std::uint64_t study_seed, int participant_number, std::size_t block)
      : study_seed_(study_seed), participant_(static_cast<std::uint64_t>(participant_number)), block_(block) {}

  [[nodiscard]] std::mt19937_64 random(Purpose purpose) const { return std::mt19937_64(seed(purpose, 0)); }

  [[nodiscard]] std::uint64_t trialSeed(std::uint64_t trial) const { return seed(Purpose::kTrialSeed, trial) >> 11; }

  [[nodiscard]] std::uint64_t seed(Purpose purpose, std::uint64_t number) const {
    return seedOf({study_seed_, participant_, block_, static_cast<std::uint64_t>(purpose), number});
  }

 private:
  std::uint64_t study_seed_, participant_, block_;
};

// Seeds of an adaptive block's main trials begin here, separate from those of its planned trials.
constexpr std::uint64_t kAdaptiveSeeds = std::uint64_t{1} << 32;

/// Returns one trial for each element of `levels`, in random order. The test is first in half of the trials of each
/// level. For odd numbers of trials, the test is first in half of the remaining trials, to within one.
std::vector<PlannedTrial> shuffledTrials(TrialKind kind, const StudyBlock& block,
                                         const std::vector<std::size_t>& levels, std::mt19937_64& random) {
  std::vector<std::size_t> times(levels.empty() ? 0 : *std::ranges::max_element(levels) + 1);
  for (const std::size_t level : levels) {
    ++times[level];
  }
  std::vector<std::size_t> odd_ones;
  for (std::size_t level = 0; level < times.size(); ++level) {
    if (times[level] % 2 == 1) {
      odd_ones.push_back(level);
    }
  }
  shuffle(odd_ones, random);
  const std::size_t either = drawn(random, 2);
  std::vector<std::size_t> with_test_first(times.size());
  for (std::size_t level = 0; level < times.size(); ++level) {
    with_test_first[level] = times[level] / 2;
  }
  for (std::size_t i = 0; i < odd_ones.size(); ++i) {
    with_test_first[odd_ones[i]] += (i + either) % 2;
  }
  std::vector<PlannedTrial> trials;
  for (std::size_t level = 0; level < times.size(); ++level) {
    for (std::size_t i = 0; i < times[level]; ++i) {
      const bool drawn_first = i < with_test_first[level];
      trials.push_back(
          {.kind = kind, .level = level, .test_first = drawn_first && block.task != TaskKind::kReferenceFirst});
    }
  }
  shuffle(trials, random);
  return trials;
}

/// Draws `count` levels as evenly as possible: the numbers of occurrences differ by at most one.
std::vector<std::size_t> evenLevels(std::size_t count, std::size_t level_count, std::mt19937_64& random) {
  std::vector<std::size_t> levels;
  while (levels.size() < count) {
    std::vector<std::size_t> round(level_count);
    std::iota(round.begin(), round.end(), std::size_t{0});
    shuffle(round, random);
    round.resize(std::min(round.size(), count - levels.size()));
    levels.insert(levels.end(), round.begin(), round.end());
  }
  return levels;
}

std::vector<PlannedTrial> mainTrials(const StudyBlock& block, const Draw& draw) {
  if (block.procedure != ProcedureKind::kConstant) {
    return {};
  }
  std::vector<std::size_t> levels;
  for (std::size_t level = 0; level < block.levels.size(); ++level) {
    levels.insert(levels.end(), static_cast<std::size_t>(block.repeats), level);
  }
  std::mt19937_64 random = draw.random(Purpose::kMain);
  return shuffledTrials(TrialKind::kMain, block, levels, random);
}

/// Returns the number of main trials of a block; approximate for an adaptive block.
std::size_t expectedTrials(const StudyBlock& block) {
  switch (block.procedure) {
    case ProcedureKind::kConstant: return block.levels.size() * static_cast<std::size_t>(block.repeats);
    case ProcedureKind::kStaircase: return static_cast<std::size_t>(block.staircase.most_trials);
    case ProcedureKind::kQuestPlus: return static_cast<std::size_t>(block.quest_plus.trials);
  }
  return 0;
}

/// Mixes in the catch trials, at any position after the first main trial.
std::vector<PlannedTrial> withCatchTrials(const StudyBlock& block, std::vector<PlannedTrial> main, const Draw& draw) {
  std::mt19937_64 random = draw.random(Purpose::kCatch);
  const auto count = static_cast<std::size_t>(block.catch_trials);
  const std::vector<std::size_t> levels = block.catch_levels.empty()
                                              ? std::vector<std::size_t>(count, farthestLevel(block))
                                              : evenLevels(count, block.catch_levels.size(), random);
  std::vector<PlannedTrial> easy = shuffledTrials(TrialKind::kCatch, block, levels, random);
  for (PlannedTrial& trial : easy) {
    trial.before_main = static_cast<int>(1 + drawn(random, std::max<std::size_t>(expectedTrials(block), 2) - 1));
  }
  std::ranges::stable_sort(easy, {}, &PlannedTrial::before_main);
  if (block.procedure != ProcedureKind::kConstant) {
    return easy;
  }
  std::ptrdiff_t inserted = 0;
  for (PlannedTrial& trial : easy) {
    main.insert(main.begin() + std::exchange(trial.before_main, 0) + inserted, trial);
    ++inserted;
  }
  return main;
}

PlannedBlock plannedBlock(const StudyProtocol& protocol, std::size_t number, const Draw& draw) {
  const StudyBlock& block = protocol.blocks[number];
  std::mt19937_64 random = draw.random(Purpose::kPractice);
  const std::vector<Stimulus>& shown = block.practice_levels.empty() ? block.levels : block.practice_levels;
  PlannedBlock planned{.block = number};
  for (int round = 0; round < block.practice_rounds; ++round) {
    const std::vector<std::size_t> levels =
        evenLevels(static_cast<std::size_t>(block.practice_trials), shown.size(), random);
    const std::vector<PlannedTrial> trials = shuffledTrials(TrialKind::kPractice, block, levels, random);
    planned.trials.insert(planned.trials.end(), trials.begin(), trials.end());
  }
  const std::vector<PlannedTrial> others = withCatchTrials(block, mainTrials(block, draw), draw);
  planned.trials.insert(planned.trials.end(), others.begin(), others.end());
  for (std::size_t i = 0; i < planned.trials.size(); ++i) {
    planned.trials[i].seed = draw.trialSeed(i);
  }
  return planned;
}

void requireParticipantNumber(int number) {
  if (number < 1) {
    throw InvalidParameter("participant_number", fmt::format("{}", number), ">= 1");
  }
}

/// Returns `blocks` in a participant's order. @param row  row of the Latin square.
std::vector<std::size_t> inOrder(std::vector<std::size_t> blocks, const StudyProtocol& protocol,
                                 std::uint64_t study_seed, int participant_number, int row) {
  if (protocol.order == BlockOrder::kLatinSquare) {
    const auto design = williamsDesign(blocks.size());
    std::vector<std::size_t> order;
    for (const std::size_t place : design[static_cast<std::size_t>(row) % design.size()]) {
      order.push_back(blocks[place]);
    }
    return order;
  }
  if (protocol.order == BlockOrder::kRandom) {
    std::mt19937_64 random = Draw(study_seed, participant_number, 0).random(Purpose::kBlockOrder);
    shuffle(blocks, random);
  }
  return blocks;
}

std::vector<PlannedBlock> planned(const StudyProtocol& protocol, const std::vector<std::size_t>& order,
                                  std::uint64_t study_seed, int participant_number) {
  std::vector<PlannedBlock> sequence;
  sequence.reserve(order.size());
  for (const std::size_t block : order) {
    sequence.push_back(plannedBlock(protocol, block, Draw(study_seed, participant_number, block)));
  }
  return sequence;
}

}  // namespace

std::vector<std::vector<std::size_t>> williamsDesign(std::size_t count) {
  std::vector<std::size_t> first;  // 0, 1, n - 1, 2, n - 2, ...: differences of neighbours are all distinct
  for (std::size_t i = 0; i < count; ++i) {
    first.push_back(i % 2 == 1 ? (i + 1) / 2 : (count - i / 2) % count);
  }
  std::vector<std::vector<std::size_t>> rows;
  for (std::size_t shift = 0; shift < count; ++shift) {
    std::vector<std::size_t> row(count);
    std::ranges::transform(first, row.begin(), [&](std::size_t block) { return (block + shift) % count; });
    rows.push_back(row);
    if (count % 2 == 1 && count > 1) {  // an odd square is balanced only together with its mirror image
      rows.emplace_back(row.rbegin(), row.rend());
    }
  }
  return rows;
}

std::vector<PlannedBlock> sequenceFor(const StudyProtocol& protocol, std::uint64_t study_seed, int participant_number) {
  requireParticipantNumber(participant_number);
  std::vector<std::size_t> all(protocol.blocks.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return planned(protocol, inOrder(all, protocol, study_seed, participant_number, participant_number - 1), study_seed,
                 participant_number);
}

std::vector<PlannedBlock> sequenceIn(const ParticipantGroup& group, int row, const StudyProtocol& protocol,
                                     std::uint64_t study_seed, int participant_number) {
  requireParticipantNumber(participant_number);
  return planned(protocol, inOrder(group.blocks, protocol, study_seed, participant_number, row), study_seed,
                 participant_number);
}

const Stimulus& testOf(const StudyBlock& block, const PlannedTrial& trial) {
  const std::vector<Stimulus>& own = trial.kind == TrialKind::kCatch ? block.catch_levels : block.practice_levels;
  const bool has_own = trial.kind != TrialKind::kMain && !own.empty();
  return (has_own ? own : block.levels).at(trial.level);
}

std::uint64_t procedureSeed(std::uint64_t study_seed, int participant_number, std::size_t block) {
  requireParticipantNumber(participant_number);
  return Draw(study_seed, participant_number, block).seed(Purpose::kProcedure, 0);
}

int nextNumber(const StudyProtocol& protocol, std::span<const int> kept, int last) {
  if (protocol.order != BlockOrder::kLatinSquare || !protocol.groups.empty()) {
    return last + 1;
  }
  const int rows = static_cast<int>(williamsDesign(protocol.blocks.size()).size());
  const auto uses = [&](int number) {
    return std::ranges::count_if(kept, [&](int other) { return (other - number) % rows == 0; });
  };
  int best = last + 1;
  for (int number = last + 2; number <= last + rows; ++number) {
    best = uses(number) < uses(best) ? number : best;
  }
  return best;
}

int nextRow(const StudyProtocol& protocol, const ParticipantGroup& group, std::span<const int> kept) {
  if (protocol.order != BlockOrder::kLatinSquare) {
    return 0;
  }
  std::vector<std::ptrdiff_t> uses;
  for (int row = 0; row < static_cast<int>(williamsDesign(group.blocks.size()).size()); ++row) {
    uses.push_back(std::ranges::count(kept, row));
  }
  return static_cast<int>(std::ranges::min_element(uses) - uses.begin());
}

PlannedTrial adaptiveTrial(const StudyProtocol& protocol, std::size_t block, std::uint64_t study_seed,
                           int participant_number, int n, std::size_t level) {
  requireParticipantNumber(participant_number);
  const Draw draw(study_seed, participant_number, block);
  const auto number = static_cast<std::uint64_t>(n);
  const bool first_of_pair = draw.seed(Purpose::kAdaptiveOrder, number / 2) >> 63 == number % 2;
  return {.kind = TrialKind::kMain,
          .level = level,
          .test_first = first_of_pair && protocol.blocks.at(block).task != TaskKind::kReferenceFirst,
          .seed = draw.trialSeed(kAdaptiveSeeds + number)};
}

}  // namespace haptolith
