#pragma once

#include "haptolith/lab/theory/earthmoving.h"

namespace haptolith {

/// Force of the soil on a narrow blade, and the body of soil that breaks out.
struct WedgeForce {
  double draft_n = 0;             ///< horizontal force against the movement
  double vertical_n = 0;          ///< > 0: the soil pushes the blade down
  double beta_rad = 0;            ///< angle of the failure surface over the horizontal
  double rupture_distance_m = 0;  ///< r, on the surface, from the blade to the rupture line ahead of it
  double crescent_width_m = 0;    ///< s, on the surface, from the blade's side to the rupture line next to it
  double crescent_angle_rad = 0;  ///< eta, angle of a crescent, from straight ahead to the side; 90 deg if alpha is
  double n_gamma = 0;             ///< these four are factors of the draft, including the sides
  double n_c = 0;
  double n_a = 0;
  double n_q = 0;
};

/// Returns the force on a blade of any width, in N, with the crescents of soil that break out at both its sides.
///
///     draft    = F sin(alpha + delta) + c_a d w cot alpha
///     F        = w (rho g d^2 N_gamma + c d N_c + c_a d N_a + q d N_q)
///     N_gamma  = (r / 2d) (1 + 2s / 3w) / D
///     N_c      = (1 + cot beta cot(beta + phi)) (1 + s / w) / D
///     N_a      = (1 - cot alpha cot(beta + phi)) / D
///     N_q      = (r / d) (1 + s / w) / D
///     D        = cos(alpha + delta) + sin(alpha + delta) cot(beta + phi)
///     r        = d (cot alpha + cot beta)
///     s        = r sin eta = d sqrt(cot^2 beta + 2 cot alpha cot beta),    cos eta = (d / r) cot alpha
///     vertical = the same with r eta in place of s and cos(alpha + delta) in place of sin(alpha + delta), - c_a d w
///
/// In q N_q the part with s / w has the surcharge next to the blade, if that differs.
///
/// McKyes and Ali, The cutting of soil by narrow blades (J. Terramechanics 14(2):43-51, 1977); McKyes, Soil Cutting and
/// Tillage (1985). The plane wedge of earthmovingForce() slides ahead of the blade. On either side are slices of a
/// crescent with the angle d eta', each r long on the surface and with its point at the blade's lower corner. Per
/// angle, the volume of a slice is r^2 d / 6, its failure surface r d / (2 sin beta) and its upper face r^2 / 2. Each
/// pushes at the angle alpha + delta like the wedge, but outwards at its eta'; cos eta' of that adds to the draft.
///
/// Soil fails at the weakest surface: beta is the angle with the least draft. McKyes and Ali take the least N_gamma,
/// which is equal without cohesion, adhesion and surcharge. Derived from the balance of forces, which a test repeats by
/// quadrature; the paper and its curves were not available.
///
/// Two choices. All slices have the same upward component, so the vertical force has eta instead of the draft's sin
/// eta. The draft factors are often used for both, which makes the sides' part of the vertical force up to 36 % too
/// small. All slices have the same beta, as in the paper, although for an inclined blade the failure surface is steeper
/// at the sides than ahead.
///
/// It neglects, as the plane equation does, inertia, accumulated soil and curved failure surfaces, and also friction
/// between the slices. Far below a critical depth of about six widths soil flows around a blade and does not rise; this
/// equation neglects that. For upright blades in sand it is too high: it gives 1.0 to 2.5 times the measured drafts of
/// tests/data/blade_draft_measured.csv, 1.9 on average.
/// @param blade  as for earthmovingForce(), with a rake of up to 90 deg: a blade that leans forward has no crescents.
/// @throws InvalidParameter outside those ranges, and for a rake too flat for the width, mostly under 45 deg in soil of
/// low friction. There the draft has no minimum before the crescents vanish at beta = 90 deg. Not for the tick.
[[nodiscard]] WedgeForce wedgeForce(const BladeCase& blade);

/// Returns the force on a blade, in N, with a wedge that slides up between upright sides with friction.
///
///     F  = plane F + S cos phi / sin(alpha + delta + beta + phi)
///     S  = 2 A (c + K_0 (rho g d / 3 + q) tan phi),    A = r d / 2,    K_0 = 1 - sin phi
///
/// Perumpral, Grisso and Desai, A soil-tool model based on limit equilibrium analysis (Trans. ASAE 26(4):991-994,
/// 1983): no crescents. Cohesion, and friction under the earth pressure at rest, act on the sides along the failure
/// plane. The pressure of a surcharge on the sides is an addition. Derived from the balance of forces; the paper was
/// not available. Swick and Perumpral (J. Terramechanics 25(1), 1988) returned to crescents and added inertia, which
/// does not affect slow blades.
///
/// The sides add far less than the crescents of wedgeForce(): 1.2 times the plane draft instead of 3.2, for an upright
/// blade as wide as deep in sand of 40 deg (delta = 20 deg). It gives 0.7 to 1.2 times the measured drafts of
/// tests/data/blade_draft_measured.csv, 1.04 on average.
/// @throws InvalidParameter as earthmovingForce(). Not for the tick.
[[nodiscard]] BladeForce uprightWedgeForce(const BladeCase& blade);

}  // namespace haptolith
