// What seven scenes come to, bit for bit, on each instruction set (of AMD's processors where nothing else is said).
//
// Bits are a promise: a recording that somebody keeps replays with a later version, and a study that is repeated meets
// the same soil. These numbers change only when physics is changed on purpose, in a commit that says why and what it
// does to measured values, and with a line in CHANGELOG.md; never to make a refactoring pass. To renew them, run
//
//     build/release/tests/scene_file/test_scene_file --gtest_filter='Golden*'
//
// which prints the new hashes where they differ. Numbers that differ between two builds of one source are a bug of the
// build: look there first.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <hwy/detect_targets.h>
#include <hwy/targets.h>
#include <xxhash.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "haptolith/bed/bed_state.h"
#include "haptolith/bed/kernel/simd_target.h"
#include "haptolith/device/hand/virtual_hand.h"
#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/scene_file/scene_file.h"

namespace haptolith {
namespace {

struct Golden {
  const char* name;
  const char* toml;
  double duration_s;                          ///< simulated
  std::map<std::string, std::uint64_t> hash;  ///< by instruction set
};

const Golden kScenes[]{
    {"PaperScoop",
     R"(
[hand]
manoeuvre = "scoop"
)",
     8,
     {{"AVX3", 0x853e971c88b028edU},
      {"AVX2", 0x701758d21de33a58U},
      {"SSE4", 0x59c608acca51a370U},
      {"SSSE3", 0x59c608acca51a370U},
      {"AVX2 (Intel)", 0xfbd8997a9ddff00bU},
      {"SSE4 (Intel)", 0xf41aa077fe32568dU},
      {"SSSE3 (Intel)", 0xf41aa077fe32568dU},
      {"SCALAR", 0x76ffd2bd40d3f779U}}},
    {"PaperStir",
     R"(
[hand]
manoeuvre = "stir"
)",
     8,
     {{"AVX3", 0x29d251383686f1ebU},
      {"AVX2", 0x3101e8619702c032U},
      {"SSE4", 0xd92218c08a179b40U},
      {"SSSE3", 0xd92218c08a179b40U},
      {"AVX2 (Intel)", 0xebe89f834d332181U},
      {"SSE4 (Intel)", 0x76cd4aff0feaeadeU},
      {"SSSE3 (Intel)", 0x76cd4aff0feaeadeU},
      {"SCALAR", 0x38267b3673d193a0U}}},
    {"LunarStir",
     R"(
[soil]
name = "lunar-0-15cm"
[hand]
manoeuvre = "stir"
)",
     4,
     {{"AVX3", 0x63d8104b8dd9dbe9U},
      {"AVX2", 0x70a3677972e60f06U},
      {"SSE4", 0x4acc525a4084b30fU},
      {"SSSE3", 0x4acc525a4084b30fU},
      {"AVX2 (Intel)", 0x45d6285700814cf5U},
      {"SSE4 (Intel)", 0x156578dbce7fecc9U},
      {"SSSE3 (Intel)", 0x156578dbce7fecc9U},
      {"SCALAR", 0x7ae99bbf03d8968cU}}},
    {"SandboxThatSleeps",
     R"(
[bed]
start = "packed"
width_mm = 400
length_mm = 400
depth_mm = 90
[hand]
manoeuvre = "stir"
)",
     4,
     {{"AVX3", 0xa1d9a95e4b9d445fU},
      {"AVX2", 0xc793703ddaa1fda9U},
      {"SSE4", 0x50423769d8c9653eU},
      {"SSSE3", 0x50423769d8c9653eU},
      {"AVX2 (Intel)", 0x414a85d71b24c543U},
      {"SSE4 (Intel)", 0x29b46335390b2cb3U},
      {"SSSE3 (Intel)", 0x29b46335390b2cb3U},
      {"SCALAR", 0x7352134a4f5ce0b3U}}},
    {"Jaws",
     R"(
[soil]
preset = "P4"
friction = "pairwise"
[tool]
shape = "jaws"
size_mm = [50, 40, 5]
opening_mm = 40
[hand]
manoeuvre = "scoop"
depth_mm = 15
)",
     8,
     {{"AVX3", 0x49da71839a64b4c1U},
      {"AVX2", 0x27d80eec30dcc1d8U},
      {"SSE4", 0xa31a718d683d4beaU},
      {"SSSE3", 0xa31a718d683d4beaU},
      {"AVX2 (Intel)", 0xe241114c266e79d4U},
      {"SSE4 (Intel)", 0xad52d93bf83094a6U},
      {"SSSE3 (Intel)", 0xad52d93bf83094a6U},
      {"SCALAR", 0x177d299acbeacf65U}}},
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
manoeuvre = "stir"
)",
     2,
     {{"AVX3", 0x584d742da06b9f8dU},
      {"AVX2", 0xe211a4a43e00648aU},
      {"SSE4", 0xe02a7a990ae4339eU},
      {"SSSE3", 0xe02a7a990ae4339eU},
      {"AVX2 (Intel)", 0x204fed1a16c04fdaU},
      {"SSE4 (Intel)", 0x947026261d985209U},
      {"SSSE3 (Intel)", 0x947026261d985209U},
      {"SCALAR", 0x94414a205fc065d3U}}},
    {"Rain",
     R"(
[bed]
start = "rain"
particles = 300
seed = 7
[hand]
manoeuvre = "stir"
)",
     8,
     {{"AVX3", 0x45723445e747db35U},
      {"AVX2", 0x2d8da8c8cf991ab6U},
      {"SSE4", 0x1324a776c03bc7c3U},
      {"SSSE3", 0x1324a776c03bc7c3U},
      {"AVX2 (Intel)", 0x7acd6d0e8e40e33bU},
      {"SSE4 (Intel)", 0xb52bc6fd26f5cd45U},
      {"SSSE3 (Intel)", 0xb52bc6fd26f5cd45U},
      {"SCALAR", 0xc7f30c39fef9d7c7U}}},
};

void PrintTo(const Golden& golden, std::ostream* out) {
  *out << golden.name;
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
  const std::uint64_t state = scene.bed().hash();
  return fold(hash, &state, sizeof state);
}

/// An instruction set and, where its first guesses of reciprocals and roots are not the same on every processor, whose
/// they are. AVX-512's are laid down to the last bit; those of AVX2 and SSE are their maker's own.
std::string guessesOf(const std::string& target) {
#if HWY_ARCH_X86
  const bool is_makers_own = target == "AVX2" || target == "SSE4" || target == "SSSE3";
  if (is_makers_own && __builtin_cpu_is("intel")) {
    return target + " (Intel)";
  }
#endif
  return target;
}

class GoldenScene : public testing::TestWithParam<Golden> {
 protected:
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
};

TEST_P(GoldenScene, HasTheBitsItAlwaysHad) {
  const Golden& golden = GetParam();
  SceneFile scene_file = loadSceneFileText(golden.toml, golden.name);
  scene_file.loop.paced = false;
  scene_file.loop.duration_s = golden.duration_s;
  int compared = 0;
  for (std::int64_t targets = hwy::SupportedTargets() & HWY_TARGETS; targets != 0; targets &= targets - 1) {
    hwy::SetSupportedTargetsForTest(targets & -targets);
    const std::string target = guessesOf(simdTarget());
    const auto stored = golden.hash.find(target);
    const std::uint64_t hash = outcomeOf(scene_file);
    const std::string row = fmt::format("{{\"{}\", 0x{:x}U}}", target, hash);
    if (stored == golden.hash.end()) {
      fmt::print("{}: no hash of this instruction set has been stored yet: {}\n", golden.name, row);
      continue;
    }
    ++compared;
    EXPECT_EQ(stored->second, hash) << row;
  }
  EXPECT_GT(compared, 0) << "add this machine's instruction sets to the table";
}

/// The soil in each tick of a cut whose way asks nothing of the C library: in a browser without vectors it comes to the
/// same bits. What the tool feels does not always, in the last bits of a double (docs/demo.md).
std::uint64_t outcomeOfStraightCut(const SceneFile& scene_file, int ticks) {
  Scene scene(scene_file.bed, scene_file.tool);
  const double surface_m = scene.bed().surfaceHeight();
  std::uint64_t hash = 0;
  HandState hand;
  for (int tick = 0; tick <= ticks; ++tick) {
    const double share = static_cast<double>(tick) / ticks;
    hand.pose.position_m = Vec3(0.04 * share - 0.02, 0, surface_m + 0.01 - 0.025 * share);
    if (tick == 0) {
      scene.placeTool(hand);
    } else {
      EXPECT_EQ(scene.tick(hand), StepStatus::kOk);
      const std::uint64_t state = scene.bed().hash();
      hash = fold(hash, &state, sizeof state);
    }
  }
  EXPECT_GT(scene.soilWrench().force_n.norm(), 0.05) << "the tool never touched the soil";
  return hash;
}

TEST(GoldenStraightCut, WithoutVectorsHasTheBitsOfABrowserWithoutThem) {
  hwy::SetSupportedTargetsForTest(0);
  if ((hwy::SupportedTargets() & HWY_TARGETS & HWY_SCALAR) == 0) {
    GTEST_SKIP() << "this build has vectors only";
  }
  hwy::SetSupportedTargetsForTest(HWY_SCALAR);
  for (const auto& [soil, golden] :
       {std::pair("preset = \"P3\"", 0xdf808dcaf080cedaU), std::pair("name = \"lunar-0-15cm\"", 0x16b91cf91059c19aU)}) {
    const SceneFile scene_file = loadSceneFileText(fmt::format("[soil]\n{}\n", soil), "cut");
    const std::uint64_t hash = outcomeOfStraightCut(scene_file, 2000);
    EXPECT_EQ(hash, golden) << fmt::format("0x{:x}", hash);
  }
  hwy::SetSupportedTargetsForTest(0);
}

INSTANTIATE_TEST_SUITE_P(Golden, GoldenScene, testing::ValuesIn(kScenes),
                         [](const auto& scene) { return std::string(scene.param.name); });

}  // namespace
}  // namespace haptolith
