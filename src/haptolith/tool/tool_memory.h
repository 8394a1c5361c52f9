#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "haptolith/bed/bed.h"

namespace haptolith {

/// Memory of a tool's contact for every particle: the large face of the tool that it touches, -1, 0 (none) or +1, and,
/// with contact friction, its slip along the tool, in m, tool frame; empty without. With jaws it is the sides of both
/// (see JawContacts), and of both slips, which are along a surface, the two numbers that are not 0.
struct ParticleMemory {
  std::span<std::int8_t> side;
  std::span<Float4> slip;
};

/// Memory of a tool's contact for one sphere of a stone.
struct SphereMemory {
  std::int8_t side = 0;
  Float4 slip_m;
};

/// A tool's memory between two ticks: of those particles and spheres that it touches. Without gaps: bytes are values.
struct SavedToolMemory {
  using Slip = std::array<float, 4>;
  struct Particle {
    std::uint32_t particle = 0;
    std::int32_t side = 0;
    Slip slip_m{};
  };
  struct Sphere {
    std::uint32_t stone = 0, sphere = 0;
    std::int32_t side = 0;
    Slip slip_m{};
  };
  std::vector<Particle> particles;  ///< in ascending order
  std::vector<Sphere> spheres;
  std::vector<std::uint32_t> near_groups;  ///< that Bed::groupsNear() found last, without those before
};

/// Memory of one tool for the soil and the stones that it touches. It belongs to the tool: a bed has none.
class ToolMemory {
 public:
  /// Empty memory, with room for everything in the bed. Not for the tick.
  explicit ToolMemory(const Bed& bed);

  [[nodiscard]] ParticleMemory particles() noexcept { return {side_, slip_}; }
  [[nodiscard]] std::span<SphereMemory> stone(std::size_t stone) noexcept { return stones_[stone]; }
  [[nodiscard]] NearGroups& nearGroups() noexcept { return near_; }
  /// For hashes. May be called in the tick.
  [[nodiscard]] ToolTrace trace() const noexcept { return {side_, slip_}; }

  /// Forgets all contacts. May be called in the tick.
  /// @param near  groups that may hold particles with a contact.
  void forget(std::span<const std::uint32_t> near) noexcept;

  /// Bytes of memory in use.
  [[nodiscard]] std::size_t bytes() const noexcept;

  /// Not for the tick.
  [[nodiscard]] SavedToolMemory save() const;
  /// Not for the tick. @throws InvalidParameter for particles, spheres or groups that the bed does not have, and for
  /// slips that are not finite.
  void requireSound(const SavedToolMemory& saved) const;
  /// Continues from memory that has been checked.
  void restore(const SavedToolMemory& saved) noexcept;

 private:
  std::vector<std::int8_t> side_;
  std::vector<Float4> slip_;
  std::vector<std::vector<SphereMemory>> stones_;
  NearGroups near_;
  std::size_t groups_;
};

}  // namespace haptolith
