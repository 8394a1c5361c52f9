#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/identify/soil_belief.h"

namespace haptolith {

/// A soil whose strength was measured, and what its forces tell.
struct CheckedSoil {
  std::uint64_t number = 0;
  bool has_stone = false;
  SoilState truth;
  double tool_friction_angle_deg = 0;  ///< true
  SoilBelief belief;
};

/// One of the numbers, over all soils.
struct CheckedNumber {
  std::string name, unit;
  int decimals = 0;
  double median_error = 0;  ///< of the medians, without sign
  double held_share = 0;    ///< of the soils whose 90 % interval holds the true number
};

/// How well soils are told that no training has seen, by a sensor with noise and a zero that is wrong.
class SoilCheck {
 public:
  static constexpr double kNoise_n = 0.05;  ///< of the mean over a window
  static constexpr double kBias_n = 0.1;    ///< standard deviation of the zero, along each axis

  /// @param hidden  soils that were all sheared. @throws InvalidParameter for others; as SoilIdentifier.
  SoilCheck(const Training& training, const Training& hidden);

  [[nodiscard]] const std::vector<CheckedSoil>& soils() const noexcept { return soils_; }
  /// Friction angle, cohesion, cohesion in parts of itself where it is 250 Pa and more, tool friction: of all soils, or
  /// of those without a stone in them.
  [[nodiscard]] std::vector<CheckedNumber> numbers(bool with_stones = true) const;
  /// How many are told to be of no kind that was learned.
  [[nodiscard]] int strange() const;

 private:
  std::vector<CheckedSoil> soils_;
};

/// Draws each soil's numbers as they were told, with their intervals, over the true ones. @throws as Figure.
void drawCheck(const OutputFile& file, const std::vector<CheckedSoil>& soils);

}  // namespace haptolith
