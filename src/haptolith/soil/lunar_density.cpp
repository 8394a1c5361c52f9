#include "haptolith/soil/lunar_density.h"

#include <array>
#include <cmath>

#include "haptolith/core/error.h"
#include "haptolith/core/math/portable_math.h"

namespace haptolith {

namespace {

constexpr double kSurfaceDensity = 1270;  // kg/m^3
constexpr double kKappa = 121;            // kg/m^3
constexpr double kPerMetre = 100;         // the source's z is in cm

constexpr std::array kMeasuredBands{
    MeasuredBand{0.00, 0.15, 1500, 50},
    MeasuredBand{0.00, 0.30, 1580, 50},
    MeasuredBand{0.30, 0.60, 1740, 50},
    MeasuredBand{0.00, 0.60, 1660, 50},
};

// Integral of rho from the surface to z, in kg/m^2.
double massAbove(double z) {
  const double u = kPerMetre * z + 1;
  return kSurfaceDensity * z + kKappa * (u * portable::log(u) - u + 1) / kPerMetre;
}

}  // namespace

double lunarBulkDensity(double depth_m) {
  requireInRange("depth_m", depth_m, {0, kLunarLawDepthM});
  return kSurfaceDensity + kKappa * portable::log(kPerMetre * depth_m + 1);
}

double lunarMeanBulkDensity(double top_m, double bottom_m) {
  requireInRange("top_m", top_m, {0, kLunarLawDepthM});
  requireInRange("bottom_m", bottom_m, {top_m, kLunarLawDepthM, Ends::kOpenBelow});
  return (massAbove(bottom_m) - massAbove(top_m)) / (bottom_m - top_m);
}

std::span<const MeasuredBand> measuredBands() {
  return kMeasuredBands;
}

}  // namespace haptolith
