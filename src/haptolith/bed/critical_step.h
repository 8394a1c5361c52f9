#pragma once

#include "haptolith/soil/soil_parameters.h"

namespace haptolith {

/// Highest natural frequency that a macroparticle of this soil can show, in rad/s.
///
///     m omega^2 = 8 k + 2 k + k_tool
///
/// 8 k: the fastest mode of a close packing of springs k (neighbouring layers against each other); 2 k: a wall, which
/// answers like a mirror image and so twice as stiffly; k_tool: the tool's contact (paper 21), 0 without a tool.
///
/// With contact friction all of it times 1 + k_t / k, for the springs across the contacts, and k is the largest slope
/// of the contact: k itself, or 4 F_c / range where cohesion sets in.
[[nodiscard]] double highestFrequency(const SoilParameters& soil, double tool_stiffness_n_m);

/// Number of equal substeps of `tick_s` that keep dt * omega at or below 1, half of the semi-implicit step's limit
/// of 2; with much damping less, as that lowers the limit.
/// @throws InvalidParameter when more than `max_substeps` would be needed, naming the stiffness that would do.
[[nodiscard]] int substepsFor(const SoilParameters& soil, double tool_stiffness_n_m, double tick_s, int max_substeps);

/// Simulated time that soil needs at most to sink by `height_m` once its particles touch, in s. The paper's damping
/// (20) acts against space, and lets them sink no faster than 2 m g / (p k dt) with p = 12 neighbours; contact
/// friction does not hinder them, and needs none.
[[nodiscard]] double sinkingTime(const SoilParameters& soil, double gravity_m_s2, double height_m, double dt_s);

}  // namespace haptolith
