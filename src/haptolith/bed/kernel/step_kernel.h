#pragma once

#include <cstddef>
#include <cstdint>

#include "haptolith/bed/kernel/kernel_law.h"
#include "haptolith/bed/kernel/step_arrays.h"

namespace haptolith {

/// Constants of one step, in the particles' precision.
struct StepConstants {
  float dt;
  float weight_x, weight_y, weight_z;  ///< weight of a particle of class 0, N
  float inverse_mass;                  ///< 1/m of a particle of class 0, 1/kg
  float skin_half_squared;     ///< (skin / 2)^2 of class 0, m^2: a particle that has moved further is listed again
  float rest_squared;          ///< (m/s)^2: what moves faster is not at rest
  std::uint64_t pruning_pass;  ///< number of the present pruning pass, see InnerRows
  float inner_skin_m;          ///< inner list: distances up to the cutoff plus this, m
  // ICRA 2021 friction:
  float damping, static_friction, moving_friction;
  // Contact friction:
  float friction_ratio;  ///< friction and cohesion over the soil's: 1, and 0 while settling
  float drag;            ///< share of the speed kept, 1 but while settling
};

/// Floor at z = 0, and the side walls where the box does not repeat itself.
struct StepBox {
  float half_width, half_length;
  bool walls_x, walls_y;
  float wall_ratio;  ///< friction and cohesion of the side walls over the soil's, contact friction only
  Periods periods;
};

/// Particles that have moved further than half the skin from their reference position, and the largest speed.
struct Moved {
  std::int32_t* particle;  ///< indices, with room for all
  std::size_t count = 0;
  bool finite = true;         ///< false if a position is NaN or infinite
  float fastest_squared = 0;  ///< (m/s)^2, of all particles
};

/// Steps the particles of arrays.groups[first..last-1]: their neighbours, weight, walls and others' forces, then
/// velocity, then position. May be called in the tick; parts of one bed may be stepped by several threads at once.
void stepWithIcra2021Friction(const KernelLaw& law, const StepConstants& now, const StepBox& box,
                              const StepArrays& arrays, std::size_t first, std::size_t last, Moved& moved) noexcept;

/// As above with contact friction, whose memory advances by the step. Each pair is worked out from both sides, with
/// exactly opposite results.
void stepWithContactFriction(const GradedLaw& law, const StepConstants& now, const StepBox& box,
                             const StepArrays& arrays, std::size_t first, std::size_t last, Moved& moved) noexcept;

/// Contact forces of all neighbours on a particle.
struct ContactSum {
  float force_x_n = 0, force_y_n = 0, force_z_n = 0;
  float repulsion_n = 0;  ///< sum of the magnitudes of repulsive contact forces, for friction (paper 14); with contact
                          ///< friction of what limits friction
  float contacts = 0;     ///< p, number of macroparticles that overlap this one, for damping (paper 20)
};

/// Contacts alone, of groups first..last-1, 16 sums each.
void sumContacts(const KernelLaw& law, const Periods& periods, const StepArrays& arrays, std::size_t first,
                 std::size_t last, ContactSum* sums) noexcept;
void sumFrictionalContacts(const GradedLaw& law, const Periods& periods, float dt_s, const StepArrays& arrays,
                           std::size_t first, std::size_t last, ContactSum* sums) noexcept;

}  // namespace haptolith
