#pragma once

#include <optional>

#include "haptolith/core/error.h"

namespace haptolith {

/// Which strength of a sheared bed is compared with the target.
enum class SoilStrength {
  kResidual,  ///< strength after long shearing (critical state)
  kPeak,      ///< maximum strength
};

/// Valid ranges of measured values.
struct SoilTargetRanges {
  static constexpr Range bulk_density_kg_m3{0, 1e5, Ends::kOpenBelow};
  static constexpr Range friction_angle_deg{0, 89};
  static constexpr Range cohesion_pa{0, 1e6};
};

/// Strength that an engineer measured.
struct SoilTarget {
  double bulk_density_kg_m3 = 0;
  double friction_angle_deg = 0;
  std::optional<Range> friction_angle_range_deg;  ///< the measurement's own uncertainty, where it is known
  double cohesion_pa = 0;
  std::optional<Range> cohesion_range_pa;
  SoilStrength strength = SoilStrength::kResidual;
};

/// Strength that the virtual laboratory simulated at the end of a calibration: mean and SD over seeds.
struct SoilReached {
  double friction_angle_deg = 0, friction_angle_sd_deg = 0;
  double cohesion_pa = 0, cohesion_sd_pa = 0;
  double bulk_density_kg_m3 = 0;
  int seeds = 0;
};

}  // namespace haptolith
