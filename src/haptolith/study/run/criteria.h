#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "haptolith/study/protocol/protocol.h"
#include "haptolith/study/store/store.h"

namespace haptolith {

/// Number of correct responses, and of all responses.
struct Score {
  int right = 0, of = 0;

  /// Whether the current fraction correct is at least `share`.
  [[nodiscard]] bool reaches(double share) const noexcept { return right >= share * of; }
};

/// Performance of a participant in the trials with a criterion.
struct BlockScores {
  Score practice = {};           ///< in the last complete round of practice
  int practice_rounds = 0;       ///< number of complete rounds
  int practised = 0;             ///< responses in all rounds
  bool practice_is_over = true;  ///< whether the criterion is met or no round is left
  Score caught = {};             ///< in catch trials so far
};

/// Computes the scores of a participant in a block.
/// @param trials       trials of the study, or of the participant.
/// @param block        index in the protocol's blocks. @param participant  ParticipantRow::id.
[[nodiscard]] BlockScores scoresOf(const StudyProtocol& protocol, std::span<const TrialRow> trials, std::size_t block,
                                   std::int64_t participant);

/// Describes the criteria of the block that are not met, such as "catch criterion not met: 3 of 6 right, 0.8 asked
/// for". Empty if all are met, during practice, and before the first response in a catch trial.
[[nodiscard]] std::string criteriaNotMet(const StudyBlock& block, const BlockScores& scores);

/// Returns the number of participants who have finished, for the stopping rule.
[[nodiscard]] int finishedParticipants(std::span<const ParticipantRow> participants);

}  // namespace haptolith
