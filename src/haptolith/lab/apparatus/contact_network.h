#pragma once

#include <cstdint>
#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// What holds a particle along a contact and across it.
struct AlongAndAcross {
  double along = 0, across = 0;
};

/// Spring and damper of one contact, as the first particle feels them: a wall is its mirror image, which moves against
/// it (bed/kernel/step_kernel.cpp), and so twice as stiff along the contact.
struct ContactLink {
  static constexpr std::int32_t kFixed = -1;
  std::int32_t first = 0;
  std::int32_t second = kFixed;  ///< or a wall, a tool or a driven particle, none of which gives way
  Vec3 normal = Vec3::UnitZ();
  AlongAndAcross stiffness_n_m{}, damping_n_s_m{};
};

/// The contacts of a bed with contact friction as they are at one moment: what decides how short its steps must be.
///
/// Each contact is as stiff as its law there, and sticks: one that slides is softer. What is cohering only, across a
/// gap, is in it, too. The turning of the contact forces themselves, at most 2 % of k, is not.
struct ContactNetwork {
  std::size_t particles = 0;
  double mass_kg = 0;                ///< of a particle of the soil's own radius
  std::vector<double> mass_ratio{};  ///< of each particle over that; empty: all alike
  std::vector<ContactLink> links;
};

/// @param bed  one with contact friction. Not for the tick.
[[nodiscard]] ContactNetwork contactNetwork(const Bed& bed);

/// Adds what touches a tool. Its damping goes with the step (paper 21).
void addTool(ContactNetwork& network, const ToolParameters& tool, const Pose& scene_T_tool, double dt_s,
             const Bed& bed);

/// Square of the highest natural frequency of the springs alone, in 1/s^2, to about 1e-6 of it.
[[nodiscard]] double largestFrequencySquared(const ContactNetwork& network);

/// How much of what the step can bear a step of `dt_s` asks of it; above 1 some movement grows.
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
