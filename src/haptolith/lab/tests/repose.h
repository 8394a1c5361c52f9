#pragma once

#include <string_view>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/vec.h"
#include "haptolith/lab/apparatus/heap_profile.h"
#include "haptolith/lab/apparatus/lab_bed.h"
#include "haptolith/lab/laboratory.h"

namespace haptolith {

/// Options of the angle-of-repose test. Lengths are in particle radii R, because the angle of a heap of enough
/// particles does not depend on their number. The standard heap is about 10 particle diameters high; below 8 the angle
/// scatters by several degrees.
struct ReposeOptions {
  double tube_radius = 13;                        ///< inner radius of the tube, in R; 4 to 100
  double fill = 60;                               ///< height of the soil in the tube, in R; 4 to 500
  double lift_speed = 0.4;                        ///< speed of the tube, in sqrt(g R); above 0 to 5
  double ring_width = 4;                          ///< width of the rings of the surface profile, in R; 2 to 20
  Preparation preparation = Preparation::kDense;  ///< dense soil gives heaps above its residual angle
};

struct ReposeResult {
  double angle_rad = 0;     ///< angle of repose
  double angle_se_rad = 0;  ///< standard error, from the scatter of the profile about the line
  double height_m = 0;      ///< height of the heap
  HeapProfile profile;
  std::vector<Vec3> centres_m;  ///< final centres of the soil; the heap's axis is x = y = 0
  double radius_m = 0;          ///< R
  double floor_z_m = 0;         ///< mean height of the rough floor's top
  LabTrace trace;               ///< time_s, tube_m (height of its lower edge), heap_m, fastest_m_s
};

/// Simulates the angle of repose (rad) of a heap that a lifted tube leaves on a rough floor.
///
/// Soil settles in a smooth tube (see LabBed::settle), the tube is lifted until it is empty, and the heap settles. Its
/// slope is that of heapProfile(). This is the hollow-cylinder test, e.g. Beakawi Al-Hashemi and Baghabra Al-Amoudi, A
/// review on the angle of repose of granular materials (Powder Technology 330, 2018).
///
/// The tube's speed is a multiple of sqrt(g R), and the speed at rest is that after falling a fraction of R. A heap of
/// rigid particles without cohesion has no other scale of speed than sqrt(g R), so the test is the same under any
/// gravity. The remaining effect of gravity is the overlap of the particles, rho g h / k.
/// @throws InvalidParameter for values out of range; Failure as LabBed and heapProfile(), when the heap does not
/// settle, and when the soil spreads to the walls because it has almost no angle of repose. Soil so cohesive that it
/// forms a column has none either. Not for the tick.
[[nodiscard]] ReposeResult reposeTest(const LabConditions& conditions, const ReposeOptions& options = {});

/// Draws the heap: a slice through its axis, the profile and the fitted line. @throws as Figure.
void drawRepose(const OutputFile& path, const ReposeResult& result, std::string_view title);

}  // namespace haptolith
