#pragma once

namespace haptolith {

/// Smooth rigid wheel on soil, in the theory of Bekker, Wong and Reece.
struct RigidWheel {
  double radius_m = 0;             ///< r; above 0
  double width_m = 0;              ///< b; above 0
  double modulus = 0;              ///< k of p = k z^n, in Pa/m^n, of a plate as wide as the wheel; above 0
  double exponent = 1;             ///< n; 0.05 to 5
  double friction_angle_rad = 0;   ///< angle of the shear under the rim: the smaller of phi and delta; 0 to 60 deg
  double cohesion_pa = 0;          ///< c; 0 or more
  double shear_modulus_m = 0.025;  ///< K of Janosi and Hanamoto; 25 mm is Wong's for dry sand; above 0
  double peak_angle_ratio = 0.18;  ///< c_1 for loose sand (Wong and Reece 1967)
  double peak_angle_slip = 0.32;   ///< c_2
};

/// Forces of the soil on a wheel that travels forwards.
struct WheelForces {
  double sinkage_m = 0;   ///< z, below the level surface
  double vertical_n = 0;  ///< W, upwards
  double drawbar_n = 0;   ///< DP, forwards
  double torque_nm = 0;   ///< T, against the rotation
};

/// Ratio of the speed of travel v to that of the rim, v / (r omega), at a slip s: 1 - s for a driven wheel
/// (s = 1 - v / (r omega)), 1 / (1 + s) for a braked one (s = r omega / v - 1). Infinite at s = -1.
/// @param slip  -1 to below 1.
[[nodiscard]] double travelOverRim(double slip);

/// Returns the forces at a sinkage (Wong and Reece, J. Terramech. 4(1) and 4(2), 1967, with the shear of Janosi and
/// Hanamoto 1961). theta counts from the lowest point forwards; contact is from 0 to theta_1, cos theta_1 = 1 - z / r.
///
///     sigma = k r^n (cos theta_f - cos theta_1)^n
///     theta_f = theta                                                         before theta_m
///     theta_f = theta_1 - theta (theta_1 - theta_m) / theta_m                 behind it
///     theta_m = (c_1 + c_2 |s|) theta_1
///     j = r (theta_1 - theta) - (v / omega) (sin theta_1 - sin theta)
///     tau = sign(j) (c + sigma tan phi) (1 - exp(-|j| / K))
///     W = r b integral(sigma cos theta + tau sin theta)
///     DP = r b integral(tau cos theta - sigma sin theta),   T = r^2 b integral(tau)
///
/// The authors split a braked wheel where the soil under it parts. Here tau changes its sign with j instead, and |s| in
/// theta_m extends their driven wheel to braking. At s = -1 the rim is dragged: j = -infinity.
/// @throws InvalidParameter outside the ranges above, for a slip outside -1 to 0.99, and for a sinkage that is not
/// above 0 and below r. Not for the tick.
[[nodiscard]] WheelForces rigidWheelForces(const RigidWheel& wheel, double slip, double sinkage_m);

/// As above at the sinkage at which the wheel carries `load_n`.
/// @throws InvalidParameter also for a load that it does not carry at any sinkage below r.
[[nodiscard]] WheelForces rigidWheelUnderLoad(const RigidWheel& wheel, double slip, double load_n);

}  // namespace haptolith
