#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "haptolith/bed/bed.h"

namespace haptolith {

/// Square cells of a map, scene frame seen from above: columns along x, rows along y.
struct HeightGrid {
  double x_m = 0, y_m = 0;  ///< corner of the first cell
  double cell_m = 0;        ///< width of each
  std::size_t columns = 0, rows = 0;

  [[nodiscard]] std::size_t cells() const noexcept { return columns * rows; }
  [[nodiscard]] bool operator==(const HeightGrid&) const = default;
};

/// Cells of that width, a grain's width away from the sides; at least one.
[[nodiscard]] HeightGrid gridWithinSides(const BedParameters& bed, double cell_m);

/// The part of a bed that a camera above it sees.
struct SeenSoil {
  double radius_m = 0;         ///< radius of a particle
  std::vector<Float4> grains;  ///< as BedState::position
  std::vector<Float4> stones;  ///< spheres of the stones, as above
};
[[nodiscard]] SeenSoil seenSoil(const Bed& bed);
/// As above for a moment from which particles of this radius and poses of stones were copied, while the bed continues:
/// only the stones' shapes, which never change, are read from the bed.
[[nodiscard]] SeenSoil seenSoil(const Bed& bed, double radius_m, std::span<const Float4> grains,
                                std::span<const Pose> stones);

/// Height of the soil over the floor in each cell, in m, row by row: of the spheres, as seen from above, the mean of
/// `rays` by `rays` places. Not for the tick.
[[nodiscard]] std::vector<double> surfaceHeights(const SeenSoil& seen, const HeightGrid& grid, std::size_t rays);

/// Mean height of the soil as a camera above it would see it, stones taken away, over the floor, in m: over a grid as
/// fine as half a grain. Soil of other grains lies as high by it where it was filled as high, which its highest grain
/// does not. Not for the tick.
[[nodiscard]] double meanSurfaceHeight(const Bed& bed);
[[nodiscard]] double meanSurfaceHeight(SeenSoil seen, const BedParameters& bed);

}  // namespace haptolith
