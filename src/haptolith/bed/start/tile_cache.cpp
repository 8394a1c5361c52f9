#include "haptolith/bed/start/tile_cache.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "haptolith/bed/kernel/simd_target.h"
#include "haptolith/core/error.h"
#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/files/input_file.h"
#include "haptolith/core/files/user_folder.h"
#include "haptolith/core/platform/files.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little, "tiles are little-endian");

/// Incremented whenever a bed settles to other bits: with the reference hashes
/// (tests/scene_file/golden_test.cpp).
constexpr int kLaw = 2;
/// As above, for graded beds alone.
constexpr int kGradedLaw = 2;
/// One more whenever a file is laid out otherwise.
constexpr int kFormat = 1;

constexpr std::string_view kPrefix = "tile-";
constexpr std::string_view kTileMagic = "haptolith tile\n";

struct Cache {
  fs::path folder;
  std::function<void(std::string_view)> tell;
};

Cache& cache() {
  static Cache the_one;
  return the_one;
}

void tell(const std::string& line) {
  if (cache().tell) {
    cache().tell(line);
  }
}

template <class Number>
void append(std::string& bytes, const std::vector<Number>& numbers) {
  const std::uint64_t count = numbers.size();
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
  bytes.append(reinterpret_cast<const char*>(numbers.data()), count * sizeof(Number));
}

void append(std::string& bytes, const std::string& text) {
  append(bytes, std::vector<char>(text.begin(), text.end()));
}

/// False when there are not as many bytes as they would be.
template <class Number>
[[nodiscard]] bool take(std::string_view& bytes, std::vector<Number>& numbers) {
  std::uint64_t count = 0;
  if (bytes.size() < sizeof count) {
    return false;
  }
  std::memcpy(&count, bytes.data(), sizeof count);
  bytes.remove_prefix(sizeof count);
  if (count > bytes.size() / sizeof(Number)) {
    return false;
  }
  numbers.resize(count);
  if (count > 0) {
    std::memcpy(numbers.data(), bytes.data(), count * sizeof(Number));
  }
  bytes.remove_prefix(count * sizeof(Number));
  return true;
}

std::string fileOf(const BedTile& tile, const std::string& key) {
  std::string bytes(kTileMagic);
  append(bytes, key);
  append(bytes, std::vector<double>{tile.width_m, tile.length_m});
  append(bytes, tile.grains);
  append(bytes, tile.firsts);
  append(bytes, tile.contacts);
  append(bytes, tile.floor_slips);
  const std::uint64_t sum = XXH3_64bits(bytes.data(), bytes.size());
  bytes.append(reinterpret_cast<const char*>(&sum), sizeof sum);
  return bytes;
}

bool finite(const Slip& slip) {
  return std::isfinite(slip.x) && std::isfinite(slip.y) && std::isfinite(slip.z);
}

/// A requested soil: its inputs, and the properties of the result.
struct Wanted {
  std::string key;
  BedParameters bed;
  double highest_m;  ///< no grain of it lies higher
};

/// Whether a tile from a file is one of the bed that is wanted: nothing in it may lead outside of it.
bool isSound(const BedTile& tile, const Wanted& soil) {
  const BedParameters& wanted = soil.bed;
  const std::size_t n = tile.grains.size();
  const bool remembers = wanted.soil.friction == FrictionModel::kContact;
  const auto within = [&](const Float4& p) {
    return std::abs(p.x) <= wanted.width_m && std::abs(p.y) <= wanted.length_m && std::abs(p.z) <= soil.highest_m &&
           std::abs(p.w) <= wanted.soil.radius_m;  // also false for NaN
  };
  const auto known = [&](const TileContact& contact) { return contact.other < n && finite(contact.slip); };
  return n > 0 && tile.width_m == wanted.width_m && tile.length_m == wanted.length_m && tile.firsts.size() == n + 1 &&
         tile.floor_slips.size() == (remembers ? n : 0) && tile.firsts.front() == 0 &&
         tile.firsts.back() == tile.contacts.size() && std::ranges::is_sorted(tile.firsts) &&
         std::ranges::all_of(tile.grains, within) && std::ranges::all_of(tile.contacts, known) &&
         std::ranges::all_of(tile.floor_slips, finite);
}

std::optional<BedTile> tileIn(std::string_view bytes, const Wanted& wanted) {
  std::uint64_t sum = 0;
  if (bytes.size() < kTileMagic.size() + sizeof sum || !bytes.starts_with(kTileMagic)) {
    return std::nullopt;
  }
  std::memcpy(&sum, bytes.data() + bytes.size() - sizeof sum, sizeof sum);
  bytes.remove_suffix(sizeof sum);
  if (XXH3_64bits(bytes.data(), bytes.size()) != sum) {
    return std::nullopt;
  }
  bytes.remove_prefix(kTileMagic.size());
  BedTile tile;
  std::vector<char> own_key;
  std::vector<double> periods;
  const bool whole = take(bytes, own_key) && take(bytes, periods) && take(bytes, tile.grains) &&
                     take(bytes, tile.firsts) && take(bytes, tile.contacts) && take(bytes, tile.floor_slips) &&
                     bytes.empty() && std::string(own_key.begin(), own_key.end()) == wanted.key && periods.size() == 2;
  if (!whole) {
    return std::nullopt;
  }
  tile.width_m = periods[0];
  tile.length_m = periods[1];
  return isSound(tile, wanted) ? std::optional(std::move(tile)) : std::nullopt;
}

/// The tile, if the cache has it.
std::optional<BedTile> readTile(const fs::path& file, const Wanted& wanted) {
  std::error_code ignored;
  if (!fs::exists(fs::symlink_status(file, ignored))) {
    return std::nullopt;
  }
  try {
    std::ifstream in = openInput(file, kMostTileBytes);
    const std::string bytes(std::istreambuf_iterator<char>(in), {});
    std::optional<BedTile> tile = tileIn(bytes, wanted);
    if (!tile) {
      tell(fmt::format("{}: cache file is damaged or for another soil; it is generated again", file.string()));
    }
    return tile;
  } catch (const std::exception& error) {
    tell(fmt::format("{}: the cache file is generated again", error.what()));
    return std::nullopt;
  }
}

/// Takes away the oldest tiles as long as all together are too large.
void makeRoom(const fs::path& folder) {
  struct Kept {
    fs::file_time_type written;
    fs::path file;
    std::uintmax_t bytes;
  };
  std::vector<Kept> kept;
  std::uintmax_t bytes = 0;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().filename().string().starts_with(kPrefix) && entry.is_regular_file(error)) {
      kept.push_back({entry.last_write_time(error), entry.path(), entry.file_size(error)});
      bytes += kept.back().bytes;
    }
  }
  std::ranges::sort(kept, {}, &Kept::written);
  for (const Kept& oldest : kept) {
    if (bytes <= kMostTileBytes) {
      return;
    }
    fs::remove(oldest.file, error);
    bytes -= oldest.bytes;
  }
}

/// Writes a cache file, without listing it for the user: completely or not at all.
void writeTile(const fs::path& file, const std::string& bytes) {
  const auto fail = [&](const char* what) {
    tell(fmt::format("cannot {} {}: {}; soil settles again in each run (HAPTOLITH_CACHE selects another folder)", what,
                     file.string(), std::strerror(errno)));
  };
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  if (error) {
    errno = error.value();
    return fail("keep");
  }
  const fs::path part = temporaryBeside(file, "part");
  const int descriptor = makeNewFile(part, Readers::kOwner);
  if (descriptor < 0) {
    return fail("keep");
  }
  const bool whole = writeBytes(descriptor, bytes) && flushToDisk(descriptor);
  const int why = errno;
  const bool closed = closeFile(descriptor);
  if (!whole || !closed || !renameFile(part, file, true)) {
    errno = whole ? errno : why;
    fail("write");
    fs::remove(part, error);
    return;
  }
  makeRoom(file.parent_path());
}

std::string fileName(const std::string& key) {
  return fmt::format("{}{:016x}", kPrefix, XXH3_64bits(key.data(), key.size()));
}

/// The numbers that a bed of one size of grain depends on while it settles.
std::vector<double> numbersOf(const BedParameters& bed) {
  std::vector<double> numbers{bed.width_m, bed.length_m, bed.depth_m, bed.gravity_m_s2.z(), bed.tick_s};
  for (const SoilNumber& number : soilNumbersBy(&SoilNumber::tile_place)) {
    numbers.push_back(bed.soil.*number.member);
  }
  return numbers;
}

/// Inputs of a bed of one particle size while it settles.
std::string keyOf(const BedParameters& bed) {
  std::string key =
      fmt::format("format {} law {} {} friction {} particles {} seed {} max_substeps {}", kFormat, kLaw, arithmetic(),
                  static_cast<int>(bed.soil.friction), bed.particles, bed.seed, bed.max_substeps);
  for (const double number : numbersOf(bed)) {
    key += fmt::format(" {:a}", number);
  }
  return key;
}

/// Additional inputs of a graded bed.
std::string gradedKey(const BedParameters& bed) {
  const Grading& grading = bed.grading;
  static_assert(sizeof(Grading) == 6 * sizeof(double), "a new number of the grading belongs in the key");
  std::string key = fmt::format("{} graded law {} start {} layers {} periodic {} {}", keyOf(bed), kGradedLaw,
                                static_cast<int>(bed.start), bed.layers, bed.periodic_x, bed.periodic_y);
  for (const double number :
       {bed.gravity_m_s2.x(), bed.gravity_m_s2.y(), bed.wall_friction_ratio, grading.fine_radius_m, grading.fine_x_m,
        grading.fine_y_m, grading.fine_width_m, grading.fine_length_m, grading.fine_depth_m}) {
    key += fmt::format(" {:a}", number);
  }
  return key;
}

/// Upper bound of the height of settled particles, however loose.
double highestOf(const BedParameters& bed) {
  constexpr double kLoosest = 8, kLayersMore = 20;  // volume of a grain in R^3
  const double r = bed.soil.radius_m;
  return 2 * bed.depth_m + kLayersMore * r + kLoosest * bed.particles * r * r * r / (bed.width_m * bed.length_m);
}

BedTile cached(const Wanted& wanted, const std::function<BedTile()>& make) {
  if (cache().folder.empty()) {
    return make();
  }
  const fs::path file = cache().folder / fileName(wanted.key);
  if (std::optional<BedTile> tile = readTile(file, wanted)) {
    return *std::move(tile);
  }
  BedTile tile = make();
  if (const std::string bytes = fileOf(tile, wanted.key); bytes.size() <= kMostTileBytes) {
    writeTile(file, bytes);
  }
  return tile;
}

}  // namespace

std::filesystem::path tileFolder() {
  if (const char* own = std::getenv("HAPTOLITH_CACHE"); own != nullptr && *own != '\0') {
    return std::string_view(own) == "off" ? "" : own;
  }
  return userCacheFolder();
}

void useTileCache(const fs::path& folder, std::function<void(std::string_view)> tell) {
  cache() = {folder, std::move(tell)};
}

std::string tileKey(const BedParameters& bed) {
  return keyOf(tileBed(bed));
}

std::string readyTileKey(const BedParameters& bed) {
  const BedParameters tile = tileBed(bed);
  std::string key = fmt::format("law {} friction {} seed {}", kLaw, static_cast<int>(tile.soil.friction), tile.seed);
  for (const double number : numbersOf(tile)) {
    key += fmt::format(" {:.6g}", number);
  }
  return key;
}

std::string tileFileName(const BedParameters& bed) {
  return fileName(tileKey(bed));
}

BedTile cachedTile(const BedParameters& bed, const TileProgress& progress) {
  const BedParameters tile = tileBed(bed);
  return cached({keyOf(tile), tile, highestOf(tile)}, [&] { return settledTile(bed, progress); });
}

std::vector<Float4> cachedGradedGrains(const BedParameters& bed, const std::function<std::vector<Float4>()>& settled) {
  return cached({gradedKey(bed), bed, highestOf(bed)},
                [&] {
                  BedTile whole{bed.width_m, bed.length_m, settled(), {}, {}, {}};
                  whole.firsts.resize(whole.grains.size() + 1);  // no contact remembers anything yet
                  whole.floor_slips.resize(whole.grains.size());
                  return whole;
                })
      .grains;
}

}  // namespace haptolith
