#pragma once

#include "haptolith/core/vec.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// One of two jaws as a plate that is bent about an axis along the tool's y: how its flat plate is laid round the arc.
///
///     rho = length / bend        of the plate's middle
///     (x, z) of the tool  ->  (rho theta, r - rho) of the plate, |theta| <= bend / 2; beyond, along the end's tangent
///
/// Distances to the faces and to the ends' edges are exact: a face is as far from a point as the circle that it is, and
/// beyond an end the plate is seen straight. Functions may be called in the tick.
class JawShell {
 public:
  /// @param side  -1: the jaw at x < 0; +1: at x > 0.
  JawShell(const ToolParameters& tool, int side) noexcept;

  /// A point near the jaw, in the frame of the flat plate: z becomes x, and the outside of the right jaw z > 0.
  struct Place {
    Vec3 flat_m;
    double cosine, sine;  ///< cos theta, sin theta
  };
  [[nodiscard]] Place flattened(const Vec3& tool_m) const noexcept;
  /// A direction there, back in the tool's frame.
  [[nodiscard]] Vec3 bent(const Vec3& flat, const Place& place) const noexcept;

  /// Half the height of the jaw along the tool's z, and how far its outer face reaches along x, both in m.
  [[nodiscard]] double halfHeight() const noexcept { return half_height_m_; }
  [[nodiscard]] double farthestX() const noexcept { return farthest_x_m_; }
  /// Maps a point of the flat plate (along, across, out of it) to the shell. The inverse of flattened(), for |along| <=
  /// length / 2.
  [[nodiscard]] Vec3 onTool(const Vec3& flat_m) const noexcept;

 private:
  double side_, half_length_m_;
  double end_x_m_;  ///< x of the plate's mid-surface, at its ends
  double farthest_x_m_, half_height_m_;
  double bend_rad_, radius_m_;                   ///< 0: flat
  double axis_x_m_ = 0, cosine_ = 1, sine_ = 0;  ///< cos and sin of half the bend
};

}  // namespace haptolith
