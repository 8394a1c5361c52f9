// Stones saved, and as they were saved.

#include <algorithm>
#include <array>

#include "haptolith/bed/stones.h"
#include "haptolith/bed/stones_internal.h"
#include "haptolith/core/error.h"

namespace haptolith {

StonesState Stones::save() const {
  StonesState saved{.stones = state_.stones, .slips = {}};
  const auto keep = [&](std::size_t stone, StoneSlip::With with, std::size_t sphere, std::uint32_t other,
                        const Stretch& s) {
    if (s != Stretch{}) {
      saved.slips.push_back({.stone = static_cast<std::uint32_t>(stone),
                             .with = with,
                             .sphere = static_cast<std::uint32_t>(sphere),
                             .other = other,
                             .x = s[0],
                             .y = s[1],
                             .z = s[2]});
    }
  };
  for (std::size_t i = 0; i < size(); ++i) {
    const Memory& memory = memory_[i];
    for (const StonePack& pack : memory.packs) {
      for (std::size_t k = 0; k < pack.count; ++k) {
        keep(i, StoneSlip::With::kParticle, 0, static_cast<std::uint32_t>(pack.particle[k]),
             {pack.stretch_m[0][k], pack.stretch_m[1][k], pack.stretch_m[2][k]});
      }
    }
    for (const Slid& slid : memory.before) {
      keep(i, StoneSlip::With::kParticle, 0, slid.particle, slid.stretch_m);
    }
    for (const NearStone& near : memory.stones) {
      keep(i, StoneSlip::With::kStone, near.sphere, memory.pairs[near.pair].stone, near.stretch);
    }
    for (std::size_t s = 0; s < memory.walls.size(); ++s) {
      for (std::uint32_t w = 0; w < memory.walls[s].size(); ++w) {
        keep(i, StoneSlip::With::kWall, s, w, memory.walls[s][w]);
      }
    }
  }
  return saved;
}

void Stones::requireSound(const StonesState& saved, std::size_t particles) const {
  const auto is_number = [](const auto& v) { return v.allFinite(); };
  bool sound = saved.stones.size() == size();
  for (const StoneState& stone : saved.stones) {
    for (const Pose& pose : {stone.scene_T_stone, stone.rested_at}) {
      sound = sound && is_number(pose.position_m) && isUnit(pose.orientation);
    }
    sound = sound && is_number(stone.velocity_m_s) && is_number(stone.angular_momentum_nms);
  }
  for (const StoneSlip& slip : saved.slips) {
    sound = sound && slip.stone < size() && slip.sphere < memory_[slip.stone].walls.size() &&
            is_number(Eigen::Vector3f(slip.x, slip.y, slip.z)) && slip.with <= StoneSlip::With::kWall &&
            (slip.with != StoneSlip::With::kParticle || slip.other < particles) &&
            (slip.with != StoneSlip::With::kWall || slip.other < 3) &&
            (slip.with != StoneSlip::With::kStone || (slip.other > slip.stone && slip.other < size()));
  }
  if (!sound) {
    throw InvalidParameter("state", "stones of another bed, or without a finite position",
                           "the stones of this bed, with finite positions");
  }
}

void Stones::restore(const StonesState& saved) {
  state_.stones = saved.stones;
  for (std::size_t i = 0; i < size(); ++i) {
    Memory& memory = memory_[i];
    memory.packs.clear();
    memory.before.clear();
    memory.pairs.clear();
    memory.stones.clear();
    std::ranges::fill(memory.walls, std::array<Stretch, 3>{});
    memory.look = true;
    memory.touched_walls = true;
    noteTurn(i);
    bodies_[i].pushed = {};
  }
  for (const StoneSlip& slip : saved.slips) {
    Memory& memory = memory_[slip.stone];
    const Stretch stretch{slip.x, slip.y, slip.z};
    switch (slip.with) {
      case StoneSlip::With::kParticle:
        if (memory.before.size() < memory.before.capacity()) {
          memory.before.push_back({slip.other, stretch});
        }
        break;
      case StoneSlip::With::kStone: {
        auto pair = std::ranges::find(memory.pairs, slip.other, &Pair::stone);
        if (pair == memory.pairs.end() && memory.pairs.size() < kMostPartners) {
          memory.pairs.push_back({slip.other, {}});
          pair = memory.pairs.end() - 1;
        }
        if (pair != memory.pairs.end()) {
          memory.stones.push_back({static_cast<std::uint32_t>(pair - memory.pairs.begin()), slip.sphere, stretch});
        }
        break;
      }
      case StoneSlip::With::kWall: memory.walls[slip.sphere][slip.other] = stretch; break;
    }
  }
}

}  // namespace haptolith
