#pragma once

#include <span>
#include <vector>

#include "haptolith/core/vec.h"
#include "haptolith/lab/theory/straight_line.h"

namespace haptolith {

/// Position of a heap, and resolution of its profile.
struct HeapCase {
  double radius_m = 0;  ///< R, radius of the particles; above 0
  double axis_x_m = 0;  ///< vertical axis of symmetry of the heap
  double axis_y_m = 0;
  double floor_z_m = 0;     ///< height of the floor under the heap
  double ring_width_m = 0;  ///< width of the rings and patches; 0: 4 R, two particles
};

/// One ring of the surface.
struct HeapRing {
  double radius_m = 0;  ///< mean distance of the surface particles from the axis
  double height_m = 0;  ///< mean height of their tops above the floor
};

/// Surface profile of a heap from the axis outwards, and its slope.
struct HeapProfile {
  std::vector<HeapRing> rings;
  std::vector<HeapRing> flank;  ///< rings that the line was fitted to
  StraightLine line;            ///< height over distance, in m
  double angle_of_repose_rad = 0;
  double angle_se_rad = 0;  ///< standard error, from the scatter of the flank's rings about the line
  double height_m = 0;      ///< height of the highest ring
};

/// Returns the angle of repose (rad) of a heap of particles, and the profile that it was read from.
///
/// The plan is divided into rings of equal width about the axis. Ring i has 2 pi (i + 1/2) sectors, rounded, about as
/// long as the ring is wide. So all patches have the same size, and the height of a patch's highest particle above the
/// mean surface is the same everywhere: it shifts the profile up but does not change its slope. The point of a ring is
/// the mean, over its patches, of the position and the top of the highest particle. Patches without particles are left
/// out.
///
/// The flank is the part outside the highest ring between 80 % and 20 % of its height, because the tip is rounded and
/// the foot flattens out. Its slope is that of a straight line by least squares; the angle of repose is the arc tangent
/// of the slope.
/// @param centres_m  centres of the particles, scene frame, all of the same radius.
/// @throws InvalidParameter for values out of range; Failure when fewer than three rings make up the flank: the heap is
/// too small for its particles, or flat. Not for the tick.
[[nodiscard]] HeapProfile heapProfile(std::span<const Vec3> centres_m, const HeapCase& heap);

}  // namespace haptolith
