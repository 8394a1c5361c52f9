#include "haptolith/bed/pairwise_kernel.h"

#include <cmath>

// This file is compiled once for every instruction set; sumPairwiseContacts() picks the best one at run time.
// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "haptolith/bed/pairwise_kernel.cpp"
#include <hwy/foreach_target.h>  // before highway.h
#include <hwy/highway.h>
#include "haptolith/bed/friction-inl.h"
#include "haptolith/bed/records-inl.h"
#include "haptolith/soil/contact_law-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace haptolith::HWY_NAMESPACE {

/// One particle against its list, a vector of neighbours at a time.
template <bool kPeriodic>
void sumPairwiseIn(const PairwiseLaw& scalar_law, const Periods& periods, float dt, const Float4* HWY_RESTRICT position,
                   const Float4* HWY_RESTRICT velocity, const Neighbours& neighbours, const ContactMemory& memory,
                   std::size_t first, std::size_t last, ContactSum* HWY_RESTRICT sums) {
  const D d;
  const auto set = [&d](float value) { return hn::Set(d, value); };
  const KernelLaw& normal = scalar_law.normal;
  const V zero = hn::Zero(d);
  const V one = set(1);
  const LawOf<V> law{set(normal.gamma), set(normal.a_min), set(normal.a_thr), set(normal.h), set(normal.k)};
  const CohesionOf<V> cohesion{set(scalar_law.cohesion), set(scalar_law.two_per_range), zero, one};
  const V diameter = set(normal.diameter);
  const FrictionOf<V> friction{set(dt),    set(scalar_law.stiffness), set(scalar_law.tangential_damping), zero, one,
                               set(1e-20F)};
  const V cutoff = set(normal.cutoff);
  const V coefficient = set(scalar_law.friction);
  const V damping = set(scalar_law.damping);
  const V root_of_gamma = set(scalar_law.root_of_gamma);
  const V width = set(periods.width);
  const V length = set(periods.length);
  const V per_width = set(periods.per_width);
  const V per_length = set(periods.per_length);
  const V tiny = set(1e-24F);  // two centres in one point repel nowhere, instead of 0/0

  for (std::size_t i = first; i < last; ++i) {
    const Records x{set(position[i].x), set(position[i].y), set(position[i].z), set(position[i].w)};
    const Records v{set(velocity[i].x), set(velocity[i].y), set(velocity[i].z), zero};
    V fx = zero, fy = zero, fz = zero, compression = zero;
    for (std::uint32_t n = neighbours.begin[i]; n < neighbours.end[i]; n += static_cast<std::uint32_t>(hn::Lanes(d))) {
      const Records other = loadRecords(position, neighbours.index + n);
      const V dx = nearestImage<kPeriodic>(x.x - other.x, width, per_width);
      const V dy = nearestImage<kPeriodic>(x.y - other.y, length, per_length);
      const V dz = x.z - other.z;
      const V distance = hn::Sqrt(hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::MulAdd(dz, dz, tiny))));
      const V a = distance - (x.w + other.w);  // as far as two particles of the mean size would be
      const auto near = a < cutoff;
      if (hn::AllFalse(d, near)) {
        hn::Store(zero, d, memory.x + n);
        hn::Store(zero, d, memory.y + n);
        hn::Store(zero, d, memory.z + n);
        continue;
      }
      const V per_metre = one / distance;
      const Triple<V> towards{dx * per_metre, dy * per_metre, dz * per_metre};
      const CohesiveContact<V> contact = cohesiveContact(law, cohesion, diameter, a);

      // Damping takes energy from approach and parting alike, but never pulls.
      const Records u = loadRecords(velocity, neighbours.index + n);
      const Triple<V> relative{v.x - u.x, v.y - u.y, v.z - u.z};
      const V parting = dot(relative, towards);
      const V damped = contact.normal - damping * rootOfStiffness(law, root_of_gamma, a) * parting;
      const V push = hn::Max(damped, hn::Min(contact.normal, zero));

      const Triple<V> slip{relative.x - parting * towards.x, relative.y - parting * towards.y,
                           relative.z - parting * towards.z};
      Triple<V> stretch{hn::Load(d, memory.x + n), hn::Load(d, memory.y + n), hn::Load(d, memory.z + n)};
      const Triple<V> drag = frictionForce(friction, coefficient * contact.compression, towards, slip, stretch);
      hn::Store(hn::IfThenElseZero(near, stretch.x), d, memory.x + n);
      hn::Store(hn::IfThenElseZero(near, stretch.y), d, memory.y + n);
      hn::Store(hn::IfThenElseZero(near, stretch.z), d, memory.z + n);

      fx = fx + hn::IfThenElseZero(near, hn::MulAdd(push, towards.x, drag.x));
      fy = fy + hn::IfThenElseZero(near, hn::MulAdd(push, towards.y, drag.y));
      fz = fz + hn::IfThenElseZero(near, hn::MulAdd(push, towards.z, drag.z));
      compression = compression + hn::IfThenElseZero(near, contact.compression);
    }
    storeSums(fx, fy, fz, compression, sums[i]);
  }
}

void sumPairwiseContactsOf(const PairwiseLaw& law, const Periods& periods, float dt, const Float4* position,
                           const Float4* velocity, const Neighbours& neighbours, const ContactMemory& memory,
                           std::size_t first, std::size_t last, ContactSum* sums) {
  (periods.any() ? sumPairwiseIn<true> : sumPairwiseIn<false>)(law, periods, dt, position, velocity, neighbours, memory,
                                                               first, last, sums);
}

}  // namespace haptolith::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace haptolith {

HWY_EXPORT(sumPairwiseContactsOf);

PairwiseLaw pairwiseLaw(const SoilParameters& soil) {
  const auto f = [](double value) { return static_cast<float>(value); };
  const ContactLaw law = makeContactLaw(soil);
  const double tangential_stiffness = soil.tangential_ratio * soil.stiffness_n_m;
  const double damping = soil.damping_ratio * std::sqrt(2 * macroparticleMass(soil));
  return {.normal = kernelLaw(law, soil.radius_m),
          .cohesion = f(law.cohesion_n),
          .two_per_range = f(2 / law.cohesion_range_m),
          .root_of_gamma = f(std::sqrt(law.gamma_nm)),
          .damping = f(damping),
          .friction = f(soil.contact_friction),
          .stiffness = f(tangential_stiffness),
          .tangential_damping = f(damping * std::sqrt(tangential_stiffness))};
}

void sumPairwiseContacts(const PairwiseLaw& law, const Periods& periods, float dt_s, const Float4* position,
                         const Float4* velocity, const Neighbours& neighbours, const ContactMemory& memory,
                         std::size_t first, std::size_t last, ContactSum* sums) noexcept {
  HWY_DYNAMIC_DISPATCH(sumPairwiseContactsOf)
  (law, periods, dt_s, position, velocity, neighbours, memory, first, last, sums);
}

void carryMemory(const Neighbours& from_list, const ContactMemory& from, const Neighbours& to_list,
                 const ContactMemory& to, std::size_t particles) noexcept {
  for (std::size_t i = 0; i < particles; ++i) {
    for (std::uint32_t old = from_list.begin[i]; old < from_list.end[i]; ++old) {
      if (from.x[old] == 0 && from.y[old] == 0 && from.z[old] == 0) {
        continue;
      }
      std::uint32_t now = to_list.begin[i];
      while (now < to_list.end[i] && to_list.index[now] != from_list.index[old]) {
        ++now;
      }
      if (now < to_list.end[i]) {  // else they have parted by more than the reach, and touch no more
        to.x[now] = from.x[old];
        to.y[now] = from.y[old];
        to.z[now] = from.z[old];
      }
    }
  }
}

}  // namespace haptolith
#endif  // HWY_ONCE
