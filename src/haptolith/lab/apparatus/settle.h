#pragma once

#include <string_view>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/lab/laboratory.h"

namespace haptolith {

struct SettleOptions {
  double depth_m = 0.6;         ///< min. depth of the soil; 0.05 to 2
  double width_diameters = 10;  ///< width of the column, periodic on all sides; >= 6
};

/// Density of one slice of the settled column.
struct SettledSlice {
  double depth_m = 0;  ///< depth of its centre
  double density_kg_m3 = 0;
};

/// Mean density of a range of depth.
struct SettledBand {
  double top_m = 0, bottom_m = 0;
  double density_kg_m3 = 0;
};

struct SettleResult {
  std::vector<SettledSlice> slices;
  std::vector<SettledBand> bands;  ///< bands of measuredBands() within the column's depth
  double depth_m = 0;
  double time_s = 0;  ///< simulated time until the soil was at rest
  LabTrace trace;     ///< depth_m, density_kg_m3

  /// Returns the mean density from the surface down to `depth_m`, in kg/m^3.
  [[nodiscard]] double meanDensity(double depth_m) const;
};

/// Returns density against depth of soil that has settled densely under its weight. The soil falls without friction
/// until it is at rest, and only then gets its friction and cohesion. The surface is the height at which a parabola
/// fitted to the mass above a height is zero: it does not depend on single particles.
/// @throws InvalidParameter for values out of range; Failure as LabBed::settle().
[[nodiscard]] SettleResult settleTest(const LabConditions& conditions, const SettleOptions& options = {});

void validate(const SettleOptions& options);

/// Draws density against depth: the settled column, for lunar soil the law (paper 1), and the analysis of layers
/// (paper 6). @throws as Figure.
void drawSettle(const OutputFile& path, const LabConditions& conditions, const SettleResult& result, bool lunar,
                std::string_view title);

}  // namespace haptolith
