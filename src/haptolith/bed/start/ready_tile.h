#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "haptolith/bed/start/bed_tile.h"

namespace haptolith {

/// Radii of particles to choose from, in m, coarse to fine, in steps of at most 10 %. The scene `auto` ships with
/// settled soil of each.
inline constexpr std::array kGrainRadii_m{7e-3,   6.4e-3, 5.8e-3,  5.3e-3, 4.8e-3, 4.4e-3, 4e-3,   3.75e-3, 3.5e-3,
                                          3.2e-3, 2.9e-3, 2.65e-3, 2.4e-3, 2.2e-3, 2e-3,   1.9e-3, 1.75e-3};

/// Radius of kGrainRadii_m that is one step coarser than `radius_m`, in m: at least 4 % larger. None above the largest.
[[nodiscard]] std::optional<double> coarserRadius(double radius_m);

/// Settled soil that ships with the program (BedParameters::ready_made): the tile of `bed`.
/// None where no tile ships for this soil, radius, depth, gravity and seed. Not for the tick.
[[nodiscard]] std::optional<BedTile> readyTile(const BedParameters& bed);

/// Name of the file in scenes/tiles that holds the tile of `bed`, whether it is there or not: "4.4mm-1a2b3c4d.tile".
[[nodiscard]] std::string readyTileName(const BedParameters& bed);

/// Content of that file: positions as they are, and what contacts remember in 16 bits, once for both particles.
/// @throws InvalidParameter for a tile of more than 65535 particles.
[[nodiscard]] std::string readyTileBytes(const BedTile& tile, const BedParameters& bed);

/// The tile in such a content; none when it is damaged or of another bed.
[[nodiscard]] std::optional<BedTile> readyTileIn(std::string_view bytes, const BedParameters& bed);

/// Content of the file of that name; empty: there is none. The build writes this function (cmake/EmbedTiles.cmake); the
/// demo reads the file that its page has loaded.
[[nodiscard]] std::string_view readyTileFile(std::string_view name);

}  // namespace haptolith
