#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace haptolith {

/// One particle's three numbers as one aligned record, so that a neighbour is one 16-byte load.
struct alignas(16) Float4 {
  float x = 0, y = 0, z = 0, w = 0;
};

/// Everything that changes while a bed runs. Restoring it and going on gives the same bits as never having stopped.
///
/// position and velocity hold one record more than there are particles: a ghost, infinitely far for the contact law,
/// that fills the last block of every neighbour list.
struct BedState {
  std::uint64_t step = 0;              ///< substeps since the start
  std::vector<Float4> position;        ///< m
  std::vector<Float4> velocity;        ///< m/s
  std::vector<Float4> listed_at;       ///< positions at which the neighbour list was built: it fixes the order of sums
  std::vector<std::int8_t> tool_side;  ///< on which large face of the tool a particle lies: -1, 0 (neither), +1

  [[nodiscard]] std::size_t particles() const noexcept { return tool_side.size(); }
};

/// 64-bit hash (XXH3) over positions, velocities and contact memory. Equal states have equal hashes on one machine
/// type.
[[nodiscard]] std::uint64_t stateHash(const BedState& state) noexcept;

/// The state as bytes, and back. @throws Failure when the bytes are no state, are cut short or of another version.
[[nodiscard]] std::string serialise(const BedState& state);
[[nodiscard]] BedState deserialiseBedState(std::string_view bytes);

}  // namespace haptolith
