#pragma once

#include <span>
#include <vector>

namespace haptolith {

/// Responses to one stimulus: `k` positive ones of `n`.
struct Level {
  double x = 0;  ///< stimulus, in the unit of the axis, -kMostStimulus to kMostStimulus
  double k = 0;  ///< number of positive responses, a whole number, 0 to n
  double n = 0;  ///< number of responses, a whole number, 0 to kMostAnswers
};

/// Max. number of responses to one stimulus; more would exceed the precision of the fit.
inline constexpr double kMostAnswers = 1e9;
/// Max. absolute stimulus; this and kLeastStimulus on a logarithmic axis keep the fit in the range of its numbers.
inline constexpr double kMostStimulus = 1e60;
inline constexpr double kLeastStimulus = 1e-60;

/// Returns the levels in ascending order of x, with responses to equal stimuli added; stimuli without responses are
/// left out. Stimuli with a relative difference of 1e-12 count as equal.
/// @throws InvalidParameter unless every x is in its range and k, n are whole numbers with 0 <= k <= n <= kMostAnswers.
[[nodiscard]] std::vector<Level> pooled(std::span<const Level> levels);

/// Pools levels as psignifit does: those within `tolerance` (in the unit of x) of the first one in `levels`, at the
/// mean stimulus of their responses. Returns them in ascending order of x.
/// @throws InvalidParameter as pooled(), or unless tolerance >= 0.
[[nodiscard]] std::vector<Level> pooledWithin(std::span<const Level> levels, double tolerance);

/// As above, for the levels of all participants as those of one participant.
[[nodiscard]] std::vector<Level> pooled(std::span<const std::vector<Level>> participants);

}  // namespace haptolith
