#include "haptolith/bed/start/ready_tile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "haptolith/bed/bed.h"
#include "haptolith/bed/critical_step.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

/// Shallow, so that its tile settles in a second.
BedParameters shallowBed() {
  BedParameters bed;
  bed.soil = findPreset("P3").soil;
  bed.soil.friction = FrictionModel::kContact;
  bed.soil.size_spread = 0.1;
  bed.soil.contact_cohesion_n = 2e-3;
  bed.start = BedStart::kSettled;
  bed.width_m = bed.length_m = 0.3;
  bed.depth_m = 0.025;
  return bed;
}

TEST(ReadyTile, IsReadBackWithEachContactFromBothSides) {
  const BedTile tile = settledTile(shallowBed(), {});
  const std::string bytes = readyTileBytes(tile, shallowBed());
  const std::optional<BedTile> read = readyTileIn(bytes, shallowBed());
  ASSERT_TRUE(read);
  ASSERT_EQ(read->grains.size(), tile.grains.size());
  EXPECT_EQ(read->width_m, tile.width_m);
  EXPECT_EQ(read->firsts, tile.firsts);
  double largest_m = 0;
  for (const TileContact& contact : tile.contacts) {
    largest_m = std::max({largest_m, std::abs(double{contact.slip.x}), std::abs(double{contact.slip.z})});
  }
  for (std::size_t i = 0; i < tile.grains.size(); ++i) {
    EXPECT_EQ(read->grains[i].x, tile.grains[i].x);
    EXPECT_EQ(read->grains[i].w, tile.grains[i].w);
    EXPECT_NEAR(read->floor_slips[i].x, tile.floor_slips[i].x, 1e-4 * largest_m);
    for (std::uint32_t at = tile.firsts[i]; at < tile.firsts[i + 1]; ++at) {
      const TileContact& contact = tile.contacts[at];
      const auto found =
          std::find_if(read->contacts.begin() + read->firsts[i], read->contacts.begin() + read->firsts[i + 1],
                       [&](const TileContact& c) { return c.other == contact.other; });
      ASSERT_NE(found, read->contacts.begin() + read->firsts[i + 1]);
      EXPECT_NEAR(found->slip.x, contact.slip.x, 1e-4 * largest_m);
      EXPECT_NEAR(found->slip.y, contact.slip.y, 1e-4 * largest_m);
      EXPECT_NEAR(found->slip.z, contact.slip.z, 1e-4 * largest_m);
    }
  }
}

TEST(ReadyTile, IsNotReadWhenDamagedOrOfAnotherBed) {
  const std::string bytes = readyTileBytes(settledTile(shallowBed(), {}), shallowBed());
  BedParameters other = shallowBed();
  other.seed = 2;
  EXPECT_FALSE(readyTileIn(bytes, other));
  EXPECT_NE(readyTileName(other), readyTileName(shallowBed()));
  for (std::size_t at = 0; at < bytes.size(); at += bytes.size() / 50) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] + 1);
    EXPECT_FALSE(readyTileIn(damaged, shallowBed())) << at;
    EXPECT_FALSE(readyTileIn(bytes.substr(0, at), shallowBed())) << at;
  }
}

TEST(ReadyTile, DoesNotDependOnLastDigits) {
  BedParameters bed = shallowBed();
  bed.soil = rescaled(rescaled(bed.soil, 3.3e-3), bed.soil.radius_m);
  bed.depth_m = std::nextafter(bed.depth_m, 1);
  EXPECT_EQ(readyTileName(bed), readyTileName(shallowBed()));
}

TEST(ReadyTile, WhereNoneShipsTheSoilSettlesHere) {
  BedParameters bed = shallowBed();
  EXPECT_FALSE(readyTile(bed));
  const Bed settled(bed);
  bed.ready_made = true;
  const Bed asked_for(bed);
  EXPECT_EQ(stateHash(asked_for.state()), stateHash(settled.state()));
}

}  // namespace
}  // namespace haptolith
