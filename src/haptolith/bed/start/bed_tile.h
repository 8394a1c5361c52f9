#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "haptolith/bed/bed_parameters.h"
#include "haptolith/bed/bed_state.h"

namespace haptolith {

/// A contact of a tile's grain that remembers something.
struct TileContact {
  std::uint32_t other;  ///< grain of the same tile, whichever copy of it is near
  Slip slip;
};

/// Soil at rest that repeats itself sideways, with what its contacts remember: what a bed is laid with that starts as
/// kSettled. Copies stand side by side as if they had settled together, so a bed of a million grains costs as much to
/// settle as a tile of some thousand.
struct BedTile {
  double width_m = 0, length_m = 0;   ///< after which it repeats itself along x and y
  std::vector<Float4> grains;         ///< m, its middle at x = y = 0, floor at z = 0; w as in BedState
  std::vector<std::uint32_t> firsts;  ///< index of each particle's first contact, and the end of the last one's
  std::vector<TileContact> contacts;  ///< from both sides
  std::vector<Slip> floor_slips;      ///< slip of each particle with contact friction, along x and y
};

/// The bed that settles to become the tile of `bed`. It holds everything that a tile depends on: beds of one soil,
/// depth, seed, gravity and tick share a tile, and those that repeat themselves after as long.
/// @throws InvalidParameter when a tile would have too many particles.
[[nodiscard]] BedParameters tileBed(const BedParameters& bed);

/// Called now and then while a tile settles, as SettleProgress.
using TileProgress = std::function<bool(double time_s, double speed_m_s)>;

/// Lets the tile of `bed` settle: falls without friction, is levelled at `depth_m`, and settles again with
/// friction, whose springs then carry load. Bit-identical for any number of threads. Takes seconds.
/// @throws Failure as Bed::settle().
[[nodiscard]] BedTile settledTile(const BedParameters& bed, const TileProgress& progress);

/// Soil laid out in a box. It continues outside the box's sides as far as contacts reach, and is held there: free
/// particles have all their neighbours, and are at rest in the box as in the tile. Next to smooth walls, where the
/// particles that overlap them are left out, half a layer would be missing; soil slumps into that, and carries the
/// whole bed with it for seconds, however wide.
struct LaidSoil {
  std::vector<Float4> grains;          ///< in spatial order, first those that are free, then those that are held
  std::vector<std::uint32_t> sources;  ///< source particle of each copy in the tile
  std::size_t free = 0;                ///< number of free particles
};

/// Width of the held soil around the free soil, in m: the reach of a contact. 0 in beds without held soil.
[[nodiscard]] double heldWidth(const BedParameters& bed);

/// Friction and cohesion of the side walls over the soil's: BedParameters::wall_friction_ratio, but 0 behind held soil.
/// There nothing but what was thrown or heaped above the bed can reach the walls, and would hang on them in the air.
[[nodiscard]] double wallRatio(const BedParameters& bed);

/// Copies of the tile over the box of `bed`.
/// @throws InvalidParameter when there would be too many.
[[nodiscard]] LaidSoil laidOut(const BedTile& tile, const BedParameters& bed);

}  // namespace haptolith
