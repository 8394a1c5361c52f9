// The contact law, once, for every kind of number: double here for the analysis of the soil, and the SIMD vectors of
// each instruction set in the bed's kernel. Included again for every target, hence the toggled guard (Highway's idiom).

#if defined(HAPTOLITH_CONTACT_LAW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HAPTOLITH_CONTACT_LAW_INL_H_
#undef HAPTOLITH_CONTACT_LAW_INL_H_
#else
#define HAPTOLITH_CONTACT_LAW_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>

#include "haptolith/soil/contact_law.h"

HWY_BEFORE_NAMESPACE();
namespace haptolith::HWY_NAMESPACE {

/// The constants of ContactLaw, one copy per lane.
template <class Real>
struct LawOf {
  Real gamma, a_min, a_thr, h, k;
};

// Highway's Max for single numbers, so that one expression serves both.
inline double Max(double a, double b) {
  return std::max(a, b);
}
inline float Max(float a, float b) {
  return std::max(a, b);
}

/// F(a) without its cutoff (paper 7). Both branches in one expression: below a_thr the hyperbola is held at a_thr and
/// the line k (a_thr - a) is added; above it the line is zero.
template <class Real>
HWY_INLINE Real uncutContactForce(const LawOf<Real>& law, Real a) {
  const Real held = Max(a, law.a_thr);
  return law.gamma / (held - law.a_min) - law.h + law.k * (held - a);
}

}  // namespace haptolith::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
