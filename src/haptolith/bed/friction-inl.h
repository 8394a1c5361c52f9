// Friction between two bodies that touch, once, for every kind of number: the SIMD vectors of the bed's kernel, float for
// its walls, double for the tool. Included again for every target, hence the toggled guard (Highway's idiom).

#if defined(HAPTOLITH_FRICTION_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HAPTOLITH_FRICTION_INL_H_
#undef HAPTOLITH_FRICTION_INL_H_
#else
#define HAPTOLITH_FRICTION_INL_H_
#endif

#include <hwy/highway.h>

#include <cmath>

#include "haptolith/soil/contact_law-inl.h"

HWY_BEFORE_NAMESPACE();
namespace haptolith::HWY_NAMESPACE {

// Highway's functions for single numbers, so that one expression serves both.
inline double Sqrt(double a) {
  return std::sqrt(a);
}
inline float Sqrt(float a) {
  return std::sqrt(a);
}
inline double IfThenElse(bool mask, double yes, double no) {
  return mask ? yes : no;
}
inline float IfThenElse(bool mask, float yes, float no) {
  return mask ? yes : no;
}

template <class Real>
struct Triple {
  Real x, y, z;
};

template <class Real>
HWY_INLINE Real dot(const Triple<Real>& a, const Triple<Real>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// `v` without its part along the unit vector `n`.
template <class Real>
HWY_INLINE Triple<Real> across(const Triple<Real>& v, const Triple<Real>& n) {
  const Real along = dot(v, n);
  return {v.x - along * n.x, v.y - along * n.y, v.z - along * n.z};
}

/// Constants of sticking and sliding.
template <class Real>
struct FrictionOf {
  Real dt;
  Real stiffness, per_stiffness;  ///< k_t, N/m, and 1 / k_t
  Real damping;                   ///< c_t, N s/m
  Real zero, one, tiny;           ///< 0, 1, and what is nothing beside any force
};

/// Friction on the first of two bodies, with the normal `n` from the second to it (Cundall and Strack 1979, eq. 5, 15):
/// a spring along the surface remembers how far they have slid against each other since they met, and gives way where
/// its force, with the damper's, exceeds the Coulomb `limit`:
///
///     xi <- xi - (xi n) n + v_t dt,     F_t = -(k_t xi + c_t v_t)
///     |F_t| > limit:   F_t <- limit F_t / |F_t|,   xi <- -F_t / k_t
///
/// Every term changes its sign with n, v and xi, so what the second body works out for itself is the exact opposite.
/// @param slip      v_t, velocity of the first against the second, without its part along n.
/// @param stretch   xi, read and written.
template <class Real>
HWY_INLINE Triple<Real> frictionForce(const FrictionOf<Real>& friction, Real limit, const Triple<Real>& n,
                                      const Triple<Real>& slip, Triple<Real>& stretch) {
  const Triple<Real> old = across(stretch, n);
  const Triple<Real> xi{old.x + slip.x * friction.dt, old.y + slip.y * friction.dt, old.z + slip.z * friction.dt};
  const auto held = [&friction](Real stretched, Real sliding) {
    return friction.stiffness * stretched + friction.damping * sliding;
  };
  const Triple<Real> wanted{held(xi.x, slip.x), held(xi.y, slip.y), held(xi.z, slip.z)};  // -F_t
  const Real share = limit / Max(Sqrt(dot(wanted, wanted)), friction.tiny);
  const auto slides = share < friction.one;
  const Real kept = Min(share, friction.one);
  const Triple<Real> against{wanted.x * kept, wanted.y * kept, wanted.z * kept};
  stretch = {IfThenElse(slides, against.x * friction.per_stiffness, xi.x),
             IfThenElse(slides, against.y * friction.per_stiffness, xi.y),
             IfThenElse(slides, against.z * friction.per_stiffness, xi.z)};
  return {friction.zero - against.x, friction.zero - against.y, friction.zero - against.z};
}

}  // namespace haptolith::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
