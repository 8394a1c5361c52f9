#include "haptolith/bed/start/tile_cache.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

BedParameters smallBed() {
  BedParameters bed;
  bed.soil = findPreset("P3").soil;
  bed.soil.friction = FrictionModel::kContact;
  bed.start = BedStart::kSettled;
  bed.width_m = bed.length_m = 0.3;
  bed.depth_m = 0.025;
  return bed;
}

class TileCache : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "haptolith-tiles-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
    use(folder_);
  }
  void TearDown() override {
    useTileCache({});
    fs::remove_all(folder_);
  }
  void use(const fs::path& folder) {
    useTileCache(folder, [this](std::string_view line) { told_.emplace_back(line); });
  }
  /// Whether the tile had to settle.
  bool settles(const BedParameters& bed) {
    bool settled = false;
    tile_ = cachedTile(bed, [&](double, double) { return settled = true; });
    return settled;
  }
  [[nodiscard]] fs::path file() const { return folder_ / tileFileName(smallBed()); }
  void change(std::streamoff at, char to) const {
    std::fstream(file(), std::ios::in | std::ios::out | std::ios::binary).seekp(at).put(to);
  }

  fs::path folder_;
  std::vector<std::string> told_;
  BedTile tile_;
};

TEST_F(TileCache, SettlesATileOnceAndGivesItBackBitForBit) {
  EXPECT_TRUE(settles(smallBed()));
  const Bed made(smallBed());
  EXPECT_FALSE(settles(smallBed()));
  useTileCache({});
  const Bed without(smallBed());
  EXPECT_EQ(stateHash(made.state()), stateHash(without.state()));
  EXPECT_THAT(told_, IsEmpty());
}

TEST_F(TileCache, MakesAFolderThatIsNotThere) {
  use(folder_ / "a" / "b");
  EXPECT_TRUE(settles(smallBed()));
  EXPECT_FALSE(settles(smallBed()));
}

TEST_F(TileCache, MakesADamagedTileAnewAndSaysSo) {
  ASSERT_TRUE(settles(smallBed()));
  const auto size = static_cast<std::streamoff>(fs::file_size(file()));
  for (const std::streamoff at : {std::streamoff{0}, std::streamoff{40}, size / 2, size - 1}) {
    told_.clear();
    change(at, '\x5a');
    EXPECT_TRUE(settles(smallBed())) << at;
    EXPECT_THAT(told_, ElementsAre(HasSubstr("is damaged or for another soil")));
    EXPECT_FALSE(settles(smallBed()));
  }
  for (const std::uintmax_t left : {std::uintmax_t{0}, std::uintmax_t{10}, static_cast<std::uintmax_t>(size - 1)}) {
    fs::resize_file(file(), left);
    EXPECT_TRUE(settles(smallBed())) << left;
  }
}

TEST_F(TileCache, MakesAForeignTileAnew) {
  ASSERT_TRUE(settles(smallBed()));
  BedParameters other = smallBed();
  other.seed = 2;
  fs::copy_file(file(), folder_ / tileFileName(other));
  EXPECT_TRUE(settles(other));
  EXPECT_THAT(told_, ElementsAre(HasSubstr("for another soil")));
}

TEST_F(TileCache, MakesTheBedWithoutAFolderThatCannotBeWritten) {
  std::ofstream(folder_ / "file") << "in the way";
  use(folder_ / "file");
  EXPECT_TRUE(settles(smallBed()));
  EXPECT_TRUE(settles(smallBed()));
  EXPECT_THAT(told_, testing::Each(HasSubstr("soil settles again in each run")));
  EXPECT_FALSE(told_.empty());
}

TEST_F(TileCache, MakesTheBedThoughTheDiskIsFull) {
  // A limit of the file size acts on write() like a full disk, once its signal is ignored.
  rlimit usual{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &usual), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit little{10'000, usual.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &little), 0);
  const bool settled = settles(smallBed());
  setrlimit(RLIMIT_FSIZE, &usual);
  std::signal(SIGXFSZ, handler);
  EXPECT_TRUE(settled);
  EXPECT_FALSE(tile_.grains.empty());
  EXPECT_THAT(told_, ElementsAre(HasSubstr("cannot write")));
  EXPECT_TRUE(fs::is_empty(folder_));  // nothing half written stays
}

TEST_F(TileCache, NeitherReadsNorReplacesWhatIsNoFile) {
  fs::create_directory(file());
  EXPECT_TRUE(settles(smallBed()));
  EXPECT_TRUE(fs::is_directory(file()));
  EXPECT_EQ(told_.size(), 2U);
}

TEST_F(TileCache, KeyHoldsAllThatATileDependsOnAndNothingElse) {
  const std::string key = tileKey(smallBed());
  const auto differs = [&](auto change) {
    BedParameters bed = smallBed();
    change(bed);
    return tileKey(bed) != key;
  };
  EXPECT_TRUE(differs([](BedParameters& b) { b.seed = 2; }));
  EXPECT_TRUE(differs([](BedParameters& b) { b.depth_m *= 1.001; }));
  EXPECT_TRUE(differs([](BedParameters& b) { b.gravity_m_s2 *= 1.001; }));
  EXPECT_TRUE(differs([](BedParameters& b) { b.tick_s *= 0.5; }));
  EXPECT_TRUE(differs([](BedParameters& b) { b.soil.friction = FrictionModel::kIcra2021; }));
  for (const SoilNumber& number : kSoilNumbers) {
    const auto change = [&](BedParameters& b) { b.soil.*number.member = 1.001 * b.soil.*number.member + 1e-4; };
    EXPECT_TRUE(differs(change)) << number.key;
  }
  EXPECT_TRUE(differs([](BedParameters& b) { b.periodic_x = true; }));
  EXPECT_FALSE(differs([](BedParameters& b) { b.width_m *= 3; }));
  EXPECT_FALSE(differs([](BedParameters& b) { b.threads = 2; }));
  EXPECT_FALSE(differs([](BedParameters& b) { b.wall_friction_ratio = 0; }));
  EXPECT_FALSE(differs([](BedParameters& b) { b.sleep_speed_m_s = 1e-3; }));
  EXPECT_FALSE(differs([](BedParameters& b) { b.sleep_distance_m = 1e-3; }));
}

TEST_F(TileCache, SettlesGrainsOfSeveralSizesOnceAndGivesThemBackBitForBit) {
  BedParameters bed;
  bed.soil = findPreset("P3").soil;
  bed.soil.friction = FrictionModel::kContact;
  bed.start = BedStart::kRain;
  bed.particles = 100;
  bed.grading.fine_radius_m = bed.soil.radius_m / 2;
  bed.grading.fine_width_m = bed.grading.fine_length_m = 0.04;
  bed.grading.fine_depth_m = 0.015;
  // It settles for long, and builds up friction each time it is made, reported in the same way.
  const auto looks = [](const BedParameters& wanted, std::uint64_t& hash) {
    int count = 0;
    hash = stateHash(Bed(wanted, [&](double, double) { return ++count > 0; }).state());
    return count;
  };
  std::uint64_t made = 0;
  std::uint64_t kept = 0;
  const int at_first = looks(bed, made);
  const int again = looks(bed, kept);
  EXPECT_LT(again, at_first / 4);
  EXPECT_EQ(made, kept);
  useTileCache({});
  EXPECT_EQ(looks(bed, kept), at_first);
  EXPECT_EQ(made, kept);
  use(folder_);
  bed.grading.fine_depth_m = 0.014;
  EXPECT_GT(looks(bed, kept), 2 * again);
  EXPECT_THAT(told_, IsEmpty());
}

}  // namespace
}  // namespace haptolith
