// The contact law, once, for every kind of number: double here for the analysis of the soil, and the SIMD vectors of
// each instruction set in the bed's kernel. Included again for every target, therefore the toggled guard (Highway's
// idiom).

#if defined(HAPTOLITH_CONTACT_LAW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HAPTOLITH_CONTACT_LAW_INL_H_
#undef HAPTOLITH_CONTACT_LAW_INL_H_
#else
#define HAPTOLITH_CONTACT_LAW_INL_H_
#endif

#include <hwy/highway.h>

#include "haptolith/core/math/arithmetic-inl.h"
#include "haptolith/soil/contact_law.h"

HWY_BEFORE_NAMESPACE();
namespace haptolith::HWY_NAMESPACE {

/// The constants of ContactLaw, one copy per lane.
template <class Real>
struct LawOf {
  Real gamma, a_min, a_thr, h, k;
};

/// The constants of cohesion with contact friction: F_c, 2 / range, 0 and 1.
template <class Real>
struct CohesionOf {
  Real largest, two_per_range, zero, one;
};

/// F(a) without its cutoff (paper 7). Both branches in one expression: below a_thr the hyperbola is held at a_thr and
/// the line k (a_thr - a) is added; above it the line is zero.
template <class Real>
HWY_INLINE Real uncutContactForce(const LawOf<Real>& law, Real a) {
  const Real held = larger(a, law.a_thr);
  return MulAdd(law.k, held - a, MulSub(law.gamma, Inverse(held - law.a_min), law.h));
}

/// Effect of cohesion between two surfaces.
template <class Real>
struct Cohesion {
  Real pull;    ///< towards each other: F_c (1 - u^2) = 4 F_c s (1 - s),  s = gap / range
  Real weight;  ///< addition to the repulsion that limits friction: F_c max(u, 0)^2
};

/// Cohesion across a gap: with u = 1 - 2 gap / range, held between -1 and 1, there is no pull where the surfaces touch
/// (u = 1), F_c halfway and none from the range on. Friction feels F_c while they touch and nothing from halfway on.
template <class Real>
HWY_INLINE Cohesion<Real> cohesionAcross(const CohesionOf<Real>& cohesion, Real gap) {
  const Real u =
      larger(smaller(NegMulAdd(gap, cohesion.two_per_range, cohesion.one), cohesion.one), cohesion.zero - cohesion.one);
  const Real growing = larger(u, cohesion.zero);
  return {cohesion.largest * NegMulAdd(u, u, cohesion.one), cohesion.largest * growing * growing};
}

/// Forces between two particles with contact friction along the line between their centres.
template <class Real>
struct CohesiveContact {
  Real normal;       ///< F > 0 repels
  Real compression;  ///< limit of friction, divided by mu_p
};

/// Repulsion (paper 7) while particles overlap, cohesion beyond.
template <class Real>
HWY_INLINE CohesiveContact<Real> cohesiveContact(const LawOf<Real>& law, const CohesionOf<Real>& constants,
                                                 Real diameter, Real a) {
  const Real repulsion = larger(uncutContactForce(law, a), constants.zero);
  const Cohesion<Real> cohesion = cohesionAcross(constants, a - diameter);
  return {repulsion - cohesion.pull, repulsion + cohesion.weight};
}

/// Square root of the law's stiffness -dF/da (paper 7), over that of gamma: the stiffness is gamma / (a - a_min)^2 down
/// to a_thr, and k from there on.
template <class Real>
HWY_INLINE Real rootOfStiffness(const LawOf<Real>& law, Real a) {
  return Inverse(larger(a, law.a_thr) - law.a_min);
}

}  // namespace haptolith::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
