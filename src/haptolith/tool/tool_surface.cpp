#include "haptolith/tool/tool_surface.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "haptolith/core/math/portable_math.h"
#include "haptolith/tool/jaw_shell.h"
#include "haptolith/tool/tool_mesh.h"

namespace haptolith {

namespace {

constexpr std::int32_t kArcSegments = 24;
constexpr int kSegments = 48;  ///< round the axis; the eye takes it for a circle

ToolSurface boxSurface(const Vec3& size_m, const Vec3& middle_m) {
  ToolSurface box;
  for (const int z : {-1, 1}) {
    for (const auto& [x, y] : {std::array{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
      box.points_tool_m.emplace_back(middle_m + size_m.cwiseProduct(Vec3(x, y, z)) / 2);
    }
  }
  box.triangles = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}};  // below, above
  for (std::int32_t i = 0; i < 4; ++i) {
    const std::int32_t next = (i + 1) % 4;
    box.triangles.push_back({i, next, next + 4});
    box.triangles.push_back({i, next + 4, i + 4});
  }
  return box;
}

/// A point of an outline: distance from the tool's axis and height, in m.
struct OutlinePoint {
  double radius_m, z_m;
};

/// Surface of revolution of an outline about the z axis: its first and last points lie on the axis, or it is closed.
ToolSurface turned(const std::vector<OutlinePoint>& outline) {
  ToolSurface surface;
  std::vector<std::int32_t> first;  // point of each of the outline's; one on the axis has a single one
  for (const auto& [radius_m, z_m] : outline) {
    first.push_back(static_cast<std::int32_t>(surface.points_tool_m.size()));
    for (int segment = 0; segment < (radius_m > 0 ? kSegments : 1); ++segment) {
      const double angle = 2 * std::numbers::pi * segment / kSegments;
      surface.points_tool_m.emplace_back(radius_m * portable::cos(angle), radius_m * portable::sin(angle), z_m);
    }
  }
  const bool closed = outline.front().radius_m > 0;
  const auto point = [&](std::size_t i, int segment) {
    return outline[i].radius_m > 0 ? first[i] + segment % kSegments : first[i];
  };
  for (std::size_t i = 0; i < outline.size() - (closed ? 0 : 1); ++i) {
    const std::size_t next = (i + 1) % outline.size();
    for (int segment = 0; segment < kSegments; ++segment) {
      if (outline[i].radius_m > 0) {
        surface.triangles.push_back({point(i, segment), point(i, segment + 1), point(next, segment + 1)});
      }
      if (outline[next].radius_m > 0) {
        surface.triangles.push_back({point(i, segment), point(next, segment + 1), point(next, segment)});
      }
    }
  }
  return surface;
}

std::vector<OutlinePoint> sphereOutline(double radius_m) {
  constexpr int kParallels = kSegments / 2;
  std::vector<OutlinePoint> outline{{0, -radius_m}};
  for (int i = 1; i < kParallels; ++i) {
    const double angle = std::numbers::pi * i / kParallels;
    outline.push_back({radius_m * portable::sin(angle), -radius_m * portable::cos(angle)});
  }
  outline.push_back({0, radius_m});
  return outline;
}

std::vector<OutlinePoint> cylinderOutline(double rim_m, double half_height_m) {
  return {{0, -half_height_m}, {rim_m, -half_height_m}, {rim_m, half_height_m}, {0, half_height_m}};
}

std::vector<OutlinePoint> coneOutline(const ToolParameters& tool) {
  const double rim_m = tool.diameter_m / 2;
  const double height_m = rim_m / portable::tan(tool.cone_angle_rad / 2);
  std::vector<OutlinePoint> outline{{0, 0}, {rim_m, height_m}};
  if (tool.length_m > height_m) {
    outline.push_back({rim_m, tool.length_m});
  }
  outline.push_back({0, outline.back().z_m});
  return outline;
}

/// Round the wall of a tube, whose ends are half circles.
std::vector<OutlinePoint> tubeOutline(const ToolParameters& tool) {
  constexpr int kHalfCircle = 8;
  const double wall_m = tool.thickness_m / 2;
  std::vector<OutlinePoint> outline;
  for (const int end : {1, -1}) {
    for (int i = 0; i <= kHalfCircle; ++i) {
      const double angle = std::numbers::pi * i / kHalfCircle;
      outline.push_back({std::max(tool.diameter_m / 2 + end * wall_m * portable::cos(angle), wall_m * 1e-6),
                         end * (tool.length_m / 2 + wall_m * portable::sin(angle))});
    }
  }
  return outline;
}

/// @param side  -1 or 1: see JawShell.
ToolSurface jawSurface(const ToolParameters& tool, int side) {
  const Vec3 half_m = tool.size_m / 2;
  if (tool.jaw_bend_rad == 0) {
    return boxSurface({tool.size_m.z(), tool.size_m.y(), tool.size_m.x()},
                      {side * (tool.opening_m + tool.size_m.z()) / 2, 0, 0});
  }
  const JawShell shell(tool, side);
  ToolSurface jaw;
  for (std::int32_t station = 0; station <= kArcSegments; ++station) {
    const double along_m = half_m.x() * (2.0 * station / kArcSegments - 1);
    for (const auto& [x, y] : {std::array{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
      jaw.points_tool_m.push_back(shell.onTool({along_m, y * half_m.y(), x * half_m.z()}));
    }
  }
  jaw.triangles = {{0, 2, 1}, {0, 3, 2}};  // below
  for (std::int32_t first = 0; first < 4 * kArcSegments; first += 4) {
    for (std::int32_t i = 0; i < 4; ++i) {
      const std::int32_t next = (i + 1) % 4;
      jaw.triangles.push_back({first + i, first + next, first + next + 4});
      jaw.triangles.push_back({first + i, first + next + 4, first + i + 4});
    }
  }
  constexpr std::int32_t kTop = 4 * kArcSegments;
  jaw.triangles.push_back({kTop, kTop + 1, kTop + 2});
  jaw.triangles.push_back({kTop, kTop + 2, kTop + 3});
  return jaw;
}

ToolSurface jawsSurface(const ToolParameters& tool, double opening_m) {
  ToolParameters now = tool;
  now.opening_m = opening_m;
  ToolSurface jaws = jawSurface(now, -1);
  const ToolSurface right = jawSurface(now, 1);
  const auto left_points = static_cast<std::int32_t>(jaws.points_tool_m.size());
  jaws.points_tool_m.insert(jaws.points_tool_m.end(), right.points_tool_m.begin(), right.points_tool_m.end());
  for (const auto& [a, b, c] : right.triangles) {
    jaws.triangles.push_back({a + left_points, b + left_points, c + left_points});
  }
  return jaws;
}

}  // namespace

ToolSurface toolSurface(const ToolParameters& tool, double opening_m) {
  const double rim_m = tool.diameter_m / 2;
  switch (tool.shape) {
    case ToolShape::kBox: return boxSurface(tool.size_m, Vec3::Zero());
    case ToolShape::kSphere: return turned(sphereOutline(rim_m));
    case ToolShape::kPlate: return turned(cylinderOutline(rim_m, tool.thickness_m / 2));
    case ToolShape::kCylinder: return turned(cylinderOutline(rim_m, tool.length_m / 2));
    case ToolShape::kCone: return turned(coneOutline(tool));
    case ToolShape::kTube: return turned(tubeOutline(tool));
    case ToolShape::kJaws: return jawsSurface(tool, opening_m);
    case ToolShape::kMesh: return {tool.mesh->surface.points_m, tool.mesh->surface.triangles};
  }
  return {};
}

}  // namespace haptolith
