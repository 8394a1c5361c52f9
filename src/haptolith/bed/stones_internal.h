// What the parts of Stones share: stones.cpp, stones_neighbours.cpp and stones_restore.cpp.

#pragma once

#include <cstddef>

#include "haptolith/bed/bed_state.h"
#include "haptolith/core/vec.h"

namespace haptolith {

/// Bits of a word in which each sphere of a stone has one.
inline constexpr std::size_t kSphereBits = 64;

/// Other stones next to one, counted once for each pair.
inline constexpr std::size_t kMostPartners = 64;

[[nodiscard]] inline Vec3 placeOf(const Float4& p) noexcept {
  return {p.x, p.y, p.z};
}

[[nodiscard]] inline Vec3 inFrame(const Eigen::Matrix3d& scene_R_frame, const Vec3& v) noexcept {
  return scene_R_frame.transpose() * v;
}

}  // namespace haptolith
