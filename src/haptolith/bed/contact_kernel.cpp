#include "haptolith/bed/contact_kernel.h"

// This file is compiled once for every instruction set; sumContacts() picks the best one at run time.
// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "haptolith/bed/contact_kernel.cpp"
#include <hwy/foreach_target.h>  // before highway.h
#include <hwy/highway.h>
#include "haptolith/bed/records-inl.h"
#include "haptolith/soil/contact_law-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace haptolith::HWY_NAMESPACE {

using Indices = hn::RebindToSigned<D>;

// Highway's dispatch tables take no noexcept functions; the public ones below are.

/// One particle against its list, a vector of neighbours at a time.
template <bool kPeriodic>
void sumContactsIn(const KernelLaw& scalar_law, const Periods& periods, const Float4* HWY_RESTRICT position,
                   const Neighbours& neighbours, std::size_t first, std::size_t last, ContactSum* HWY_RESTRICT sums) {
  const D d;
  const LawOf<V> law{hn::Set(d, scalar_law.gamma), hn::Set(d, scalar_law.a_min), hn::Set(d, scalar_law.a_thr),
                     hn::Set(d, scalar_law.h), hn::Set(d, scalar_law.k)};
  const V cutoff = hn::Set(d, scalar_law.cutoff);
  const V width = hn::Set(d, periods.width);
  const V length = hn::Set(d, periods.length);
  const V per_width = hn::Set(d, periods.per_width);
  const V per_length = hn::Set(d, periods.per_length);
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
      const Records other = loadRecords(position, neighbours.index + n);
      const V dx = nearestImage<kPeriodic>(xi - other.x, width, per_width);
      const V dy = nearestImage<kPeriodic>(yi - other.y, length, per_length);
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

void sumContactsOf(const KernelLaw& law, const Periods& periods, const Float4* position, const Neighbours& neighbours,
                   std::size_t first, std::size_t last, ContactSum* sums) {
  (periods.any() ? sumContactsIn<true> : sumContactsIn<false>)(law, periods, position, neighbours, first, last, sums);
}

/// Copies the particles of cells first_x to last_x of one row behind the `count` scratch already holds.
HWY_INLINE std::uint32_t gatherRow(const CellGrid& grid, const Candidates& candidates, const std::uint32_t* row,
                                   int first_x, int last_x, std::uint32_t count) {
  const D d;
  const Indices di;
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(d));
  const std::uint32_t from = row[first_x];
  const std::uint32_t to = row[last_x + 1];
  for (std::uint32_t n = from; n < to; n += lanes) {  // what is copied too much is overwritten by the next row
    const std::uint32_t at = count + n - from;
    hn::StoreU(hn::LoadU(d, grid.x + n), d, candidates.x + at);
    hn::StoreU(hn::LoadU(d, grid.y + n), d, candidates.y + at);
    hn::StoreU(hn::LoadU(d, grid.z + n), d, candidates.z + at);
    hn::StoreU(hn::LoadU(di, grid.particle + n), di, candidates.particle + at);
  }
  return count + to - from;
}

/// Copies a cell and its 26 neighbours side by side into the scratch arrays and returns how many particles that are.
HWY_INLINE std::uint32_t gatherCandidates(const CellGrid& grid, const Candidates& candidates, int ix, int iy, int iz) {
  const int first_x = HWY_MAX(ix - 1, 0);
  const int last_x = HWY_MIN(ix + 1, grid.nx - 1);
  const int first_y = grid.periodic_y ? iy - 1 : HWY_MAX(iy - 1, 0);
  const int last_y = grid.periodic_y ? iy + 1 : HWY_MIN(iy + 1, grid.ny - 1);
  std::uint32_t count = 0;
  for (int z = HWY_MAX(iz - 1, 0); z <= HWY_MIN(iz + 1, grid.nz - 1); ++z) {
    for (int y = first_y; y <= last_y; ++y) {
      const int wrapped_y = y < 0 ? grid.ny - 1 : y == grid.ny ? 0 : y;
      const std::uint32_t* row = grid.cell_begin + (z * grid.ny + wrapped_y) * grid.nx;
      count = gatherRow(grid, candidates, row, first_x, last_x, count);
      if (grid.periodic_x && ix == 0) {
        count = gatherRow(grid, candidates, row, grid.nx - 1, grid.nx - 1, count);
      }
      if (grid.periodic_x && ix == grid.nx - 1) {
        count = gatherRow(grid, candidates, row, 0, 0, count);
      }
    }
  }
  return count;
}

/// Writes those candidates to `out` that are near the particle `self`, and returns how many.
HWY_INLINE std::uint32_t appendNear(const Candidates& candidates, const Periods& periods, std::uint32_t count,
                                    const Float4& centre, std::int32_t self, float reach_m,
                                    std::int32_t* HWY_RESTRICT out) {
  const D d;
  const Indices di;
  const V x = hn::Set(d, centre.x);
  const V y = hn::Set(d, centre.y);
  const V z = hn::Set(d, centre.z);
  const V reach_squared = hn::Set(d, reach_m * reach_m);
  const V width = hn::Set(d, periods.width);
  const V length = hn::Set(d, periods.length);
  const V per_width = hn::Set(d, periods.per_width);
  const V per_length = hn::Set(d, periods.per_length);
  std::uint32_t found = 0;
  for (std::uint32_t n = 0; n < count; n += static_cast<std::uint32_t>(hn::Lanes(d))) {
    const V dx = nearestImage<true>(x - hn::LoadU(d, candidates.x + n), width, per_width);
    const V dy = nearestImage<true>(y - hn::LoadU(d, candidates.y + n), length, per_length);
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

std::size_t listNeighboursOf(const CellGrid& grid, const Candidates& candidates, const Periods& periods,
                             const Float4* HWY_RESTRICT position, float reach_m, std::size_t capacity,
                             const Neighbours& neighbours) {
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
            return kTooMany;
          }
          const std::int32_t self = grid.particle[slot];
          neighbours.begin[self] = next;
          next += appendNear(candidates, periods, count, position[self], self, reach_m, neighbours.index + next);
          while (next % kNeighbourBlock != 0) {
            neighbours.index[next++] = neighbours.ghost;
          }
          neighbours.end[self] = next;
        }
      }
    }
  }
  return next;
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

void sumContacts(const KernelLaw& law, const Periods& periods, const Float4* position, const Neighbours& neighbours,
                 std::size_t first, std::size_t last, ContactSum* sums) noexcept {
  HWY_DYNAMIC_DISPATCH(sumContactsOf)(law, periods, position, neighbours, first, last, sums);
}

std::size_t listNeighbours(const CellGrid& grid, const Candidates& candidates, const Periods& periods,
                           const Float4* position, float reach_m, std::size_t capacity,
                           const Neighbours& neighbours) noexcept {
  return HWY_DYNAMIC_DISPATCH(listNeighboursOf)(grid, candidates, periods, position, reach_m, capacity, neighbours);
}

const char* simdTarget() noexcept {
  return HWY_DYNAMIC_DISPATCH(targetName)();
}

}  // namespace haptolith
#endif  // HWY_ONCE
