#include <CLI/App.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/files/atomic_file.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/scene_file/scene_words.h"
#include "haptolith/session/session.h"
#include "haptolith/viewer/headless_browser.h"
#include "haptolith/viewer/live_view.h"

#include "commands.h"
#include "run/film_file.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/overwrite.h"
#include "shared/scene_options.h"
#include "shared/stop_on_signal.h"

namespace haptolith {

namespace {

using namespace std::chrono_literals;

constexpr const char* kSnapshotExamples = R"(Examples:
  haptolith snapshot --motion scoop --out view.png          lunar soil after two seconds
  haptolith snapshot --at-s 3.5 --theme light --no-panels --out bed.png
  haptolith snapshot --body Mars --colour force --view front --out mars.png
  haptolith snapshot scenes/sandbox.toml --out sandbox.png
  haptolith snapshot --film --duration-s 8 --motion scoop --out scoop.mp4

Requires Chromium (apt install chromium), which runs without a window; films also require ffmpeg.
HAPTOLITH_CHROMIUM=PATH selects another Chromium than the one in PATH.)";

/// Simulated time between updates of the page, in s: two frames of an animation, sufficient for its plots.
constexpr double kStep_s = 0.032;

/// Time range of the page's plots, in s.
constexpr double kPlotted_s = 10;

/// Time until the page's numbers are current; it updates them ten times per second.
constexpr auto kBetweenNumbers = 150ms;

/// Timeout of the page; a large bed, drawn in software on a busy machine, is slow.
constexpr auto kPatienceForPage = 300s;

/// Max. fraction of ticks longer than the tick's period in a snapshot of soil in real time.
constexpr double kMaxLate = 0.001;

struct SnapshotOptions {
  SceneOptions scene;
  std::string out_file;
  Overwrite overwrite;
  std::optional<double> at_s;
  int width_px = 1280, height_px = 720;
  std::string view = "three-quarter", drawing = "grains", colour = "plain", theme = "dark";
  bool panels = true;
  bool require_in_time = false;
  bool film = false;
  double duration_s = 8, frames_per_s = 30;
};

/// Returns the scene, not in real time and without an end: time advances only as required by a snapshot.
SceneFile sceneFileFor(const SnapshotOptions& options) {
  SceneFile scene_file = sceneFileFor(options.scene);
  if (options.scene.motion || options.scene.poses_file) {
    scene_file.device = {};
  }
  if (scene_file.device.kind != DeviceKind::kVirtualHand) {  // its speed would not be that of simulated time
    throw InvalidParameter(
        "device", fmt::format("'{}'", wordFor(kDeviceWords, scene_file.device.kind)),
        "virtual-hand, the only device of a snapshot: add --device virtual-hand, or choose a motion with --motion");
  }
  scene_file.loop.real_time = false;
  scene_file.loop.duration_s = 0;
  validate(scene_file);
  return scene_file;
}

/// Scene in which time is paused between snapshots, with a browser that shows it. Snapshots of a scene at one time are
/// reproducible.
class Studio {
 public:
  Studio(const SnapshotOptions& options, const SceneFile& scene_file, StatusLine& status)
      : options_(options),
        browser_({.width_px = options.width_px,
                  .height_px = options.height_px,
                  .stopped = [] { return stopAsked().load(); }}),
        session_(scene_file, false, settlingIn(status)),
        view_(session_, {.bind = "127.0.0.1", .port = 0}, HAPTOLITH_VERSION, {}) {
    session_.pause();
    session_.start(stopAsked());
    browser_.open(fmt::format("{}?view={}&drawing={}&colour={}&theme={}&panels={}&quality=full", view_.url(),
                              options.view, options.drawing, options.colour, options.theme, options.panels ? 1 : 0));
    waitForPage();
  }

  /// Advances time to `time_s`, so that speeds and plots include the time before. Nothing is drawn in between, because
  /// drawing in software would take the processor from the loop, whose duration is checked.
  void play(double time_s) {
    drawPicture(false);
    const double back_s = options_.panels ? kPlotted_s : kStep_s;
    for (double at_s = std::max(time_, time_s - back_s); at_s < time_s; at_s += kStep_s) {
      advance(at_s);
      showNow();
    }
    advance(time_s);
    drawPicture(true);
    showNow();
    std::this_thread::sleep_for(kBetweenNumbers);
    showNow();
  }

  /// Advances time in one step, to the next frame of an animation.
  void step(double time_s) {
    advance(time_s);
    showNow();
  }

  /// Returns a snapshot of the page, once it shows the current scene.
  std::string picture() {
    waitUntilDrawn();
    std::string png = browser_.screenshot(options_.film ? HeadlessBrowser::Png::kQuick : HeadlessBrowser::Png::kSmall);
    throwWhenConnectionLost();
    return png;
  }

  /// Checks that the soil ran in real time. Ticks interrupted by other programs do not count, because time is paused
  /// between snapshots.
  /// @throws Failure if the computing time of more ticks than kMaxLate was too long.
  void requireInTime() {
    const SceneSnapshot& scene = session_.snapshot();
    const auto ticks = static_cast<double>(scene.ticks);
    if (static_cast<double>(scene.misses_too_long) > kMaxLate * ticks) {
      throw Failure(
          fmt::format("no picture: {} of {} ticks took longer than {} ms, {} % are allowed; use coarser soil (--set "
                      "soil.radius_mm=...) or omit --require-in-time",
                      scene.misses_too_long, scene.ticks, 1e3 * session_.sceneFile().bed.tick_s, 100 * kMaxLate));
    }
  }

 private:
  /// Returns the tick of a snapshot, which is at the end of a tick. The first tick moves the tool to the hand.
  [[nodiscard]] std::uint64_t tickAt(double time_s) const {
    const double tick_s = session_.sceneFile().bed.tick_s;
    return static_cast<std::uint64_t>(std::max(1LL, std::llround(time_s / tick_s)));
  }

  void advance(double time_s) {
    time_ = time_s;
    const std::uint64_t wanted = tickAt(time_s);
    const std::uint64_t now = session_.snapshot().ticks;
    if (wanted > now) {
      session_.advance(static_cast<int>(wanted - now));
    }
    // A snapshot of a large bed takes several ticks, so only the second one at this moment is entirely of this moment.
    for (int complete = 0; complete < 2;) {
      throwIfStopped();
      if (session_.done()) {
        throw Failure(fmt::format("stopped at {:.3f} s: {}", session_.loop().time(), text(session_.join())));
      }
      if (session_.update()) {
        complete += session_.snapshot().ticks >= wanted ? 1 : 0;
      } else {
        std::this_thread::sleep_for(1ms);
      }
    }
  }

  void drawPicture(bool draw) { browser_.evaluate(fmt::format("window.haptolith.drawPicture({})", draw)); }

  void showNow() {
    view_.handleMessages();
    view_.show(true, session_.poll());
  }

  /// Waits until the page has drawn its first frame. @throws Failure with the page's message if it cannot.
  void waitForPage() {
    const auto until = std::chrono::steady_clock::now() + kPatienceForPage;
    advance(0);
    do {
      showNow();
      const nlohmann::json failed = browser_.evaluate(
          "document.querySelector('.no-picture')?.innerText ??"
          "(document.readyState === 'complete' && !window.haptolith ? document.body.innerText.trim() : null)");
      if (failed.is_string()) {
        throw Failure(fmt::format("the page shows no picture: {}", failed.get<std::string>()));
      }
      if (std::chrono::steady_clock::now() > until) {
        throw Failure("the page drew nothing for five minutes");
      }
      throwIfStopped();
      std::this_thread::sleep_for(20ms);
    } while (!browser_.evaluate("window.haptolith?.ready === true"));
    client_ = browser_.evaluate(kConnectedClient);
    throwWhenConnectionLost();
  }

  /// Throws if the connection was lost, also if the page has reconnected, because its plots are then empty.
  void throwWhenConnectionLost() {
    if (client_.is_null() || browser_.evaluate(kConnectedClient) != client_) {
      throw Failure(
          "no picture: the page lost its connection to the program; try again on a less busy machine, or with fewer "
          "pixels (--width, --height)");
    }
  }

  /// Waits until the page has drawn everything, with a frame of this moment that is newer than the last snapshot; or
  /// until it has lost its connection.
  void waitUntilDrawn() {
    constexpr std::string_view kWaiting = R"(
      new Promise((drawn) => {{
        const page = window.haptolith;
        let pictures = -1, still = 0;
        const look = () => {{
          if (!page.connected) return drawn({number});
          const there = page.frame && page.frame.time_s >= {time_s} && page.frame.number > {number};
          still = there && page.framesDrawn === pictures ? still + 1 : 0;
          pictures = page.framesDrawn;
          if (still < 3) requestAnimationFrame(look);
          else drawn(page.frame.number);
        }};
        look();
      }}))";
    frame_drawn_ = browser_
                       .evaluate(fmt::format(kWaiting, fmt::arg("time_s", session_.snapshot().time_s),
                                             fmt::arg("number", frame_drawn_)))
                       .get<std::uint32_t>();
  }

  static constexpr std::string_view kConnectedClient = "window.haptolith.connected ? window.haptolith.client : null";

  const SnapshotOptions& options_;
  HeadlessBrowser browser_;
  Session session_;
  LiveView view_;
  nlohmann::json client_;          ///< number of the page's connection; null before it is ready
  double time_ = 0;                ///< simulated, s
  std::uint32_t frame_drawn_ = 0;  ///< number of the page's frame in the last snapshot
};

void takePicture(const SnapshotOptions& options) {
  constexpr double kUsual_s = 2;
  if (!options.out_file.ends_with(".png")) {
    throw InvalidParameter("out", fmt::format("'{}'", options.out_file),
                           "a file name ending in .png, or with --film in .mp4 or .webm");
  }
  const SceneFile scene_file = sceneFileFor(options);
  AtomicFile file(options.overwrite(options.out_file));
  StatusLine status;
  Studio studio(options, scene_file, status);
  studio.play(options.at_s.value_or(kUsual_s));
  file.write(studio.picture());
  if (options.require_in_time) {
    studio.requireInTime();
  }
  file.commit();
}

void makeFilm(const SnapshotOptions& options) {
  if (options.width_px % 2 != 0 || options.height_px % 2 != 0) {
    throw InvalidParameter("width and height", fmt::format("{} x {}", options.width_px, options.height_px),
                           "even for a film");
  }
  const SceneFile scene_file = sceneFileFor(options);
  FilmFile film(options.overwrite(options.out_file), options.frames_per_s);
  StatusLine status;
  Studio studio(options, scene_file, status);
  const double start_s = options.at_s.value_or(0);
  const auto frames = std::max(1LL, std::llround(options.duration_s * options.frames_per_s));
  studio.play(start_s);
  for (long long frame = 0; frame < frames; ++frame) {
    status.tell([&] { return fmt::format("frame {} of {}", frame + 1, frames); });
    if (frame > 0) {
      studio.step(start_s + static_cast<double>(frame) / options.frames_per_s);
    }
    film.add(studio.picture());
  }
  if (options.require_in_time) {
    studio.requireInTime();
  }
  film.save();
}

std::vector<std::string> colourNames() {
  const auto names = namesOf(kColourWords);
  return {names.begin(), names.end()};
}

}  // namespace

void addSnapshotCommand(CLI::App& app) {
  auto options = std::make_shared<SnapshotOptions>();
  CLI::App* command = app.add_subcommand("snapshot", "Save a picture or film of a scene as the browser view shows it");
  command->footer(kSnapshotExamples);
  options->scene.addTo(*command);
  command->add_option("--out", options->out_file, "Output file: .png, or with --film .mp4 or .webm")
      ->required()
      ->option_text("FILE");
  options->overwrite.addTo(*command);
  command->add_option("--at-s", options->at_s, "Simulated time of the picture [2] or of the start of the film [0]")
      ->check(numberIn({0.0, 1e5}))
      ->option_text("SECONDS");
  command->add_option("--width", options->width_px, "Width in pixels [1280]")
      ->check(wholeNumberIn({320, 7680}))
      ->option_text("PIXELS");
  command->add_option("--height", options->height_px, "Height in pixels [720]")
      ->check(wholeNumberIn({240, 4320}))
      ->option_text("PIXELS");
  command->add_option("--view", options->view, "Direction of view [three-quarter]")
      ->check(oneOf({"front", "side", "top", "three-quarter"}))
      ->option_text("front|side|top|three-quarter");
  command
      ->add_option("--drawing", options->drawing,
                   "Appearance of particles: as soil grains or as the simulated spheres [grains]")
      ->check(oneOf({"grains", "balls"}))
      ->option_text("grains|balls");
  command->add_option("--colour", options->colour, "Quantity that colours the particles [plain]")
      ->check(oneOf(colourNames()))
      ->option_text("plain|force|speed|depth|sleep");
  command->add_option("--theme", options->theme, "Colours of the page [dark]")
      ->check(oneOf({"dark", "light"}))
      ->option_text("dark|light");
  CLI::Option* panels = command->add_flag_callback(
      "--panels", [options] { options->panels = true; }, "Include status, plots and controls [on]");
  command
      ->add_flag_callback(
          "--no-panels", [options] { options->panels = false; }, "Show only the bed and the forces")
      ->excludes(panels);
  command->add_flag("--require-in-time", options->require_in_time,
                    "Save nothing if more than 0.1 % of ticks took longer than 1 ms");
  CLI::Option* film = command->add_flag("--film", options->film, "Save a film instead of a picture");
  command->add_option("--duration-s", options->duration_s, "Simulated duration of the film [8]")
      ->needs(film)
      ->check(numberIn({0.1, 3600.0}))
      ->option_text("SECONDS");
  command->add_option("--fps", options->frames_per_s, "Frames per second of the film [30]")
      ->needs(film)
      ->check(numberIn({1.0, 120.0}))
      ->option_text("N");
  command->callback([options] {
    const StopOnSignal stop_on_signal;
    if (options->film) {
      makeFilm(*options);
    } else {
      takePicture(*options);
    }
  });
}

}  // namespace haptolith
