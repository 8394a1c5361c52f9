// Friction between two bodies that touch, once, for every kind of number: the SIMD vectors of the bed's kernel, float
// for its walls, double for the tool. Included again for every target, hence the toggled guard (Highway's idiom).

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
  Real stiffness;        ///< k_t, N/m
  Real damping;          ///< c_t, N s/m
  Real zero, one, tiny;  ///< 0, 1, and what is nothing beside any force's square
};

/// Friction on the first of two bodies, with the normal `n` from the second to it (Cundall and Strack 1979, eq. 5, 15):
/// a spring along the surface remembers how far they have slid against each other since they met, and beside it works a
/// damper. Both together hold no more than the Coulomb `limit`, and neither does the spring alone, which gives way:
///
///     xi <- xi - (xi n) n + v_t dt,     |k_t xi| > limit:  xi <- limit / k_t xi / |xi|
///     F_t = -(k_t xi + c_t v_t),        |F_t| > limit:     F_t <- limit F_t / |F_t|
///
/// Often xi is set to -F_t / k_t wherever F_t is limited. That stretches the spring by the damper's force at one
/// stroke, to more energy than sliding has given it: a particle at rest that is nudged would come out faster than it
/// went in.
///
/// Every term changes its sign with n, v and xi, so what the second body works out for itself is the exact opposite.
/// @param slip      v_t, velocity of the first against the second, without its part along n.
/// @param stretch   xi, read and written.
template <class Real>
HWY_INLINE Triple<Real> frictionForce(const FrictionOf<Real>& friction, Real limit, const Triple<Real>& n,
                                      const Triple<Real>& slip, Triple<Real>& stretch) {
  // How much of a force is left when it may not exceed the limit.
  const auto share = [&](const Triple<Real>& force) {
    return Min(limit * InverseSqrt(Max(dot(force, force), friction.tiny)), friction.one);
  };
  const Triple<Real> old = across(stretch, n);
  const Triple<Real> xi{MulAdd(slip.x, friction.dt, old.x), MulAdd(slip.y, friction.dt, old.y),
                        MulAdd(slip.z, friction.dt, old.z)};
  const Triple<Real> spring{xi.x * friction.stiffness, xi.y * friction.stiffness, xi.z * friction.stiffness};
  const Real held = share(spring);
  stretch = {xi.x * held, xi.y * held, xi.z * held};
  const auto both = [&](Real of_spring, Real sliding) { return MulAdd(of_spring, held, friction.damping * sliding); };
  const Triple<Real> wanted{both(spring.x, slip.x), both(spring.y, slip.y), both(spring.z, slip.z)};  // -F_t
  const Real kept = friction.zero - share(wanted);
  return {wanted.x * kept, wanted.y * kept, wanted.z * kept};
}

}  // namespace haptolith::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
