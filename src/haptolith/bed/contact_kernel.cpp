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

#else

/// Four records of every 128-bit block, one from each group of four neighbours, as one vector. Loading records whole and
/// turning them in registers takes a third of the time of three gathers on processors whose gathers are slow.
template <class AnyD>
HWY_INLINE hn::Vec<AnyD> loadRecords(AnyD d, const Float4* HWY_RESTRICT records, const std::int32_t* HWY_RESTRICT index) {
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

#endif

/// One particle against its list, a vector of neighbours at a time.
void sumContactsOf(const KernelLaw& scalar_law, const Float4* HWY_RESTRICT position,
                   const std::int32_t* HWY_RESTRICT neighbours, const std::uint32_t* HWY_RESTRICT begin,
                   std::size_t first, std::size_t last, ContactSum* HWY_RESTRICT sums) {
  const D d;
  const LawOf<V> law{hn::Set(d, scalar_law.gamma), hn::Set(d, scalar_law.a_min), hn::Set(d, scalar_law.a_thr),
                     hn::Set(d, scalar_law.h), hn::Set(d, scalar_law.k)};
  const V cutoff = hn::Set(d, scalar_law.cutoff);
  const V diameter = hn::Set(d, scalar_law.diameter);
  const V one = hn::Set(d, 1.0F);
  const V zero = hn::Zero(d);
  const V tiny = hn::Set(d, 1e-24F);  // two centres in one point repel nowhere, instead of 0/0

  for (std::size_t i = first; i < last; ++i) {
    const V xi = hn::Set(d, position[i].x);
    const V yi = hn::Set(d, position[i].y);
    const V zi = hn::Set(d, position[i].z);
    V fx = zero, fy = zero, fz = zero, repulsion = zero, contacts = zero;
    for (std::uint32_t n = begin[i]; n < begin[i + 1]; n += static_cast<std::uint32_t>(hn::Lanes(d))) {
      const Positions other = loadPositions(position, neighbours + n);
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
      contacts = contacts + hn::IfThenElseZero(a < diameter, one);
    }
    ContactSum& sum = sums[i];
    sum.force_x_n = hn::GetLane(hn::SumOfLanes(d, fx));
    sum.force_y_n = hn::GetLane(hn::SumOfLanes(d, fy));
    sum.force_z_n = hn::GetLane(hn::SumOfLanes(d, fz));
    sum.repulsion_n = hn::GetLane(hn::SumOfLanes(d, repulsion));
    sum.contacts = hn::GetLane(hn::SumOfLanes(d, contacts));
  }
}

/// Appends to `out` those particles of one row of cells that are near, and returns how many.
HWY_INLINE std::uint32_t appendRow(const CellGrid& grid, std::uint32_t from, std::uint32_t to, const Float4& centre,
                                   std::int32_t self, float reach_m, std::int32_t* HWY_RESTRICT out) {
  const D d;
  const Indices di;
  const V reach_squared = hn::Set(d, reach_m * reach_m);
  std::uint32_t found = 0;
  for (std::uint32_t n = from; n < to; n += static_cast<std::uint32_t>(hn::Lanes(d))) {
    const V dx = hn::Set(d, centre.x) - hn::LoadU(d, grid.x + n);
    const V dy = hn::Set(d, centre.y) - hn::LoadU(d, grid.y + n);
    const V dz = hn::Set(d, centre.z) - hn::LoadU(d, grid.z + n);
    const auto particle = hn::LoadU(di, grid.particle + n);
    const auto near = hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, dz * dz)) < reach_squared;
    const auto others = hn::And(hn::Ne(particle, hn::Set(di, self)), hn::FirstN(di, to - n));
    const auto listed = hn::And(hn::RebindMask(di, near), others);
    hn::StoreU(hn::Compress(particle, listed), di, out + found);  // the rest of the vector is overwritten by the next
    found += static_cast<std::uint32_t>(hn::CountTrue(di, listed));
  }
  return found;
}

bool listNeighboursOf(const CellGrid& grid, const Float4* HWY_RESTRICT position, std::size_t particles, float reach_m,
                      std::size_t capacity, std::uint32_t* HWY_RESTRICT begin, std::int32_t* HWY_RESTRICT indices) {
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < particles; ++i) {
    begin[i] = next;
    const int cell = static_cast<int>(grid.cell_of[i]);
    const int ix = cell % grid.nx;
    const int iy = cell / grid.nx % grid.ny;
    const int iz = cell / grid.nx / grid.ny;
    const int first_x = HWY_MAX(ix - 1, 0);
    const int last_x = HWY_MIN(ix + 1, grid.nx - 1);
    for (int z = HWY_MAX(iz - 1, 0); z <= HWY_MIN(iz + 1, grid.nz - 1); ++z) {
      for (int y = HWY_MAX(iy - 1, 0); y <= HWY_MIN(iy + 1, grid.ny - 1); ++y) {
        const std::uint32_t* row = grid.cell_begin + (z * grid.ny + y) * grid.nx;
        const std::uint32_t from = row[first_x];
        const std::uint32_t to = row[last_x + 1];
        if (next + (to - from) + kNeighbourBlock > capacity) {
          return false;
        }
        next += appendRow(grid, from, to, position[i], static_cast<std::int32_t>(i), reach_m, indices + next);
      }
    }
    while ((next - begin[i]) % kNeighbourBlock != 0) {
      indices[next++] = static_cast<std::int32_t>(particles);
    }
  }
  begin[particles] = next;
  return true;
}

const char* targetName() { return hwy::TargetName(HWY_TARGET); }

}  // namespace haptolith::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace haptolith {

HWY_EXPORT(sumContactsOf);
HWY_EXPORT(listNeighboursOf);
HWY_EXPORT(targetName);

KernelLaw kernelLaw(const ContactLaw& law, double radius_m) {
  const auto f = [](double value) { return static_cast<float>(value); };
  return {f(law.gamma_nm), f(law.a_min_m),  f(law.a_thr_m), f(law.h_n),
          f(law.stiffness_n_m), f(law.cutoff_m), f(2 * radius_m)};
}

void sumContacts(const KernelLaw& law, const Float4* position, const std::int32_t* neighbours,
                 const std::uint32_t* begin, std::size_t first, std::size_t last, ContactSum* sums) noexcept {
  HWY_DYNAMIC_DISPATCH(sumContactsOf)(law, position, neighbours, begin, first, last, sums);
}

bool listNeighbours(const CellGrid& grid, const Float4* position, std::size_t particles, float reach_m,
                    std::size_t capacity, std::uint32_t* begin, std::int32_t* indices) noexcept {
  return HWY_DYNAMIC_DISPATCH(listNeighboursOf)(grid, position, particles, reach_m, capacity, begin, indices);
}

const char* simdTarget() noexcept { return HWY_DYNAMIC_DISPATCH(targetName)(); }

}  // namespace haptolith
#endif  // HWY_ONCE
