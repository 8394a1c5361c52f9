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

/// One particle against its list, a vector of neighbours at a time.
HWY_ATTR void sumContactsOf(const KernelLaw& scalar_law, const Float4* HWY_RESTRICT position,
                            const std::int32_t* HWY_RESTRICT neighbours, const std::uint32_t* HWY_RESTRICT begin,
                            std::size_t first, std::size_t last, ContactSum* HWY_RESTRICT sums) {
  const D d;
  const Indices di;
  const LawOf<V> law{hn::Set(d, scalar_law.gamma), hn::Set(d, scalar_law.a_min), hn::Set(d, scalar_law.a_thr),
                     hn::Set(d, scalar_law.h), hn::Set(d, scalar_law.k)};
  const V cutoff = hn::Set(d, scalar_law.cutoff);
  const V diameter = hn::Set(d, scalar_law.diameter);
  const V one = hn::Set(d, 1.0F);
  const V zero = hn::Zero(d);
  const V tiny = hn::Set(d, 1e-24F);  // two centres in one point repel nowhere, instead of 0/0
  const float* xyz = &position->x;

  for (std::size_t i = first; i < last; ++i) {
    const V xi = hn::Set(d, position[i].x);
    const V yi = hn::Set(d, position[i].y);
    const V zi = hn::Set(d, position[i].z);
    V fx = zero, fy = zero, fz = zero, repulsion = zero, contacts = zero;
    for (std::uint32_t n = begin[i]; n < begin[i + 1]; n += static_cast<std::uint32_t>(hn::Lanes(d))) {
      const auto record = hn::ShiftLeft<2>(hn::LoadU(di, neighbours + n));
      const V dx = xi - hn::GatherIndex(d, xyz, record);
      const V dy = yi - hn::GatherIndex(d, xyz + 1, record);
      const V dz = zi - hn::GatherIndex(d, xyz + 2, record);
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

HWY_ATTR std::uint32_t appendNeighboursOf(const SortedPositions& sorted, std::uint32_t from, std::uint32_t to,
                                          const Float4& centre, std::int32_t self, float reach_m,
                                          std::int32_t* HWY_RESTRICT out) {
  const D d;
  const Indices di;
  const V x = hn::Set(d, centre.x);
  const V y = hn::Set(d, centre.y);
  const V z = hn::Set(d, centre.z);
  const V reach_squared = hn::Set(d, reach_m * reach_m);
  std::uint32_t found = 0;
  for (std::uint32_t n = from; n < to; n += static_cast<std::uint32_t>(hn::Lanes(d))) {
    const V dx = x - hn::LoadU(d, sorted.x + n);
    const V dy = y - hn::LoadU(d, sorted.y + n);
    const V dz = z - hn::LoadU(d, sorted.z + n);
    const auto particle = hn::LoadU(di, sorted.particle + n);
    const auto near = hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, dz * dz)) < reach_squared;
    const auto listed = hn::And(hn::RebindMask(di, near), hn::And(hn::Ne(particle, hn::Set(di, self)),
                                                                  hn::FirstN(di, to - n)));
    found += static_cast<std::uint32_t>(hn::CompressStore(particle, listed, di, out + found));
  }
  return found;
}

const char* targetName() { return hwy::TargetName(HWY_TARGET); }

}  // namespace haptolith::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace haptolith {

HWY_EXPORT(sumContactsOf);
HWY_EXPORT(appendNeighboursOf);
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

std::uint32_t appendNeighbours(const SortedPositions& sorted, std::uint32_t from, std::uint32_t to, const Float4& centre,
                               std::int32_t self, float reach_m, std::int32_t* out) noexcept {
  return HWY_DYNAMIC_DISPATCH(appendNeighboursOf)(sorted, from, to, centre, self, reach_m, out);
}

const char* simdTarget() noexcept { return HWY_DYNAMIC_DISPATCH(targetName)(); }

}  // namespace haptolith
#endif  // HWY_ONCE
