#pragma once

#include <span>
#include <vector>

namespace haptolith {

/// Answers to one stimulus: `k` positive ones of `n`.
struct Level {
  double x = 0;  ///< the stimulus, in the unit of the axis, -kMostStimulus to kMostStimulus
  double k = 0;  ///< positive answers, a whole number, 0 to n
  double n = 0;  ///< answers, a whole number, 0 to kMostAnswers
};

/// More answers to one stimulus determine the fit more closely than its numbers have digits.
inline constexpr double kMostAnswers = 1e9;
/// Larger stimuli, and smaller ones on a logarithmic axis than kLeastStimulus, leave the range of its numbers.
inline constexpr double kMostStimulus = 1e60;
inline constexpr double kLeastStimulus = 1e-60;

/// The levels in ascending order of x, answers to the same stimulus added up, stimuli without an answer left out.
/// Stimuli that differ by rounding, by 1e-12 of themselves, are the same.
/// @throws InvalidParameter unless every x is in its range and k, n are whole numbers with 0 <= k <= n <= kMostAnswers.
[[nodiscard]] std::vector<Level> pooled(std::span<const Level> levels);

/// Levels whose stimuli differ by no more than `tolerance` (in the unit of x) from the first of them taken together, at
/// the mean stimulus of their answers, as psignifit pools; the first is whichever comes first in `levels`. In ascending
/// order of x.
/// @throws InvalidParameter as pooled(), or unless tolerance >= 0.
[[nodiscard]] std::vector<Level> pooledWithin(std::span<const Level> levels, double tolerance);

/// All participants' levels as if they were of one person; see pooled() above.
[[nodiscard]] std::vector<Level> pooled(std::span<const std::vector<Level>> participants);

}  // namespace haptolith
