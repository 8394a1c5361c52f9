#pragma once

#include <string_view>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/vec.h"
#include "haptolith/lab/laboratory.h"

namespace haptolith {

/// Options of the vertical-cut test. Lengths are in m where cohesion sets their scale, otherwise in radii R or heights
/// H of the cut.
struct VerticalCutOptions {
  double height_m = 0.1;     ///< H, height of the cut; 6 R to 1000 R
  double depth = 1.5;        ///< length of the soil behind the cut, in H; 1 to 10
  double room = 2;           ///< length in front of the cut, in H; 1 to 10
  double width = 12;         ///< width along the cut, in R; periodic; 12 to 1000
  double retreat_speed = 2;  ///< speed of the retaining plate, in sqrt(g H); above 0 to 10
};

/// Point of the surface over x; x is 0 at the cut and > 0 in front of it.
struct CutProfilePoint {
  double x_m = 0;
  double height_m = 0;  ///< mean over the width, above the floor
};

/// Min. remaining fraction of the height of a cut that stands; without cohesion about 0.6 remains.
inline constexpr double kStandingCut = 0.9;

struct VerticalCutResult {
  bool stands = false;
  double height_before_m = 0;  ///< initial height just behind the face: mean over H / 4
  double height_after_m = 0;   ///< final height over the same range
  double height_kept = 0;      ///< final over initial height; kStandingCut or more: the cut is stable
  double crest_back_m = 0;     ///< retreat of the crest (0.9 of the initial height)
  double toe_ahead_m = 0;      ///< advance of the toe (0.1 of the initial height)
  std::vector<CutProfilePoint> before, after;
  std::vector<Vec3> centres_before_m, centres_after_m;  ///< x as in the profile, z above the floor
  double radius_m = 0;                                  ///< R
  LabTrace trace;  ///< time_s, plate_m (its distance), height_m (behind the face), fastest_m_s
};

/// Returns the critical height (m) of an unsupported vertical cut.
///
///     H_c = 4 c / (rho g) tan(45 deg + phi / 2)
///
/// Terzaghi, Theoretical Soil Mechanics (1943), section 57: a plane slip surface, no tension cracks; these reduce it to
/// 2/3.
/// @param cohesion_pa  c, 0 to 1e9.   @param friction_angle_rad  phi, 0 to below pi/2.
/// @param density_kg_m3  rho, above 0.   @param gravity_m_s2  g, above 0.
/// @throws InvalidParameter outside these ranges.
[[nodiscard]] double criticalCutHeight(double cohesion_pa, double friction_angle_rad, double density_kg_m3,
                                       double gravity_m_s2);

/// Determines whether a vertical cut stands when its support is removed.
///
/// Soil settles on a rough floor against a smooth plate and then becomes cohesive in place (see LabBed::settle). The
/// plate retreats sideways, faster than a flow of soil could follow, so that it neither supports nor drags the soil.
/// Once the soil is at rest, its surface is compared with the initial one.
///
/// In theory a cut stands up to criticalCutHeight(). In lunar soil (c = 500 Pa) that is more than 1 m: the walls of the
/// astronauts' trenches and core holes were vertical and stable. Without cohesion no cut stands (Carrier, Olhoeft and
/// Mendell, in Lunar Sourcebook, 1991, chapter 9).
/// @throws InvalidParameter for values out of range; Failure as LabBed, and when the soil does not settle. Not for the
/// tick.
[[nodiscard]] VerticalCutResult verticalCutTest(const LabConditions& conditions,
                                                const VerticalCutOptions& options = {});

/// Draws the soil before and after. @throws as Figure.
void drawVerticalCut(const OutputFile& path, const VerticalCutResult& result, std::string_view title);

}  // namespace haptolith
