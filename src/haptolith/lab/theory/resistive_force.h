#pragma once

#include "haptolith/core/vec.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// Soil as three-dimensional resistive force theory knows it: without cohesion, and slow tools.
struct ResistiveSoil {
  double density_kg_m3 = 0;      ///< rho_c, once it has been sheared for long; above 0
  double gravity_m_s2 = 0;       ///< g; above 0 to 1000
  double internal_friction = 0;  ///< mu_int, once it has been sheared for long, tan(phi); above 0 to 2
  double surface_m = 0;          ///< height of the flat surface in the scene
};

/// Where the published fit of the scale was made; outside it extrapolates.
inline constexpr Range kResistiveFriction{0.3, 0.9};

/// How a surface element lies and moves. r is horizontal, the way the element goes; z is up, theta = z x r.
struct ResistiveAngles {
  double beta_rad = 0;   ///< tilt of the element, -90 to 90 deg; 0 lies flat, 90 deg stands upright
  double gamma_rad = 0;  ///< of the velocity below the horizontal, -90 to 90 deg; 90 deg is straight down
  double psi_rad = 0;    ///< of the tilt's direction to r, -90 to 90 deg
};

/// Generic response of soil to a surface element, of no unit: components along r, theta and z.
///
///     alpha = (f1 sin(beta) cos(psi) + f2 cos(gamma),  f1 sin(beta) sin(psi),  -f1 cos(beta) - f2 sin(gamma) - f3)
///     f_i   = sum over k of c_i^k T_k(x1, x2, x3)                        T: the 20 monomials up to the third degree
///     x1    = sin(gamma),   x2 = cos(beta),   x3 = cos(psi) cos(gamma) sin(beta) + sin(gamma) cos(beta)
///
/// Agarwal, Goldman and Kamrin, Mechanistic framework for reduced-order models in soft materials: application to
/// three-dimensional granular intrusion (PNAS 120(4), e2214017120, 2023); the c_i^k are those of its supporting
/// information, see resistive_force.cpp. It is a fit to simulations of a frictional continuum.
[[nodiscard]] Vec3 genericResponse(const ResistiveAngles& angles) noexcept;

/// The same without angles, in the scene's frame: alpha = f1 n + f2 v - f3 z with x1 = -v.z, x2 = -n.z, x3 = n.v, where
/// n is the element's normal or its opposite, whichever looks down. An element is a piece of a thin plate to the
/// theory: which of its sides leads is told by the velocity alone.
/// @param normal, direction  unit vectors: out of the tool, and of the element's velocity.
[[nodiscard]] Vec3 genericResponse(const Vec3& normal, const Vec3& direction) noexcept;

/// xi_n, by which the generic response is multiplied, in N/m^3.
///
///     xi_n = rho_c g (894 mu_int^3 - 386 mu_int^2 + 89 mu_int)
///
/// The same paper's fit to simulations with mu_int from 0.3 to 0.9.
/// @throws InvalidParameter outside the ranges of ResistiveSoil. Not for the tick.
[[nodiscard]] double resistiveScale(const ResistiveSoil& soil);

/// What the soil does to a surface element that is one metre deep, per area, in N/m^3 in the scene's frame.
///
///     xi_n (alpha_n + min(1, mu_surf |alpha_n| / |alpha_t|) alpha_t),   alpha_n = (alpha . n) n,  alpha_t = alpha -
///     alpha_n
///
/// Nothing where the element moves away from the soil, n . v < 0.
/// @param normal     unit vector, out of the tool.
/// @param velocity   of the element, in any unit: only its direction counts. Nothing acts on one that stands still.
/// @param mu_surf    friction between surface and soil; 0 or more.
[[nodiscard]] Vec3 resistiveResponse(const Vec3& normal, const Vec3& velocity, double xi_n_m3, double mu_surf) noexcept;

/// Force and torque of the soil on any tool about its origin, in N and N m in the scene's frame, by three-dimensional
/// resistive force theory: dF = resistiveResponse() * depth * dA over all that is below the flat surface.
///
/// The theory knows neither inertia nor cohesion, neither walls nor a floor, no soil that has been moved before and no
/// shadow of one part of the tool on another. Its own limit is slow movement.
///
/// The surface is toolSurface()'s, cut at the soil's surface and into triangles of at most 1/24 of the tool's extent,
/// on each of which depth and velocity are those of its middle. So tools that do not turn have exact forces, and others
/// good to a per mille or so.
/// A surface that slides along itself, n . v = 0, counts to the theory; of a round one that turns on the spot it is cut
/// into flat pieces, half of which look backwards and do not count here.
/// @param opening_m  of jaws, as in toolSurface().
/// @return wrench on the tool about its origin, scene frame, as `twist` is.
/// @throws InvalidParameter as validate(ToolParameters) and resistiveScale(). Not for the tick.
[[nodiscard]] Wrench resistiveForce(const ToolParameters& tool, double opening_m, const Pose& scene_T_tool,
                                    const Twist& twist, const ResistiveSoil& soil);

}  // namespace haptolith
