#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "haptolith/study/protocol/protocol.h"

namespace haptolith {

/// Practice comes first and counts for nothing; catch trials are easy ones among the main ones.
enum class TrialKind { kPractice, kMain, kCatch };

/// A trial before it is run.
struct PlannedTrial {
  TrialKind kind = TrialKind::kMain;
  std::size_t level = 0;    ///< of the block's levels; of practice and catch trials, of theirs if it has any
  bool test_first = false;  ///< whether the test comes before the reference
  std::uint64_t seed = 0;   ///< below 2^53: tables and JSON keep it exactly
  int before_main = 0;      ///< a catch trial of an adaptive block comes before this main trial, counted from 0

  [[nodiscard]] bool operator==(const PlannedTrial&) const = default;
};

/// A block at its place in a participant's order. The main trials of an adaptive block are not planned, since their
/// level is the procedure's: its trials are the practice and the catch trials.
struct PlannedBlock {
  std::size_t block = 0;  ///< of the protocol's blocks
  std::vector<PlannedTrial> trials = {};
};

/// A participant's whole sequence. Same protocol, study seed and number: the same sequence, on every machine and after
/// every crash.
/// @param participant_number  1 is the first.
[[nodiscard]] std::vector<PlannedBlock> sequenceFor(const StudyProtocol& protocol, std::uint64_t study_seed,
                                                    int participant_number);

/// The same of somebody in a group. @param row  of the Latin square of the group's blocks, see nextRow().
[[nodiscard]] std::vector<PlannedBlock> sequenceIn(const ParticipantGroup& group, int row,
                                                   const StudyProtocol& protocol, std::uint64_t study_seed,
                                                   int participant_number);

/// The n-th main trial of an adaptive block, counted from 0: its order and seed. Of trials 2 k and 2 k + 1, one has the
/// test first if the task's order is drawn.
[[nodiscard]] PlannedTrial adaptiveTrial(const StudyProtocol& protocol, std::size_t block, std::uint64_t study_seed,
                                         int participant_number, int n, std::size_t level);

/// The test stimulus of a trial.
[[nodiscard]] const Stimulus& testOf(const StudyBlock& block, const PlannedTrial& trial);

/// What an adaptive block's procedure draws with: another number for each study, participant and block.
[[nodiscard]] std::uint64_t procedureSeed(std::uint64_t study_seed, int participant_number, std::size_t block);

/// The number that the next participant gets: the least above `last` whose row of the Latin square is the least used by
/// those who have not withdrawn; the next one where there is no such square, and where groups have squares of their
/// own.
/// @param kept  their numbers, 1 is the first.
[[nodiscard]] int nextNumber(const StudyProtocol& protocol, std::span<const int> kept, int last);

/// The row that the next participant of a group gets: the first that is the least used by those of the group who have
/// not withdrawn. 0 where there is no Latin square.
/// @param kept  their rows.
[[nodiscard]] int nextRow(const StudyProtocol& protocol, const ParticipantGroup& group, std::span<const int> kept);

/// The orders of `count` blocks that participants take in turn: a Latin square for an even count, a pair of them for
/// an odd one, in which each block follows each other equally often (Williams 1949).
[[nodiscard]] std::vector<std::vector<std::size_t>> williamsDesign(std::size_t count);

}  // namespace haptolith
