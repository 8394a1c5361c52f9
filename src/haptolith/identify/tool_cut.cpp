#include "haptolith/identify/tool_cut.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace haptolith {

namespace {

constexpr double kStill_m_s = 0.002;
constexpr double kUpwards = 0.3;  // sine of the max. upward slope of a cut

}  // namespace

std::optional<ToolCut> cutOf(const ToolSurface& surface, const Pose& site_T_tool, const Vec3& velocity_m_s) {
  const double speed_m_s = velocity_m_s.norm();
  if (!(speed_m_s >= kStill_m_s) || velocity_m_s.z() > kUpwards * speed_m_s) {
    return std::nullopt;
  }
  std::vector<Vec3> points;
  points.reserve(surface.points_tool_m.size());
  double lowest_m = 0;
  for (const Vec3& point : surface.points_tool_m) {
    points.push_back(site_T_tool.fromBody(point));
    lowest_m = std::min(lowest_m, points.back().z());
  }
  if (-lowest_m < kLeastDepth_m) {
    return std::nullopt;
  }
  Vec3 leading = Vec3::Zero();
  for (const auto& [a, b, c] : surface.triangles) {
    const Vec3& corner = points[static_cast<std::size_t>(a)];
    const Vec3 normal_m2 =
        (points[static_cast<std::size_t>(b)] - corner).cross(points[static_cast<std::size_t>(c)] - corner);
    const double lowest_corner_m =
        std::min({corner.z(), points[static_cast<std::size_t>(b)].z(), points[static_cast<std::size_t>(c)].z()});
    const double sweeps = normal_m2.dot(velocity_m_s) / speed_m_s;
    if (sweeps > 0 && lowest_corner_m < 0) {
      leading += normal_m2.normalized() * sweeps;
    }
  }
  ToolCut cut;
  cut.depth_m = -lowest_m;
  const Vec3 across(velocity_m_s.x(), velocity_m_s.y(), 0);
  cut.ahead = across.norm() > 0.1 * speed_m_s ? Vec3(across.normalized()) : Vec3::UnitX();
  cut.rake_rad = std::atan2(leading.dot(cut.ahead), leading.z());
  return leading.isZero() ? std::nullopt : std::optional(cut);
}

}  // namespace haptolith
