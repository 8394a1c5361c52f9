#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "haptolith/psychometrics/fit.h"
#include "haptolith/study/protocol/protocol.h"
#include "haptolith/study/run/simulated_participant.h"

namespace haptolith {

/// How large a study may become.
struct StudySize {
  int participants = 8;
  int repeats = 3;  ///< of each level
};

/// A block of constant stimuli, done again and again by simulated people.
struct PlanParameters {
  ObserverParameters observer = {};    ///< the person in the middle
  double spread = 0;                   ///< standard deviation of ln w between people, >= 0
  std::optional<double> against = {};  ///< another Weber fraction, which the study shall tell from the observer's
  std::optional<double> width = {};    ///< of the interval, from end to end as a share of the estimate, that is wanted
  int studies = 200;                   ///< of each size
  double confidence = 0.95;
  std::uint64_t seed = 1;
};

/// A share of simulated studies, and where it lies for studies without end (Wilson's interval of 95 %).
struct SimulatedShare {
  double value = 0;
  Interval interval = {};
};

/// What becomes of studies of one size, each fitted as `study figure` does: several people by fitGroup(), with PSE and
/// lapse rate free, one person by fitOptionsOf().
struct PlanOutcome {
  StudySize size;
  int answers = 0;                       ///< of one study
  double median = 0, low = 0, high = 0;  ///< of the estimated Weber fractions: median, 2.5 % and 97.5 %
  double interval_width = 0;             ///< median of the intervals' lengths as shares of their estimates
  SimulatedShare covered;                ///< intervals that hold the observer's Weber fraction
  /// Intervals that leave out `against` on the side of the observer's Weber fraction; where both are the same, on
  /// either.
  std::optional<SimulatedShare> power;
  std::optional<SimulatedShare> narrow;  ///< intervals that are at most as long as `width`
};

/// @param goes_on  asked after each study; false ends the work with Failure.
/// @throws InvalidParameter for a block that is not one of constant stimuli above 0, or parameters out of range.
[[nodiscard]] std::vector<PlanOutcome> planStudy(const StudyBlock& block, const std::vector<StudySize>& sizes,
                                                 const PlanParameters& parameters,
                                                 const std::function<bool()>& goes_on = {});

/// The most participants that leastParticipants() tries.
inline constexpr int kMostParticipants = 500;

/// The least number of participants, up to kMostParticipants, with which as many studies as `share` have the power (or
/// narrow intervals) that is wanted: every size that was tried, in the order of their participants.
/// @param parameters  with `against` or `width`. @param share  between 0 and 1, both excluded.
/// @throws InvalidParameter as planStudy(); Failure when that many do not suffice.
[[nodiscard]] std::vector<PlanOutcome> leastParticipants(const StudyBlock& block, int repeats,
                                                         const PlanParameters& parameters, double share,
                                                         const std::function<bool()>& goes_on = {});

/// The share of studies that succeed: of those with the power, or else with narrow intervals. @pre one of them is
/// there.
[[nodiscard]] const SimulatedShare& successOf(const PlanOutcome& outcome);

}  // namespace haptolith
