#pragma once

#include <span>
#include <vector>

#include "haptolith/core/vec.h"
#include "haptolith/lab/theory/straight_line.h"

namespace haptolith {

/// Where a heap stands, and how finely its surface is read.
struct HeapCase {
  double radius_m = 0;  ///< R, of the particles; above 0
  double axis_x_m = 0;  ///< the vertical axis about which the heap is round
  double axis_y_m = 0;
  double floor_z_m = 0;     ///< what the heap stands on
  double ring_width_m = 0;  ///< of the rings and patches; 0 takes 4 R, two particles
};

/// One ring of the surface.
struct HeapRing {
  double radius_m = 0;  ///< mean distance of the particles at the surface from the axis
  double height_m = 0;  ///< mean height of their tops above the floor
};

/// A heap's surface from the axis outwards, and its slope.
struct HeapProfile {
  std::vector<HeapRing> rings;
  std::vector<HeapRing> flank;  ///< the rings that the line was fitted to
  StraightLine line;            ///< height over distance, in m
  double angle_of_repose_rad = 0;
  double angle_se_rad = 0;  ///< from the scatter of the flank's rings about the line
  double height_m = 0;      ///< of the highest ring
};

/// The angle of repose (rad) of a heap of particles, and the profile that it was read from.
///
/// The plan is divided into rings of equal width about the axis and each ring into sectors about as long as the ring is
/// wide, 2 pi (i + 1/2) of them in ring i, rounded. So all patches are of the same size, and what the highest particle
/// of a patch lies above the mean surface is the same everywhere: it lifts the profile but does not turn it. A ring's
/// point is the mean, over its patches, of the place and the top of the highest particle; patches without particles are
/// left out.
///
/// The flank is what lies outside the highest ring between 80 % and 20 % of its height: the tip is rounded and the foot
/// runs out. Its slope is that of a straight line by least squares, the angle of repose its arc tangent.
/// @param centres_m  of the particles, in the scene's frame, all of the same radius.
/// @throws InvalidParameter for nonsense; Failure when fewer than three rings make up the flank: the heap is too small
/// for its particles, or flat. Not for the tick.
[[nodiscard]] HeapProfile heapProfile(std::span<const Vec3> centres_m, const HeapCase& heap);

}  // namespace haptolith
