#pragma once

#include <cstdint>
#include <new>
#include <string>
#include <string_view>
#include <vector>

namespace haptolith {

/// One particle's three numbers as one aligned record, so that a neighbour is one 16-byte load.
struct alignas(16) Float4 {
  float x = 0, y = 0, z = 0, w = 0;
};

/// Float arrays that SIMD registers load whole: they begin at a cache line.
template <class T>
struct CacheAligned {
  using value_type = T;  // NOLINT(readability-identifier-naming): the standard's name
  static constexpr std::align_val_t kLine{64};

  CacheAligned() = default;
  template <class Other>
  CacheAligned(const CacheAligned<Other>&) noexcept {}  // NOLINT(google-explicit-constructor): allocators convert

  [[nodiscard]] T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), kLine)); }
  void deallocate(T* p, std::size_t) noexcept { ::operator delete(p, kLine); }
  friend bool operator==(const CacheAligned&, const CacheAligned&) noexcept { return true; }
};
using FloatArray = std::vector<float, CacheAligned<float>>;

/// How far a particle has slid along the floor and the nearest wall of each pair since it came to touch them, in m.
struct WallSlip {
  float floor_x = 0, floor_y = 0;    ///< floor
  float x_wall_y = 0, x_wall_z = 0;  ///< walls at x = +-width/2
  float y_wall_x = 0, y_wall_z = 0;  ///< walls at y = +-length/2
};

/// Everything that changes while a bed runs. Restoring it and going on gives the same bits as never having stopped.
///
/// position and velocity hold one record more than there are particles: a ghost, infinitely far for the contact law,
/// that fills the last block of every neighbour list.
struct BedState {
  std::uint64_t step = 0;              ///< substeps since the start
  std::vector<Float4> position;        ///< m; w is by how much the particle's radius exceeds the mean
  std::vector<Float4> velocity;        ///< m/s; w is 1 for a driven particle, which keeps its velocity, else 0
  std::vector<Float4> listed_at;       ///< positions at which the neighbour list was built: it fixes the order of sums
  std::vector<std::int8_t> tool_side;  ///< on which large face of the tool a particle lies: -1, 0 (neither), +1

  // Memory of friction, in m; empty with the paper's friction, which remembers nothing.
  FloatArray slip_x, slip_y, slip_z;  ///< one entry for each of the neighbour list: see ContactMemory
  std::vector<WallSlip> wall_slip;    ///< one for each particle
  std::vector<Float4> tool_slip;      ///< one for each particle, in the tool's frame

  [[nodiscard]] std::size_t particles() const noexcept { return tool_side.size(); }
};

/// 64-bit hash (XXH3) over positions, velocities and the memory of contacts. Equal states have equal hashes on one
/// machine type.
[[nodiscard]] std::uint64_t stateHash(const BedState& state) noexcept;

/// The state as bytes, and back. @throws Failure when the bytes are no state, are cut short or of another version.
[[nodiscard]] std::string serialise(const BedState& state);
[[nodiscard]] BedState deserialiseBedState(std::string_view bytes);

}  // namespace haptolith
