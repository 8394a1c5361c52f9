#pragma once

#include <string_view>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/lab/laboratory.h"

namespace haptolith {

struct SettleOptions {
  double depth_m = 0.6;         ///< of soil that is needed at least; 0.05 to 2
  double width_diameters = 10;  ///< of the column, periodic on all sides; >= 6
};

/// Density of one slice of the settled column.
struct SettledSlice {
  double depth_m = 0;  ///< of its middle
  double density_kg_m3 = 0;
};

/// Mean density of a band of depth.
struct SettledBand {
  double top_m = 0, bottom_m = 0;
  double density_kg_m3 = 0;
};

struct SettleResult {
  std::vector<SettledSlice> slices;
  std::vector<SettledBand> bands;  ///< those of measuredBands() that the column is deep enough for
  double depth_m = 0;
  double time_s = 0;  ///< simulated time until it rested
  LabTrace trace;     ///< depth_m, density_kg_m3

  /// Mean density from the surface down to `depth_m`, in kg/m^3.
  [[nodiscard]] double meanDensity(double depth_m) const;
};

/// Density with depth of soil that has settled densely under its own weight: falls without friction, comes to rest, and
/// only then gets its friction and cohesion. The surface is where the mass above a height, a parabola of depth,
/// comes to nothing: no particle decides it alone.
/// @throws InvalidParameter for nonsense; Failure as LabBed::settle().
[[nodiscard]] SettleResult settleTest(const LabConditions& conditions, const SettleOptions& options = {});

void validate(const SettleOptions& options);

/// Density against depth: the settled column, for lunar soil the law (paper 1), and the analysis of layers (paper 6).
void drawSettle(const OutputFile& path, const LabConditions& conditions, const SettleResult& result, bool lunar,
                std::string_view title);

}  // namespace haptolith
