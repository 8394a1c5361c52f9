#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/vec.h"

namespace haptolith {

/// One stone as it is between two steps.
struct StoneState {
  Pose scene_T_stone;                        ///< its centre of mass and its principal axes
  Vec3 velocity_m_s = Vec3::Zero();          ///< velocity of its centre of mass
  Vec3 angular_momentum_nms = Vec3::Zero();  ///< about its centre of mass, scene frame
  Pose rested_at;                            ///< pose at which it came to rest
  std::uint16_t rested = 0;                  ///< number of steps at rest, or asleep: as BedState::rested

  static constexpr std::uint16_t kAsleep = 0xFFFF;
  [[nodiscard]] bool asleep() const noexcept { return rested == kAsleep; }
};

/// Slip of one contact of a stone; those with tools are the tools' own: see ToolMemory.
struct StoneSlip {
  enum class With : std::uint32_t { kParticle, kStone, kWall };
  std::uint32_t stone = 0;
  With with = With::kParticle;
  std::uint32_t sphere = 0;   ///< sphere of the stone; 0 with particles, which touch it as one
  std::uint32_t other = 0;    ///< particle, stone, or wall: 0 floor, 1 at x, 2 at y
  float x = 0, y = 0, z = 0;  ///< m

  [[nodiscard]] bool operator==(const StoneSlip&) const = default;
};

/// All stones of a bed between two steps.
struct StonesState {
  std::vector<StoneState> stones;
  std::vector<StoneSlip> slips;  ///< in an order that depends on nothing else
};

/// 64-bit hash (XXH3) over poses and velocities, continuing from `hash`. May be called in the tick.
[[nodiscard]] std::uint64_t stonesHash(const StonesState& state, std::uint64_t hash) noexcept;

/// As bytes, and back. @throws Failure when the bytes are no stones or are cut short.
[[nodiscard]] std::string serialise(const StonesState& state);
[[nodiscard]] StonesState deserialiseStones(std::string_view bytes);

}  // namespace haptolith
