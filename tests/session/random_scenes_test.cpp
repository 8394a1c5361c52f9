// Scenes of valid numbers run, or are refused with the key that is wrong: never a crash, never a force that is no
// number.

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/scene_file/scene_file_keys.h"
#include "haptolith/session/session.h"

namespace haptolith {
namespace {

constexpr double kDuration_s = 0.03;

/// Keys that need a file or a device, or that say nothing about what is computed.
bool isLeftOut(const SceneFileKey& key) {
  constexpr std::array<std::string_view, 3> kTables = {"", "names", "device"};
  constexpr std::array<std::string_view, 8> kNames = {"duration_s", "real_time", "cpu",        "threads",
                                                      "poses",      "file",      "ready_made", "mesh"};
  return std::ranges::find(kTables, key.table) != kTables.end() || std::ranges::find(kNames, key.name) != kNames.end();
}

/// Valid scenes that take too long for a test: a billion particles, beds that settle for minutes.
double mostOf(const SceneFileKey& key) {
  if (key.table == "bed" && (key.name == "particles" || key.name == "layers")) {
    return key.name == "particles" ? 1500 : 10;
  }
  if (key.table == "bed" && key.name.ends_with("_mm")) {
    return 200;
  }
  if (key.table == "stones" && key.name == "count") {
    return 40;
  }
  return 1e9;
}

class Draw {
 public:
  explicit Draw(unsigned seed) : random_(seed) {}

  int below(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }

  /// One of the ends, something near 0, or any number between, evenly in its logarithm.
  double number(const Range& valid, double most) {
    const double low = std::max(valid.lowest, -most), high = std::max(low, std::min(valid.highest, most));
    const int kind = below(6);
    double value = kind == 0 ? low : kind == 1 ? high : std::exp(std::uniform_real_distribution(-7.0, 7.0)(random_));
    if (kind == 2) {
      value = -value;
    }
    value = std::clamp(value, low, high);
    return valid.contains(value) ? value : std::nextafter(std::nextafter(value, 1.0), 1.0);
  }

  /// "0.25", `true`, `'rain'` or "[1, 2, 3]" for a key; empty for one that takes a file or bytes.
  std::string valueFor(const SceneFileKey& key) {
    const double most = mostOf(key);
    if (const auto* n = std::get_if<SceneFileKey::NumberValue>(&key.value)) {
      return fmt::format("{}", number(n->valid, most));
    }
    if (const auto* n = std::get_if<SceneFileKey::CountValue>(&key.value)) {
      return fmt::format("{}", std::llround(number(n->valid, most)));
    }
    if (const auto* n = std::get_if<SceneFileKey::VectorValue>(&key.value)) {
      return fmt::format("[{}, {}, {}]", number(n->valid, most), number(n->valid, most), number(n->valid, most));
    }
    if (const auto* n = std::get_if<SceneFileKey::WordValue>(&key.value)) {
      const std::string_view word = n->valid[static_cast<std::size_t>(below(static_cast<int>(n->valid.size())))];
      return word == "poses" || word == "given" || word == "mesh" ? "" : fmt::format("{}", word);
    }
    if (std::holds_alternative<SceneFileKey::SwitchValue>(key.value)) {
      return below(2) == 0 ? "false" : "true";
    }
    return "";
  }

  std::string overrideText() {
    for (;;) {
      const auto keys = sceneFileKeys();
      const SceneFileKey& key = keys[static_cast<std::size_t>(below(static_cast<int>(keys.size())))];
      const std::string value = isLeftOut(key) ? "" : valueFor(key);
      if (!value.empty()) {
        return fmt::format("{}.{}={}", key.table, key.name, value);
      }
    }
  }

 private:
  std::mt19937 random_;
};

TEST(RandomScenes, RunOrAreRefusedWithTheirKey) {
  // HAPTOLITH_RANDOM_SCENES=2000, or 400-2000 to continue.
  const char* wanted = std::getenv("HAPTOLITH_RANDOM_SCENES");  // NOLINT(concurrency-mt-unsafe): no thread yet
  const std::string_view range = wanted != nullptr ? wanted : "40";
  const std::size_t dash = range.find('-');
  const int first = dash == range.npos ? 0 : std::atoi(std::string(range.substr(0, dash)).c_str());
  const int scenes = std::atoi(std::string(range.substr(dash == range.npos ? 0 : dash + 1)).c_str());
  int ran = 0;
  for (int number = first; number < scenes; ++number) {
    Draw draw(static_cast<unsigned>(number));
    std::vector<std::string> overrides;
    for (int i = draw.below(4); i >= 0; --i) {
      overrides.push_back(draw.overrideText());
    }
    const char* base =
        std::array{"stones", "sandbox", "icra2021"}[static_cast<std::size_t>(std::min(2, draw.below(8)))];
    if (std::string_view(base) != "icra2021") {  // small, so that it settles soon
      overrides.insert(overrides.begin(), {"soil.radius_mm=7", "bed.width_mm=100", "bed.length_mm=100"});
      std::ranges::stable_sort(overrides);
      const auto table = [](const std::string& text) { return text.substr(0, text.find('=')); };
      overrides.erase(std::ranges::unique(overrides, {}, table).begin(), overrides.end());
    }
    const std::string told =
        fmt::format("{} of {}: {} --set {}", number, scenes, base, fmt::join(overrides, " --set "));
    SCOPED_TRACE(told);
    if (wanted != nullptr) {
      fmt::print("{}\n", told);
      std::fflush(stdout);
    }
    try {
      SceneFile scene_file = findSceneFile(base, overrides);
      scene_file.loop.real_time = false;
      scene_file.loop.duration_s = kDuration_s;
      Session session(scene_file, false);
      std::atomic<bool> stop{false};
      session.start(stop);
      const LoopEnd end = session.join();
      EXPECT_NE(end, LoopEnd::kNotFinite);
      session.update();
      EXPECT_TRUE(session.snapshot().device_wrench.force_n.allFinite());
      ++ran;
    } catch (const InvalidParameter& refused) {
      EXPECT_THAT(refused.what(),
                  testing::ContainsRegex("[a-z0-9_]+ = .* is not valid: must be|cannot both|has no effect: it needs"))
          << refused.what();
    } catch (const Failure& failure) {
      EXPECT_THAT(failure.what(), testing::HasSubstr("settle")) << failure.what();
    }
  }
  EXPECT_GT(ran, (scenes - first) / 3) << "most of what is valid alone is valid together";
}

}  // namespace
}  // namespace haptolith
