#include "haptolith/bed/neighbourhood.h"

#include <algorithm>
#include <array>
#include <cmath>

// This file is compiled once for every instruction set; selectNear() picks the best one at run time.
// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "haptolith/bed/neighbourhood.cpp"
#include <hwy/foreach_target.h>  // before highway.h
#include <hwy/highway.h>
#include "haptolith/bed/kernel/float4_vectors-inl.h"
#include "haptolith/core/assert.h"
// clang-format on

#ifndef HAPTOLITH_NEAR_RULE_
#define HAPTOLITH_NEAR_RULE_
namespace haptolith {
/// Search radius of one particle for others, whose class follows from their size.
struct NearRule {
  const GrainClasses& classes;
  float reach_m;   ///< to one of class 0 and the mean size
  float beyond_m;  ///< see NeighbourReach

  /// By how much less a particle of a class reaches beyond its surface than one of class 0.
  [[nodiscard]] float lessBy(int grain_class) const noexcept {
    return beyond_m / 2 * (1 - GrainClasses::scale(grain_class));
  }
};
}  // namespace haptolith
#endif

HWY_BEFORE_NAMESPACE();
namespace haptolith::HWY_NAMESPACE {

using Indices = hn::RebindToSigned<D>;

/// Writes those candidates to `out` that are within reach of the particle `self`, and returns how many.
template <bool kPeriodic>
std::uint32_t selectNearIn(const Float4* HWY_RESTRICT place, const Periods& periods, const NearRule& rule,
                           std::int32_t self, const std::int32_t* HWY_RESTRICT candidates, std::uint32_t count,
                           std::int32_t* HWY_RESTRICT out) {
  const D d;
  const Indices di;
  const Float4& here = place[self];
  const V x = hn::Set(d, here.x);
  const V y = hn::Set(d, here.y);
  const V z = hn::Set(d, here.z);
  const V width = hn::Set(d, periods.width);
  const V length = hn::Set(d, periods.length);
  const V per_width = hn::Set(d, periods.per_width);
  const V per_length = hn::Set(d, periods.per_length);
  std::uint32_t found = 0;
  for (std::uint32_t n = 0; n < count; n += static_cast<std::uint32_t>(hn::Lanes(d))) {
    const Float4Vectors other = gatherFloat4(place, candidates + n);
    const V dx = nearestImage<kPeriodic>(x - other.x, width, per_width);
    const V dy = nearestImage<kPeriodic>(y - other.y, length, per_length);
    const V dz = z - other.z;
    V reach = hn::Set(d, rule.reach_m) + (hn::Set(d, here.w) + other.w);
    for (int c = 0; c + 1 < rule.classes.count(); ++c) {
      const V less = hn::Set(d, rule.lessBy(c + 1) - rule.lessBy(c));
      reach = hn::IfThenElse(other.w < hn::Set(d, rule.classes.finerThan(c)), reach - less, reach);
    }
    const auto ids = hn::LoadU(di, candidates + n);
    const auto near = hn::And(MulAdd(dx, dx, MulAdd(dy, dy, dz * dz)) < reach * reach,
                              hn::RebindMask(d, hn::Ne(ids, hn::Set(di, self))));
    found += static_cast<std::uint32_t>(hn::CompressStore(ids, hn::RebindMask(di, near), di, out + found));
  }
  return found;
}

std::uint32_t selectNearOf(const Float4* place, const Periods& periods, const NearRule& rule, std::int32_t self,
                           const std::int32_t* candidates, std::uint32_t count, std::int32_t* out) {
  return (periods.any() ? selectNearIn<true> : selectNearIn<false>)(place, periods, rule, self, candidates, count, out);
}

}  // namespace haptolith::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace haptolith {

HWY_EXPORT(selectNearOf);

Neighbourhood::Neighbourhood(std::size_t particles, const NeighbourReach& reach, const GridBox& box)
    : classes_(reach.classes),
      reach_m_(static_cast<float>(reach.reach_m)),
      beyond_m_(static_cast<float>(reach.beyond_m)),
      radius_m_((reach_m_ - beyond_m_) / 2),
      largest_excess_m_(static_cast<float>(reach.largest_excess_m)),
      periods_(box.periods) {
  const double widest_m = reach.reach_m + 2 * reach.largest_excess_m;
  for (int c = 0; c < classes_.count(); ++c) {
    grids_.emplace_back(particles, GrainClasses::scale(c) * widest_m, box);
  }
  std::size_t most = 0;
  for (const CellGrid& grid : grids_) {
    most += classes_.count() == 1 ? grid.candidatesAtMost() : grid.candidatesAtMost(static_cast<float>(widest_m));
  }
  candidates_.resize(most + kGroup);
  near_.resize(most + kGroup);
}

std::uint32_t Neighbourhood::findNear(std::int32_t particle, const std::vector<Float4>& reference_position) noexcept {
  HAPTO_ASSERT(particle >= 0 && static_cast<std::size_t>(particle) < reference_position.size());
  const Float4& here = reference_position[static_cast<std::size_t>(particle)];
  const int own = classes_.of(here.w);
  NearRule rule{classes_, reach_m_, beyond_m_};
  rule.reach_m -= rule.lessBy(own);
  std::uint32_t found = 0;
  for (int c = 0; c < classes_.count(); ++c) {
    const CellGrid& grid = grids_[static_cast<std::size_t>(c)];
    std::int32_t* const out = candidates_.data() + found;
    if (c <= own) {  // its cells are as wide as the two reach
      found += grid.candidates(grid.cellOf(here), out);
    } else {
      const float largest_m = GrainClasses::scale(c) * (largest_excess_m_ + radius_m_) - radius_m_;
      found += grid.candidatesWithin(here, rule.reach_m - rule.lessBy(c) + here.w + largest_m, out);
    }
  }
  // Whole vectors are read: behind the candidates stands the particle itself, which is never its own neighbour.
  std::fill_n(candidates_.begin() + static_cast<std::ptrdiff_t>(found), kGroup, particle);
  return HWY_DYNAMIC_DISPATCH(selectNearOf)(reference_position.data(), periods_, rule, particle, candidates_.data(),
                                            found, near_.data());
}

bool Neighbourhood::buildAll(const std::vector<Float4>& reference_position, ContactLists& lists) noexcept {
  HAPTO_ASSERT(reference_position.size() == paddedCount(lists.particles()));
  const std::size_t n = lists.particles();
  ++changes_;
  for (CellGrid& grid : grids_) {
    grid.clear();
  }
  for (std::size_t i = 0; i < n; ++i) {
    CellGrid& grid = gridOf(reference_position[i]);
    grid.insert(static_cast<std::int32_t>(i), grid.cellOf(reference_position[i]));
  }
  for (std::size_t i = 0; i < n; ++i) {
    const auto particle = static_cast<std::int32_t>(i);
    const std::uint32_t near = findNear(particle, reference_position);
    for (std::uint32_t k = 0; k < near; ++k) {
      HAPTO_ASSERT(static_cast<std::size_t>(near_[k]) < n);
      if (!lists.add(i, near_[k])) {
        return false;
      }
    }
    sortByDistance(i, reference_position, lists);
  }
  return true;
}

void Neighbourhood::sortByDistance(std::size_t i, const std::vector<Float4>& reference_position,
                                   ContactLists& lists) noexcept {
  HAPTO_ASSERT(i < lists.particles());
  HAPTO_ASSERT(lists.count(i) <= ContactLists::kMostNeighbours);
  struct Entry {
    float nearness;
    std::int32_t other;
    std::uint32_t at;
  };
  const auto before = [](const Entry& a, const Entry& b) {
    return a.nearness < b.nearness || (a.nearness == b.nearness && a.other < b.other);
  };
  const bool alike = classes_.count() == 1;  // then the centre that is nearest is taken for the surface that is
  const auto nearness = [alike](float squared_m2, float excess_m) {
    return alike ? squared_m2 : std::sqrt(squared_m2) - excess_m;
  };
  std::array<Entry, ContactLists::kMostNeighbours> entries;
  const std::uint32_t count = lists.count(i);
  const Float4& here = reference_position[i];
  for (std::uint32_t s = 0; s < count; ++s) {
    const std::int32_t other = lists.neighbour(i, s);
    const Float4& there = reference_position[static_cast<std::size_t>(other)];
    float x = here.x - there.x;
    float y = here.y - there.y;
    const float z = here.z - there.z;
    if (periods_.any()) {
      x -= periods_.width * std::round(x * periods_.per_width);
      y -= periods_.length * std::round(y * periods_.per_length);
    }
    const Entry entry{nearness(x * x + y * y + z * z, there.w), other, s};
    std::uint32_t at = s;  // by insertion: lists are short, and nearly sorted
    for (; at > 0 && before(entry, entries[at - 1]); --at) {
      entries[at] = entries[at - 1];
    }
    entries[at] = entry;
  }
  std::array<Slip, ContactLists::kMostNeighbours> slips;
  for (std::uint32_t s = 0; lists.remembers() && s < count; ++s) {
    slips[s] = lists.slip(i, s);
  }
  for (std::uint32_t s = 0; s < count; ++s) {
    if (entries[s].at != s) {
      lists.set(i, s, entries[s].other);
      if (lists.remembers()) {
        lists.setSlip(i, s, slips[entries[s].at]);
      }
    }
  }
}

bool Neighbourhood::rebuild(std::span<const std::int32_t> particles, const std::vector<Float4>& position,
                            std::vector<Float4>& reference_position, ContactLists& lists) noexcept {
  // First all reference positions, then the lists: a pair that moves together stays listed and keeps its slip.
  for (const std::int32_t particle : particles) {
    Float4& place = reference_position[static_cast<std::size_t>(particle)];
    const Float4& here = position[static_cast<std::size_t>(particle)];
    CellGrid& grid = gridOf(here);
    const std::uint32_t left = grid.cellOf(place);
    const std::uint32_t cell = grid.cellOf(here);
    if (cell != left) {
      grid.remove(particle, left);
      grid.insert(particle, cell);
      ++changes_;
    }
    place = here;
  }
  return std::ranges::all_of(particles,
                             [&](std::int32_t particle) { return rebuildList(particle, reference_position, lists); });
}

bool Neighbourhood::rebuildList(std::int32_t particle, const std::vector<Float4>& reference_position,
                                ContactLists& lists) noexcept {
  const auto i = static_cast<std::size_t>(particle);
  std::int32_t* const near = near_.data();
  std::uint32_t unlisted = findNear(particle, reference_position);
  // Drops neighbours that are already listed from `near`, and stale entries from the list.
  for (std::uint32_t s = lists.count(i); s-- > 0;) {
    const std::int32_t other = lists.neighbour(i, s);
    std::int32_t* const found = std::find(near, near + unlisted, other);
    if (found != near + unlisted) {
      *found = near[--unlisted];
    } else {
      lists.remove(i, s);
      lists.removeNeighbour(static_cast<std::size_t>(other), particle);
    }
  }
  const bool fits = std::all_of(near, near + unlisted, [&](std::int32_t other) {
    return lists.add(i, other) && lists.add(static_cast<std::size_t>(other), particle);
  });
  sortByDistance(i, reference_position, lists);
  return fits;
}

std::size_t Neighbourhood::bytes() const noexcept {
  std::size_t bytes = (candidates_.size() + near_.size()) * sizeof(near_[0]);
  for (const CellGrid& grid : grids_) {
    bytes += grid.bytes();
  }
  return bytes;
}

}  // namespace haptolith
#endif  // HWY_ONCE
