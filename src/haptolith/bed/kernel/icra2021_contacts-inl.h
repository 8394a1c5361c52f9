// Force of the neighbours on each particle by the law of icra2021. Included again for every target, therefore the
// toggled guard (Highway's idiom).

#if defined(HAPTOLITH_ICRA2021_CONTACTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HAPTOLITH_ICRA2021_CONTACTS_INL_H_
#undef HAPTOLITH_ICRA2021_CONTACTS_INL_H_
#else
#define HAPTOLITH_ICRA2021_CONTACTS_INL_H_
#endif

#include "haptolith/bed/kernel/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace haptolith::HWY_NAMESPACE {

struct Icra2021Contacts {
  LawOf<V> law;
  V cutoff, inner_cutoff, diameter;
  PeriodsOf periods;

  Icra2021Contacts(const KernelLaw& scalar, const Periods& box, float inner_skin_m)
      : law(lawOf(scalar)),
        cutoff(set(scalar.cutoff)),
        inner_cutoff(set(scalar.cutoff + inner_skin_m)),
        diameter(set(scalar.diameter)),
        periods(box) {}

  /// (paper 19) over all neighbours. While one row's forces are worked out, the next row's particles are fetched
  /// already: either alone is a long chain in which each step waits for the one before.
  template <bool kPeriodic>
  HWY_INLINE Sums sum(const StepArrays& arrays, const Lanes& at, const Float4Vectors& here) const {
    const V zero = hn::Zero(D());
    const V one = set(1);
    Sums sums{zero, zero, zero, zero, zero};
    const Rows rows(arrays, at);
    const auto fetch = [&](std::size_t row) { return separationOf<kPeriodic>(periods, here, rows.positions(row)); };
    Separation next = fetch(0);  // there is room for a row, if with ghosts only
    for (std::size_t row = 0; row < at.rows; ++row) {
      const Separation d = next;
      next = fetch(row + 1 < at.rows ? row + 1 : row);
      rows.prefetchNextNeighbours(row);
      const Distance a = distanceOf(d.squared);
      if (at.pruning != nullptr && !hn::AllFalse(D(), a.metres < inner_cutoff)) {
        keepInInnerList(at, row);
      }
      const V force = hn::IfThenElseZero(a.metres < cutoff, uncutContactForce(law, a.metres));
      const V per_metre = force * a.inverse;
      sums.x = MulAdd(per_metre, d.x, sums.x);
      sums.y = MulAdd(per_metre, d.y, sums.y);
      sums.z = MulAdd(per_metre, d.z, sums.z);
      sums.repulsion = sums.repulsion + larger(force, zero);
      sums.contacts = sums.contacts + hn::IfThenElseZero(a.metres < diameter, one);
    }
    return sums;
  }

  /// Adds the push of a wall at `distance` along one axis; `sign` is the axis's direction away from the wall. The wall
  /// is the particle's mirror image (see wallLaw()) and, like any macroparticle, counts for friction and damping.
  HWY_INLINE void addWall(V distance, V sign, V& force, Sums& sums) const {
    const V a = distance + distance;
    const auto touches = a < diameter;
    if (hn::AllFalse(D(), touches)) {
      return;
    }
    const V push = hn::IfThenElseZero(touches, uncutContactForce(law, a));
    force = MulAdd(sign, push, force);
    sums.repulsion = sums.repulsion + push;
    sums.contacts = sums.contacts + hn::IfThenElseZero(touches, set(1));
  }
};

}  // namespace haptolith::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
