#include "haptolith/tool/tool_memory.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

using SavedSlip = SavedToolMemory::Slip;

constexpr SavedSlip kNoSlip{};

SavedSlip slipOf(const Float4& slip_m) noexcept {
  return {slip_m.x, slip_m.y, slip_m.z, slip_m.w};
}
Float4 float4(const SavedSlip& slip_m) noexcept {
  return {slip_m[0], slip_m[1], slip_m[2], slip_m[3]};
}

/// Whether all bits are zero: a slip of -0 counts as memory, for the sake of hashes.
bool isNothing(std::int32_t side, const SavedSlip& slip_m) noexcept {
  return side == 0 && std::bit_cast<std::array<std::uint32_t, 4>>(slip_m) == std::array<std::uint32_t, 4>{};
}

bool isSound(std::int32_t side, const SavedSlip& slip_m) noexcept {
  using Side = std::numeric_limits<std::int8_t>;
  return side >= Side::min() && side <= Side::max() &&
         std::ranges::all_of(slip_m, [](float value) { return std::isfinite(value); });
}

}  // namespace

ToolMemory::ToolMemory(const Bed& bed)
    : side_(bed.particles()),
      slip_(bed.parameters().soil.friction == FrictionModel::kContact ? bed.particles() : 0),
      near_(bed.nearGroups()),
      groups_(bed.state().rested.size()) {
  for (std::size_t stone = 0; stone < bed.stones().size(); ++stone) {
    stones_.emplace_back(bed.stones().shape(stone)->spheres.size());
  }
}

void ToolMemory::forget(std::span<const std::uint32_t> near) noexcept {
  for (const std::size_t group : near) {
    for (std::size_t i = group * kGroup; i < std::min((group + 1) * kGroup, side_.size()); ++i) {
      side_[i] = 0;
      if (!slip_.empty()) {
        slip_[i] = {};
      }
    }
  }
  for (std::vector<SphereMemory>& spheres : stones_) {
    std::ranges::fill(spheres, SphereMemory{});
  }
}

std::size_t ToolMemory::bytes() const noexcept {
  std::size_t bytes = side_.size() + slip_.size() * sizeof(Float4);
  for (const std::vector<SphereMemory>& spheres : stones_) {
    bytes += spheres.size() * sizeof(SphereMemory);
  }
  return bytes;
}

SavedToolMemory ToolMemory::save() const {
  SavedToolMemory saved{.particles = {}, .spheres = {}, .near_groups = near_.save()};
  for (std::size_t i = 0; i < side_.size(); ++i) {
    const SavedSlip slip_m = slip_.empty() ? kNoSlip : slipOf(slip_[i]);
    if (!isNothing(side_[i], slip_m)) {
      saved.particles.push_back({.particle = static_cast<std::uint32_t>(i), .side = side_[i], .slip_m = slip_m});
    }
  }
  for (std::size_t stone = 0; stone < stones_.size(); ++stone) {
    for (std::size_t s = 0; s < stones_[stone].size(); ++s) {
      const SphereMemory& sphere = stones_[stone][s];
      const SavedSlip slip_m = slipOf(sphere.slip_m);
      if (!isNothing(sphere.side, slip_m)) {
        saved.spheres.push_back({.stone = static_cast<std::uint32_t>(stone),
                                 .sphere = static_cast<std::uint32_t>(s),
                                 .side = sphere.side,
                                 .slip_m = slip_m});
      }
    }
  }
  return saved;
}

void ToolMemory::requireSound(const SavedToolMemory& saved) const {
  const auto particle = [&](const SavedToolMemory::Particle& p) {
    return p.particle < side_.size() && isSound(p.side, p.slip_m) && (!slip_.empty() || isNothing(0, p.slip_m));
  };
  const auto sphere = [&](const SavedToolMemory::Sphere& s) {
    return s.stone < stones_.size() && s.sphere < stones_[s.stone].size() && isSound(s.side, s.slip_m);
  };
  const auto group = [&](std::uint32_t g) { return g < groups_; };
  if (!std::ranges::all_of(saved.particles, particle) || !std::ranges::all_of(saved.spheres, sphere) ||
      !std::ranges::all_of(saved.near_groups, group)) {
    throw InvalidParameter("state", "contacts of a tool with other soil, or slips that are not finite",
                           "contacts with the particles and stones of this bed");
  }
}

void ToolMemory::restore(const SavedToolMemory& saved) noexcept {
  std::ranges::fill(side_, std::int8_t{0});
  std::ranges::fill(slip_, Float4{});
  for (std::vector<SphereMemory>& spheres : stones_) {
    std::ranges::fill(spheres, SphereMemory{});
  }
  for (const SavedToolMemory::Particle& p : saved.particles) {
    side_[p.particle] = static_cast<std::int8_t>(p.side);
    if (!slip_.empty()) {
      slip_[p.particle] = float4(p.slip_m);
    }
  }
  for (const SavedToolMemory::Sphere& s : saved.spheres) {
    stones_[s.stone][s.sphere] = {static_cast<std::int8_t>(s.side), float4(s.slip_m)};
  }
  near_.restore(saved.near_groups);
}

}  // namespace haptolith
