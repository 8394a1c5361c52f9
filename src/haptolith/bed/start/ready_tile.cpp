#include "haptolith/bed/start/ready_tile.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>
#include <vector>

#include "haptolith/bed/start/tile_cache.h"
#include "haptolith/core/error.h"

namespace haptolith {

namespace {

static_assert(std::endian::native == std::endian::little, "tiles are little-endian");

constexpr std::string_view kReadyMagic = "haptolith ready tile 1\n";

/// SlipSteps of what contacts remember: the largest has this many.
constexpr double kSlipSteps = std::numeric_limits<std::int16_t>::max();

using SlipSteps = std::array<std::int16_t, 3>;

/// A contact, from the side of the particle with the lower index.
struct TilePair {
  std::uint16_t first, second;
  SlipSteps slip;
};

/// A particle's contact with the floor.
struct OnFloor {
  std::uint16_t particle;
  std::array<std::int16_t, 2> slip;
};

template <class Value>
void appendReady(std::string& bytes, const Value& value) {
  static_assert(std::is_trivially_copyable_v<Value>);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <class Value>
void appendReady(std::string& bytes, const std::vector<Value>& values) {
  appendReady(bytes, static_cast<std::uint32_t>(values.size()));
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value));
}

template <class Value>
[[nodiscard]] bool takeReady(std::string_view& bytes, Value& value) {
  static_assert(std::is_trivially_copyable_v<Value>);
  if (bytes.size() < sizeof value) {
    return false;
  }
  std::memcpy(&value, bytes.data(), sizeof value);
  bytes.remove_prefix(sizeof value);
  return true;
}

template <class Value>
[[nodiscard]] bool takeReady(std::string_view& bytes, std::vector<Value>& values) {
  std::uint32_t count = 0;
  if (!takeReady(bytes, count) || count > bytes.size() / sizeof(Value)) {
    return false;
  }
  values.resize(count);
  if (count > 0) {
    std::memcpy(values.data(), bytes.data(), count * sizeof(Value));
  }
  bytes.remove_prefix(count * sizeof(Value));
  return true;
}

double largestSlip(const BedTile& tile) {
  double largest_m = std::numeric_limits<float>::min();
  const auto look = [&largest_m](const Slip& slip) {
    for (const float part : {slip.x, slip.y, slip.z}) {
      largest_m = std::max(largest_m, std::abs(static_cast<double>(part)));
    }
  };
  for (const TileContact& contact : tile.contacts) {
    look(contact.slip);
  }
  std::ranges::for_each(tile.floor_slips, look);
  return largest_m;
}

std::int16_t slipInSteps(double slip_m, double step_m) {
  return static_cast<std::int16_t>(std::lround(slip_m / step_m));
}

Slip slipOfSteps(const SlipSteps& slip, double step_m, double sign) {
  const auto length = [&](std::int16_t part) { return static_cast<float>(sign * part * step_m); };
  return {length(slip[0]), length(slip[1]), length(slip[2])};
}

/// Each pair once: forces are equal and opposite, and so is what they remember.
std::vector<TilePair> tilePairs(const BedTile& tile, double step_m) {
  std::vector<TilePair> pairs;
  for (std::size_t i = 0; i < tile.grains.size(); ++i) {
    for (std::uint32_t at = tile.firsts[i]; at < tile.firsts[i + 1]; ++at) {
      const auto& [other, slip] = tile.contacts[at];
      if (i < other) {
        pairs.push_back({static_cast<std::uint16_t>(i),
                         static_cast<std::uint16_t>(other),
                         {slipInSteps(slip.x, step_m), slipInSteps(slip.y, step_m), slipInSteps(slip.z, step_m)}});
      }
    }
  }
  return pairs;
}

/// From both sides again. False when a pair names a particle that there is not.
[[nodiscard]] bool fromBothSides(const std::vector<TilePair>& pairs, double step_m, BedTile& tile) {
  const std::size_t n = tile.grains.size();
  if (std::ranges::any_of(pairs, [n](const TilePair& pair) { return pair.first >= n || pair.second >= n; })) {
    return false;
  }
  tile.firsts.assign(n + 1, 0);
  for (const TilePair& pair : pairs) {
    ++tile.firsts[pair.first + 1U];
    ++tile.firsts[pair.second + 1U];
  }
  for (std::size_t i = 0; i < n; ++i) {
    tile.firsts[i + 1] += tile.firsts[i];
  }
  tile.contacts.resize(2 * pairs.size());
  std::vector<std::uint32_t> next(tile.firsts.begin(), tile.firsts.end() - 1);
  for (const TilePair& pair : pairs) {
    tile.contacts[next[pair.first]++] = {pair.second, slipOfSteps(pair.slip, step_m, 1)};
    tile.contacts[next[pair.second]++] = {pair.first, slipOfSteps(pair.slip, step_m, -1)};
  }
  return true;
}

}  // namespace

std::optional<double> coarserRadius(double radius_m) {
  constexpr double kLeastStep = 1.04;
  std::optional<double> found;
  for (const double coarser_m : kGrainRadii_m) {
    if (coarser_m >= kLeastStep * radius_m) {
      found = coarser_m;
    }
  }
  return found;
}

std::string readyTileName(const BedParameters& bed) {
  const std::string key = readyTileKey(bed);
  return fmt::format("{:g}mm-{:08x}.tile", inUnits(bed.soil.radius_m, 1e-3),
                     XXH3_64bits(key.data(), key.size()) >> 32U);
}

std::string readyTileBytes(const BedTile& tile, const BedParameters& bed) {
  if (tile.grains.size() > std::numeric_limits<std::uint16_t>::max()) {
    throw InvalidParameter("tile", fmt::format("{} particles", tile.grains.size()), "at most 65535");
  }
  const double step_m = largestSlip(tile) / kSlipSteps;
  std::vector<OnFloor> on_floor;
  for (std::size_t i = 0; i < tile.floor_slips.size(); ++i) {
    const Slip& slip = tile.floor_slips[i];
    if (slip.x != 0 || slip.y != 0) {
      on_floor.push_back({static_cast<std::uint16_t>(i), {slipInSteps(slip.x, step_m), slipInSteps(slip.y, step_m)}});
    }
  }
  const std::string key = readyTileKey(bed);
  std::string bytes(kReadyMagic);
  appendReady(bytes, std::vector<char>(key.begin(), key.end()));
  appendReady(bytes, tile.width_m);
  appendReady(bytes, tile.length_m);
  appendReady(bytes, step_m);
  appendReady(bytes, tile.grains);
  appendReady(bytes, tilePairs(tile, step_m));
  appendReady(bytes, on_floor);
  appendReady(bytes, XXH3_64bits(bytes.data(), bytes.size()));
  return bytes;
}

std::optional<BedTile> readyTileIn(std::string_view bytes, const BedParameters& bed) {
  std::uint64_t sum = 0;
  if (bytes.size() < kReadyMagic.size() + sizeof sum || !bytes.starts_with(kReadyMagic)) {
    return std::nullopt;
  }
  std::memcpy(&sum, bytes.data() + bytes.size() - sizeof sum, sizeof sum);
  bytes.remove_suffix(sizeof sum);
  if (XXH3_64bits(bytes.data(), bytes.size()) != sum) {
    return std::nullopt;
  }
  bytes.remove_prefix(kReadyMagic.size());
  const BedParameters wanted = tileBed(bed);
  BedTile tile;
  std::vector<char> key;
  double step_m = 0;
  std::vector<TilePair> pairs;
  std::vector<OnFloor> on_floor;
  const bool sound = takeReady(bytes, key) && takeReady(bytes, tile.width_m) && takeReady(bytes, tile.length_m) &&
                     takeReady(bytes, step_m) && takeReady(bytes, tile.grains) && takeReady(bytes, pairs) &&
                     takeReady(bytes, on_floor) && bytes.empty() &&
                     std::string(key.begin(), key.end()) == readyTileKey(bed) && !tile.grains.empty() &&
                     fromBothSides(pairs, step_m, tile);
  if (!sound) {
    return std::nullopt;
  }
  // The numbers of this bed, which may differ in their last digits.
  tile.width_m = wanted.width_m;
  tile.length_m = wanted.length_m;
  if (wanted.soil.friction == FrictionModel::kContact) {
    tile.floor_slips.resize(tile.grains.size());
    for (const auto& [particle, slip] : on_floor) {
      if (particle >= tile.grains.size()) {
        return std::nullopt;
      }
      tile.floor_slips[particle] = slipOfSteps({slip[0], slip[1], 0}, step_m, 1);
    }
  }
  return tile;
}

std::optional<BedTile> readyTile(const BedParameters& bed) {
  const std::string_view bytes = readyTileFile(readyTileName(bed));
  return bytes.empty() ? std::nullopt : readyTileIn(bytes, bed);
}

}  // namespace haptolith
