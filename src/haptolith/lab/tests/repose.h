#pragma once

#include <string_view>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/vec.h"
#include "haptolith/lab/apparatus/heap_profile.h"
#include "haptolith/lab/laboratory.h"

namespace haptolith {

/// A heap is made of so many particles that its angle no longer depends on how many: lengths are in radii R of a
/// particle. The standard heap is some 10 particle diameters high; below 8 the angle scatters by several degrees.
struct ReposeOptions {
  double tube_radius = 13;  ///< inner radius of the tube, in R; 4 to 100
  double fill = 60;         ///< height of the soil in the tube, in R; 4 to 500
  double lift_speed = 0.4;  ///< in sqrt(g R); above 0 to 5
  double ring_width = 4;    ///< of the rings in which the surface is read, in R; 2 to 20
};

struct ReposeResult {
  double angle_rad = 0;     ///< angle of repose
  double angle_se_rad = 0;  ///< from the scatter of the profile about the line
  double height_m = 0;      ///< of the heap
  HeapProfile profile;
  std::vector<Vec3> centres_m;  ///< of the soil at the end; the heap's axis is x = y = 0
  double radius_m = 0;          ///< R
  double floor_z_m = 0;         ///< mean height of the rough floor's top
  LabTrace trace;               ///< time_s, tube_m (height of its lower edge), heap_m, fastest_m_s
};

/// The angle of repose (rad) of a heap that a lifted tube leaves on a rough floor.
///
/// Soil settles in a smooth tube (see LabBed::settle), the tube goes up until nothing is left in it, and the heap comes
/// to rest. Its slope is read by heapProfile(). This is the hollow-cylinder test, e.g. Beakawi Al-Hashemi and
/// Baghabra Al-Amoudi, A review on the angle of repose of granular materials (Powder Technology 330, 2018).
///
/// The tube's speed is a multiple of sqrt(g R), and rest is judged by what a particle gains in falling by a part of R:
/// a heap of rigid grains without cohesion has no other scale of speed than sqrt(g R), so that the same test is done
/// under any gravity. What is left of gravity is how far particles are pressed into each other, rho g h / k.
/// @throws InvalidParameter for nonsense; Failure as LabBed, heapProfile(), when the heap does not come to rest and
/// when the soil spreads as far as the walls: it has no angle of repose, or hardly any. Soil so cohesive that it stands
/// as a column has none either. Not for the tick.
[[nodiscard]] ReposeResult reposeTest(const LabConditions& conditions, const ReposeOptions& options = {});

/// Draws the heap: a slice through its axis, the measured profile and the line that was fitted. @throws as Figure.
void drawRepose(const OutputFile& path, const ReposeResult& result, std::string_view title);

}  // namespace haptolith
