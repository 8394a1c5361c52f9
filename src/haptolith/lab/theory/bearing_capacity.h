#pragma once

namespace haptolith {

/// Round footing with a flat base, loaded slowly and vertically, in unbounded soil.
struct Footing {
  double diameter_m = 0;          ///< D; above 0
  double depth_m = 0;             ///< D_f, depth of the base below the surface; 0 to 2.5 D
  double density_kg_m3 = 0;       ///< rho; above 0
  double gravity_m_s2 = 9.81;     ///< g; above 0 to 1000
  double friction_angle_rad = 0;  ///< phi; 0 to 50 deg
  double cohesion_pa = 0;         ///< c; 0 or more
};

/// Max. pressure under a footing before the soil fails, and the factors that it consists of.
struct BearingCapacity {
  double pressure_pa = 0;  ///< q_u
  double n_c = 0, n_q = 0, n_gamma = 0;
};

/// Returns the bearing capacity of a round footing, in Pa, by one of three theories; q = rho g D_f is the surcharge
/// around it.
///
///     Terzaghi (Theoretical Soil Mechanics, 1943):
///         q_u = 1.3 c N_c + q N_q + 0.3 rho g D N_gamma
///         N_q = exp((3 pi / 2 - phi) tan phi) / (2 cos^2(45 deg + phi / 2)),  N_c = (N_q - 1) cot phi
///         N_gamma = tan phi (K / cos^2 phi - 1) / 2, where K is a table
///     Meyerhof (Can. Geotech. J. 1, 1963), K_p = tan^2(45 deg + phi / 2), r = D_f / D:
///         q_u = c N_c s_c d_c + q N_q s d + rho g D N_gamma s d / 2
///         N_q = exp(pi tan phi) K_p,  N_gamma = (N_q - 1) tan(1.4 phi)
///         s_c = 1 + 0.2 K_p,  d_c = 1 + 0.2 sqrt(K_p) r,  s = 1 + 0.1 K_p,  d = 1 + 0.1 sqrt(K_p) r (phi >= 10 deg)
///     Vesic (J. Soil Mech. Found. Div. ASCE 99, 1973), N_q as Meyerhof's, k = r, or atan r where r is above 1:
///         N_gamma = 2 (N_q + 1) tan phi
///         s_c = 1 + N_q / N_c,  s_q = 1 + tan phi,  s_gamma = 0.6
///         d_c = 1 + 0.4 k,  d_q = 1 + 2 tan phi (1 - sin phi)^2 k,  d_gamma = 1
///
/// At large angles they differ by a factor of two and more, mostly in N_gamma, so they give a range rather than a
/// number. All hold for general shear failure at one friction angle; a plate that goes deeper pushes soil aside.
/// @throws InvalidParameter outside the ranges above. Not for the tick.
[[nodiscard]] BearingCapacity terzaghiBearing(const Footing& footing);
/// As above for local shear failure (Terzaghi 1943): soil so loose that it yields under the footing without heaving
/// next to it. With two thirds of c and of tan phi.
[[nodiscard]] BearingCapacity terzaghiLocalBearing(const Footing& footing);
[[nodiscard]] BearingCapacity meyerhofBearing(const Footing& footing);
[[nodiscard]] BearingCapacity vesicBearing(const Footing& footing);

/// Deformation of soil before it fails.
struct Compressibility {
  double shear_modulus_pa = 0;  ///< G; above 0
  double volume_strain = 0;     ///< Delta, decrease of volume until failure; 0 to 1
};

/// Bearing capacity of soil that is compressed before it fails.
struct CompressibleBearing {
  double pressure_pa = 0;
  double rigidity_index = 0;           ///< I_rr
  double critical_rigidity_index = 0;  ///< I_rc
  double compressibility_factor = 1;   ///< zeta of N_q and N_gamma
};

/// Returns vesicBearing() with his factors for local and punching failure (same source), for a round footing:
///
///     I_r = G / (c + q' tan phi), with q' the overburden at depth D_f + D / 2
///     I_rr = I_r / (1 + I_r Delta)
///     I_rc = exp(2.85 cot(45 deg - phi / 2)) / 2
///     zeta = exp(-3.8 tan phi + 3.07 sin phi log10(2 I_rr) / (1 + sin phi)) for N_q and N_gamma
///     zeta_c = zeta - (1 - zeta) / (N_q - 1) for N_c, at least 0; without friction 0.44 + 0.6 log10 I_rr
///
/// From I_rc on, soil is as rigid and zeta is 1; it is never more.
/// @throws InvalidParameter as vesicBearing(), and outside the ranges above. Not for the tick.
[[nodiscard]] CompressibleBearing vesicCompressibleBearing(const Footing& footing, const Compressibility& soil);

}  // namespace haptolith
