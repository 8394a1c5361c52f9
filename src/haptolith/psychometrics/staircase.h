#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "haptolith/psychometrics/adaptive_procedure.h"

namespace haptolith {

/// What a staircase looks for.
enum class StaircaseTarget {
  /// The least difference from the reference that is told apart: one staircase above the reference and one below it, in
  /// turns, each with the levels of its side. Right answers lead towards the reference, wrong ones away.
  kDifference,
  /// The point of subjective equality: one staircase over all levels; positive answers lead down, negative ones up.
  kEquality
};

/// A transformed up-down staircase (Levitt 1971, J. Acoust. Soc. Am. 49, 467), over the places of a list of levels.
/// With `up` = 1 it settles where a right (or positive) answer has the probability 2^(-1/down): 0.5 for 1 down, 0.707
/// for 2, 0.794 for 3.
struct StaircaseOptions {
  StaircaseTarget target = StaircaseTarget::kDifference;
  int down = 2;                                ///< right answers in a row that lead a step on, 1 or more
  int up = 1;                                  ///< wrong answers in a row that lead a step back, 1 or more
  std::optional<double> start = std::nullopt;  ///< kEquality: begins at the level nearest to this; else the last level
  int first_step = 2;                          ///< levels at a time until the first reversal
  int step = 1;                                ///< levels at a time afterwards
  int reversals = 8;                           ///< ends a staircase; the first of them do not count
  int uncounted_reversals = 2;
  int most_trials = 80;    ///< of both staircases together
  bool log_axis = false;   ///< means of reversals are taken of ln x
  std::uint64_t seed = 1;  ///< decides which side's turn it is
};

/// A staircase over `levels`. Its estimate is the mean of the reversals that count; from two sides, the threshold is
/// the middle and the JND half the distance, scaled to the 84 % point of a Gaussian. Of kEquality there is no JND: NaN.
/// @param levels  ascending, two or more; for kDifference the reference may be among them and is not shown.
/// @throws InvalidParameter when levels and options make no sense.
[[nodiscard]] std::unique_ptr<AdaptiveProcedure> makeStaircase(const StaircaseOptions& options,
                                                               std::vector<double> levels, double reference);

}  // namespace haptolith
