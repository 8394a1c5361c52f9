#pragma once

#include <cstdint>
#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/core/vec.h"
#include "haptolith/soil/soil_parameters.h"
#include "haptolith/tool/tool_memory.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// Force on one particle along the tool's outward normal, in N, > 0 pushing it away (paper 21):
///
///     F = k_tool z + c_tool z_dot   for z > -0.002 R,   c_tool = damping_factor dt k_tool / 2
///
/// Between -0.002 R and 0 the spring pulls: dust that sticks to the tool. May be called in the tick.
/// @param depth_m      z, penetration of the particle's sphere into the tool.
/// @param closing_m_s  z_dot, how fast the penetration grows.
[[nodiscard]] double toolForce(const ToolParameters& tool, double radius_m, double dt_s, double depth_m,
                               double closing_m_s) noexcept;

/// Contribution of a tool to a particle's stiffness for substepsFor(), in N/m: k_tool, twice where
/// jaws hold the particle from both sides. With contact friction its damper comes to it, 2 c_tool / dt: the step bears
/// dt^2 k + 2 dt c. The paper's steps have room for it.
[[nodiscard]] double stiffnessInStep(const ToolParameters& tool, FrictionModel friction) noexcept;

/// As above for several tools that may hold one particle between them. A particle that two of them press has soil on
/// neither side: the second stands where the step expects a wall, which is 2 k stiff, so only what exceeds that counts.
[[nodiscard]] double stiffnessInStep(std::span<const ToolParameters> tools, const SoilParameters& soil) noexcept;

/// Largest distance of a particle's centre from the tool's surface at which a force acts, in m.
[[nodiscard]] double contactReach(const ToolParameters& tool, const SoilParameters& soil) noexcept;

/// As above for any sphere in a bed, those of stones included.
[[nodiscard]] double contactReach(const ToolParameters& tool, const BedParameters& bed) noexcept;

/// Reaction of the soil on the tool.
struct ToolReaction {
  Wrench wrench;  ///< about the tool's origin, scene frame
  /// Derivative of the force by a small movement of the tool, with unchanged particle velocities: dF = -stiffness dx.
  /// The sum of k_tool s n n^T over the contacts, in N/m, scene frame; n is the normal, s the fraction of the tool's
  /// speed along n that the contact takes up: 1 when the particle stays where it is, 0 when it moves with the tool.
  Eigen::Matrix3d stiffness_n_m = Eigen::Matrix3d::Zero();
  /// Force of the soil that opens the jaws, > 0 opening them: half the difference of its forces on the right and the
  /// left jaw, along the tool's x. With it, wrench times twist and grip_n times opening speed are the power of the soil
  /// on the tool. 0 with other tools.
  double grip_n = 0;
};

/// The tool against all particles: writes their forces to `forces` and returns the reaction on the tool. Particles
/// further from the box around the tool than contact reaches are passed over without an exact test, 16 at a time. May
/// be called in the tick.
///
/// Soil with ICRA 2021 friction meets the tool as (paper 21) says. With contact friction the normal force is the
/// same while they overlap, but damping never pulls, adhesion is the tool's own (as cohesion, see cohesionAcross()),
/// and Coulomb friction with a memory acts along the surface, tan(delta) (N + F_adhesion) at most.
/// @param tool    of jaws, `opening_m` is how far apart they are now.
/// @param scene_T_tool  pose of the tool; `twist` its velocity.
/// @param opening_m_s  how fast jaws open.
/// @param state   positions and velocities.
/// @param memory  read and written.
/// @param forces  one per particle; overwritten with the tool's force, 0 where it does not reach.
ToolReaction applyToolContact(const ToolParameters& tool, const Pose& scene_T_tool, const Twist& twist,
                              const SoilParameters& soil, double dt_s, const BedState& state,
                              const ParticleMemory& memory, std::vector<Float4>& forces,
                              double opening_m_s = 0) noexcept;

/// As above for a tool in a bed: only particles near it are checked. The forces, and those on stones, are for the next
/// step, and come to those of other tools.
ToolReaction applyToolContact(const ToolParameters& tool, const Pose& scene_T_tool, const Twist& twist, double dt_s,
                              Bed& bed, ToolMemory& memory, double opening_m_s = 0) noexcept;

}  // namespace haptolith
