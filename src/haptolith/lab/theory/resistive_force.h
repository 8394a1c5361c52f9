#pragma once

#include "haptolith/core/vec.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// Soil in three-dimensional resistive force theory, which holds without cohesion and for slow tools.
struct ResistiveSoil {
  double density_kg_m3 = 0;      ///< rho_c, density in the residual state; above 0
  double gravity_m_s2 = 0;       ///< g; above 0 to 1000
  double internal_friction = 0;  ///< mu_int, tan(phi) in the residual state; above 0 to 2
  double surface_m = 0;          ///< height of the flat surface in the scene
};

/// Range of mu_int of the published fit of the scale; outside it is an extrapolation.
inline constexpr Range kResistiveFriction{0.3, 0.9};

/// Orientation and motion of a surface element. r is horizontal, in the direction of motion; z is up, theta = z x r.
struct ResistiveAngles {
  double beta_rad = 0;   ///< tilt of the element, -90 to 90 deg; 0 is flat, 90 deg is upright
  double gamma_rad = 0;  ///< angle of the velocity below the horizontal, -90 to 90 deg; 90 deg is straight down
  double psi_rad = 0;    ///< angle of the tilt's direction to r, -90 to 90 deg
};

/// Returns the dimensionless generic response of soil to a surface element: components along r, theta and z.
///
///     alpha = (f1 sin(beta) cos(psi) + f2 cos(gamma),  f1 sin(beta) sin(psi),  -f1 cos(beta) - f2 sin(gamma) - f3)
///     f_i   = sum over k of c_i^k T_k(x1, x2, x3)                        T: the 20 monomials up to the third degree
///     x1    = sin(gamma),   x2 = cos(beta),   x3 = cos(psi) cos(gamma) sin(beta) + sin(gamma) cos(beta)
///
/// Agarwal, Goldman and Kamrin, Mechanistic framework for reduced-order models in soft materials: application to
/// three-dimensional granular intrusion (PNAS 120(4), e2214017120, 2023); the c_i^k are those of its supporting
/// information, see resistive_force.cpp. It is a fit to simulations of a frictional continuum.
[[nodiscard]] Vec3 genericResponse(const ResistiveAngles& angles) noexcept;

/// As above without angles, in the scene's frame: alpha = f1 n + f2 v - f3 z with x1 = -v.z, x2 = -n.z, x3 = n.v. Here
/// n is the element's normal or its opposite, whichever points down. In the theory an element is a piece of a thin
/// plate: the velocity alone determines its leading side.
/// @param normal, direction  unit vectors: out of the tool, and along the element's velocity.
[[nodiscard]] Vec3 genericResponse(const Vec3& normal, const Vec3& direction) noexcept;

/// Returns xi_n, the factor of the generic response, in N/m^3.
///
///     xi_n = rho_c g (894 mu_int^3 - 386 mu_int^2 + 89 mu_int)
///
/// A fit in that paper to simulations with mu_int from 0.3 to 0.9.
/// @throws InvalidParameter outside the ranges of ResistiveSoil. Not for the tick.
[[nodiscard]] double resistiveScale(const ResistiveSoil& soil);

/// Returns the force of the soil on a surface element per area and depth, in N/m^3 in the scene's frame.
///
///     xi_n (alpha_n + min(1, mu_surf |alpha_n| / |alpha_t|) alpha_t),   alpha_n = (alpha . n) n,  alpha_t = alpha -
///     alpha_n
///
/// Zero if the element moves away from the soil, n . v < 0.
/// @param normal     unit vector, out of the tool.
/// @param velocity   velocity of the element, in any unit: only its direction matters. Zero for an element at rest.
/// @param mu_surf    friction between surface and soil; 0 or more.
[[nodiscard]] Vec3 resistiveResponse(const Vec3& normal, const Vec3& velocity, double xi_n_m3, double mu_surf) noexcept;

/// Returns force and torque of the soil on any tool about its origin, in N and N m in the scene's frame, by
/// three-dimensional resistive force theory: dF = resistiveResponse() * depth * dA over the part below the flat
/// surface.
///
/// The theory neglects inertia, cohesion, walls, the floor, previously moved soil, and shadowing of one part of the
/// tool by another. It holds in the limit of slow movement.
///
/// The surface is that of toolSurface(), cut at the soil's surface and into triangles of at most 1/24 of the tool's
/// extent. Each has the depth and velocity of its centre. So forces are exact for tools that do not rotate, and
/// otherwise accurate to about 0.1 %. In the theory a surface that slides along itself, n . v = 0, contributes. A round
/// surface that rotates in place is divided into flat pieces, half of which point backwards and do not contribute here.
/// @param opening_m  opening of jaws, as in toolSurface().
/// @return wrench on the tool about its origin, scene frame, as `twist` is.
/// @throws InvalidParameter as validate(ToolParameters) and resistiveScale(). Not for the tick.
[[nodiscard]] Wrench resistiveForce(const ToolParameters& tool, double opening_m, const Pose& scene_T_tool,
                                    const Twist& twist, const ResistiveSoil& soil);

}  // namespace haptolith
