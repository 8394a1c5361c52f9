#pragma once

#include <optional>
#include <vector>

#include "haptolith/identify/training/ridge.h"
#include "haptolith/identify/training/training.h"

namespace haptolith {

/// How strong soil is whose contacts are known: through the shear tests of a training, of soils that differ in kind.
///
///     phi = quadratic of mu_p and ln(1 + s / 300 Pa),    c = s exp(quadratic of mu_p, linear of ln s),    s = F_c /
///     R^2
///
/// with linear terms of the grains' spread, stiffness, tangential stiffness and range of cohesion. Soil without
/// cohesion between its particles has none.
class StrengthMap {
 public:
  static constexpr std::size_t kLeastSheared = 12;

  /// @throws InvalidParameter when fewer than kLeastSheared of the runs were sheared.
  explicit StrengthMap(const std::vector<TrainingRun>& runs);

  [[nodiscard]] ShearStrength of(const SoilParameters& soil, SoilStrength kind = SoilStrength::kResidual) const;

  /// The same kind of soil with contacts that have this residual strength, as near as contacts of the training go.
  [[nodiscard]] SoilParameters with(SoilParameters soil, const ShearStrength& residual) const;

  /// Standard deviations of what was measured from the map: of phi in deg, of ln c.
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
