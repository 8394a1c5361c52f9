#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "haptolith/psychometrics/adaptive/adaptive_procedure.h"

namespace haptolith {

/// Target of a staircase.
enum class StaircaseTarget {
  /// Smallest discriminated difference from the reference. Staircases above and below the reference use the levels of
  /// their side, from the farthest. Correct responses lead towards the reference, wrong ones away.
  kDifference,
  /// Point of subjective equality, over all levels. Positive responses lead down, negative ones up.
  kEquality
};

/// Options of a transformed up-down staircase (Levitt 1971, J. Acoust. Soc. Am. 49, 467), over a list of levels. With
/// `up` = 1 it converges to the probability 2^(-1/down) of a correct (or positive) response: 0.5 for 1 down, 0.707 for
/// 2, 0.794 for 3.
struct StaircaseOptions {
  StaircaseTarget target = StaircaseTarget::kDifference;
  /// Number of interleaved staircases, 1 to 10; for kDifference on each side of the reference. For kEquality the
  /// second, fourth, ... begin at the first level.
  int staircases = 1;
  int down = 2;                                ///< correct responses in a row for a step forward, 1 or more
  int up = 1;                                  ///< wrong responses in a row for a step back, 1 or more
  std::optional<double> start = std::nullopt;  ///< kEquality: begins at the nearest level; otherwise at the last level
  int first_step = 2;                          ///< step in levels until the first reversal
  int step = 1;                                ///< step in levels afterwards
  int reversals = 8;  ///< number of reversals that ends a staircase; the first ones do not count
  int uncounted_reversals = 2;
  int most_trials = 80;    ///< limit for all staircases together
  bool log_axis = false;   ///< means of reversals use ln x
  std::uint64_t seed = 1;  ///< seed of the turns
};

/// Creates staircases over `levels`. The staircase of each trial is drawn uniformly from all but those that are four
/// responses ahead of another (the big stick of Soares and Wu 1983, Commun. Statist. A 12, 2017). So the sides are
/// about equally frequent, and a trial does not predict the next one.
///
/// The estimate is the mean of the counted reversals. From two sides, the threshold is their centre and the JND half
/// their distance, scaled to the 84 % point of a Gaussian. For kEquality the JND is NaN. Coarse levels and the ends of
/// the ladder bias it: procedureEstimates() uses all responses.
/// @param levels  ascending, two or more; for kDifference the reference may be among them and is not presented.
/// @throws InvalidParameter for invalid levels or options.
[[nodiscard]] std::unique_ptr<AdaptiveProcedure> makeStaircase(const StaircaseOptions& options,
                                                               const std::vector<double>& levels, double reference);

}  // namespace haptolith
