#include "haptolith/bed/contact_kernel.h"

// This file is compiled once for every instruction set; sumContacts() picks the best one at run time.
// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "haptolith/bed/contact_kernel.cpp"
#include <hwy/foreach_target.h>  // before highway.h
#include <hwy/highway.h>
#include "haptolith/soil/contact_law-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace haptolith::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;
using Indices = hn::RebindToSigned<D>;

// Highway's dispatch tables take no noexcept functions; the public ones below are.

struct Positions {
  V x, y, z;
};

#if HWY_TARGET == HWY_SCALAR

HWY_INLINE Positions loadPositions(const Float4* HWY_RESTRICT position, const std::int32_t* HWY_RESTRICT index) {
  const D d;
  const Float4& record = position[*index];
  return {hn::Set(d, record.x), hn::Set(d, record.y), hn::Set(d, record.z)};
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
HWY_INLINE hn::Vec<AnyD> loadRecords(AnyD d, const Float4* HWY_RESTRICT records,
                                     const std::int32_t* HWY_RESTRICT index) {
  if constexpr (hn::MaxLanes(d) == 4) {
    return hn::Load(d, &records[index[0]].x);
  } else {
    const hn::Half<AnyD> half;
    return hn::Combine(d, loadRecords(half, records, index + hn::MaxLanes(half)), loadRecords(half, records, index));
  }
}

/// Positions of as many neighbours as a vector has lanes, in their order.
HWY_INLINE Positions loadPositions(const Float4* HWY_RESTRICT position, const std::int32_t* HWY_RESTRICT index) {
  const D d;
  const V first = loadRecords(d, position, index);
  const V second = loadRecords(d, position, index + 1);
  const V third = loadRecords(d, position, index + 2);
  const V fourth = loadRecords(d, position, index + 3);
  const V xy_odd = hn::InterleaveLower(d, first, third);  // x0 x2 y0 y2 of every block
  const V xy_even = hn::InterleaveLower(d, second, fourth);
  const V z_odd = hn::InterleaveUpper(d, first, third);
  const V z_even = hn::InterleaveUpper(d, second, fourth);
  return {hn::InterleaveLower(d, xy_odd, xy_even), hn::InterleaveUpper(d, xy_odd, xy_even),
          hn::InterleaveLower(d, z_odd, z_even)};
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

/// One particle against its list, a vector of neighbours at a time.
void sumContactsOf(const KernelLaw& scalar_law, const Float4* HWY_RESTRICT position, const Neighbours& neighbours,
                   std::size_t first, std::size_t last, ContactSum* HWY_RESTRICT sums) {
  const D d;
  const LawOf<V> law{hn::Set(d, scalar_law.gamma), hn::Set(d, scalar_law.a_min), hn::Set(d, scalar_law.a_thr),
                     hn::Set(d, scalar_law.h), hn::Set(d, scalar_law.k)};
  const V cutoff = hn::Set(d, scalar_law.cutoff);
  const V diameter = hn::Set(d, scalar_law.diameter);
  const V zero = hn::Zero(d);
  const V tiny = hn::Set(d, 1e-24F);  // two centres in one point repel nowhere, instead of 0/0

  for (std::size_t i = first; i < last; ++i) {
    const V xi = hn::Set(d, position[i].x);
    const V yi = hn::Set(d, position[i].y);
    const V zi = hn::Set(d, position[i].z);
    V fx = zero, fy = zero, fz = zero, repulsion = zero;
    std::size_t contacts = 0;
    for (std::uint32_t n = neighbours.begin[i]; n < neighbours.end[i]; n += static_cast<std::uint32_t>(hn::Lanes(d))) {
      const Positions other = loadPositions(position, neighbours.index + n);
      const V dx = xi - other.x;
      const V dy = yi - other.y;
      const V dz = zi - other.z;
      const V a = hn::Sqrt(hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::MulAdd(dz, dz, tiny))));
      const V force = hn::IfThenElseZero(a < cutoff, uncutContactForce(law, a));  // (paper 19)
      const V per_metre = force / a;
      fx = hn::MulAdd(per_metre, dx, fx);
      fy = hn::MulAdd(per_metre, dy, fy);
      fz = hn::MulAdd(per_metre, dz, fz);
      repulsion = repulsion + hn::Max(force, zero);
      contacts += hn::CountTrue(d, a < diameter);
    }
    storeSums(fx, fy, fz, repulsion, sums[i]);
    sums[i].contacts = static_cast<float>(contacts);
  }
}

/// Copies a cell and its 26 neighbours side by side into the scratch arrays and returns how many particles that are.
HWY_INLINE std::uint32_t gatherCandidates(const CellGrid& grid, const Candidates& candidates, int ix, int iy, int iz) {
  const D d;
  const Indices di;
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(d));
  const int first_x = HWY_MAX(ix - 1, 0);
  const int last_x = HWY_MIN(ix + 1, grid.nx - 1);
  std::uint32_t count = 0;
  for (int z = HWY_MAX(iz - 1, 0); z <= HWY_MIN(iz + 1, grid.nz - 1); ++z) {
    for (int y = HWY_MAX(iy - 1, 0); y <= HWY_MIN(iy + 1, grid.ny - 1); ++y) {
      const std::uint32_t* row = grid.cell_begin + (z * grid.ny + y) * grid.nx;
      const std::uint32_t from = row[first_x];
      const std::uint32_t to = row[last_x + 1];
      for (std::uint32_t n = from; n < to; n += lanes) {  // what is copied too much is overwritten by the next row
        const std::uint32_t at = count + n - from;
        hn::StoreU(hn::LoadU(d, grid.x + n), d, candidates.x + at);
        hn::StoreU(hn::LoadU(d, grid.y + n), d, candidates.y + at);
        hn::StoreU(hn::LoadU(d, grid.z + n), d, candidates.z + at);
        hn::StoreU(hn::LoadU(di, grid.particle + n), di, candidates.particle + at);
      }
      count += to - from;
    }
  }
  return count;
}

/// Writes those candidates to `out` that are near the particle `self`, and returns how many.
HWY_INLINE std::uint32_t appendNear(const Candidates& candidates, std::uint32_t count, const Float4& centre,
                                    std::int32_t self, float reach_m, std::int32_t* HWY_RESTRICT out) {
  const D d;
  const Indices di;
  const V x = hn::Set(d, centre.x);
  const V y = hn::Set(d, centre.y);
  const V z = hn::Set(d, centre.z);
  const V reach_squared = hn::Set(d, reach_m * reach_m);
  std::uint32_t found = 0;
  for (std::uint32_t n = 0; n < count; n += static_cast<std::uint32_t>(hn::Lanes(d))) {
    const V dx = x - hn::LoadU(d, candidates.x + n);
    const V dy = y - hn::LoadU(d, candidates.y + n);
    const V dz = z - hn::LoadU(d, candidates.z + n);
    const auto particle = hn::LoadU(di, candidates.particle + n);
    const auto near = hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, dz * dz)) < reach_squared;
    const auto others = hn::And(hn::Ne(particle, hn::Set(di, self)), hn::FirstN(di, count - n));
    const auto listed = hn::And(hn::RebindMask(di, near), others);
    hn::StoreU(hn::Compress(particle, listed), di, out + found);  // the rest of the vector is overwritten by the next
    found += static_cast<std::uint32_t>(hn::CountTrue(di, listed));
  }
  return found;
}

bool listNeighboursOf(const CellGrid& grid, const Candidates& candidates, const Float4* HWY_RESTRICT position,
                      float reach_m, std::size_t capacity, const Neighbours& neighbours) {
  std::uint32_t next = 0;
  int cell = 0;
  for (int iz = 0; iz < grid.nz; ++iz) {
    for (int iy = 0; iy < grid.ny; ++iy) {
      for (int ix = 0; ix < grid.nx; ++ix, ++cell) {
        const std::uint32_t from = grid.cell_begin[cell];
        const std::uint32_t to = grid.cell_begin[cell + 1];
        const std::uint32_t count = from == to ? 0 : gatherCandidates(grid, candidates, ix, iy, iz);
        for (std::uint32_t slot = from; slot < to; ++slot) {
          if (next + count + 2 * kNeighbourBlock > capacity) {
            return false;
          }
          const std::int32_t self = grid.particle[slot];
          neighbours.begin[self] = next;
          next += appendNear(candidates, count, position[self], self, reach_m, neighbours.index + next);
          while (next % kNeighbourBlock != 0) {
            neighbours.index[next++] = neighbours.ghost;
          }
          neighbours.end[self] = next;
        }
      }
    }
  }
  return true;
}

const char* targetName() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace haptolith::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace haptolith {

HWY_EXPORT(sumContactsOf);
HWY_EXPORT(listNeighboursOf);
HWY_EXPORT(targetName);

KernelLaw kernelLaw(const ContactLaw& law, double radius_m) {
  const auto f = [](double value) { return static_cast<float>(value); };
  return {f(law.gamma_nm),      f(law.a_min_m),  f(law.a_thr_m), f(law.h_n),
          f(law.stiffness_n_m), f(law.cutoff_m), f(2 * radius_m)};
}

void sumContacts(const KernelLaw& law, const Float4* position, const Neighbours& neighbours, std::size_t first,
                 std::size_t last, ContactSum* sums) noexcept {
  HWY_DYNAMIC_DISPATCH(sumContactsOf)(law, position, neighbours, first, last, sums);
}

bool listNeighbours(const CellGrid& grid, const Candidates& candidates, const Float4* position, float reach_m,
                    std::size_t capacity, const Neighbours& neighbours) noexcept {
  return HWY_DYNAMIC_DISPATCH(listNeighboursOf)(grid, candidates, position, reach_m, capacity, neighbours);
}

const char* simdTarget() noexcept {
  return HWY_DYNAMIC_DISPATCH(targetName)();
}

}  // namespace haptolith
#endif  // HWY_ONCE
