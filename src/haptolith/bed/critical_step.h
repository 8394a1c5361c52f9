#pragma once

#include "haptolith/bed/bed_parameters.h"
#include "haptolith/soil/soil_parameters.h"

namespace haptolith {

/// Steps that a bed of this soil needs in a second at least.
///
/// With ICRA 2021 friction 1 / dt = omega, half of the semi-implicit step's limit:
///
///     m omega^2 = 8 k + 2 k + k_tool
///
/// 8 k: the fastest mode of a close packing of springs k (neighbouring layers against each other); 2 k: a wall, which
/// answers like a mirror image and so twice as stiffly; k_tool: the tool's contact (paper 21), 0 without a tool.
///
/// With contact friction springs and dampers do not share their modes; the step is stable while no eigenvalue of
/// dt^2 K + 2 dt C exceeds 4 m (lab/apparatus/contact_network.h). These are measured, walls included; see packing() in
/// critical_step.cpp. k is the largest slope of the contact: k itself, or 4 F_c / range where cohesion sets in.
/// @param tool_stiffness_n_m  as stiffnessInStep() gives it.
[[nodiscard]] double stepsPerSecond(const SoilParameters& soil, double tool_stiffness_n_m);

/// As above for a bed: for its finest particles, on which a tool is softer (ToolParameters::stiffness_n_m), and for its
/// lightest stones; see stepsForStone() in critical_step.cpp.
[[nodiscard]] double stepsPerSecond(const BedParameters& bed, double tool_stiffness_n_m);

/// Number of equal substeps of `tick_s` that make up stepsPerSecond().
/// @throws InvalidParameter when more than `max_substeps` would be needed, naming the stiffness that would do.
[[nodiscard]] int substepsFor(const SoilParameters& soil, double tool_stiffness_n_m, double tick_s, int max_substeps);

/// As above for a bed.
/// @throws InvalidParameter also when a stone is so light that more than `max_substeps` would be needed, with its size
/// and the least that would do.
[[nodiscard]] int substepsFor(const BedParameters& bed, double tool_stiffness_n_m);

/// Simulated time that soil needs at most to sink by `height_m` once its particles touch, in s. The paper's damping
/// (20) acts against space, and lets them sink no faster than 2 m g / (p k dt) with p = 12 neighbours; contact
/// friction does not hinder them, and needs none.
[[nodiscard]] double sinkingTime(const SoilParameters& soil, double gravity_m_s2, double height_m, double dt_s);

}  // namespace haptolith
