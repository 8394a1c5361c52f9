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

/// A mean over people, whose interval is that of Student's t with n - 1 degrees of freedom, exact where people differ
/// normally:
///
///     mean +- t s / sqrt(n)
///
/// One person has no interval (NaN).
struct PeopleMean {
  std::size_t people = 0;
  double mean = std::numeric_limits<double>::quiet_NaN();
  Interval interval = {};
};

/// @param values  one of each person, finite. @param confidence  of the interval, between 0 and 1.
[[nodiscard]] PeopleMean meanOverPeople(std::span<const double> values, double confidence = 0.95);

/// Something that was measured of people, each over their main trials of a block or in its form.
struct TeleopMeasure {
  std::string name = {}, unit = {};               ///< "task time", "s"; of a form the item's key
  std::map<std::int64_t, double> of_people = {};  ///< by ParticipantRow::id
};

/// Of a block whose trials are work for a robot.
struct TeleopBlockResult {
  std::size_t block = 0;  ///< of the protocol's
  /// The share that was done, task time, error of force, largest force on the robot's tool and its stops, then the
  /// scales of the block's form.
  std::vector<TeleopMeasure> measures = {};
};

/// Of each such block that somebody has done a main trial of. Who is excluded does not count.
/// @param withdrawn  whether those who have withdrawn do.
[[nodiscard]] std::vector<TeleopBlockResult> teleopResults(const StudyStore& study, bool withdrawn);

/// Mean over people of a measure, and of how much more they have of it than in another block; over those who have both.
[[nodiscard]] PeopleMean meanOf(const TeleopMeasure& measure, double confidence = 0.95);
[[nodiscard]] PeopleMean meanDifference(const TeleopMeasure& measure, const TeleopMeasure& less,
                                        double confidence = 0.95);

}  // namespace haptolith
