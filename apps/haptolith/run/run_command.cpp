#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "haptolith/bed/start/tile_cache.h"
#include "haptolith/core/error.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/core/pluralise.h"
#include "haptolith/haptics/loop/stiffness_check.h"
#include "haptolith/machine/deadline_report.h"
#include "haptolith/machine/machine_fit.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/scene_file/scene_words.h"
#include "haptolith/scene_file/toml/file_keys.h"
#include "haptolith/session/session.h"
#include "haptolith/viewer/live_view.h"
#include "haptolith/viewer/waiting_page.h"

#include "commands.h"
#include "run/run_companion.h"
#include "run/run_figure.h"
#include "run/run_summary.h"
#include "run/trace_file.h"
#include "shared/common_options.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/overwrite.h"
#include "shared/scene_options.h"
#include "shared/session_driver.h"
#include "shared/stop_on_signal.h"
#include "shared/web_options.h"

namespace haptolith {

namespace {

using namespace std::chrono_literals;

constexpr const char* kRunExamples = R"(Examples:
  haptolith run                                     lunar soil, until Ctrl-C
  haptolith run --coarser                           one step coarser particles, to save CPU time
  haptolith run icra2021                            scene of the ICRA 2021 paper
  haptolith run --motion stir --duration-s 10       ten seconds of stirring
  haptolith run --soil surveyor-3 --body Mars       named soil (haptolith soil list) on another body
  haptolith run --preset P1 --json                  soil of the ICRA 2021 paper, in its scene
  haptolith run --motion press --trace press.csv --figure press.svg
  haptolith run deep-bed                            another scene (haptolith scenes)
  haptolith run sandbox --auto-resolution           another scene, in the finest particles
  haptolith run --poses movement.csv                recorded motion of the hand
  haptolith run --no-realtime --duration-s 60       as fast as possible, for experiments
  haptolith run --motion still --port 9000          dig at http://127.0.0.1:9000/
  haptolith run --device force-dimension            use a haptic device (haptolith devices)
  haptolith run --duration-s 60 --record run.h5     record for haptolith replay and export)";

/// Options of the command line; everything else comes from the scene file.
struct RunOptions {
  SceneOptions scene;
  std::optional<double> duration_s;
  bool no_realtime = false, auto_resolution = false, measure_again = false;
  int coarser = 0;  ///< number of steps
  std::optional<int> cpu;
  std::string trace_file, figure_file, record_file;
  Overwrite overwrite;
  double frames_per_s = 10;
  bool json = false;
  std::optional<bool> serve;
  WebOptions web;
  CompanionFactory companion;  ///< empty: none
};

SceneFile sceneFileFor(const RunOptions& options) {
  SceneFile scene_file = sceneFileFor(options.scene);
  scene_file.loop.duration_s = options.duration_s.value_or(scene_file.loop.duration_s);
  scene_file.loop.real_time = scene_file.loop.real_time && !options.no_realtime;
  scene_file.loop.cpu = options.cpu.value_or(scene_file.loop.cpu);
  validate(scene_file);
  requireUsableCpu(scene_file.loop.cpu);
  return scene_file;
}

/// Selects the finest particles that the machine allows, if the scene permits: `auto` unless a radius is given, and any
/// other with --auto-resolution.
std::optional<FinestGrain> fitted(SceneFile& scene_file, const RunOptions& options) {
  const SceneOptions& asked = options.scene;
  const bool has_radius = setsKey(asked.overrides, "soil.radius_mm");
  const bool has_threads = asked.threads || setsKey(asked.overrides, "bed.threads");
  const bool is_auto = asked.scene() == kAutoScene;
  if (!options.auto_resolution && (!is_auto || has_radius || !canBeFitted(scene_file))) {
    if (is_auto && !has_threads) {
      scene_file.bed.threads = std::min(2, loopThreads());
    }
    return std::nullopt;
  }
  StatusLine status;
  const std::string before = sceneInWords(scene_file);
  const FinestGrain found = fitToMachine(
      scene_file,
      {.threads = is_auto && !has_threads ? std::nullopt : std::optional(scene_file.bed.threads),
       .folder = tileFolder(),
       .measure_again = options.measure_again,
       .measuring = [&status] { status.update("measuring the finest soil that this machine renders in real time"); }},
      stopAsked());
  if (!is_auto) {
    retitle(scene_file, before);
  }
  return found;
}

/// Chooses the particles, and applies the steps of --coarser.
std::optional<FinestGrain> chooseParticles(SceneFile& scene_file, const RunOptions& options) {
  std::optional<FinestGrain> finest = fitted(scene_file, options);
  for (int step = 0; step < options.coarser; ++step) {
    makeCoarser(scene_file);
  }
  validate(scene_file);
  return finest;
}

/// Describes the chosen particles of a scene in one line; empty: they are those of the scene.
std::string particlesText(const Scene& scene, const std::optional<FinestGrain>& finest, int coarser) {
  const BedParameters& bed = scene.bed().parameters();
  if (coarser > 0) {
    return fmt::format("{:g} mm particles on {}: {} coarser than {} ({} particles)\n", 1e3 * bed.soil.radius_m,
                       pluralise(bed.threads, "thread"), pluralise(coarser, "step"),
                       finest ? fmt::format("{:g} mm, the finest soil that this machine renders in real time",
                                            1e3 * finest->chosen.radius_m)
                              : "asked for otherwise",
                       scene.bed().particles());
  }
  return finest ? text(*finest, scene.bed().particles()) + "\n" : "";
}

/// Checks that the name of a recording does not suggest another file type.
void requireRecordingName(const std::filesystem::path& file) {
  if (file.extension() != ".h5") {
    throw InvalidParameter("record", inQuotes(file.string()), "a file name ending in .h5");
  }
  std::error_code ignored;
  if (std::filesystem::file_size(file, ignored) > 0 && !ignored && irreplaceable(file) != "a recording") {
    throw Failure(fmt::format("cannot replace {}: it is not a recording; choose another name", file.string()));
  }
}

/// Consumers of the loop's records: trace, history for the figure, status line.
class Follower {
 public:
  Follower(const RunOptions& options, const SceneFile& scene_file, RunCompanion* companion)
      : scene_file_(scene_file),
        companion_(companion),
        keep_history_(!options.figure_file.empty()),
        recording_(recordingFor(options.frames_per_s, companion != nullptr && companion->leadsRobot())) {
    if (!options.trace_file.empty()) {
      trace_.emplace(options.overwrite(options.trace_file));
    }
    if (!options.record_file.empty()) {
      RecordingWriter::requireFree(options.record_file, options.overwrite.allowed);
      requireRecordingName(options.record_file);
    }
  }

  [[nodiscard]] bool wantsRecords() const noexcept { return trace_ || keep_history_; }
  [[nodiscard]] bool traces() const noexcept { return trace_.has_value(); }

  /// Records the session from its first tick.
  void record(Session& session, const RunOptions& options) {
    session.loop().hashRecords();
    recording_.start(session, options.record_file, options.overwrite.allowed);
  }

  void follow(Session& session, const SessionDriver::News& news) {
    for (const TickRecord& record : news.ticks) {
      if (trace_) {
        trace_->write(record);
      }
      if (keep_history_) {
        remember(record);
      }
    }
    if (companion_ != nullptr) {
      companion_->follow(session, news, recording_);
    }
    if (news.snapshot) {
      const SceneSnapshot& now = session.snapshot();
      if (keep_history_ && (history_.strongest.position.empty() ||
                            now.device_wrench.force_n.norm() > history_.strongest.device_wrench.force_n.norm())) {
        history_.strongest = now;
      }
      if (status_.visible()) {
        const std::string companion = companion_ != nullptr ? companion_->status() : "";
        status_.update(companion.empty() ? statusText(now) : companion);
      }
    }
  }

  [[nodiscard]] StatusLine& status() noexcept { return status_; }

  [[nodiscard]] SessionRecording& recording() noexcept { return recording_; }

  /// Saves trace and recording, and clears the status line.
  void finish(LoopEnd end, double time_s) {
    recording_.note("end", time_s, text(end));
    if (trace_) {
      trace_->commit();
    }
    recording_.stop();
    status_.clear();
  }

  [[nodiscard]] const RunHistory& history() const noexcept { return history_; }

 private:
  /// Keeps every stride-th record; if there are too many, drops every second one and doubles the stride.
  void remember(const TickRecord& record) {
    constexpr std::size_t kMostRecords = 20'000;
    if (seen_++ % stride_ != 0) {
      return;
    }
    history_.records.push_back(record);
    if (history_.records.size() >= kMostRecords) {
      for (std::size_t i = 0; i < kMostRecords / 2; ++i) {
        history_.records[i] = history_.records[2 * i];
      }
      history_.records.resize(kMostRecords / 2);
      stride_ *= 2;
    }
  }

  [[nodiscard]] std::string statusText(const SceneSnapshot& now) const {
    const double wanted = scene_file_.loop.duration_s;
    const std::string deadlines = scene_file_.loop.real_time ? fmt::format("  in time {:5.1f} %  misses {}",
                                                                           100 * now.success_rate, now.deadline_misses)
                                                             : "";
    return fmt::format("{}{}  {} {:6.2f} N  tick p99 {:5.0f} us{}  awake {}", fmt::format("{:7.1f} s", now.time_s),
                       wanted > 0 ? fmt::format(" of {:g} s", wanted) : "",
                       now.trip == SafetyTrip::kNone ? "force" : "SAFETY TRIP", now.device_wrench.force_n.norm(),
                       now.tick_us_p99, deadlines, now.awake);
  }

  const SceneFile& scene_file_;
  RunCompanion* companion_;
  bool keep_history_;
  std::optional<TraceFile> trace_;
  SessionRecording recording_;
  StatusLine status_;
  RunHistory history_;
  std::uint64_t seen_ = 0, stride_ = 1;
};

/// Returns the command that opens the scene with slightly coarser soil.
std::string coarserSoil(const RunOptions& options, const SceneFile& shown) {
  constexpr double kCoarser = 1.15;
  if (!options.scene.name_or_file.empty() || options.scene.preset) {
    return fmt::format("--set soil.radius_mm={:.2g}", kCoarser * 1e3 * shown.bed.soil.radius_m);
  }
  std::string command = "haptolith run";
  for (int step = 0; step <= options.coarser; ++step) {
    command += " --coarser";
  }
  return command;
}

/// Throws for a run that failed or ended before its duration; its trace is kept.
void throwWhenItFailed(const SceneFile& scene_file, const HapticLoop& loop, LoopEnd end) {
  const bool cut_short = end == LoopEnd::kStopped && scene_file.loop.duration_s > 0;
  if (cut_short || end == LoopEnd::kHandLeft || end == LoopEnd::kLost || end == LoopEnd::kNotFinite ||
      end == LoopEnd::kCollapsed) {
    throw Failure(cut_short
                      ? fmt::format("interrupted after {:.3f} s of {:g} s", loop.time(), scene_file.loop.duration_s)
                      : fmt::format("stopped at {:.3f} s: {}", loop.time(), text(end)));
  }
}

/// Warns if a device could oscillate at the max. stiffness of the soil.
void warnOfStiffness(const Session& session) {
  const SceneFile& scene_file = session.shown();
  const DeviceLimits limits = session.device().limits();
  const StiffnessCheck check = checkStiffness(scene_file.handling, scene_file.tool, scene_file.bed.soil.radius_m,
                                              limits, scene_file.loop.tick_s);
  if (!session.device().simulated() && limits.max_force_n > 0 && !check.stable()) {
    spdlog::warn("{}", check.text);
  }
}

/// Creates the browser view, which is omitted for measurements and if a program reads the output. Null if no port is
/// free and the view was not requested.
std::unique_ptr<LiveView> viewOf(Session& session, Follower& follower, const RunOptions& options,
                                 const WebServerOptions& web) {
  try {
    SessionRecording& recording = follower.recording();
    auto view = std::make_unique<LiveView>(
        session, web, HAPTOLITH_VERSION,
        LiveView::Recorder{.start = [&recording, &session] { recording.start(session); },
                           .stop = [&recording] { recording.stopPart(); },
                           .name = [&recording] { return recording.name(); }},
        LiveView::Extension{}, options.web.read_only ? LiveView::Clients::kLookOn : LiveView::Clients::kCommand);
    const bool has_two_addresses = view->urlHere() != view->url();
    printNotice(fmt::format("{}see {} at {}\n{}", options.web.portNotice(view->port()),
                            options.web.read_only ? "it" : "and touch it", view->url(),
                            has_two_addresses ? fmt::format("on this machine also at {}\n", view->urlHere()) : ""));
    return view;
  } catch (const Failure& failure) {
    if (options.serve || options.web.port) {
      throw;
    }
    spdlog::warn("cannot serve the browser view: {}", failure.what());
    return nullptr;
  }
}

/// Shows the progress of settling in the terminal, and on a page if there will be one.
SettleProgress settlingOn(WaitingPage* page, SettledFraction& settled, StatusLine& status) {
  return [shown = settlingIn(status), page, &settled](double time_s, double speed_m_s) {
    if (page != nullptr) {
      page->say(fmt::format("soil is settling, {:.0f} % done", 100 * settled.update(speed_m_s)));
    }
    return shown(time_s, speed_m_s);
  };
}

void run(const RunOptions& options) {
  const StopOnSignal stop_on_signal;
  SceneFile scene_file = sceneFileFor(options);
  const std::unique_ptr<RunCompanion> companion =
      options.companion ? options.companion(scene_file, options.scene) : nullptr;
  const WebServerOptions web = options.web.forAll();
  const std::optional<FinestGrain> finest = chooseParticles(scene_file, options);
  // Fails for files that cannot be written before the bed is created.
  Follower follower(options, scene_file, companion.get());
  std::optional<Figure> figure;
  if (!options.figure_file.empty()) {
    figure.emplace(options.overwrite(options.figure_file), kRunFigureWidth_px, kRunFigureHeight_px);
  }
  const bool serves = options.serve.value_or(scene_file.loop.real_time && !options.json);
  const bool leads = companion && companion->leadsRobot();
  const bool keeps_records = follower.wantsRecords() || serves || companion || !options.record_file.empty();
  std::optional<WaitingPage> waiting;
  SettledFraction settled;
  if (serves) {
    waiting.emplace(web);
  }
  Session session(scene_file, keeps_records, settlingOn(waiting ? &*waiting : nullptr, settled, follower.status()),
                  companion ? companion->device() : nullptr);
  waiting.reset();
  follower.status().clear();
  printNotice(particlesText(session.scene(), finest, options.coarser));
  warnOfStiffness(session);
  if (companion) {
    companion->begin(session);
  }
  const std::unique_ptr<LiveView> view = serves ? viewOf(session, follower, options, web) : nullptr;
  if (!options.record_file.empty()) {
    follower.record(session, options);
  }
  std::optional<RecordTaker> taker;
  if (keeps_records) {
    taker.emplace(session.loop(), follower.recording(),
                  follower.wantsRecords() || leads ? RecordTaker::Keep::kForTake : RecordTaker::Keep::kNothing,
                  scene_file.loop.real_time, companion ? companion->listener() : RecordTaker::Listener());
  }
  SessionDriver driver(session, follower.recording(), follower.status(), view.get(), taker ? &*taker : nullptr);
  session.start(stopAsked());
  if (const std::string& advice = session.realTime().advice; !advice.empty()) {
    spdlog::warn("{}", advice);
  }
  driver.run(
      [&](const SessionDriver::News& news) {
        follower.follow(session, news);
        if (view && companion) {
          companion->showIn(*view);
        }
        return true;
      },
      !scene_file.loop.real_time ? 1ms
      : view || leads            ? 4ms
                                 : 20ms);
  const LoopEnd end = session.join();
  follower.follow(session, driver.look());
  const RunSummary summary{end,
                           session.realTime(),
                           taker ? taker->lost() : 0,
                           finest,
                           scene_file.loop.real_time
                               ? deadlineAdvice(session.loop().statistics(), coarserSoil(options, session.shown()))
                               : "",
                           session.device().inputSummary()};
  follower.finish(summary.end, session.loop().time());
  driver.tellTheRest();
  if (figure) {
    drawRun(*figure, session.shown(), follower.history(), session.loop().statistics());
  }
  if (options.json) {
    nlohmann::ordered_json json = summaryJson(session.shown(), session.scene(), session.loop(), summary);
    if (companion) {
      companion->addTo(json);
    }
    printJson(json);
  } else {
    printText(summaryText(session.shown(), session.scene(), session.loop(), summary));
    if (companion) {
      printText(companion->summary());
    }
    if (!summary.advice.empty()) {
      printText(summary.advice + "\n");
    }
  }
  throwWhenItFailed(session.shown(), session.loop(), summary.end);
  if (!follower.recording().problem().empty()) {
    throw Failure(fmt::format("the recording is incomplete: {}", follower.recording().problem()));
  }
  if (summary.lost_records > 0 && follower.traces()) {
    throw Failure(fmt::format("the trace is incomplete: {} missing, because the program was interrupted for too long",
                              pluralise(summary.lost_records, "tick is", "ticks are")));
  }
}

}  // namespace

namespace {

/// Adds all options of a run.
void addOptions(CLI::App* command, const std::shared_ptr<RunOptions>& options) {
  options->scene.addTo(*command);
  command->add_option("--duration-s", options->duration_s, "Simulated time [until Ctrl-C]")
      ->check(numberIn(LoopRanges::duration_s))
      ->option_text("SECONDS");
  command->add_flag("--no-realtime", options->no_realtime, "Run as fast as possible instead of in real time");
  command->add_flag(
      "--auto-resolution", options->auto_resolution,
      "Use the finest particles of settled soil that this machine renders in real time; always on in scene auto");
  command->add_flag("--coarser", options->coarser,
                    "Use particles that are one step coarser, 5 to 10 % larger; can be repeated");
  command->add_flag("--measure-again", options->measure_again,
                    "Measure the speed of this machine again, for one second");
  command->add_option("--cpu", options->cpu, "CPU for the thread of the loop [any]")->option_text("N");
  command->add_option("--trace", options->trace_file, "Write every tick to this CSV file")->option_text("FILE");
  command->add_option("--figure", options->figure_file, "Draw the run to this file (.svg or .png)")
      ->option_text("FILE");
  command
      ->add_option("--record", options->record_file,
                   "Record every tick to this HDF5 file (docs/how-to/record-and-replay.md)")
      ->option_text("FILE.h5");
  command->add_option("--record-frames", options->frames_per_s, "Recorded frames of all particles per second [10]")
      ->check(numberIn({0, 60}))
      ->option_text("N");
  options->overwrite.addTo(*command);
  addJson(*command, options->json);
  CLI::Option* serve = command->add_flag_callback(
      "--serve", [options] { options->serve = true; },
      "Show the scene in the browser [unless --no-realtime or --json]");
  command
      ->add_flag_callback(
          "--no-serve", [options] { options->serve = false; }, "Do not show the scene in the browser")
      ->excludes(serve);
  options->web.addToRun(*command);
  command->callback([options] { run(*options); });
}

}  // namespace

void addRunCommand(CLI::App& app) {
  auto options = std::make_shared<RunOptions>();
  options->scene.usual = kAutoScene;
  CLI::App* command = app.add_subcommand("run", "Run a scene at 1 kHz until Ctrl-C or --duration-s");
  command->footer(kRunExamples);
  addOptions(command, options);
}

void addRunOptions(CLI::App& command, CompanionFactory companion, const std::string& scene) {
  auto options = std::make_shared<RunOptions>();
  options->companion = std::move(companion);
  options->scene.name_or_file = scene;
  addOptions(&command, options);
  if (!scene.empty()) {
    command.get_option("scenario")->description(fmt::format("Scene: a name (haptolith scenes) or a file [{}]", scene));
  }
}

}  // namespace haptolith
