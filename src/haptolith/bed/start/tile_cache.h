#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/bed/start/bed_tile.h"

namespace haptolith {

/// Sets the folder that keeps tiles of settled soil between runs; an empty name, the default, keeps none. Problems are
/// reported to `tell`, in a line each, and do not affect any bed. Not for the tick, and before any bed
/// is made.
void useTileCache(const std::filesystem::path& folder, std::function<void(std::string_view)> tell = {});

/// The folder from the environment: HAPTOLITH_CACHE, which may be "off", else a folder of the user's caches;
/// empty: none.
[[nodiscard]] std::filesystem::path tileFolder();

/// settledTile() from the cache, or made and put there. A file that is damaged, or of another tile, is replaced; a
/// folder that cannot be written, or a full disk, keeps nothing.
/// @throws as settledTile().
[[nodiscard]] BedTile cachedTile(const BedParameters& bed, const TileProgress& progress);

/// Grains of a graded bed at rest, from the cache, or settled and put there as cachedTile() does.
[[nodiscard]] std::vector<Float4> cachedGradedGrains(const BedParameters& bed,
                                                     const std::function<std::vector<Float4>()>& settled);

/// All inputs of a bed's tile, as text: the exact numbers of tileBed(), arithmetic(), and the
/// versions of law and format.
[[nodiscard]] std::string tileKey(const BedParameters& bed);

/// Inputs of a tile that ships with the program (ready_tile.h), as text: the numbers of tileBed() to six digits, and
/// the version of the law, but no arithmetic, because soil at rest is at rest with each.
[[nodiscard]] std::string readyTileKey(const BedParameters& bed);

/// "tile-" and the hash of its key.
[[nodiscard]] std::string tileFileName(const BedParameters& bed);

/// No file of a tile is larger, nor are all of them together: the oldest go first.
inline constexpr std::uintmax_t kMostTileBytes = 512U << 20U;

}  // namespace haptolith
