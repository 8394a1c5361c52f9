#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "haptolith/identify/next_measurement.h"

namespace haptolith {

/// Order of the parts.
enum class PartOrder { kByGain, kAsLearned, kAtRandom };

/// Belief about a soil after one more part.
struct PartsStep {
  std::size_t part = 0;
  double time_s = 0;  ///< duration of all parts until then
  SoilBelief belief;
  SoilWidths expected;  ///< expected widths of the belief, before the part was made
};

/// Identification of a soil, part by part.
struct PartsCourse {
  SoilState truth;
  SoilWidths before;
  std::vector<PartsStep> steps;

  /// Returns the time until all intervals are narrow enough; empty: never.
  [[nodiscard]] std::optional<double> timeUntil(const SoilWidths& wanted) const;
};

/// Leave-one-out check: time to identify each sheared soil of a training, by the order of the parts, and whether the
/// interval widths agree with the expected ones.
class PartsCheck {
 public:
  /// @param every  stride over the sheared soils: 1 takes all. @throws as ForceEmulator.
  explicit PartsCheck(const Training& training, std::size_t every = 1);

  [[nodiscard]] std::vector<PartsCourse> courses(PartOrder order) const;
  /// Returns the duration of all parts, in s.
  [[nodiscard]] double duration() const;

 private:
  [[nodiscard]] PartsCourse courseOf(std::size_t place, PartOrder order) const;

  const Training& training_;
  double temper_;
  std::vector<MovementPart> parts_;
  std::vector<std::size_t> sheared_;
  std::vector<ForceEmulator> others_;  ///< emulators, each trained without one of these
};

/// Statistics of the courses after a number of parts.
struct PartsRow {
  std::size_t parts = 0;
  double held_share = 0;      ///< fraction of all 90 % intervals that contain the true number
  SoilWidths median;          ///< median of their widths
  SoilWidths over_expected;   ///< median of widths over expected widths
  double within_quarter = 0;  ///< fraction of the widths within 25 % of the expected ones
};
[[nodiscard]] std::vector<PartsRow> partsRows(const std::vector<PartsCourse>& courses);

/// Mean time until all intervals are narrow enough, and the number of soils that reach it. A soil that does not reach
/// it counts with `most_s`.
struct TimeUntil {
  double mean_s = 0;
  std::size_t soils = 0;
};
[[nodiscard]] TimeUntil timeUntil(const std::vector<PartsCourse>& courses, const SoilWidths& wanted, double most_s);

}  // namespace haptolith
