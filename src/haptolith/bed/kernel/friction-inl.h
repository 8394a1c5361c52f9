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
};

/// One body against one other: it touches it.
struct Touches {};

/// Factor that shortens what is longer than `reach` to it. @param squared  square of its length.
template <class Real>
HWY_INLINE Real shareWithin(Touches, Real reach, Real squared) {
  return squared > reach * reach ? reach / std::sqrt(squared) : Real{1};
}
/// As above for a vector; lanes that are not `touching` are not shortened. Most contacts stick: where none of a vector
/// slides, it needs no root.
template <class Mask, class V>
HWY_INLINE V shareWithin(Mask touching, V reach, V squared) {
  const hwy::HWY_NAMESPACE::DFromV<V> d;
  const V one = hwy::HWY_NAMESPACE::Set(d, 1);
  const auto slides = hwy::HWY_NAMESPACE::And(touching, squared > reach * reach);
  if (hwy::HWY_NAMESPACE::AllFalse(d, slides)) {
    return one;
  }
  return hwy::HWY_NAMESPACE::IfThenElse(slides, reach / hwy::HWY_NAMESPACE::Sqrt(squared), one);
}

/// Remaining part of the stretch: none in lanes that do not touch.
template <class Real>
HWY_INLINE Real kept(Touches, Real stretch) {
  return stretch;
}
template <class Mask, class V>
HWY_INLINE V kept(Mask touching, V stretch) {
  return hwy::HWY_NAMESPACE::IfThenElseZero(touching, stretch);
}

/// The first half of frictionForce(): xi after a step of sliding, whatever the limit.
template <class Real>
HWY_INLINE Triple<Real> stretched(const FrictionOf<Real>& friction, const Triple<Real>& n, const Triple<Real>& slip,
                                  const Triple<Real>& stretch) {
  const Triple<Real> old = across(stretch, n);
  return {MulAdd(slip.x, friction.dt, old.x), MulAdd(slip.y, friction.dt, old.y), MulAdd(slip.z, friction.dt, old.z)};
}

/// The second half: the force, within the limit, as the stretch is then.
/// @param touching  Touches, or the mask of lanes whose bodies touch: in others nothing remains of the stretch.
template <class Real, class Touching>
HWY_INLINE Triple<Real> heldFriction(const FrictionOf<Real>& friction, Touching touching, Real reach,
                                     const Triple<Real>& slip, Triple<Real>& stretch) {
  const Real held = shareWithin(touching, reach, dot(stretch, stretch));
  stretch = {kept(touching, stretch.x * held), kept(touching, stretch.y * held), kept(touching, stretch.z * held)};
  const Triple<Real> wanted{MulAdd(slip.x, friction.lag, stretch.x), MulAdd(slip.y, friction.lag, stretch.y),
                            MulAdd(slip.z, friction.lag, stretch.z)};  // -F_t / k_t
  const Real force = friction.minus_stiffness * shareWithin(touching, reach, dot(wanted, wanted));
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
/// @param touching  Touches, or the mask of lanes whose bodies touch.
/// @param reach     limit / k_t, how far the spring alone can be stretched, in m.
/// @param slip      v_t, velocity of the first against the second, without its part along n.
/// @param stretch   xi, read and written.
template <class Real, class Touching>
HWY_INLINE Triple<Real> frictionForce(const FrictionOf<Real>& friction, Touching touching, Real reach,
                                      const Triple<Real>& n, const Triple<Real>& slip, Triple<Real>& stretch) {
  stretch = stretched(friction, n, slip, stretch);
  return heldFriction(friction, touching, reach, slip, stretch);
}

}  // namespace haptolith::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
