#pragma once

#include <optional>
#include <vector>

#include "haptolith/identify/training/ridge.h"
#include "haptolith/identify/training/training.h"

namespace haptolith {

/// Map from contacts to strength, fitted to the shear tests of a training with various kinds of soil.
///
///     phi = quadratic of mu_p and ln(1 + s / 300 Pa),    c = s exp(quadratic of mu_p, linear of ln s),    s = F_c /
///     R^2
///
/// with linear terms of the particles' spread, stiffness, tangential stiffness and cohesion range. Without cohesion
/// between particles c is 0.
class StrengthMap {
 public:
  static constexpr std::size_t kLeastSheared = 12;

  /// @throws InvalidParameter if fewer than kLeastSheared of the runs were sheared.
  explicit StrengthMap(const std::vector<TrainingRun>& runs);

  [[nodiscard]] ShearStrength of(const SoilParameters& soil, SoilStrength kind = SoilStrength::kResidual) const;

  /// Returns soil of the same kind with contacts for this residual strength, clamped to the contacts of the training.
  [[nodiscard]] SoilParameters with(SoilParameters soil, const ShearStrength& residual) const;

  /// Returns standard deviations of shear tests about the map: of phi in deg, of ln c.
  [[nodiscard]] double angleScatter() const noexcept { return angle_scatter_deg_; }
  [[nodiscard]] double cohesionScatter() const noexcept { return cohesion_scatter_; }

 private:
  struct Fit {
    Ridge angle, cohesion;
  };
  Fit residual_, peak_;
  double angle_scatter_deg_ = 0, cohesion_scatter_ = 0;
};

}  // namespace haptolith
