#pragma once

#include <array>
#include <limits>

#include "haptolith/bed/kernel/kernel_law.h"
#include "haptolith/core/vec.h"
#include "haptolith/soil/contact_law.h"
#include "haptolith/soil/soil_parameters.h"

namespace haptolith {

/// Overlap of a sphere with a stone, or of a stone with its mirror image.
struct Overlap {
  double depth_m = -std::numeric_limits<double>::max();  ///< negative: the gap between the surfaces
  Vec3 towards = Vec3::UnitZ();                          ///< unit normal from the second body to the first
  double steepness = 1;  ///< by how much the depth grows for each metre that the bodies come closer
};

/// Overlap of a sphere with the union of others: where it reaches into several of them, as deep as
///
///     d = (d_1^4 + d_2^4 + ...)^(1/4)
///
/// so that in the groove between two spheres the force turns smoothly from one normal to the other, and a contact with
/// several spheres is barely stiffer than one with a single sphere. The deepest alone would be a valley without a
/// bottom in which soil trembles, all of them together a contact as stiff as they are many.
class OverlapOfSpheres {
 public:
  /// @param apart_m  from the middle of one of the union's spheres to that of the sphere.
  /// @param radii_m  of both together.
  void add(const Vec3& apart_m, double radii_m) noexcept;
  [[nodiscard]] Overlap overlap() const noexcept;

 private:
  Vec3 gradient_ = Vec3::Zero();  ///< sum of d^3 n
  double fourth_ = 0;             ///< sum of d^4
  Overlap nearest_;
};

/// Two bodies that touch.
struct TouchingBodies {
  double radius_a_m, radius_b_m;
  double mass_a_kg, mass_b_kg;
};

/// The law between a stone and another body: that of two grains between their sizes, see Stones.
class StoneContactLaw {
 public:
  StoneContactLaw() = default;

  /// @param soil  grains that cohere with a stone as with each other; a bare stone and another, or a wall, do not.
  /// @param friction_ratio  friction over the soil's.
  [[nodiscard]] static StoneContactLaw withGrains(const SoilParameters& soil, const TouchingBodies& bodies);
  [[nodiscard]] static StoneContactLaw bare(const SoilParameters& soil, const TouchingBodies& bodies,
                                            double friction_ratio = 1);

  /// The law in the form of the kernel for soil around stones.
  [[nodiscard]] ContactFrictionLaw inKernel() const;

  /// From this gap between the surfaces on there is no force, in m.
  [[nodiscard]] double reach() const noexcept { return law_.cutoff_m - law_.diameter_m; }

  /// Force on the first of two bodies that touch, in N. May be called in the tick.
  /// @param overlap   not beyond reach(). @param relative_m_s  velocity of the first against the second, at one point.
  /// @param stretch_m  how far the contact has slid, read and written.
  [[nodiscard]] Vec3 force(const Overlap& overlap, const Vec3& relative_m_s, double dt_s,
                           Vec3& stretch_m) const noexcept;

  /// Energy stored in the contact, friction's stretch included, in J. Not for the tick.
  [[nodiscard]] double energy(double depth_m, const Vec3& stretch_m) const noexcept;

 private:
  StoneContactLaw(const SoilParameters& soil, const TouchingBodies& bodies, double friction_ratio);

  ContactLaw law_;
  double damping_ = 0;         ///< as ContactFrictionLaw::damping
  double friction_ = 0;        ///< mu_p
  double tangential_n_m_ = 1;  ///< k_t
  double lag_s_ = 0;           ///< c_t / k_t
};

/// A vector in single precision, as contacts keep it.
using Stretch = std::array<float, 3>;
[[nodiscard]] inline Vec3 vectorOf(const Stretch& s) noexcept {
  return {s[0], s[1], s[2]};
}
[[nodiscard]] inline Stretch stretchOf(const Vec3& v) noexcept {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

}  // namespace haptolith
