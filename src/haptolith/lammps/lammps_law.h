#pragma once

#include <optional>
#include <string>

#include "haptolith/bed/bed.h"
#include "haptolith/lammps/tool_spheres.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// Law between two bodies in terms of LAMMPS' pair style `granular`: along the normal a spring, F = k delta
/// (`hooke`) or F = K sqrt(r) delta^(3/2) (`hertz`), r = r1 r2 / (r1 + r2), and a parallel damper that never pulls;
/// across it Cundall and Strack's spring and slider, which holds mu F at most.
struct GranularContact {
  bool hertz = false;
  double stiffness = 0;  ///< k in N/m, or K in Pa
  double damping_n_s_m = 0;
  double across_n_m = 0;      ///< k_t
  double across_damping = 0;  ///< c_t / c_n
  double friction = 0;        ///< mu

  /// "hooke 1000 0.2 damping velocity tangential linear_history 500 0.7 0.5 limit_damping".
  [[nodiscard]] std::string text() const;
};

/// haptolith's law itself, as sub-models of pair style `granular` that LAMMPS has where extras/lammps was built in.
struct OwnContact {
  ContactLaw law;
  double damping_n_s = 0;  ///< c (a - a_min): zeta sqrt(2 m gamma)
  double across_n_m = 0;   ///< k_t
  double lag_s = 0;        ///< c_t / k_t
  double friction = 0;     ///< mu
  /// Reach of a contact beyond touching: that of cohesion, if any. Two radii together are larger by this
  /// in LAMMPS than the particles' are, because its neighbour lists have radii, and no reach.
  double reach_m = 0;

  /// "haptolith 0.014 0.0133 6e-05 3000 ...". @param ratio  share of friction and cohesion that a wall has.
  [[nodiscard]] std::string text(double ratio = 1) const;
};

/// Contact law of a bed in LAMMPS: the nearest of standard LAMMPS, or haptolith's (OwnContact).
enum class LammpsLaw { kStandard, kHaptolith };

/// The contacts of a bed for LAMMPS.
///
/// If (paper 7) is a line and there is no cohesion, `granular` has the law itself. Other soil has Hertz' law for
/// the limit of friction, compression and cohesion together, as near as a stiffness and a distance at which it begins
/// come to that of the contacts that the bed has now; and a table of what is lacking to the force along the normal
/// (restForce()), which therefore is (paper 7)'s, with the pull across gaps. A table knows distances and not radii, so
/// grains are then of a few sizes (SizeBins). Walls are springs that do not cohere.
///
/// With LammpsLaw::kHaptolith all of it is as here, whatever the soil.
struct GranularLaw {
  GranularContact grains, wall;        ///< the wall is a grain's mirror image, as in haptolith
  std::optional<OwnContact> own = {};  ///< instead of both
  bool exact = true;
  double larger_m = 0;       ///< excess of radii in LAMMPS over the particles'
  double wall_behind_m = 0;  ///< offset of a wall there
  double spread_of_fit = 0;  ///< relative RMS error of the limit of friction, each contact weighted by it

  [[nodiscard]] std::string betweenGrains() const;
  /// @param ratio  of a side wall's friction to the soil's.
  [[nodiscard]] std::string atWall(double ratio) const;
};

/// @throws InvalidParameter for soil that no style of LAMMPS comes near: ICRA 2021 friction, grains of several
/// sizes by classes, stones, which turn.
[[nodiscard]] GranularLaw granularLaw(const Bed& bed, LammpsLaw whose = LammpsLaw::kStandard);

/// Contribution of the table to the granular part, in N, for two particles whose radii add up to 2 R + `more_m`.
[[nodiscard]] double restForce(const GranularLaw& law, const ContactLaw& contact, double more_m, double distance_m);

/// Between a grain and each sphere of a tool, which are as stiff together as the tool is.
/// @param dt_s  of a step: the tool's damper depends on it.
[[nodiscard]] GranularContact granularContact(const ToolParameters& tool, const SoilParameters& soil, double dt_s,
                                              const SpheresUnderAGrain& spheres);

}  // namespace haptolith
