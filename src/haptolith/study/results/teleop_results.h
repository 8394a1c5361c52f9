#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "haptolith/psychometrics/fit.h"
#include "haptolith/study/store/store.h"

namespace haptolith {

/// Mean over participants. The interval is that of Student's t with n - 1 degrees of freedom, exact if participants are
/// normally distributed:
///
///     mean +- t s / sqrt(n)
///
/// A single participant has no interval (NaN).
struct PeopleMean {
  std::size_t people = 0;
  double mean = std::numeric_limits<double>::quiet_NaN();
  Interval interval = {};
};

/// Computes the mean and its interval.
/// @param values  one finite value per participant. @param confidence  probability of the interval, between 0 and 1.
[[nodiscard]] PeopleMean meanOverPeople(std::span<const double> values, double confidence = 0.95);

/// Measure of participants, over the main trials of a block or from its form.
struct TeleopMeasure {
  std::string name = {}, unit = {};               ///< "task time", "s"; for a form the item's key
  std::map<std::int64_t, double> of_people = {};  ///< values by ParticipantRow::id
};

/// Results of a teleoperation block.
struct TeleopBlockResult {
  std::size_t block = 0;  ///< index in the protocol's blocks
  /// Fraction of tasks completed, task time, force error, maximum force on the robot's tool and its stops, then the
  /// scales of the block's form.
  std::vector<TeleopMeasure> measures = {};
};

/// Returns the results of each teleoperation block with main trials, without excluded participants.
/// @param withdrawn  whether to include participants who have withdrawn.
[[nodiscard]] std::vector<TeleopBlockResult> teleopResults(const StudyStore& study, bool withdrawn);

/// Returns the mean of a measure over participants.
[[nodiscard]] PeopleMean meanOf(const TeleopMeasure& measure, double confidence = 0.95);
/// Returns the mean of the differences `measure` - `less` over the participants who have both.
[[nodiscard]] PeopleMean meanDifference(const TeleopMeasure& measure, const TeleopMeasure& less,
                                        double confidence = 0.95);

}  // namespace haptolith
