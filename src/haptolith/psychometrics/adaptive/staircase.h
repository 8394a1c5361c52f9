#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "haptolith/psychometrics/adaptive/adaptive_procedure.h"

namespace haptolith {

/// What a staircase looks for.
enum class StaircaseTarget {
  /// The least difference from the reference that is told apart: staircases above the reference and below it, each with
  /// the levels of its side, from the farthest. Right answers lead towards the reference, wrong ones away.
  kDifference,
  /// The point of subjective equality: over all levels; positive answers lead down, negative ones up.
  kEquality
};

/// A transformed up-down staircase (Levitt 1971, J. Acoust. Soc. Am. 49, 467), over the places of a list of levels.
/// With `up` = 1 it settles where a right (or positive) answer has the probability 2^(-1/down): 0.5 for 1 down, 0.707
/// for 2, 0.794 for 3.
struct StaircaseOptions {
  StaircaseTarget target = StaircaseTarget::kDifference;
  /// 1 to 10 that take turns, with kDifference on each side of the reference. With kEquality the second, fourth, ...
  /// begin at the first level.
  int staircases = 1;
  int down = 2;                                ///< right answers in a row that lead a step on, 1 or more
  int up = 1;                                  ///< wrong answers in a row that lead a step back, 1 or more
  std::optional<double> start = std::nullopt;  ///< kEquality: begins at the level nearest to this; else the last level
  int first_step = 2;                          ///< levels at a time until the first reversal
  int step = 1;                                ///< levels at a time afterwards
  int reversals = 8;                           ///< ends a staircase; the first of them do not count
  int uncounted_reversals = 2;
  int most_trials = 80;    ///< of all staircases together
  bool log_axis = false;   ///< means of reversals are taken of ln x
  std::uint64_t seed = 1;  ///< draws whose turn it is
};

/// Staircases over `levels`. Whose turn it is is drawn evenly for each trial, but for those that are four answers ahead
/// of another (the big stick of Soares and Wu 1983, Commun. Statist. A 12, 2017): the sides come about equally often,
/// and one trial does not tell the next.
/// The estimate is the mean of the reversals that count; from two sides, the threshold is the middle and the JND half
/// the distance, scaled to the 84 % point of a Gaussian. Of kEquality there is no JND: NaN. Coarse levels and the ends
/// of the ladder shift it: procedureEstimates() tells what all answers together say.
/// @param levels  ascending, two or more; for kDifference the reference may be among them and is not shown.
/// @throws InvalidParameter when levels and options make no sense.
[[nodiscard]] std::unique_ptr<AdaptiveProcedure> makeStaircase(const StaircaseOptions& options,
                                                               const std::vector<double>& levels, double reference);

}  // namespace haptolith
