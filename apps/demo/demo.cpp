// Runs a scene in a web worker, with the session, loop and view of the program. The functions that the worker calls
// from JavaScript (web/src/demo/worker.ts) are at the end. No function blocks, because the worker has one thread.

#include <emscripten.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "haptolith/bed/kernel/simd_target.h"
#include "haptolith/bed/start/ready_tile.h"
#include "haptolith/bed/start/tile_cache.h"
#include "haptolith/core/error.h"
#include "haptolith/device/hand/virtual_hand.h"
#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/machine/finest_grain.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/session/session.h"
#include "haptolith/viewer/live_view.h"

#include "page_server.h"

// clang-format off
EM_JS(void, postToPage, (const char* bytes, size_t size, int binary), {
  Module['toPage'](HEAPU8.slice(bytes, bytes + size), binary);
});
EM_JS(void, tellSettling, (double settled_s), {
  Module['settling'](settled_s);
});
// clang-format on

namespace haptolith::demo {

namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

/// Max. computing time of the soil before messages of the page are processed.
constexpr auto kLongestTurn = 12ms;
/// Max. delay that is caught up. A slow or suspended machine skips the rest, so the soil moves in slow motion.
constexpr double kMostBehind_s = 0.03;
/// Delay before a bed is created, so that the page can show it. Bed creation blocks the worker.
constexpr auto kBeforeMaking = 300ms;

class Demo {
 public:
  Demo(SceneFile base, SceneFile scene_file)
      : base_(std::move(base)),
        session_(asFastAsPossible(std::move(scene_file)), false,
                 [](double settled_s, double) {
                   tellSettling(settled_s);
                   return true;
                 }),
        view_(session_, {.takes_uploads = true}, HAPTOLITH_VERSION, {}) {}

  /// Returns the changes of the current scene from the named one: see overridesOf().
  [[nodiscard]] std::string changes() const;

  /// Advances the soil to the current time, and updates the page. @return whether the scene continues.
  bool turn(double now_s) {
    const double before_s = std::exchange(last_s_, now_s);
    const double passed_s = before_s < 0 ? 0 : now_s - before_s;
    if (end_ == LoopEnd::kRunning) {
      behind_s_ = std::min(kMostBehind_s, behind_s_ + passed_s * session_.speed());
      tickUntil(Clock::now() + kLongestTurn);
    }
    view_.handleMessages();
    const bool changed = mayMake() && session_.poll();
    const bool newer = session_.update();
    view_.show(newer, changed);
    return end_ == LoopEnd::kRunning;
  }

 private:
  static SceneFile asFastAsPossible(SceneFile scene_file) {
    scene_file.loop.real_time = false;  // the worker paces it
    scene_file.bed.threads = 1;
    return scene_file;
  }

  void tickUntil(Clock::time_point until) {
    const double tick_s = session_.sceneFile().loop.tick_s;
    for (; behind_s_ >= tick_s && end_ == LoopEnd::kRunning; behind_s_ -= tick_s) {
      end_ = session_.loop().tick();
      if (Clock::now() >= until) {
        return;
      }
    }
    if (end_ != LoopEnd::kRunning) {
      session_.loop().publishEnd(end_);
    }
  }

  /// Whether the page had time to show that a bed is being created.
  bool mayMake() {
    const Clock::time_point now = Clock::now();
    if (session_.busy().empty()) {
      idle_at_ = now;
    }
    return session_.busy().empty() || now - idle_at_ > kBeforeMaking;
  }

  SceneFile base_;
  Session session_;
  LiveView view_;
  LoopEnd end_ = LoopEnd::kRunning;
  double behind_s_ = 0;
  double last_s_ = -1;  ///< time of the last turn(); negative: none yet
  Clock::time_point idle_at_;
};

std::unique_ptr<Demo> demo;
std::string told;

/// Returns the hash of the program's golden test: each force on the hand, and the final soil.
std::string outcomeOf(SceneFile scene_file, int ticks) {
  scene_file.loop.real_time = false;
  Scene scene(scene_file.bed, scene_file.tool);
  const double surface_m = scene.bed().surfaceHeight();
  scene_file.hand.surface_m = surface_m;
  VirtualHand hand(scene_file.hand, scene_file.bed.tick_s);
  HapticLoop loop(scene, hand, scene_file.loop, true, handlingOf(scene_file, surface_m));
  std::vector<TickRecord> records;
  std::uint64_t hash = 0;
  const auto fold = [&hash](const void* data, std::size_t bytes) { hash = XXH3_64bits_withSeed(data, bytes, hash); };
  const Clock::time_point begun = Clock::now();
  for (int tick = 0; tick < ticks; ++tick) {
    if (loop.tick() != LoopEnd::kRunning) {
      throw Failure("the run ended early");
    }
    records.clear();
    loop.takeRecords(records);
    for (const TickRecord& record : records) {
      fold(record.sent.wrench.force_n.data(), sizeof(double) * 3);
      fold(record.sent.wrench.torque_nm.data(), sizeof(double) * 3);
    }
  }
  const double took_s = std::chrono::duration<double>(Clock::now() - begun).count();
  const std::uint64_t state = scene.hash();
  fold(&state, sizeof state);
  return fmt::format("0x{:x} {:.1f}", hash, 1e6 * took_s / ticks);
}

/// Runs `work`; stores the reason of a failure in `told`, empty on success.
template <class Work>
const char* tell(Work work) {
  try {
    told.clear();
    work();
  } catch (const std::exception& error) {
    told = error.what();
  }
  return told.c_str();
}

/// Scene that one thread of a browser can run in time. The program's scenes are also opened by name on request.
struct DemoScene {
  std::string_view name, of;
};
const std::vector<DemoScene>& demoScenes() {
  static const std::vector<DemoScene> kScenes{
      {"moon", "auto"}, {"icra2021", "icra2021"}, {"rain", "rain"}, {"jaws", "jaws"}, {"sandbox", "sandbox"},
  };
  return kScenes;
}

/// Selects the finest particles that this browser's worker computes in time, measured once.
SceneFile fitted(SceneFile scene_file) {
  static const double radius_m = [&] {
    constexpr std::array kOneThread{1};
    const std::atomic<bool> never{false};
    return finestGrain(scene_file.bed, scene_file.tool, {.real_time = false}, kOneThread, never).chosen.radius_m;
  }();
  scene_file.bed.soil = rescaled(scene_file.bed.soil, radius_m);
  return scene_file;
}

SceneFile sceneNamed(std::string_view name) {
  const auto scene = std::ranges::find(demoScenes(), name, &DemoScene::name);
  const std::string_view of = scene == demoScenes().end() ? name : scene->of;
  return of == "auto" ? fitted(findSceneFile(of)) : findSceneFile(of);
}

/// Returns a scene with changes. @param changes  result of overridesOf(): one "table.key=value" per line.
SceneFile sceneOf(std::string_view name, std::string_view changes) {
  SceneFile scene_file = sceneNamed(name);
  std::vector<std::string> overrides;
  while (!changes.empty()) {
    const std::size_t end = std::min(changes.find('\n'), changes.size());
    overrides.emplace_back(changes.substr(0, end));
    changes.remove_prefix(std::min(end + 1, changes.size()));
  }
  // As numbers, so that changes do not contradict a name.
  return overrides.empty() ? scene_file : sceneFileFromText(sceneFileText(scene_file), "this address", overrides);
}

/// Returns the lines of a scene's text, each as "table.key=value".
std::vector<std::string> settingsOf(const SceneFile& scene_file) {
  std::vector<std::string> settings;
  std::string table;
  std::istringstream text(sceneFileText(scene_file));
  for (std::string line; std::getline(text, line);) {
    const std::size_t equals = line.find(" = ");
    if (line.starts_with('[')) {
      table = line.starts_with("[[") ? "" : line.substr(1, line.find(']') - 1);
    } else if (!table.empty() && equals != std::string::npos) {
      settings.push_back(table + "." + line.substr(0, equals) + "=" + line.substr(equals + 3));
    }
  }
  return settings;
}

/// Returns the changes from `base` to `now` that fit into an address; particles and mesh files do not.
std::string overridesOf(const SceneFile& base, const SceneFile& now) {
  constexpr std::size_t kLongest = 200;
  const std::vector<std::string> before = settingsOf(base);
  std::string changes;
  for (const std::string& setting : settingsOf(now)) {
    if (std::ranges::find(before, setting) == before.end() && setting.size() <= kLongest) {
      changes += setting + "\n";
    }
  }
  return changes;
}

std::string Demo::changes() const {
  SceneFile now = session_.sceneFile();
  now.loop = base_.loop;  // the loop belongs to the worker
  now.bed.threads = base_.bed.threads;
  now.hand.surface_m = base_.hand.surface_m;
  now.hand.motion = session_.motion();
  return overridesOf(base_, now);
}

}  // namespace

}  // namespace haptolith::demo

using haptolith::demo::page;

// Functions for JavaScript. A returned text is the reason of a failure; empty: success.
extern "C" {

/// Returns the available scenes, as JSON: name, title.
EMSCRIPTEN_KEEPALIVE const char* demoScenes() {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const auto& scene : haptolith::demo::demoScenes()) {
    list.push_back({{"name", scene.name}, {"title", haptolith::findSceneFile(scene.of).title}});
  }
  haptolith::demo::told = list.dump();
  return haptolith::demo::told.c_str();
}

/// Returns the name of the file with the settled soil of a scene; empty: it needs none. The file is read from /tiles;
/// newly settled soil is written there.
EMSCRIPTEN_KEEPALIVE const char* demoTile(const char* scene, const char* changes) {
  std::string name;
  const char* failed = haptolith::demo::tell([&] {
    const haptolith::SceneFile scene_file = haptolith::demo::sceneOf(scene, changes);
    const haptolith::BedParameters& bed = scene_file.bed;
    name = bed.start != haptolith::BedStart::kSettled ? ""
           : bed.ready_made                           ? haptolith::readyTileName(bed)
                                                      : haptolith::tileFileName(bed);
  });
  haptolith::demo::told = *failed == '\0' ? name : "";
  return haptolith::demo::told.c_str();
}

/// Opens a scene by name, one of demoScenes() or of the program, with changes from demoChanges().
EMSCRIPTEN_KEEPALIVE const char* demoOpen(const char* scene, const char* changes) {
  return haptolith::demo::tell([&] {
    haptolith::useTileCache("/tiles");
    page().post = [](const std::string& bytes, bool binary) { postToPage(bytes.data(), bytes.size(), binary ? 1 : 0); };
    haptolith::SceneFile scene_file = haptolith::demo::sceneOf(scene, changes);
    haptolith::demo::demo.reset();
    haptolith::demo::demo =
        std::make_unique<haptolith::demo::Demo>(haptolith::demo::sceneNamed(scene), std::move(scene_file));
    page().come();
  });
}

/// Returns the changes of the current scene from the named one, one per line.
EMSCRIPTEN_KEEPALIVE const char* demoChanges() {
  std::string changes;
  const char* failed = haptolith::demo::tell([&] { changes = haptolith::demo::demo->changes(); });
  haptolith::demo::told = *failed == '\0' ? changes : "";
  return haptolith::demo::told.c_str();
}

/// Advances to the current time, in s. Returns false when the scene has ended.
EMSCRIPTEN_KEEPALIVE bool demoTurn(double now_s) {
  return haptolith::demo::demo->turn(now_s);
}

EMSCRIPTEN_KEEPALIVE void demoHear(const char* text) {
  page().sent(text);
}

EMSCRIPTEN_KEEPALIVE void demoTook() {
  page().took();
}

EMSCRIPTEN_KEEPALIVE double demoTakeFile(const char* bytes, std::size_t size) {
  return page().brought(std::string(bytes, size));
}

EMSCRIPTEN_KEEPALIVE const char* demoArithmetic() {
  return haptolith::arithmetic();
}

/// Returns the hash of tests/scene_file/golden_test.cpp for a scene's text after a number of ticks, and the duration of
/// one in us. On failure the reason.
EMSCRIPTEN_KEEPALIVE const char* demoOutcome(const char* scene, int ticks) {
  std::string outcome;
  const char* failed = haptolith::demo::tell(
      [&] { outcome = haptolith::demo::outcomeOf(haptolith::loadSceneFileText(scene, "scene"), ticks); });
  if (*failed == '\0') {
    haptolith::demo::told = outcome;
  }
  return haptolith::demo::told.c_str();
}

}  // extern "C"
