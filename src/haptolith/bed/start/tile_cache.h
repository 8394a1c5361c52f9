#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/bed/start/bed_tile.h"

namespace haptolith {

/// Where tiles of settled soil are kept between runs, from now on; an empty name keeps none, as at first. What goes
/// wrong with it is told `tell`, in a line each, and no bed is the worse for it. Not for the tick, and before any bed
/// is made.
void useTileCache(const std::filesystem::path& folder, std::function<void(std::string_view)> tell = {});

/// Where that is as the environment says: HAPTOLITH_CACHE, which may be "off", else a folder of the user's caches;
/// empty: nowhere.
[[nodiscard]] std::filesystem::path tileFolder();

/// settledTile() from the cache, or made and put there. A file that is damaged, or of another tile, is made anew; a
/// folder that cannot be written, or a full disk, keeps nothing.
/// @throws as settledTile().
[[nodiscard]] BedTile cachedTile(const BedParameters& bed, const TileProgress& progress);

/// Grains of a graded bed at rest, from the cache, or settled and put there as cachedTile() does.
[[nodiscard]] std::vector<Float4> cachedGradedGrains(const BedParameters& bed,
                                                     const std::function<std::vector<Float4>()>& settled);

/// All that the tile of a bed depends on, as text: the numbers of tileBed() to the last bit, the instruction set, and
/// which law and format these are.
[[nodiscard]] std::string tileKey(const BedParameters& bed);

/// What a tile that ships with the program (ready_tile.h) is of, as text: the numbers of tileBed() to six digits, and
/// which law it settled by, but no instruction set, for soil at rest is at rest with each.
[[nodiscard]] std::string readyTileKey(const BedParameters& bed);

/// "tile-" and the hash of its key.
[[nodiscard]] std::string tileFileName(const BedParameters& bed);

/// No file of a tile is larger, nor are all of them together: the oldest go first.
inline constexpr std::uintmax_t kMostTileBytes = 512U << 20U;

}  // namespace haptolith
