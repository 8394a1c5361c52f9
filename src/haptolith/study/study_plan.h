#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "haptolith/study/protocol.h"
#include "haptolith/study/simulated_participant.h"

namespace haptolith {

/// How large a study may become.
struct StudySize {
  int participants = 8;
  int repeats = 3;  ///< of each level
};

/// A block of constant stimuli, done again and again by simulated people.
struct PlanParameters {
  ObserverParameters observer = {};
  double spread = 0;                   ///< standard deviation of ln w between people, >= 0
  std::optional<double> against = {};  ///< another Weber fraction, which the study shall tell from the observer's
  int studies = 200;                   ///< of each size
  double confidence = 0.95;
  std::uint64_t seed = 1;
};

/// What becomes of studies of one size: pooled answers, fitted as fitOptionsOf() says.
struct PlanOutcome {
  StudySize size;
  int answers = 0;                       ///< of one study
  double median = 0, low = 0, high = 0;  ///< of the estimated Weber fractions: median, 2.5 % and 97.5 %
  double interval_ratio = 0;             ///< median of upper over lower end of the intervals
  double covered = 0;                    ///< share of the intervals that hold the observer's Weber fraction
  std::optional<double> power;           ///< share of the intervals that leave out `against`
};

/// @param goes_on  asked after each study; false ends the work with Failure.
/// @throws InvalidParameter for a block that is not one of constant stimuli above 0, or parameters out of range.
[[nodiscard]] std::vector<PlanOutcome> planStudy(const StudyBlock& block, const std::vector<StudySize>& sizes,
                                                 const PlanParameters& parameters,
                                                 const std::function<bool()>& goes_on = {});

}  // namespace haptolith
