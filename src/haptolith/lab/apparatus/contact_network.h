#pragma once

#include <cstdint>
#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// Values along a contact's normal and across it.
struct AlongAndAcross {
  double along = 0, across = 0;
};

/// Spring and damper of one contact, as they act on the first particle. A wall is its mirror image, which moves against
/// it (bed/kernel/step_kernel.cpp); this doubles the stiffness along the contact.
struct ContactLink {
  static constexpr std::int32_t kFixed = -1;
  std::int32_t first = 0;
  std::int32_t second = kFixed;  ///< kFixed: a wall, a tool or a driven particle
  Vec3 normal = Vec3::UnitZ();
  AlongAndAcross stiffness_n_m{}, damping_n_s_m{};
};

/// Contacts of a bed with contact friction at one moment; they determine its critical time step.
///
/// Each contact has the stiffness of its law at its overlap, and sticks; a sliding contact is softer. Pairs that only
/// cohere across a gap are included. The rotation of the contact forces themselves, at most 2 % of k, is not.
struct ContactNetwork {
  std::size_t particles = 0;
  double mass_kg = 0;                ///< mass of a particle with the soil's radius
  std::vector<double> mass_ratio{};  ///< mass of each particle over mass_kg; empty: all equal
  std::vector<ContactLink> links;
};

/// @param bed  a bed with contact friction. Not for the tick.
[[nodiscard]] ContactNetwork contactNetwork(const Bed& bed);

/// Adds the contacts with a tool, each with the surface next to it. Their damping depends on the step (paper 21).
void addTool(ContactNetwork& network, const ToolParameters& tool, const Pose& scene_T_tool, double dt_s,
             const Bed& bed);

/// Square of the highest natural frequency of the springs alone, in 1/s^2, to about 1e-6 of it.
[[nodiscard]] double largestFrequencySquared(const ContactNetwork& network);

/// Returns the stability ratio of a step of `dt_s`; above 1 some movement grows.
///
/// The semi-implicit step with damping of the last velocity is
///
///     v' = v - dt/m (K x + C v),   x' = x + dt v'.
///
/// An eigenvector y of it with growth z obeys z^2 - (2 - a - b) z + (1 - b) = 0, where a = y* K y dt^2/m and
/// b = y* C y dt/m are real and not negative; |z| <= 1 while a + 2 b <= 4 (Jury). So the step is stable for any K and
/// C, as long as no eigenvalue of dt^2 K + 2 dt C exceeds 4 m, and at 4 m there is a movement with z = -1: the bound is
/// sharp.
[[nodiscard]] double shareOfStableStep(const ContactNetwork& network, double dt_s);

}  // namespace haptolith
