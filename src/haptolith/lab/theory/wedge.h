#pragma once

#include "haptolith/lab/theory/earthmoving.h"

namespace haptolith {

/// What the soil does to a narrow blade, and the body of soil that breaks out.
struct WedgeForce {
  double draft_n = 0;             ///< horizontal, against the movement
  double vertical_n = 0;          ///< > 0: the soil pushes the blade down
  double beta_rad = 0;            ///< of the failure surface over the horizontal
  double rupture_distance_m = 0;  ///< r, on the surface, from the blade to where the soil ahead of it breaks out
  double crescent_width_m = 0;    ///< s, on the surface, from the blade's side to where the soil beside it breaks out
  double crescent_angle_rad = 0;  ///< eta, of a crescent, from straight ahead to the side; 90 deg when alpha is
  double n_gamma = 0;             ///< these four are of the draft, sides and all
  double n_c = 0;
  double n_a = 0;
  double n_q = 0;
};

/// Force on a blade of any width, with the crescents of soil that break out at both its sides, in N.
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
/// where q N_q is of the surcharge beside the blade for the part with s / w, if that is another one.
///
/// McKyes and Ali, The cutting of soil by narrow blades (J. Terramechanics 14(2):43-51, 1977); McKyes, Soil Cutting and
/// Tillage (1985). Ahead of the blade slides the plane wedge of earthmovingForce(). Beside it stand, on either side,
/// slices of a crescent with the angle d eta', each r long on the surface and with its point at the blade's lower
/// corner: a sixth of r^2 d is the volume of one, half of r d / sin beta its failure surface and half of r^2 its upper
/// face. Each pushes at the angle alpha + delta like the wedge, but outwards at its own eta'; in the draft counts cos
/// eta' of that. Soil fails where it is weakest: beta is the angle with the least draft. McKyes and Ali take the least
/// N_gamma, which is the same without cohesion, adhesion and surcharge. Written down anew from the balance of forces,
/// which a test repeats by quadrature: the paper itself and its curves were not at hand.
///
/// Two choices. Upwards all slices push alike, so the vertical force has eta where the draft has sin eta; the factors
/// are often used for both, which makes the sides' part of the vertical force up to 36 % too small. And all slices have
/// the one beta, as in the paper, though on a blade that leans the failure surface beside it is steeper than ahead.
///
/// Left out are, as in the plane equation, inertia, heaps and bent failure surfaces, and friction between the slices.
/// Far below a critical depth of some six widths soil flows round a blade and does not rise; this equation does not
/// know that. Upright blades in sand needed less than it says: it gives 1.0 to 2.5 times the measured drafts of
/// tests/data/blade_draft_measured.csv, 1.9 on average.
/// @param blade  as for earthmovingForce(), with a rake of up to 90 deg: one that leans forward has no crescents.
/// @throws InvalidParameter outside those ranges, and for a rake too flat for the width, mostly under 45 deg in soil of
/// little friction: there the draft has no least value before the crescents vanish at beta = 90 deg. Not for the tick.
[[nodiscard]] WedgeForce wedgeForce(const BladeCase& blade);

/// Force on a blade before which a wedge slides up between upright sides that hold it back, in N.
///
///     F  = plane F + S cos phi / sin(alpha + delta + beta + phi)
///     S  = 2 A (c + K_0 (rho g d / 3 + q) tan phi),    A = r d / 2,    K_0 = 1 - sin phi
///
/// Perumpral, Grisso and Desai, A soil-tool model based on limit equilibrium analysis (Trans. ASAE 26(4):991-994,
/// 1983): no crescents; cohesion, and friction under the earth's pressure at rest, act on the sides along the failure
/// plane. The pressure of a surcharge on the sides is ours. Written down from the balance of forces; the paper was not
/// at hand. Swick and Perumpral (J. Terramechanics 25(1), 1988) went back to crescents and added inertia, which slow
/// blades do not feel.
///
/// The sides cost far less than wedgeForce()'s crescents: 1.2 times the plane draft instead of 3.2 for an upright blade
/// as wide as deep in sand of 40 deg (delta = 20 deg). Of the measured drafts of tests/data/blade_draft_measured.csv it
/// gives 0.7 to 1.2 times, 1.04 on average.
/// @throws InvalidParameter as earthmovingForce(). Not for the tick.
[[nodiscard]] BladeForce uprightWedgeForce(const BladeCase& blade);

}  // namespace haptolith
