// Who is near enough to a stone to touch it soon.

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "haptolith/bed/stones.h"
#include "haptolith/bed/stones_internal.h"

namespace haptolith {

bool Stones::lookAround(std::size_t stone, const SoilAroundStones& soil) noexcept {
  Memory& memory = memory_[stone];
  // After the first look, which is staggered, all are as old as they are.
  memory.looked_at_m = memory.look && memory.looked_at_m < 0 ? memory.looked_at_m : went_m_;
  memory.look = false;
  return lookForParticles(stone, soil) && lookForStones(stone);
}

bool Stones::lookForParticles(std::size_t stone, const SoilAroundStones& soil) noexcept {
  Memory& memory = memory_[stone];
  for (const StonePack& pack : memory.packs) {
    for (std::size_t k = 0; k < pack.count; ++k) {
      const Stretch stretch{pack.stretch_m[0][k], pack.stretch_m[1][k], pack.stretch_m[2][k]};
      if (stretch != Stretch{} && memory.before.size() < memory.before.capacity()) {
        memory.before.push_back({static_cast<std::uint32_t>(pack.particle[k]), stretch});
      }
    }
  }
  std::ranges::sort(memory.before, {}, &Slid::particle);
  listCandidates(stone, soil);
  const bool room = packUp(stone, soil.state);
  memory.before.clear();
  return room;
}

/// Lists particles near the sphere around the stone, class by class.
void Stones::listCandidates(std::size_t stone, const SoilAroundStones& soil) noexcept {
  Memory& memory = memory_[stone];
  memory.candidates.clear();
  const double reach_m = shapes_[stone]->reach_m + with_soil_[stone][0].law.reach() + margin();
  const double grain_m = (1 + soil_.size_spread) * soil_.radius_m;
  const Vec3& middle = state_.stones[stone].scene_T_stone.position_m;
  const double listed_m = reach_m + grain_m + skin_m_ / 2;  // reach of the list
  const auto corner = [&](double sign) {
    return Float4{static_cast<float>(middle.x() + sign * listed_m), static_cast<float>(middle.y() + sign * listed_m),
                  static_cast<float>(middle.z() + sign * listed_m), 0};
  };
  memory.has_room = true;
  soil.neighbourhood.forEachIn(soil.neighbourhood.placeOf(corner(-1), corner(1)), [&](std::int32_t particle) {
    const Float4& at = soil.state.position[static_cast<std::size_t>(particle)];
    const double far_m = reach_m + soil_.radius_m + at.w;
    if ((placeOf(at) - middle).squaredNorm() <= far_m * far_m) {
      memory.has_room = memory.has_room && memory.candidates.size() < memory.candidates.capacity();
      if (memory.has_room) {
        memory.candidates.push_back(static_cast<std::uint32_t>(particle));
      }
    }
  });
  std::ranges::sort(memory.candidates, {}, [&](std::uint32_t particle) {
    return std::pair(classes_.of(soil.state.position[particle].w), particle);
  });
}

/// Those of the candidates who are near to a sphere, in packs of one class; false when there is no room for them.
bool Stones::packUp(std::size_t stone, const BedState& soil) noexcept {
  Memory& memory = memory_[stone];
  memory.packs.clear();
  memory.spheres.clear();
  memory.groups.clear();
  const Eigen::Matrix3d& rotation = bodies_[stone].rotation;
  const Vec3& middle = state_.stones[stone].scene_T_stone.position_m;
  const double surface_m = with_soil_[stone][0].law.reach() + margin();
  const auto finish_pack = [&] {
    StonePack& pack = memory.packs.back();
    std::fill(pack.particle.begin() + pack.count, pack.particle.end(), pack.particle[0]);
    pack.first_sphere = static_cast<std::uint32_t>(memory.spheres.size());
    for (std::size_t word = 0; word < memory.near_now.size(); ++word) {
      for (std::uint64_t bits = memory.near_now[word]; bits != 0; bits &= bits - 1) {
        memory.spheres.push_back(
            static_cast<std::uint16_t>(word * kSphereBits + static_cast<std::size_t>(std::countr_zero(bits))));
      }
    }
    pack.sphere_count = static_cast<std::uint32_t>(memory.spheres.size()) - pack.first_sphere;
    std::ranges::fill(memory.near_now, std::uint64_t{0});
  };
  for (const std::uint32_t particle : memory.candidates) {
    const Float4& at = soil.position[particle];
    const Vec3 place = inFrame(rotation, placeOf(at) - middle);
    const auto x = static_cast<float>(place.x());
    const auto y = static_cast<float>(place.y());
    const auto z = static_cast<float>(place.z());
    const auto near_m = static_cast<float>(soil_.radius_m + at.w + surface_m);
    const int grain_class = classes_.of(at.w);
    const bool goes_on =
        !memory.packs.empty() && memory.packs.back().count < kGroup && memory.packs.back().grain_class == grain_class;
    bool begun = goes_on;
    bool any = false;
    for (std::size_t s = 0; s < spheres_[stone].size(); ++s) {
      const Float4& sphere = spheres_[stone][s];
      const float dx = x - sphere.x;
      const float dy = y - sphere.y;
      const float dz = z - sphere.z;
      if (dx * dx + dy * dy + dz * dz > (near_m + sphere.w) * (near_m + sphere.w)) {
        continue;
      }
      if (!begun) {
        if (!memory.packs.empty()) {
          finish_pack();
        }
        if (memory.packs.size() == memory.packs.capacity()) {
          return false;
        }
        memory.packs.push_back({.grain_class = grain_class, .apart_until_m = went_m_});
        begun = true;
      }
      memory.near_now[s / kSphereBits] |= std::uint64_t{1} << (s % kSphereBits);
      any = true;
    }
    if (!any) {
      continue;
    }
    StonePack& pack = memory.packs.back();
    const std::size_t k = pack.count++;
    pack.particle[k] = static_cast<std::int32_t>(particle);
    const auto before = std::ranges::lower_bound(memory.before, particle, {}, &Slid::particle);
    if (before != memory.before.end() && before->particle == particle) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        pack.stretch_m[axis][k] = before->stretch_m[axis];
      }
    }
    const auto group = static_cast<std::uint32_t>(particle / kGroup);
    if (memory.groups.empty() || memory.groups.back() != group) {
      memory.groups.push_back(group);
    }
  }
  if (!memory.packs.empty()) {
    finish_pack();
  }
  return memory.has_room;
}

bool Stones::lookForStones(std::size_t stone) noexcept {
  Memory& memory = memory_[stone];
  const StoneShape& shape = *shapes_[stone];
  memory.stones_before.swap(memory.stones);
  memory.stones.clear();
  std::array<std::uint32_t, kMostPartners> partners_before{};  // partners of the pairs of the last rebuild
  for (std::size_t p = 0; p < memory.pairs.size(); ++p) {
    partners_before[p] = memory.pairs[p].stone;
  }
  memory.pairs.clear();
  const Vec3& middle = state_.stones[stone].scene_T_stone.position_m;
  for (std::size_t other = stone + 1; other < size(); ++other) {
    const StoneShape& with = *shapes_[other];
    const double far_m = shape.reach_m + with.reach_m + margin();
    if ((state_.stones[other].scene_T_stone.position_m - middle).squaredNorm() > far_m * far_m ||
        (bodies_[stone].fixed && bodies_[other].fixed)) {
      continue;
    }
    if (memory.pairs.size() == kMostPartners) {
      return false;
    }
    const auto pair = static_cast<std::uint32_t>(memory.pairs.size());
    memory.pairs.push_back({static_cast<std::uint32_t>(other),
                            StoneContactLaw::bare(soil_, {bodies_[stone].radius_m, bodies_[other].radius_m,
                                                          bodies_[stone].mass_kg, bodies_[other].mass_kg})});
    for (std::size_t s = 0; s < shape.spheres.size(); ++s) {
      const double near_m = shape.spheres[s].radius_m + with.reach_m + margin();
      if ((bodies_[stone].centres_m[s] - state_.stones[other].scene_T_stone.position_m).squaredNorm() <=
          near_m * near_m) {
        NearStone near{pair, static_cast<std::uint32_t>(s), {}};
        for (const NearStone& before : memory.stones_before) {
          if (before.sphere == s && partners_before[before.pair] == other) {
            near.stretch = before.stretch;
          }
        }
        memory.stones.push_back(near);
      }
    }
  }
  return true;
}

}  // namespace haptolith
