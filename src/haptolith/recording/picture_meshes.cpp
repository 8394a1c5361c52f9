#include "haptolith/recording/picture_meshes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "haptolith/tool/tool_surface.h"

namespace haptolith {

namespace {

std::array<float, 3> single(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

std::vector<double> values(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

}  // namespace

std::vector<NamedNumbers> numbersOf(const PicturedTool& tool) {
  const Quat& q = tool.pose.orientation;
  return {{"tool_position_m", values(tool.pose.position_m)},
          {"tool_orientation_wxyz", {q.w(), q.x(), q.y(), q.z()}},
          {"tool_opening_m", {tool.opening_m}},
          {"soil_force_n", values(tool.soil.force_n)},
          {"soil_torque_nm", values(tool.soil.torque_nm)}};
}

PictureMesh toolMesh(const ToolParameters& tool, const PicturedTool& at) {
  const ToolSurface surface = toolSurface(tool, at.opening_m);
  PictureMesh mesh{.point_m = {}, .cells = {}, .points_per_cell = 3};
  mesh.point_m.reserve(surface.points_tool_m.size());
  for (const Vec3& point_tool_m : surface.points_tool_m) {
    mesh.point_m.push_back(single(at.pose.toScene(point_tool_m)));
  }
  mesh.cells.reserve(3 * surface.triangles.size());
  for (const auto& triangle : surface.triangles) {
    mesh.cells.insert(mesh.cells.end(), triangle.begin(), triangle.end());
  }
  return mesh;
}

void BoxMesh::show(const ScenePicture& picture) {
  for (std::size_t i = 0; i < picture.position_m.size(); ++i) {
    const float top_m = picture.position_m[i][2] + picture.radius_m[i];
    highest_m_ = std::isfinite(top_m) ? std::max(highest_m_, top_m) : highest_m_;
  }
}

PictureMesh BoxMesh::of(const BedParameters& bed) const {
  PictureMesh box{.point_m = {}, .cells = {}, .points_per_cell = 2};
  for (const float z_m : {0.0F, highest_m_}) {
    for (const auto& [x, y] : {std::array{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
      box.point_m.push_back({static_cast<float>(x * bed.width_m / 2), static_cast<float>(y * bed.length_m / 2), z_m});
    }
  }
  box.cells = {0, 1, 1, 2, 2, 3, 3, 0, 4, 5, 5, 6, 6, 7, 7, 4, 0, 4, 1, 5, 2, 6, 3, 7};
  return box;
}

std::vector<std::int32_t> numbered(std::size_t count) {
  std::vector<std::int32_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

std::string timeText(double time_s) {
  return fmt::format("{:.12g}", time_s);
}

}  // namespace haptolith
