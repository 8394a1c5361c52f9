#include "haptolith/lab/theory/mohr_coulomb.h"

#include <cmath>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/lab/theory/straight_line.h"

namespace haptolith {

MohrCoulomb fitMohrCoulomb(std::span<const ShearPoint> points) {
  std::vector<double> normal;
  std::vector<double> shear;
  for (const ShearPoint& point : points) {
    normal.push_back(requireInRange("normal_stress_pa", point.normal_stress_pa, {0, Range{}.highest}));
    shear.push_back(requireInRange("shear_stress_pa", point.shear_stress_pa, {0, Range{}.highest}));
  }
  const StraightLine line = fitStraightLine(normal, shear);

  MohrCoulomb strength;
  strength.friction_angle_rad = std::atan(line.slope);
  strength.friction_angle_se_rad = line.slope_se / (1 + line.slope * line.slope);
  strength.cohesion_pa = line.intercept;
  strength.cohesion_se_pa = line.intercept_se;
  return strength;
}

}  // namespace haptolith
