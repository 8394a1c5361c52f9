#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "haptolith/study/protocol/protocol.h"
#include "haptolith/study/store/store.h"

namespace haptolith {

/// Answers that were right, of how many.
struct Score {
  int right = 0, of = 0;

  /// Whether the share of right ones is at least `share`, so far.
  [[nodiscard]] bool reaches(double share) const noexcept { return right >= share * of; }
};

/// How a participant did where the protocol asks for a share of right answers.
struct BlockScores {
  Score practice = {};           ///< in the last round of practice that is complete
  int practice_rounds = 0;       ///< that are complete
  int practised = 0;             ///< answers in all rounds
  bool practice_is_over = true;  ///< the criterion is reached, or there is no round left
  Score caught = {};             ///< in catch trials so far
};

/// @param trials       the study's, or the participant's.
/// @param block        of the protocol's blocks. @param participant  ParticipantRow::id.
[[nodiscard]] BlockScores scoresOf(const StudyProtocol& protocol, std::span<const TrialRow> trials, std::size_t block,
                                   std::int64_t participant);

/// Which criteria of the block are not met, in words, such as "catch criterion not met: 3 of 6 right, 0.8 asked for";
/// empty when none, or when practice is not over or no catch trial has been answered yet.
[[nodiscard]] std::string criteriaNotMet(const StudyBlock& block, const BlockScores& scores);

/// Participants who have finished, which a stopping rule counts.
[[nodiscard]] int finishedParticipants(std::span<const ParticipantRow> participants);

}  // namespace haptolith
