#include "haptolith/study/run/criteria.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace haptolith {

namespace {

void add(Score& score, const TrialAnswer& answer) {
  ++score.of;
  score.right += answer.correct.value_or(false) ? 1 : 0;
}

}  // namespace

BlockScores scoresOf(const StudyProtocol& protocol, std::span<const TrialRow> trials, std::size_t block,
                     std::int64_t participant) {
  const StudyBlock& design = protocol.blocks.at(block);
  BlockScores scores;
  Score round;
  for (const TrialRow& trial : trials) {
    if (trial.participant != participant || trial.block != block || trial.state != TrialState::kAnswered ||
        !trial.answer) {
      continue;
    }
    if (trial.kind == TrialKind::kCatch) {
      add(scores.caught, *trial.answer);
    } else if (trial.kind == TrialKind::kPractice) {
      ++scores.practised;
      add(round, *trial.answer);
      if (round.of == design.practice_trials) {
        ++scores.practice_rounds;
        scores.practice = std::exchange(round, {});
      }
    }
  }
  scores.practice_is_over =
      round.of == 0 && (design.practice_trials == 0 || scores.practice_rounds >= design.practice_rounds ||
                        (scores.practice_rounds > 0 && scores.practice.reaches(design.practice_criterion)));
  return scores;
}

std::string criteriaNotMet(const StudyBlock& block, const BlockScores& scores) {
  const auto missed = [](const char* what, const Score& score, double share) {
    return score.of == 0 || score.reaches(share)
               ? std::string()
               : fmt::format("{} criterion not met: {} of {} correct, {} required", what, score.right, score.of, share);
  };
  const std::string practice =
      scores.practice_is_over ? missed("practice", scores.practice, block.practice_criterion) : "";
  const std::string caught = missed("catch", scores.caught, block.catch_criterion);
  return practice.empty() || caught.empty() ? practice + caught : practice + "; " + caught;
}

int finishedParticipants(std::span<const ParticipantRow> participants) {
  return static_cast<int>(std::ranges::count(participants, "finished", &ParticipantRow::state));
}

}  // namespace haptolith
