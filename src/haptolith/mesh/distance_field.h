#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/mesh/mend.h"
#include "haptolith/mesh/triangle_mesh.h"

namespace haptolith {

inline constexpr Range kFieldSpacing_m{5e-5, 1e-2};
inline constexpr Range kFieldBand_m{1e-3, 3e-2};

struct DistanceFieldOptions {
  double spacing_m =
      0.4e-3;            ///< spacing of the grid's points, kFieldSpacing_m; more when it would not fit `most_bytes`
  double band_m = 5e-3;  ///< distance from the surface covered by the field, kFieldBand_m
  int threads = 2;       ///< at least 1; any number gives the same field
  std::size_t most_bytes = std::size_t{96} << 20;
};

/// Distance of points from the surface of a mesh, in the mesh frame. At the points of a grid the distance is that to
/// the nearest triangle, as a float; between them it is trilinear. Only blocks of the grid near the surface are kept.
class DistanceField {
 public:
  struct Sample {
    double distance_m;  ///< negative inside; at most the band, at least minus the band
    Vec3 gradient;      ///< unit vector in which the distance grows most; an arbitrary one where it is not known
  };

  /// At a point, in the mesh's frame. A point that is not finite is outside. May be called in the tick.
  [[nodiscard]] Sample at(const Vec3& point_m) const noexcept;

  [[nodiscard]] double spacing() const noexcept { return spacing_m_; }
  [[nodiscard]] double band() const noexcept { return band_m_; }
  /// The box around the surface, of a sheet with its thickness.
  [[nodiscard]] const MeshCorners& corners() const noexcept { return corners_; }
  /// Radius of the sphere around the origin that holds the surface, in m.
  [[nodiscard]] double enclosingRadius() const noexcept { return enclosing_radius_m_; }
  /// Memory that it takes.
  [[nodiscard]] std::size_t bytes() const noexcept;
  /// XXH3 over all values, where they are, and the band. Not for the tick.
  [[nodiscard]] std::uint64_t hash() const;
  /// Deviations from the request, a sentence each.
  [[nodiscard]] const std::vector<std::string>& report() const noexcept { return report_; }

 private:
  friend class FieldMaker;
  friend DistanceField makeDistanceField(const MendedMesh& mended, const DistanceFieldOptions& options);
  DistanceField() = default;

  /// Cells along a block's edge. Each keeps the points of its far faces, too, so that a cell's eight are together.
  static constexpr int kCells = 8;
  static constexpr int kPoints = kCells + 1;
  static constexpr std::size_t kBlockValues = std::size_t{kPoints} * kPoints * kPoints;
  /// In the table, of blocks that are farther from the surface than the band.
  static constexpr std::int32_t kOutside = -1;
  static constexpr std::int32_t kInside = -2;

  double spacing_m_ = 0;
  double band_m_ = 0;
  Vec3 low_m_ = Vec3::Zero();        // the grid's lowest point
  std::array<int, 3> blocks_{};      // along x, y, z
  std::vector<std::int32_t> table_;  // of all blocks, x fastest: which of `values_`, or where it is
  std::vector<float> values_;        // distance in m, kBlockValues for each block near the surface, x fastest
  MeshCorners corners_;
  double enclosing_radius_m_ = 0;
  std::vector<std::string> report_;
};

/// Measures how far the points of a grid are from a mesh.
///
///     closed:  |d| to the nearest triangle of the outer surface, d < 0 where closed parts go round the point
///     sheet:   d = (distance to the nearest triangle) - thickness / 2
///
/// For intersecting parts it is exact to the union, except within a quarter of the spacing of the edges
/// of intersection. Takes seconds for 500 000 triangles. Not for the tick.
/// @throws InvalidParameter for options outside their ranges, and when the thinnest walls (thinnestWall()) are less
/// than two spacings thick; Failure when stopAsked().
[[nodiscard]] DistanceField makeDistanceField(const MendedMesh& mended, const DistanceFieldOptions& options = {});

}  // namespace haptolith
