#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "haptolith/identify/next_measurement.h"

namespace haptolith {

/// In which order parts are made.
enum class PartOrder { kByGain, kAsLearned, kAtRandom };

/// What is believed of a soil once a part more has been made.
struct PartsStep {
  std::size_t part = 0;
  double time_s = 0;  ///< that all parts until then took
  SoilBelief belief;
  SoilWidths expected;  ///< of the belief, before the part was made
};

/// A soil that is told part by part.
struct PartsCourse {
  SoilState truth;
  SoilWidths before;
  std::vector<PartsStep> steps;

  /// When no interval was wider any more than it may be; none: never.
  [[nodiscard]] std::optional<double> timeUntil(const SoilWidths& wanted) const;
};

/// How soon each soil of a training that was sheared is told, left out of what the emulator learned, in some order of
/// the parts; and whether intervals become as wide as was expected.
class PartsCheck {
 public:
  /// @param every  of so many of the soils, one. @throws as ForceEmulator.
  explicit PartsCheck(const Training& training, std::size_t every = 1);

  [[nodiscard]] std::vector<PartsCourse> courses(PartOrder order) const;
  /// All that the parts take.
  [[nodiscard]] double duration() const;

 private:
  [[nodiscard]] PartsCourse courseOf(std::size_t place, PartOrder order) const;

  const Training& training_;
  double temper_;
  std::vector<MovementPart> parts_;
  std::vector<std::size_t> sheared_;
  std::vector<ForceEmulator> others_;  ///< without each of these
};

/// What holds of courses after so many parts.
struct PartsRow {
  std::size_t parts = 0;
  double held_share = 0;      ///< of all 90 % intervals
  SoilWidths median;          ///< of their widths
  SoilWidths over_expected;   ///< median of widths over what was expected of them
  double within_quarter = 0;  ///< share of the widths that are within a quarter of that
};
[[nodiscard]] std::vector<PartsRow> partsRows(const std::vector<PartsCourse>& courses);

/// The mean time until no interval is wider than it may be, where one that stays wider counts as if the parts were
/// made `most_s` long; and how many soils come to it.
struct TimeUntil {
  double mean_s = 0;
  std::size_t soils = 0;
};
[[nodiscard]] TimeUntil timeUntil(const std::vector<PartsCourse>& courses, const SoilWidths& wanted, double most_s);

}  // namespace haptolith
