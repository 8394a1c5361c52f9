#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "haptolith/psychometrics/fit.h"
#include "haptolith/study/protocol/protocol.h"
#include "haptolith/study/run/simulated_participant.h"

namespace haptolith {

/// Size of a study.
struct StudySize {
  int participants = 8;
  int repeats = 3;  ///< repeats of each level
};

/// Parameters of repeated simulations of a block of constant stimuli.
struct PlanParameters {
  ObserverParameters observer = {};        ///< the median participant
  double between_sd = 0;                   ///< SD of ln w between participants, >= 0
  std::optional<double> alternative = {};  ///< another Weber fraction, to be distinguished from the observer's
  std::optional<double> width = {};        ///< required width of the interval, relative to the estimate
  int studies = 200;                       ///< simulated studies of each size
  double confidence = 0.95;
  std::uint64_t seed = 1;
};

/// Fraction of simulated studies, with its 95 % interval (Wilson) for the limit of infinitely many.
struct SimulatedShare {
  double value = 0;
  Interval interval = {};
};

/// Results of simulated studies of one size, fitted as `study figure` does: several participants by fitGroup(), with
/// free PSE and lapse rate; a single one by fitOptionsOf().
struct PlanOutcome {
  StudySize size;
  int answers = 0;                       ///< responses in one study
  double median = 0, low = 0, high = 0;  ///< estimated Weber fractions: median, 2.5 % and 97.5 % quantile
  double interval_width = 0;             ///< median width of the intervals relative to their estimates
  SimulatedShare covered;                ///< intervals that contain the observer's Weber fraction
  /// Intervals that exclude the alternative on the side of the observer's Weber fraction; if both are equal, on either
  /// side.
  std::optional<SimulatedShare> power;
  std::optional<SimulatedShare> narrow;  ///< intervals with at most the width `width`
};

/// Simulates studies of these sizes.
/// @param goes_on  called after each study; returning false cancels with Failure.
/// @throws InvalidParameter for a block that is not one of constant stimuli above 0, or parameters out of range.
[[nodiscard]] std::vector<PlanOutcome> planStudy(const StudyBlock& block, const std::vector<StudySize>& sizes,
                                                 const PlanParameters& parameters,
                                                 const std::function<bool()>& goes_on = {});

/// Maximum number of participants that leastParticipants() tries.
inline constexpr int kMostParticipants = 500;

/// Finds the smallest number of participants, up to kMostParticipants, at which a fraction `share` of studies has the
/// required power (or narrow intervals).
/// @param parameters  with `alternative` or `width`. @param share  between 0 and 1, both excluded.
/// @return all sizes tried, in ascending order of participants.
/// @throws InvalidParameter as planStudy(); Failure if kMostParticipants do not suffice.
[[nodiscard]] std::vector<PlanOutcome> leastParticipants(const StudyBlock& block, int repeats,
                                                         const PlanParameters& parameters, double share,
                                                         const std::function<bool()>& goes_on = {});

/// Returns the fraction of successful studies: `power`, or else `narrow`. @pre one of the two is set.
[[nodiscard]] const SimulatedShare& successOf(const PlanOutcome& outcome);

}  // namespace haptolith
