// Friction between two bodies that touch, once, for every kind of number: the SIMD vectors of the bed's kernel, float
// for its walls, double for the tool. Included again for every target, therefore the toggled guard (Highway's idiom).

#if defined(HAPTOLITH_FRICTION_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HAPTOLITH_FRICTION_INL_H_
#undef HAPTOLITH_FRICTION_INL_H_
#else
#define HAPTOLITH_FRICTION_INL_H_
#endif

#include <hwy/highway.h>

#include "haptolith/soil/contact_law-inl.h"

HWY_BEFORE_NAMESPACE();
namespace haptolith::HWY_NAMESPACE {

template <class Real>
struct Triple {
  Real x, y, z;
};

template <class Real>
HWY_INLINE Real dot(const Triple<Real>& a, const Triple<Real>& b) {
  return MulAdd(a.x, b.x, MulAdd(a.y, b.y, a.z * b.z));
}

/// `v` without its part along the unit vector `n`.
template <class Real>
HWY_INLINE Triple<Real> across(const Triple<Real>& v, const Triple<Real>& n) {
  const Real along = dot(v, n);
  return {NegMulAdd(along, n.x, v.x), NegMulAdd(along, n.y, v.y), NegMulAdd(along, n.z, v.z)};
}

/// Constants of sticking and sliding.
template <class Real>
struct FrictionOf {
  Real dt;
  Real minus_stiffness;  ///< -k_t, N/m
  Real lag;              ///< c_t / k_t, s
  Real one, tiny;        ///< 1, and a square that is negligible against any stretch's, m^2
};

/// The first half of frictionForce(): xi after a step of sliding, whatever the limit.
template <class Real>
HWY_INLINE Triple<Real> stretched(const FrictionOf<Real>& friction, const Triple<Real>& n, const Triple<Real>& slip,
                                  const Triple<Real>& stretch) {
  const Triple<Real> old = across(stretch, n);
  return {MulAdd(slip.x, friction.dt, old.x), MulAdd(slip.y, friction.dt, old.y), MulAdd(slip.z, friction.dt, old.z)};
}

/// The second half: the force, within the limit, as the stretch is then.
/// @param kept  kept(xi) is what remains of each part of the stretch: nothing in lanes whose bodies do not touch.
template <class Real, class Kept>
HWY_INLINE Triple<Real> heldFriction(const FrictionOf<Real>& friction, Real reach, const Triple<Real>& slip,
                                     Triple<Real>& stretch, const Kept& kept) {
  // Factor that limits a stretch to the reach.
  const auto share = [&](const Triple<Real>& of) {
    const Real squared = MulAdd(of.x, of.x, MulAdd(of.y, of.y, MulAdd(of.z, of.z, friction.tiny)));
    return Min(reach * InverseSqrt(squared), friction.one);
  };
  const Real held = share(stretch);
  stretch = {kept(stretch.x * held), kept(stretch.y * held), kept(stretch.z * held)};
  const Triple<Real> wanted{MulAdd(slip.x, friction.lag, stretch.x), MulAdd(slip.y, friction.lag, stretch.y),
                            MulAdd(slip.z, friction.lag, stretch.z)};  // -F_t / k_t
  const Real force = friction.minus_stiffness * share(wanted);
  return {wanted.x * force, wanted.y * force, wanted.z * force};
}

/// Friction on the first of two bodies, with the normal `n` from the second to it (Cundall and Strack 1979, eq. 5, 15):
/// a spring along the surface stores their slip since contact began, with a damper in
/// parallel. Both together hold no more than the Coulomb limit, and neither does the spring alone, which gives way:
///
///     xi <- xi - (xi n) n + v_t dt,     |k_t xi| > limit:  xi <- limit / k_t xi / |xi|
///     F_t = -(k_t xi + c_t v_t),        |F_t| > limit:     F_t <- limit F_t / |F_t|
///
/// Often xi is set to -F_t / k_t wherever F_t is limited. That stretches the spring by the damper's force at one
/// stroke, to more energy than sliding has given it: a particle at rest that is nudged would come out faster than it
/// went in.
///
/// Every term changes its sign with n, v and xi, so what the second body works out for itself is the exact opposite.
/// @param reach     limit / k_t, how far the spring alone can be stretched, in m.
/// @param slip      v_t, velocity of the first against the second, without its part along n.
/// @param stretch   xi, read and written.
template <class Real>
HWY_INLINE Triple<Real> frictionForce(const FrictionOf<Real>& friction, Real reach, const Triple<Real>& n,
                                      const Triple<Real>& slip, Triple<Real>& stretch) {
  stretch = stretched(friction, n, slip, stretch);
  return heldFriction(friction, reach, slip, stretch, [](Real xi) HWY_ATTR { return xi; });
}

}  // namespace haptolith::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
