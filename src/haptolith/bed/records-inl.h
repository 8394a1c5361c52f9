// Records of many particles in SIMD registers: what every kernel over neighbour lists is built of. Included again for
// every target, hence the toggled guard (Highway's idiom).

#if defined(HAPTOLITH_RECORDS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HAPTOLITH_RECORDS_INL_H_
#undef HAPTOLITH_RECORDS_INL_H_
#else
#define HAPTOLITH_RECORDS_INL_H_
#endif

#include <hwy/highway.h>

#include "haptolith/bed/bed_state.h"
#include "haptolith/bed/contact_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace haptolith::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;

struct Records {
  V x, y, z, w;
};

#if HWY_TARGET == HWY_SCALAR

HWY_INLINE Records loadRecords(const Float4* HWY_RESTRICT record, const std::int32_t* HWY_RESTRICT index) {
  const D d;
  const Float4& one = record[*index];
  return {hn::Set(d, one.x), hn::Set(d, one.y), hn::Set(d, one.z), hn::Set(d, one.w)};
}

HWY_INLINE void storeSums(V fx, V fy, V fz, V repulsion, ContactSum& sum) {
  sum.force_x_n = hn::GetLane(fx);
  sum.force_y_n = hn::GetLane(fy);
  sum.force_z_n = hn::GetLane(fz);
  sum.repulsion_n = hn::GetLane(repulsion);
}

#else

/// Four records of every 128-bit block, one from each group of four neighbours, as one vector. Loading records whole
/// and turning them in registers takes a third of the time of three gathers on processors whose gathers are slow.
template <class AnyD>
HWY_INLINE hn::Vec<AnyD> loadEveryFourth(AnyD d, const Float4* HWY_RESTRICT records,
                                         const std::int32_t* HWY_RESTRICT index) {
  if constexpr (hn::MaxLanes(d) == 4) {
    return hn::Load(d, &records[index[0]].x);
  } else {
    const hn::Half<AnyD> half;
    return hn::Combine(d, loadEveryFourth(half, records, index + hn::MaxLanes(half)),
                       loadEveryFourth(half, records, index));
  }
}

/// Vectors of as many neighbours as a vector has lanes, in their order.
HWY_INLINE Records loadRecords(const Float4* HWY_RESTRICT record, const std::int32_t* HWY_RESTRICT index) {
  const D d;
  const V first = loadEveryFourth(d, record, index);
  const V second = loadEveryFourth(d, record, index + 1);
  const V third = loadEveryFourth(d, record, index + 2);
  const V fourth = loadEveryFourth(d, record, index + 3);
  const V xy_odd = hn::InterleaveLower(d, first, third);  // x0 x2 y0 y2 of every block
  const V xy_even = hn::InterleaveLower(d, second, fourth);
  const V z_odd = hn::InterleaveUpper(d, first, third);
  const V z_even = hn::InterleaveUpper(d, second, fourth);
  return {hn::InterleaveLower(d, xy_odd, xy_even), hn::InterleaveUpper(d, xy_odd, xy_even),
          hn::InterleaveLower(d, z_odd, z_even), hn::InterleaveUpper(d, z_odd, z_even)};
}

/// Folds a vector's 128-bit blocks onto each other.
template <class AnyD>
HWY_INLINE hn::Vec<hn::FixedTag<float, 4> > foldedBlocks(AnyD d, hn::Vec<AnyD> v) {
  if constexpr (hn::MaxLanes(d) == 4) {
    return v;
  } else {
    const hn::Half<AnyD> half;
    return foldedBlocks(half, hn::LowerHalf(half, v) + hn::UpperHalf(half, v));
  }
}

/// Sums the lanes of four vectors at once and stores them side by side.
HWY_INLINE void storeSums(V fx, V fy, V fz, V repulsion, ContactSum& sum) {
  const D d;
  const hn::FixedTag<float, 4> block;
  const auto x = foldedBlocks(d, fx);
  const auto y = foldedBlocks(d, fy);
  const auto z = foldedBlocks(d, fz);
  const auto r = foldedBlocks(d, repulsion);
  const auto xz = hn::InterleaveLower(block, x, z) + hn::InterleaveUpper(block, x, z);  // x02 z02 x13 z13
  const auto yr = hn::InterleaveLower(block, y, r) + hn::InterleaveUpper(block, y, r);
  hn::Store(hn::InterleaveLower(block, xz, yr) + hn::InterleaveUpper(block, xz, yr), block, &sum.force_x_n);
}

#endif

/// The shortest way from one particle to another where a box repeats itself (Periods): along an axis that does not, the
/// period is 0 and nothing changes, to the last bit.
template <bool kPeriodic>
HWY_INLINE V nearestImage(V distance, V period, V per_period) {
  if constexpr (kPeriodic) {
    return distance - period * hn::Round(distance * per_period);
  } else {
    return distance;
  }
}

}  // namespace haptolith::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
