#include "haptolith/mesh/distance_field.h"

#include <xxhash.h>

#include <algorithm>

namespace haptolith {

DistanceField::Sample DistanceField::at(const Vec3& point_m) const noexcept {
  const Vec3 g = (point_m - low_m_) / spacing_m_;
  std::array<int, 3> cell;
  std::array<double, 3> part;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double along = g[static_cast<Eigen::Index>(axis)];
    if (!(along >= 0 && along < blocks_[axis] * kCells)) {  // also catches NaN
      return {band_m_, Vec3::UnitZ()};
    }
    cell[axis] = static_cast<int>(along);
    part[axis] = along - cell[axis];
  }
  const auto block = static_cast<std::size_t>(
      (std::int64_t{cell[2] / kCells} * blocks_[1] + cell[1] / kCells) * blocks_[0] + cell[0] / kCells);
  const std::int32_t entry = table_[block];
  if (entry < 0) {
    return {entry == kInside ? -band_m_ : band_m_, Vec3::UnitZ()};
  }
  constexpr std::size_t kRow = kPoints;
  constexpr std::size_t kLayer = std::size_t{kPoints} * kPoints;
  const float* v = values_.data() + static_cast<std::size_t>(entry) * kBlockValues +
                   static_cast<std::size_t>(cell[2] % kCells) * kLayer +
                   static_cast<std::size_t>(cell[1] % kCells) * kRow + static_cast<std::size_t>(cell[0] % kCells);
  const auto [x, y, z] = part;
  // Along x on the four edges, then along y, then z; and the same for the slopes.
  const std::array<double, 4> low{v[0], v[kRow], v[kLayer], v[kLayer + kRow]};
  const std::array<double, 4> slope{v[1] - low[0], v[kRow + 1] - low[1], v[kLayer + 1] - low[2],
                                    v[kLayer + kRow + 1] - low[3]};
  const std::array<double, 4> d{low[0] + x * slope[0], low[1] + x * slope[1], low[2] + x * slope[2],
                                low[3] + x * slope[3]};
  const double near = d[0] + y * (d[1] - d[0]);
  const double far = d[2] + y * (d[3] - d[2]);
  const double slope_near = slope[0] + y * (slope[1] - slope[0]);
  const double slope_far = slope[2] + y * (slope[3] - slope[2]);
  const Vec3 gradient(slope_near + z * (slope_far - slope_near), d[1] - d[0] + z * (d[3] - d[2] - d[1] + d[0]),
                      far - near);
  const double steep = gradient.norm();
  const double distance_m = std::clamp(near + z * (far - near), -band_m_, band_m_);
  return {distance_m, steep > 1e-6 * spacing_m_ ? Vec3(gradient / steep) : Vec3(Vec3::UnitZ())};
}

std::size_t DistanceField::bytes() const noexcept {
  return values_.size() * sizeof(float) + table_.size() * sizeof(std::int32_t);
}

std::uint64_t DistanceField::hash() const {
  const std::array<double, 5> where{spacing_m_, band_m_, low_m_.x(), low_m_.y(), low_m_.z()};
  std::uint64_t hash = XXH3_64bits(where.data(), sizeof where);
  hash = XXH3_64bits_withSeed(blocks_.data(), sizeof blocks_, hash);
  hash = XXH3_64bits_withSeed(table_.data(), table_.size() * sizeof table_[0], hash);
  return XXH3_64bits_withSeed(values_.data(), values_.size() * sizeof values_[0], hash);
}

}  // namespace haptolith
