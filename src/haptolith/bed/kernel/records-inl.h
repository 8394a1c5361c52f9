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
#include "haptolith/bed/contact_lists.h"

HWY_BEFORE_NAMESPACE();
namespace haptolith::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;

struct Records {
  V x, y, z, w;
};

/// A record by its number, and by where it begins in bytes, as in ContactLists.
HWY_INLINE const float* recordAt(const Float4* records, std::int32_t number) {
  return &records[number].x;
}
HWY_INLINE const float* recordAt(const Float4* records, std::uint32_t offset) {
  return reinterpret_cast<const float*>(reinterpret_cast<const char*>(records) + offset);
}

#if HWY_TARGET == HWY_SCALAR

template <class Index>
HWY_INLINE Records loadRecords(const Float4* HWY_RESTRICT record, const Index* HWY_RESTRICT index) {
  const D d;
  const float* one = recordAt(record, *index);
  return {hn::Set(d, one[0]), hn::Set(d, one[1]), hn::Set(d, one[2]), hn::Set(d, one[3])};
}

HWY_INLINE Records loadInOrder(const Float4* HWY_RESTRICT record) {
  const D d;
  return {hn::Set(d, record->x), hn::Set(d, record->y), hn::Set(d, record->z), hn::Set(d, record->w)};
}

HWY_INLINE void storeInOrder(const Records& r, Float4* HWY_RESTRICT record) {
  *record = {hn::GetLane(r.x), hn::GetLane(r.y), hn::GetLane(r.z), hn::GetLane(r.w)};
}

#else

/// Two halves as one vector. hn::Combine clears what it is about to fill, a move more for each.
template <class AnyD>
HWY_INLINE hn::Vec<AnyD> joined(AnyD d, hn::Vec<hn::Half<AnyD> > upper, hn::Vec<hn::Half<AnyD> > lower) {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
  if constexpr (hn::MaxLanes(d) == 16) {
    return hn::Vec<AnyD>{_mm512_insertf32x8(_mm512_castps256_ps512(lower.raw), upper.raw, 1)};
  }
#endif
  return hn::Combine(d, upper, lower);
}

/// Four records of every 128-bit block, one from each group of four neighbours, as one vector. Loading records whole
/// and turning them in registers takes a third of the time of three gathers on processors whose gathers are slow.
template <class AnyD, class Index>
HWY_INLINE hn::Vec<AnyD> loadEveryFourth(AnyD d, const Float4* HWY_RESTRICT records, const Index* HWY_RESTRICT index) {
  if constexpr (hn::MaxLanes(d) == 4) {
    return hn::Load(d, recordAt(records, *index));
  } else {
    const hn::Half<AnyD> half;
    return joined(d, loadEveryFourth(half, records, index + hn::MaxLanes(half)), loadEveryFourth(half, records, index));
  }
}

/// From records to vectors of their parts, within every 128-bit block; and back, for that is the same thing.
HWY_INLINE Records turned(V first, V second, V third, V fourth) {
  const D d;
  const V xy_odd = hn::InterleaveLower(d, first, third);  // x0 x2 y0 y2 of every block
  const V xy_even = hn::InterleaveLower(d, second, fourth);
  const V zw_odd = hn::InterleaveUpper(d, first, third);
  const V zw_even = hn::InterleaveUpper(d, second, fourth);
  return {hn::InterleaveLower(d, xy_odd, xy_even), hn::InterleaveUpper(d, xy_odd, xy_even),
          hn::InterleaveLower(d, zw_odd, zw_even), hn::InterleaveUpper(d, zw_odd, zw_even)};
}

/// Vectors of as many records as a vector has lanes, in the order of `index`.
template <class Index>
HWY_INLINE Records loadRecords(const Float4* HWY_RESTRICT record, const Index* HWY_RESTRICT index) {
  const D d;
  return turned(loadEveryFourth(d, record, index), loadEveryFourth(d, record, index + 1),
                loadEveryFourth(d, record, index + 2), loadEveryFourth(d, record, index + 3));
}

// Records that stand one behind the other are loaded as they lie, a whole vector at a time, B blocks of 128 bits: what
// turned() makes of four such vectors has record k B + b in lane 4 b + k.
constexpr int kBlocks = static_cast<int>(hn::MaxLanes(D())) / 4;
constexpr int kBlockBits = kBlocks == 4 ? 2 : kBlocks - 1;

/// What turned() has made, in the order of the records.
HWY_INLINE V inOrder(V v) {
  if constexpr (kBlocks == 1) {
    return v;
  } else {
    const hn::RebindToSigned<D> di;
    const auto lane = hn::Iota(di, 0);
    const auto block = hn::And(lane, hn::Set(di, kBlocks - 1));
    return hn::TableLookupLanes(
        v, hn::IndicesFromVec(D(), hn::Add(hn::ShiftLeft<2>(block), hn::ShiftRight<kBlockBits>(lane))));
  }
}
/// The other way round.
HWY_INLINE V toTurn(V v) {
  if constexpr (kBlocks == 1) {
    return v;
  } else {
    const hn::RebindToSigned<D> di;
    const auto lane = hn::Iota(di, 0);
    const auto in_block = hn::And(lane, hn::Set(di, 3));
    return hn::TableLookupLanes(
        v, hn::IndicesFromVec(D(), hn::Add(hn::ShiftLeft<kBlockBits>(in_block), hn::ShiftRight<2>(lane))));
  }
}

HWY_INLINE Records loadInOrder(const Float4* HWY_RESTRICT record) {
  const D d;
  const float* from = &record->x;
  const std::size_t lanes = hn::Lanes(d);
  const Records r = turned(hn::LoadU(d, from), hn::LoadU(d, from + lanes), hn::LoadU(d, from + 2 * lanes),
                           hn::LoadU(d, from + 3 * lanes));
  return {inOrder(r.x), inOrder(r.y), inOrder(r.z), inOrder(r.w)};
}

HWY_INLINE void storeInOrder(const Records& r, Float4* HWY_RESTRICT record) {
  const D d;
  float* to = &record->x;
  const std::size_t lanes = hn::Lanes(d);
  const Records rows = turned(toTurn(r.x), toTurn(r.y), toTurn(r.z), toTurn(r.w));
  hn::StoreU(rows.x, d, to);
  hn::StoreU(rows.y, d, to + lanes);
  hn::StoreU(rows.z, d, to + 2 * lanes);
  hn::StoreU(rows.w, d, to + 3 * lanes);
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
