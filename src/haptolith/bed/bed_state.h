#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/bed/contact_lists.h"
#include "haptolith/bed/stones_state.h"

namespace haptolith {

/// One particle's three numbers as one aligned record, so that a neighbour is one 16-byte load.
struct alignas(16) Float4 {
  float x = 0, y = 0, z = 0, w = 0;
};

/// Slip of a group's particles along the floor and the nearest wall of each pair since contact began,
/// in m: 16 of each, side by side.
struct alignas(64) WallSlips {
  std::array<float, kGroup> floor_x{}, floor_y{};    ///< floor
  std::array<float, kGroup> x_wall_y{}, x_wall_z{};  ///< walls at x = +-width/2
  std::array<float, kGroup> y_wall_x{}, y_wall_z{};  ///< walls at y = +-length/2
};

/// A record behind the particles: infinitely far, and never moved.
inline constexpr Float4 kGhost{1e9F, 1e9F, 1e9F, 0};
inline constexpr Float4 kGhostVelocity{0, 0, 0, 1};

/// Everything that changes while a bed runs. A restored bed continues with the same bits as one that never stopped.
///
/// Records come in groups (paddedCount()). Those behind the particles are ghosts, infinitely far for the contact law;
/// the first of them, index n, fills up the lists.
struct BedState {
  std::uint64_t step = 0;                  ///< substeps since the start
  std::size_t particle_count = 0;          ///< records behind these are ghosts
  std::vector<Float4> position;            ///< m; w is by how much the particle's radius exceeds the mean
  std::vector<Float4> velocity;            ///< m/s; w: 0, or kDriven or kHeld
  std::vector<Float4> remainder;           ///< m; movement below the resolution of `position`; empty except
                                           ///< in wide boxes, where slow particles would otherwise stop
  std::vector<Float4> reference_position;  ///< reference position of each particle's neighbour list: see Neighbourhood
  ContactLists contacts;                   ///< pairs that may touch; with contact friction their slip, in m

  static constexpr float kDriven = 1;  ///< keeps its velocity, whatever pushes it
  static constexpr float kHeld = 2;    ///< keeps its place: fixed soil outside the sides of a settled box
  [[nodiscard]] bool isHeld(std::size_t particle) const noexcept { return velocity[particle].w == kHeld; }

  static constexpr std::uint16_t kAsleep = 0xFFFF;
  static constexpr std::uint16_t kAsleepForEver = 0xFFFE;  ///< held soil: nothing wakes it
  std::vector<std::uint16_t> rested;  ///< for how many steps each group has been at rest, or asleep: see Wakefulness
  [[nodiscard]] bool asleep(std::size_t group) const noexcept { return rested[group] >= kAsleepForEver; }
  std::vector<Float4> rested_at;  ///< m; where its particles have been since

  std::vector<WallSlips> wall_slip;  ///< one per group; empty with ICRA 2021 friction, which remembers nothing

  [[nodiscard]] std::size_t particles() const noexcept { return particle_count; }
};

/// A bed between two ticks: its state, and everything else that determines its next ticks.
struct SavedBed {
  BedState state;
  double grid_height_m = 0;  ///< height of the soil when the bed was made: the size of its grid
  StonesState stones;
};

/// Memory of one tool for each particle, for the hash of a bed: see ToolMemory.
struct ToolTrace {
  std::span<const std::int8_t> side;
  std::span<const Float4> slip;  ///< empty with ICRA 2021 friction
};

/// 64-bit hash (XXH3) over positions, velocities and the memory of contacts, those with tools included. Equal states
/// have equal hashes on one machine type. May be called in the tick; of a large bed a part at a time, which takes
/// part + 1 of `parts` groups.
[[nodiscard]] std::uint64_t stateHash(const BedState& state, std::span<const ToolTrace> tools = {},
                                      std::size_t part = 0, std::size_t parts = 1) noexcept;

/// The state as bytes, and back. @throws Failure when the bytes are no state, are cut short or of another version.
[[nodiscard]] std::string serialise(const BedState& state);
[[nodiscard]] BedState deserialiseBedState(std::string_view bytes);
[[nodiscard]] std::string serialise(const SavedBed& saved);
[[nodiscard]] SavedBed deserialiseSavedBed(std::string_view bytes);

}  // namespace haptolith
