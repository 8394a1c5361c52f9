#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/identify/soil_belief.h"

namespace haptolith {

/// Soil with known strength, and the belief from its forces.
struct CheckedSoil {
  std::uint64_t number = 0;
  bool has_stone = false;
  SoilState truth;
  double tool_friction_angle_deg = 0;  ///< true value
  SoilBelief belief;
};

/// Errors of one quantity over all soils.
struct CheckedNumber {
  std::string name, unit;
  int decimals = 0;
  double median_error = 0;  ///< median absolute error of the posterior medians
  double held_share = 0;    ///< fraction of the soils whose 90 % interval contains the true number
};

/// Check of the identification with soils outside the training, by a sensor with noise and a zero offset.
class SoilCheck {
 public:
  static constexpr double kNoise_n = 0.05;  ///< noise of the mean over a window
  static constexpr double kBias_n = 0.1;    ///< standard deviation of the zero, along each axis

  /// @param hidden  soils, all of them sheared. @throws InvalidParameter for others; as SoilIdentifier.
  SoilCheck(const Training& training, const Training& hidden);

  [[nodiscard]] const std::vector<CheckedSoil>& soils() const noexcept { return soils_; }
  /// Returns the errors of friction angle, cohesion, relative cohesion from 250 Pa, and tool friction. For all soils,
  /// or only those without a stone.
  [[nodiscard]] std::vector<CheckedNumber> numbers(bool with_stones = true) const;
  /// Returns the number of soils reported as outside the kinds of the training.
  [[nodiscard]] int strange() const;

 private:
  std::vector<CheckedSoil> soils_;
};

/// Draws each soil's estimates with their intervals over the true values. @throws as Figure.
void drawCheck(const OutputFile& file, const std::vector<CheckedSoil>& soils);

}  // namespace haptolith
