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

/// More triangles, of points in a frame whose place in the scene is `scene_T_points`.
void append(PictureMesh& mesh, const std::vector<Vec3>& points_m,
            const std::vector<std::array<std::int32_t, 3>>& triangles, const Pose& scene_T_points) {
  const auto first = static_cast<std::int32_t>(mesh.point_m.size());
  for (const Vec3& point_m : points_m) {
    mesh.point_m.push_back(single(scene_T_points.fromBody(point_m)));
  }
  for (const auto& triangle : triangles) {
    for (const std::int32_t point : triangle) {
      mesh.cells.push_back(first + point);
    }
  }
}

}  // namespace

std::vector<NamedNumbers> numbersOf(const PicturedTool& at, const ToolParameters& tool) {
  const Quat& q = at.hub.orientation;
  std::vector<NamedNumbers> numbers{{"tool_position_m", values(at.hub.position_m)},
                                    {"tool_orientation_wxyz", {q.w(), q.x(), q.y(), q.z()}},
                                    {"tool_opening_m", {at.opening_m}},
                                    {"soil_force_n", values(at.soil.force_n)},
                                    {"soil_torque_nm", values(at.soil.torque_nm)}};
  if (tool.joint.any()) {
    numbers.push_back({"joint_angle_rad", {at.joint.angle_rad}});
    numbers.push_back({"joint_speed_rad_s", {at.joint.speed_rad_s}});
    numbers.push_back({"joint_soil_torque_nm", {at.joint.soil_torque_nm}});
    numbers.push_back({"joint_motor_torque_nm", {at.joint.motor_torque_nm}});
  }
  return numbers;
}

std::vector<std::string> toolFileNames(const RecordedPictures& pictures) {
  if (!pictures.sceneFile()) {
    return {};
  }
  const std::vector<std::string_view> names = toolNames(*pictures.sceneFile());
  if (names.size() == 1) {
    return {"tool"};
  }
  std::vector<std::string> files;
  for (const std::string_view name : names) {
    files.push_back(fmt::format("tool-{}", name));
  }
  return files;
}

PictureMesh toolMesh(const ToolParameters& tool, const PicturedTool& at) {
  const ToolSurface surface = toolSurface(tool, at.opening_m);
  PictureMesh mesh{.point_m = {}, .cells = {}, .points_per_cell = 3};
  mesh.point_m.reserve(surface.points_tool_m.size());
  mesh.cells.reserve(3 * surface.triangles.size());
  append(mesh, surface.points_tool_m, surface.triangles, at.pose);
  return mesh;
}

PictureMesh stonesMesh(const std::vector<PicturedStone>& stones) {
  PictureMesh mesh{.point_m = {}, .cells = {}, .points_per_cell = 3};
  for (const auto& [scene_T_stone, shape] : stones) {
    append(mesh, shape->shown.points_m, shape->shown.triangles, scene_T_stone);
    if (!shape->shown.triangles.empty()) {
      continue;
    }
    for (const StoneSphere& sphere : shape->spheres) {
      const ToolSurface ball = toolSurface({.shape = ToolShape::kSphere, .diameter_m = 2 * sphere.radius_m}, 0);
      append(mesh, ball.points_tool_m, ball.triangles,
             {scene_T_stone.fromBody(sphere.centre_m), scene_T_stone.orientation});
    }
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
