#pragma once

#include <string_view>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/vec.h"
#include "haptolith/lab/laboratory.h"
#include "haptolith/lab/theory/beverloo.h"

namespace haptolith {

/// Options of the hopper test. Lengths are in particle diameters d = 2 R.
struct HopperOptions {
  std::vector<double> openings{2, 3, 4, 6, 8, 10, 12};  ///< D, each 1 to 40
  double fill = 18;                                     ///< min. height of the soil; 5 to 200
  double fill_openings = 3;    ///< min. height over the opening: lower soil flows more slowly; 0 to 20
  double margin = 4;           ///< flat floor around the opening, on each side; 3 to 100
  double smallest_fitted = 6;  ///< min. opening for the exponent; flow through narrower ones pauses
};

/// Discharge through one opening.
struct HopperPoint {
  double opening_m = 0;     ///< D
  double rate_kg_s = 0;     ///< rate of steady flow; 0 with almost no discharge
  double rate_se_kg_s = 0;  ///< standard error, from scatter about the line; neighbouring samples are not independent
  double discharged_kg = 0;
  bool clogged = false;  ///< whether it stopped with soil above the opening
  LabTrace trace;        ///< time_s, discharged_kg, cover_m (height of soil above the opening), fastest_m_s
};

struct HopperResult {
  std::vector<HopperPoint> points;  ///< results in the order of the options' openings
  std::vector<double> clogged_m;    ///< openings that clogged
  DischargeFit fit;  ///< fit to openings that flowed and are wide enough; exponent 0 with fewer than three
  double particle_diameter_m = 0;  ///< d
  LabTrace trace;                  ///< opening_m, rate_kg_s, rate_se_kg_s, clogged (1 or 0)
  std::vector<Vec3> centres_m;     ///< soil flowing through the widest opening, for the figure
  double floor_z_m = 0;            ///< height of the floor with the opening
  double widest_m = 0;             ///< widest opening

  [[nodiscard]] bool hasExponent() const noexcept { return fit.exponent != 0; }
};

/// Simulates discharge (kg/s) from a hopper through round openings in a flat rough floor, and its exponent in the
/// opening.
///
/// Soil settles on a floor of particles high above a bin; a plug of particles closes the opening. The plug is pulled
/// down faster than free fall, and the soil that has passed the floor is weighed. The rate is the slope of mass over
/// time after the first quarter of the discharge, while the opening is covered to a height of its width. The only time
/// scale of discharge is sqrt(d / g). So a pause of kQuiet times that counts as clogged, under any gravity.
///
/// The exponent in Beverloo's law is 5/2 (see beverlooRate()). Below about 4 to 6 d particles arch over the opening and
/// may stop (To, Lai and Pak, Phys. Rev. Lett. 86, 2001; Zuriguel et al., Phys. Rev. E 71, 051303, 2005).
///
/// These particles do not roll, so they arch over wider openings than beads and flow more slowly: C of beverlooRate()
/// is 0.2 to 0.25 for mu_p = 0.4, and 0.58 for beads. The soil is deliberately settled without friction, because poured
/// with friction from a grid it stays in columns as loose as the grid.
/// @throws InvalidParameter for values out of range; Failure as LabBed. Not for the tick.
[[nodiscard]] HopperResult hopperTest(const LabConditions& conditions, const HopperOptions& options = {});

/// Draws rates over D - k d with the fitted power, and a slice of the flow. @throws as Figure.
void drawHopper(const OutputFile& path, const HopperResult& result, std::string_view title);

}  // namespace haptolith
