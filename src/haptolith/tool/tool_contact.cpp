#include "haptolith/tool/tool_contact.h"

#include <algorithm>

#include "haptolith/tool/tool_shape.h"

namespace haptolith {

double toolForce(const ToolParameters& tool, double radius_m, double dt_s, double depth_m,
                 double closing_m_s) noexcept {
  if (depth_m <= -tool.adhesion_ratio * radius_m) {
    return 0;
  }
  const double damping = tool.damping_factor * dt_s * tool.stiffness_n_m / 2;
  return tool.stiffness_n_m * depth_m + damping * closing_m_s;
}

namespace {

/// How much of the tool's movement a contact really takes up: 1 when the particle stays where it is, 0 when it is
/// pushed along, carried or flees.
double heldShare(double closing_m_s, double tool_speed_m_s) noexcept {
  return tool_speed_m_s == 0 ? 1 : std::clamp(closing_m_s / tool_speed_m_s, 0.0, 1.0);
}

}  // namespace

ToolReaction applyToolContact(const ToolParameters& tool, const Pose& scene_T_tool, const Twist& twist, double radius_m,
                              double dt_s, const BedState& state, std::vector<std::int8_t>& tool_side,
                              std::vector<Float4>& forces) noexcept {
  const double reach = enclosingRadius(tool) + (1 + tool.adhesion_ratio) * radius_m;
  const auto reach_squared = static_cast<float>(reach * reach);
  const auto tool_x = static_cast<float>(scene_T_tool.position_m.x());
  const auto tool_y = static_cast<float>(scene_T_tool.position_m.y());
  const auto tool_z = static_cast<float>(scene_T_tool.position_m.z());
  const Eigen::Matrix3d rotation = scene_T_tool.orientation.toRotationMatrix();

  ToolReaction reaction;
  for (std::size_t i = 0; i < state.particles(); ++i) {
    const Float4& p = state.position[i];
    const float dx = p.x - tool_x;
    const float dy = p.y - tool_y;
    const float dz = p.z - tool_z;
    forces[i] = {};
    if (dx * dx + dy * dy + dz * dz > reach_squared) {
      tool_side[i] = 0;
      continue;
    }
    const Vec3 lever = Vec3(p.x, p.y, p.z) - scene_T_tool.position_m;
    const Penetration contact = penetration(tool, rotation.transpose() * lever, radius_m, tool_side[i]);
    tool_side[i] = static_cast<std::int8_t>(contact.side);

    const Vec3 outward = rotation * contact.outward;
    const Vec3 point = lever - outward * (radius_m - contact.depth_m);  // on the tool's surface, from its origin
    const Float4& v = state.velocity[i];
    const double tool_speed = outward.dot(twist.at(point));
    const double closing = tool_speed - outward.dot(Vec3(v.x, v.y, v.z));
    const double push = toolForce(tool, radius_m, dt_s, contact.depth_m, closing);
    if (push != 0) {
      const Vec3 on_particle = push * outward;
      forces[i] = {static_cast<float>(on_particle.x()), static_cast<float>(on_particle.y()),
                   static_cast<float>(on_particle.z()), 0};
      reaction.wrench.add(-on_particle, point);
      reaction.stiffness_n_m += tool.stiffness_n_m * heldShare(closing, tool_speed) * outward * outward.transpose();
    }
  }
  return reaction;
}

}  // namespace haptolith
