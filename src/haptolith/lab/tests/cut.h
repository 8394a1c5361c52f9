#pragma once

#include <string_view>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/vec.h"
#include "haptolith/lab/laboratory.h"

namespace haptolith {

/// Lengths are in m where cohesion gives them a scale, in radii R or heights H of the cut where it does not.
struct CutOptions {
  double height_m = 0.1;     ///< H, of the cut; 6 R to 1000 R
  double depth = 1.5;        ///< of the soil behind the cut, in H; 1 to 10
  double room = 2;           ///< in front of the cut, in H; 1 to 10
  double width = 12;         ///< along the cut, in R; the soil repeats itself beyond; 12 to 1000
  double retreat_speed = 2;  ///< of the retaining plate, in sqrt(g H); above 0 to 10
};

/// The surface of the soil over x, 0 at the cut, room in front of it at x > 0.
struct CutProfilePoint {
  double x_m = 0;
  double height_m = 0;  ///< mean over the width, above the floor
};

/// Part of a cut's height that is left when it stands; without cohesion about 0.6 is.
inline constexpr double kStandingCut = 0.9;

struct CutResult {
  bool stands = false;
  double height_before_m = 0;  ///< just behind the face: mean over H / 4
  double height_after_m = 0;   ///< at the same place
  double height_kept = 0;      ///< after over before; a cut stands when this is kStandingCut or more
  double crest_back_m = 0;     ///< how far the crest (0.9 of the height before) went back
  double toe_ahead_m = 0;      ///< how far the toe (0.1 of the height before) went ahead
  std::vector<CutProfilePoint> before, after;
  std::vector<Vec3> centres_before_m, centres_after_m;  ///< x as in the profile, z above the floor
  double radius_m = 0;                                  ///< R
  LabTrace trace;  ///< time_s, plate_m (how far it is away), height_m (behind the face), fastest_m_s
};

/// The height (m) to which a vertical cut can stand unsupported.
///
///     H_c = 4 c / (rho g) tan(45 deg + phi / 2)
///
/// Terzaghi, Theoretical Soil Mechanics (1943), section 57: a plane slip surface, no tension cracks; these bring it
/// down to 2/3.
/// @param cohesion_pa  c, 0 to 1e9.   @param friction_angle_rad  phi, 0 to below pi/2.
/// @param density_kg_m3  rho, above 0.   @param gravity_m_s2  g, above 0.
/// @throws InvalidParameter outside these ranges.
[[nodiscard]] double criticalCutHeight(double cohesion_pa, double friction_angle_rad, double density_kg_m3,
                                       double gravity_m_s2);

/// Whether a vertical cut stands when its support is taken away.
///
/// Soil settles on a rough floor against a smooth plate and grows cohesive where it lies (see LabBed::settle). The
/// plate goes away sideways, faster than a flood of soil would follow it, so that it neither holds nor drags. When the
/// soil has come to rest, its surface is compared with what it was.
///
/// In theory a cut stands up to criticalCutHeight(). Of lunar soil (c = 500 Pa) that is more than 1 m, and the
/// astronauts' trenches and core holes stood with vertical walls; without cohesion none stands (Carrier, Olhoeft and
/// Mendell, in Lunar Sourcebook, 1991, chapter 9).
/// @throws InvalidParameter for nonsense; Failure as LabBed, and when the soil does not come to rest. Not for the tick.
[[nodiscard]] CutResult verticalCutTest(const LabConditions& conditions, const CutOptions& options = {});

/// Draws the soil before and after. @throws as Figure.
void drawCut(const OutputFile& path, const CutResult& result, std::string_view title);

}  // namespace haptolith
