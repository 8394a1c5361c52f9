#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "haptolith/study/protocol/protocol.h"

namespace haptolith {

/// Kind of a trial. Practice comes first and is not analysed; catch trials are easy trials among the main ones.
enum class TrialKind { kPractice, kMain, kCatch };

/// Planned trial.
struct PlannedTrial {
  TrialKind kind = TrialKind::kMain;
  std::size_t level = 0;    ///< index in the block's levels, or in its practice or catch levels if it has any
  bool test_first = false;  ///< whether the test comes before the reference
  std::uint64_t seed = 0;   ///< below 2^53, so that tables and JSON store it exactly
  int before_main = 0;      ///< for a catch trial of an adaptive block: index of the main trial after it

  [[nodiscard]] bool operator==(const PlannedTrial&) const = default;
};

/// Block in a participant's order. For an adaptive block only practice and catch trials are planned, because the
/// procedure selects the levels of the main trials.
struct PlannedBlock {
  std::size_t block = 0;  ///< index in the protocol's blocks
  std::vector<PlannedTrial> trials = {};
};

/// Returns a participant's complete sequence. It depends only on protocol, study seed and number, and is identical on
/// every machine and after every crash.
/// @param participant_number  1 is the first.
[[nodiscard]] std::vector<PlannedBlock> sequenceFor(const StudyProtocol& protocol, std::uint64_t study_seed,
                                                    int participant_number);

/// As above, for a participant in a group. @param row  row of the Latin square of the group's blocks, see nextRow().
[[nodiscard]] std::vector<PlannedBlock> sequenceIn(const ParticipantGroup& group, int row,
                                                   const StudyProtocol& protocol, std::uint64_t study_seed,
                                                   int participant_number);

/// Returns order and seed of the n-th main trial of an adaptive block, counted from 0. If the order is randomised, one
/// of the trials 2 k and 2 k + 1 has the test first.
[[nodiscard]] PlannedTrial adaptiveTrial(const StudyProtocol& protocol, std::size_t block, std::uint64_t study_seed,
                                         int participant_number, int n, std::size_t level);

/// Returns the test stimulus of a trial.
[[nodiscard]] const Stimulus& testOf(const StudyBlock& block, const PlannedTrial& trial);

/// Returns the seed of an adaptive block's procedure; different for each study, participant and block.
[[nodiscard]] std::uint64_t procedureSeed(std::uint64_t study_seed, int participant_number, std::size_t block);

/// Returns the next participant's number: the smallest above `last` whose row of the Latin square is used least by
/// participants who have not withdrawn. Without a Latin square, or with one per group: the number after `last`.
/// @param kept  numbers of these participants, counted from 1.
[[nodiscard]] int nextNumber(const StudyProtocol& protocol, std::span<const int> kept, int last);

/// Returns the row for the next participant of a group: the first of the rows used least by the group's participants
/// who have not withdrawn. 0 without a Latin square.
/// @param kept  rows of these participants.
[[nodiscard]] int nextRow(const StudyProtocol& protocol, const ParticipantGroup& group, std::span<const int> kept);

/// Returns the orders of `count` blocks that participants get in turn: one Latin square for an even count, two for an
/// odd one. Each block directly follows each other block equally often (Williams 1949).
[[nodiscard]] std::vector<std::vector<std::size_t>> williamsDesign(std::size_t count);

}  // namespace haptolith
