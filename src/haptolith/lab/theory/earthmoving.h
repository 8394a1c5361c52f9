#pragma once

#include <optional>

namespace haptolith {

/// Wide, straight, slow blade and the soil in front of it.
struct BladeCase {
  double width_m = 0;             ///< w, width across the path; above 0
  double depth_m = 0;             ///< d, depth of the blade's lower edge; above 0
  double rake_rad = 0;            ///< alpha, angle of the blade over the horizontal ahead: 90 deg is upright; above 0
  double density_kg_m3 = 0;       ///< rho; above 0
  double gravity_m_s2 = 9.81;     ///< g; above 0 to 1000
  double friction_angle_rad = 0;  ///< phi, angle of internal friction; 0 to 60 deg
  double tool_friction_rad = 0;   ///< delta, between soil and blade; 0 to 60 deg
  double cohesion_pa = 0;         ///< c; 0 or more
  double adhesion_pa = 0;         ///< c_a, between soil and blade; 0 to c
  double surcharge_pa = 0;        ///< q, a load on the surface; 0 or more
  std::optional<double> surcharge_beside_pa = {};  ///< q on crescents (wedgeForce()); empty: q, as ahead of the blade
};

/// Force of the soil on the blade, and the factors that it consists of.
struct BladeForce {
  double force_n = 0;     ///< F, at the angle delta to the blade's normal, without adhesion along the blade
  double draft_n = 0;     ///< horizontal force against the movement
  double vertical_n = 0;  ///< > 0: the soil pushes the blade down, as for a small rake
  double beta_rad = 0;    ///< angle of the failure plane over the horizontal
  double n_gamma = 0;
  double n_c = 0;
  double n_a = 0;
  double n_q = 0;
};

/// Returns the force on a blade by the fundamental earthmoving equation, in N.
///
///     F       = w (rho g d^2 N_gamma + c d N_c + c_a d N_a + q d N_q)
///     N_gamma = (cot alpha + cot beta) / (2 D)
///     N_c     = (1 + cot beta cot(beta + phi)) / D
///     N_a     = (1 - cot alpha cot(beta + phi)) / D
///     N_q     = (cot alpha + cot beta) / D
///     D       = cos(alpha + delta) + sin(alpha + delta) cot(beta + phi)
///     draft    = F sin(alpha + delta) + c_a d w cot alpha
///     vertical = F cos(alpha + delta) - c_a d w
///
/// Reece, The fundamental equation of earth-moving mechanics (Proc. Inst. Mech. Eng. 179, 1964); McKyes, Soil Cutting
/// and Tillage (1985). It is the balance of forces on a wedge that slides up along a plane, which rises from the
/// blade's lower edge at the angle beta. Soil fails at the weakest plane: beta is the angle with the least F. (The beta
/// with the least N_gamma is equal without cohesion, adhesion and surcharge, and gives up to 0.2 % more in the measured
/// cases of tests/data/blade_draft_measured.csv.)
///
/// It neglects inertia, so it holds for slow blades. It neglects the wedges that break out at both sides, which
/// wedgeForce() adds, so it holds for blades wider than deep. It also neglects accumulated soil, except as surcharge,
/// and curved failure planes. For upright blades in sand it is too low, by 25 % of the measured force on average and 42
/// % at most (Obermayr et al. 2013, Fraunhofer ITWM report 228).
/// @throws InvalidParameter outside the ranges above, and unless alpha + delta + phi < 175 deg: no wedge is left to
/// fail.
[[nodiscard]] BladeForce earthmovingForce(const BladeCase& blade);

/// As above for a failure plane at `beta_rad`, which need not be the weakest. Not checked: the ranges above, and beta
/// between 0 and steepestFailurePlane().
[[nodiscard]] BladeForce earthmovingForceAt(const BladeCase& blade, double beta_rad);

/// Returns the angle over the horizontal, in rad, at which D falls to zero: 180 deg - alpha - delta - phi.
[[nodiscard]] double steepestFailurePlane(const BladeCase& blade);

/// @throws InvalidParameter with the key, the value and the valid range.
void validate(const BladeCase& blade);

}  // namespace haptolith
