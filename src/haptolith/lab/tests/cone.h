#pragma once

#include <numbers>
#include <string_view>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/lab/apparatus/pushed_tool.h"
#include "haptolith/lab/laboratory.h"

namespace haptolith {

/// Cone penetrometer and the box of the test.
struct ConeOptions {
  double base_diameter_m = 0.02027;              ///< ASABE S313.3, the larger cone; above 0
  double cone_angle_rad = std::numbers::pi / 6;  ///< full angle, between opposite sides; 30 deg
  double max_depth_m = 0.1;                      ///< max. depth of the cone's base below the surface
  double speed_m_s = 0.03;                       ///< 30 mm/s as in ASABE EP542
  double friction = 0.36;                        ///< friction of cone and shaft against soil
  double bed_width_diameters = 10;               ///< width of the square box, in base diameters; at least 4
  double below_diameters = 2.5;                  ///< soil under the point at the end, in base diameters
  Preparation preparation = Preparation::kDense;
  DepthFrom depth_from = DepthFrom::kTips;
  double window_m = 4e-3;  ///< range of depth that a point of the curve is averaged over
  int points = 50;         ///< number of points of the curve without its zero; 3 or more
};

struct ConePoint {
  double depth_m = 0;        ///< depth of the cone's base below the undisturbed surface
  double resistance_pa = 0;  ///< force over the base's area
};

struct ConeResult {
  std::vector<ConePoint> curve;
  double cone_index_pa = 0;  ///< mean resistance over the depth
  double gradient_pa_m = 0;  ///< slope of the straight line through the curve
  double bulk_density_kg_m3 = 0;
  double bed_depth_m = 0;
  std::size_t particles = 0;
  LabTrace trace;
};

/// Pushes a cone into a settled bed at constant speed; resistance is force over the area of its base, as in ASABE
/// S313.3 and EP542, and depth 0 is where the base is level with the surface.
///
/// The shaft is as wide as the base (in S313.3 it is thinner), so its friction is part of the resistance; this part
/// grows with depth. A cone only a few particles wide responds to single particles; use window_m.
/// @throws InvalidParameter outside the ranges above; Failure as LabBed::run(). Not for the tick.
[[nodiscard]] ConeResult coneTest(const LabConditions& conditions, const ConeOptions& options = {});

/// Draws resistance against depth, its mean and its straight line into an .svg or .png file. @throws as Figure.
void drawCone(const OutputFile& file, const ConeResult& result, std::string_view title);

}  // namespace haptolith
