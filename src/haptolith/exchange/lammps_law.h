#pragma once

#include <string>

#include "haptolith/bed/bed.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// What is between two bodies, in the words of LAMMPS' pair style `granular`: along the normal a spring with a damper
/// beside it, F = k delta (`hooke`) or Johnson, Kendall and Roberts' law of bodies that cohere (`jkr`, jkrForce());
/// across it Cundall and Strack's spring and slider. Friction is limited by mu F, with jkr by mu (F + 2 pull).
struct GranularContact {
  bool coheres = false;       ///< jkr; else hooke, whose damper never pulls
  double stiffness = 0;       ///< k in N/m, or E of the two together in Pa
  double pull_n = 0;          ///< jkr: the largest
  double effective_m = 0;     ///< jkr: radius r1 r2 / (r1 + r2) of two grains of mean size; of one at a wall its own
  double damping_n_s_m = 0;   ///< hooke
  double restitution = 1;     ///< jkr: by which LAMMPS knows damping that goes with sqrt(m k) ("tsuji")
  double across_n_m = 0;      ///< k_t
  double across_damping = 0;  ///< c_t / c_n
  double friction = 0;        ///< mu

  /// "hooke 1000 0.2 damping velocity tangential linear_history 500 0.7 0.5 limit_damping".
  [[nodiscard]] std::string text() const;
};

/// The contacts of a bed for LAMMPS, and what they are not.
struct GranularLaw {
  GranularContact grains, wall;  ///< the wall is a grain's mirror image, as in haptolith
  bool exact = true;             ///< (paper 7) is a line, and grains do not cohere
  double smaller_m = 0;          ///< by how much grains' radii are less in LAMMPS, where forces begin later
  double spread_of_fit = 0;      ///< where it is not exact: RMS of the difference of contact forces over their RMS
};

/// The law of a bed, as near as `granular` has one: (paper 7) itself where that is a line without cohesion. Other soil
/// without cohesion has the line, and soil with cohesion the law of jkr, that are nearest to the forces of the contacts
/// that the bed has now, stiffness and where they begin; with F_c / 2 to pull, which adds F_c to what friction is
/// limited by, as in haptolith.
/// @throws InvalidParameter for soil that no style of LAMMPS comes near: the paper's friction, grains of several
/// sizes by classes, stones, which turn.
[[nodiscard]] GranularLaw granularLaw(const Bed& bed);

/// Force between two elastic spheres that cohere (Johnson, Kendall and Roberts 1971), as LAMMPS has it:
///
///     F = 4 E a^3 / (3 r) - 2 pi a^2 sqrt(4 gamma E / (pi a)),   delta = a^2 / r - 2 sqrt(pi gamma a / E)
///
/// @param overlap_m  delta, >= 0. @param pull_n  3 pi gamma r, the largest pull. @param effective_m  r.
[[nodiscard]] double jkrForce(double overlap_m, double modulus_pa, double pull_n, double effective_m);

/// The restitution from which LAMMPS' `damping tsuji` makes c = 2 zeta sqrt(m_eff dF/d delta) of Hertz' law, with its
/// polynomial alpha(e) = 2 zeta sqrt(3/2). @param damping_ratio  zeta, 0 to 0.5.
[[nodiscard]] double restitutionOf(double damping_ratio);

/// Between a grain and each sphere of a tool (tool_spheres.h). @param dt_s  of a step: the tool's damper depends on it.
[[nodiscard]] GranularContact granularContact(const ToolParameters& tool, const SoilParameters& soil, double dt_s);

}  // namespace haptolith
