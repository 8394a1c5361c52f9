#pragma once

#include <string_view>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/vec.h"
#include "haptolith/lab/laboratory.h"
#include "haptolith/lab/theory/beverloo.h"

namespace haptolith {

/// Lengths are in particle diameters d = 2 R.
struct FunnelOptions {
  std::vector<double> openings{2, 3, 4, 6, 8, 10, 12};  ///< D, each 1 to 40
  double fill = 18;                                     ///< height of the soil at least; 5 to 200
  double fill_openings = 3;    ///< and over the opening it runs through: lower soil runs out more slowly; 0 to 20
  double margin = 4;           ///< of flat floor around the opening, on each side; 3 to 100
  double smallest_fitted = 6;  ///< narrower openings do not count for the exponent: flow halts there now and then
};

/// Discharge through one opening.
struct FunnelPoint {
  double opening_m = 0;     ///< D
  double rate_kg_s = 0;     ///< while it flowed steadily; 0 when next to nothing came
  double rate_se_kg_s = 0;  ///< from the scatter about the straight line; neighbouring moments are not independent
  double discharged_kg = 0;
  bool clogged = false;  ///< it stopped with soil above the opening
  LabTrace trace;        ///< time_s, discharged_kg, cover_m (height of soil above the opening), fastest_m_s
};

struct FunnelResult {
  std::vector<FunnelPoint> points;  ///< in the order of the options' openings
  std::vector<double> clogged_m;    ///< openings that clogged
  DischargeFit fit;                 ///< of those that ran and are wide enough; exponent 0 with fewer than three of them
  double particle_diameter_m = 0;   ///< d
  LabTrace trace;                   ///< opening_m, rate_kg_s, rate_se_kg_s, clogged (1 or 0)
  std::vector<Vec3> centres_m;      ///< of the soil while it runs through the widest opening, for the figure
  double floor_z_m = 0;             ///< height of the floor with the opening
  double widest_m = 0;              ///< that opening

  [[nodiscard]] bool hasExponent() const noexcept { return fit.exponent != 0; }
};

/// Discharge (kg/s) through round openings in a flat rough floor, and with which power of the opening it goes.
///
/// Soil settles on a floor of particles high above a bin, with the opening closed by a plug of the same. The plug is
/// pulled down faster than anything falls, and what has passed the floor is weighed. The rate is the slope of mass over
/// time in the middle of the discharge: after the first quarter, and while the opening is covered by its own width.
/// Discharge has no other scale of time than sqrt(d / g), so that is how long flow may pause before it counts as
/// clogged (kQuiet of them), under any gravity.
///
/// Beverloo's law says 5/2 (see beverlooRate()); grains arch over openings below some 4 to 6 d and may stop there (To,
/// Lai and Pak, Phys. Rev. Lett. 86, 2001; Zuriguel et al., Phys. Rev. E 71, 051303, 2005).
///
/// Two things to know. These particles do not roll, so that they arch over wider openings than beads and run more
/// slowly (C of beverlooRate() is 0.2 to 0.25 for mu_p = 0.4, where beads have 0.58). And the soil is settled without
/// friction on purpose: poured with friction from a grid it stays in columns as loose as the grid.
/// @throws InvalidParameter for nonsense; Failure as LabBed. Not for the tick.
[[nodiscard]] FunnelResult funnelTest(const LabConditions& conditions, const FunnelOptions& options = {});

/// Draws rates over D - k d with the fitted power, and a slice of the flow. @throws as Figure.
void drawFunnel(const OutputFile& path, const FunnelResult& result, std::string_view title);

}  // namespace haptolith
