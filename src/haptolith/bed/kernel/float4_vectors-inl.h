// Float4 of many particles as four SIMD vectors x, y, z and w: the loads and stores of all kernels. Included again for
// every target, therefore the toggled guard (Highway's idiom).

#if defined(HAPTOLITH_FLOAT4_VECTORS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HAPTOLITH_FLOAT4_VECTORS_INL_H_
#undef HAPTOLITH_FLOAT4_VECTORS_INL_H_
#else
#define HAPTOLITH_FLOAT4_VECTORS_INL_H_
#endif

#include <hwy/highway.h>

#include "haptolith/bed/bed_state.h"
#include "haptolith/bed/contact_lists.h"
#include "haptolith/core/math/arithmetic-inl.h"

HWY_BEFORE_NAMESPACE();
namespace haptolith::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;

/// x, y, z and w of as many particles as a vector has lanes.
struct Float4Vectors {
  V x, y, z, w;
};

/// A Float4 by its index, and by its offset in bytes as in ContactLists.
HWY_INLINE const float* float4At(const Float4* memory, std::int32_t number) {
  return &memory[number].x;
}
HWY_INLINE const float* float4At(const Float4* memory, std::uint32_t offset) {
  return reinterpret_cast<const float*>(reinterpret_cast<const char*>(memory) + offset);
}

#if HWY_TARGET == HWY_SCALAR

template <class Index>
HWY_INLINE Float4Vectors gatherFloat4(const Float4* HWY_RESTRICT memory, const Index* HWY_RESTRICT index) {
  const D d;
  const float* one = float4At(memory, *index);
  return {hn::Set(d, one[0]), hn::Set(d, one[1]), hn::Set(d, one[2]), hn::Set(d, one[3])};
}

HWY_INLINE Float4Vectors loadFloat4(const Float4* HWY_RESTRICT memory) {
  const D d;
  return {hn::Set(d, memory->x), hn::Set(d, memory->y), hn::Set(d, memory->z), hn::Set(d, memory->w)};
}

HWY_INLINE void storeFloat4(const Float4Vectors& r, Float4* HWY_RESTRICT memory) {
  *memory = {hn::GetLane(r.x), hn::GetLane(r.y), hn::GetLane(r.z), hn::GetLane(r.w)};
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

/// Every fourth Float4 of `index`, one in each 128-bit block. Loading whole Float4 and transposing them in registers
/// takes a third of the time of three gathers on processors whose gathers are slow.
template <class AnyD, class Index>
HWY_INLINE hn::Vec<AnyD> loadEveryFourth(AnyD d, const Float4* HWY_RESTRICT memory, const Index* HWY_RESTRICT index) {
  if constexpr (hn::MaxLanes(d) == 4) {
    return hn::Load(d, float4At(memory, *index));
  } else {
    const hn::Half<AnyD> half;
    return joined(d, loadEveryFourth(half, memory, index + hn::MaxLanes(half)), loadEveryFourth(half, memory, index));
  }
}

/// Transposes within every 128-bit block: Float4 to vectors of x, y, z and w, and back, since it is its own inverse.
HWY_INLINE Float4Vectors transposed(V first, V second, V third, V fourth) {
  const D d;
  const V xy_odd = hn::InterleaveLower(d, first, third);  // x0 x2 y0 y2 of every block
  const V xy_even = hn::InterleaveLower(d, second, fourth);
  const V zw_odd = hn::InterleaveUpper(d, first, third);
  const V zw_even = hn::InterleaveUpper(d, second, fourth);
  return {hn::InterleaveLower(d, xy_odd, xy_even), hn::InterleaveUpper(d, xy_odd, xy_even),
          hn::InterleaveLower(d, zw_odd, zw_even), hn::InterleaveUpper(d, zw_odd, zw_even)};
}

/// Gathers the Float4 of `index`, in that order.
template <class Index>
HWY_INLINE Float4Vectors gatherFloat4(const Float4* HWY_RESTRICT memory, const Index* HWY_RESTRICT index) {
  const D d;
  return transposed(loadEveryFourth(d, memory, index), loadEveryFourth(d, memory, index + 1),
                    loadEveryFourth(d, memory, index + 2), loadEveryFourth(d, memory, index + 3));
}

// Consecutive Float4 are loaded a whole vector at a time, B blocks of 128 bits: transposed() of four such vectors has
// Float4 number k B + b in lane 4 b + k.
constexpr int kBlocks = static_cast<int>(hn::MaxLanes(D())) / 4;
constexpr int kBlockBits = kBlocks == 4 ? 2 : kBlocks - 1;

/// Result of transposed(), in the order of the Float4 in memory.
HWY_INLINE V fromTransposed(V v) {
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
/// The inverse of fromTransposed().
HWY_INLINE V toTransposed(V v) {
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

HWY_INLINE Float4Vectors loadFloat4(const Float4* HWY_RESTRICT memory) {
  const D d;
  const float* from = &memory->x;
  const std::size_t lanes = hn::Lanes(d);
  const Float4Vectors r = transposed(hn::LoadU(d, from), hn::LoadU(d, from + lanes), hn::LoadU(d, from + 2 * lanes),
                                     hn::LoadU(d, from + 3 * lanes));
  return {fromTransposed(r.x), fromTransposed(r.y), fromTransposed(r.z), fromTransposed(r.w)};
}

HWY_INLINE void storeFloat4(const Float4Vectors& r, Float4* HWY_RESTRICT memory) {
  const D d;
  float* to = &memory->x;
  const std::size_t lanes = hn::Lanes(d);
  const Float4Vectors rows = transposed(toTransposed(r.x), toTransposed(r.y), toTransposed(r.z), toTransposed(r.w));
  hn::StoreU(rows.x, d, to);
  hn::StoreU(rows.y, d, to + lanes);
  hn::StoreU(rows.z, d, to + 2 * lanes);
  hn::StoreU(rows.w, d, to + 3 * lanes);
}

#endif

/// The shortest way from one particle to another where a box repeats itself (Periods): along an axis that does not, the
/// period is 0 and the result is bit-identical.
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
