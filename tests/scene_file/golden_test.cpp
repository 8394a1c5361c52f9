// What seven scenes come to, bit for bit, on all instruction sets of a set of bits (simd_target.h).
//
// Bits are a promise: a recording that somebody keeps replays with a later version, and a study that is repeated meets
// the same soil. These numbers change only when physics is changed on purpose, in a commit that says why and what it
// does to measured values, and with a line in CHANGELOG.md; never to make a refactoring pass. `./dev hashes` renews
// tests/data/reference_hashes.csv, and prints what has changed. Numbers that differ between two builds of one source,
// two machines or two instruction sets of a row are a bug: look there first.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <hwy/detect_targets.h>
#include <hwy/targets.h>
#include <xxhash.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <ostream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "haptolith/bed/bed_state.h"
#include "haptolith/bed/kernel/simd_target.h"
#include "haptolith/device/hand/virtual_hand.h"
#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/scene_file/scene_file.h"

#include "../source_dir.h"

namespace haptolith {
namespace {

struct Golden {
  const char* name;
  const char* toml;
  double duration_s;  ///< simulated
};

const Golden kScenes[]{
    {"Icra2021Scoop",
     R"(
[hand]
motion = "scoop"
)",
     8},
    {"Icra2021Stir",
     R"(
[hand]
motion = "stir"
)",
     8},
    {"LunarStir",
     R"(
[soil]
name = "lunar-0-15cm"
[hand]
motion = "stir"
)",
     4},
    {"SandboxThatSleeps",
     R"(
[bed]
start = "packed"
width_mm = 400
length_mm = 400
depth_mm = 90
[hand]
motion = "stir"
)",
     4},
    {"Jaws",
     R"(
[soil]
preset = "P4"
friction_model = "contact"
[tool]
shape = "jaws"
size_mm = [50, 40, 5]
opening_mm = 40
[hand]
motion = "scoop"
depth_mm = 15
)",
     8},
    {"Stones",
     R"(
[soil]
name = "lunar-0-15cm"
[bed]
start = "packed"
depth_mm = 40
sleep_speed_m_s = 0.01
sleep_distance_mm = 0.07
[stones]
count = 4
smallest_mm = 20
largest_mm = 40
[hand]
motion = "stir"
)",
     2},
    {"Rain",
     R"(
[bed]
start = "rain"
particles = 300
seed = 7
[hand]
motion = "stir"
)",
     8},
};

void PrintTo(const Golden& golden, std::ostream* out) {
  *out << golden.name;
}

/// A row of tests/data/reference_hashes.csv.
struct ReferenceHash {
  std::string scene;
  std::string arithmetic;
  std::string hash;
};

std::filesystem::path referenceFile() {
  return sourceDir() / "tests" / "data" / "reference_hashes.csv";
}

std::vector<ReferenceHash> readReferenceHashes() {
  std::ifstream file(referenceFile());
  std::vector<ReferenceHash> rows;
  std::string line;
  std::getline(file, line);  // names of columns
  ReferenceHash row;
  while (std::getline(file, row.scene, ',') && std::getline(file, row.arithmetic, ',') &&
         std::getline(file, row.hash)) {
    rows.push_back(row);
  }
  return rows;
}

/// Replaces the row of this scene and instruction set, or adds it after the scene's others.
void writeReferenceHash(const ReferenceHash& renewed) {
  std::vector<ReferenceHash> rows = readReferenceHashes();
  auto place = rows.end();
  for (auto row = rows.begin(); row != rows.end(); ++row) {
    if (row->scene == renewed.scene) {
      place = std::next(row);
      if (row->arithmetic == renewed.arithmetic) {
        place = rows.erase(row);
        break;
      }
    }
  }
  rows.insert(place, renewed);
  std::ofstream file(referenceFile());
  file << "scene,arithmetic,hash\n";
  for (const ReferenceHash& row : rows) {
    file << row.scene << ',' << row.arithmetic << ',' << row.hash << '\n';
  }
}

/// Expects the stored hash. If HAPTOLITH_RENEW_HASHES is set, stores the hash of the first instruction set of a set of
/// bits, and expects it of the others.
void expectReferenceHash(const std::string& scene, std::uint64_t hash) {
  const std::string now = fmt::format("{:#018x}", hash);
  const std::string bits = arithmetic();
  static std::set<std::pair<std::string, std::string>> renewed;
  if (std::getenv("HAPTOLITH_RENEW_HASHES") != nullptr && renewed.emplace(scene, bits).second) {
    writeReferenceHash({scene, bits, now});
  }
  const std::vector<ReferenceHash> rows = readReferenceHashes();
  const auto stored = std::ranges::find_if(
      rows, [&](const ReferenceHash& row) { return row.scene == scene && row.arithmetic == bits; });
  EXPECT_EQ(stored == rows.end() ? "none" : stored->hash, now) << simdTarget();
}

std::uint64_t fold(std::uint64_t hash, const void* data, std::size_t bytes) {
  return XXH3_64bits_withSeed(data, bytes, hash);
}

/// The soil, the tool and each force that the hand was given.
std::uint64_t outcomeOf(const SceneFile& scene_file) {
  Scene scene(scene_file.bed, scene_file.tool);
  const double surface_m = scene.bed().surfaceHeight();
  HandParameters hand_parameters = scene_file.hand;
  hand_parameters.surface_m = surface_m;
  VirtualHand hand(hand_parameters, scene_file.bed.tick_s);
  HapticLoop loop(scene, hand, scene_file.loop, true, handlingOf(scene_file, surface_m));
  std::vector<TickRecord> records;
  std::uint64_t hash = 0;
  const int ticks = static_cast<int>(scene_file.loop.duration_s / scene_file.loop.tick_s);
  double strongest_n = 0;
  for (int tick = 0; tick < ticks; ++tick) {
    EXPECT_EQ(loop.tick(), LoopEnd::kRunning);
    records.clear();
    loop.takeRecords(records);
    for (const TickRecord& record : records) {
      const Vec3& force_n = record.sent.wrench.force_n;
      const Vec3& torque_nm = record.sent.wrench.torque_nm;
      hash = fold(hash, force_n.data(), sizeof(double) * 3);
      hash = fold(hash, torque_nm.data(), sizeof(double) * 3);
      strongest_n = std::max(strongest_n, force_n.norm());
    }
  }
  EXPECT_GT(strongest_n, 0.05) << "the tool never touched the soil";
  const std::uint64_t state = scene.hash();
  return fold(hash, &state, sizeof state);
}

class GoldenScene : public testing::TestWithParam<Golden> {
 protected:
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
};

TEST_P(GoldenScene, HasTheBitsItAlwaysHad) {
  const Golden& golden = GetParam();
  SceneFile scene_file = loadSceneFileText(golden.toml, golden.name);
  scene_file.loop.real_time = false;
  scene_file.loop.duration_s = golden.duration_s;
  for (std::int64_t targets = hwy::SupportedTargets() & HWY_TARGETS; targets != 0; targets &= targets - 1) {
    hwy::SetSupportedTargetsForTest(targets & -targets);
    expectReferenceHash(golden.name, outcomeOf(scene_file));
  }
}

INSTANTIATE_TEST_SUITE_P(Golden, GoldenScene, testing::ValuesIn(kScenes),
                         [](const auto& scene) { return std::string(scene.param.name); });

}  // namespace
}  // namespace haptolith
