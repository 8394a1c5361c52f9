#include "run_command.h"

#include <CLI/CLI.hpp>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include <chrono>
#include <ctime>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "haptolith/bed/simd_target.h"
#include "haptolith/core/error.h"
#include "haptolith/scenario/scenario.h"
#include "haptolith/scenario/scene_words.h"
#include "haptolith/session/session.h"
#include "haptolith/viewer/access.h"
#include "haptolith/viewer/live_view.h"

#include "output.h"
#include "recording.h"
#include "run_figure.h"
#include "scene_options.h"
#include "stop_on_signal.h"
#include "trace_file.h"

namespace haptolith {

namespace {

using namespace std::chrono_literals;
using Json = nlohmann::ordered_json;

constexpr const char* kExamples = R"(Examples:
  haptolith run                                     the paper's scene until Ctrl-C
  haptolith run --hand stir --duration-s 10         ten seconds of stirring
  haptolith run --preset P1 --body Mars --json      another soil on another world
  haptolith run --soil surveyor-3                   a soil by its name (haptolith soil list)
  haptolith run --hand press --trace press.csv --figure press.svg
  haptolith run scenarios/deep-bed.toml             a scene from a file
  haptolith run --poses movement.csv                a recorded hand
  haptolith run --unpaced --duration-s 60 --json    as fast as it can, for experiments
  haptolith run --hand still --port 9000            to dig in, at http://127.0.0.1:9000/)";

/// What the command line says; everything else comes from the scenario.
struct RunOptions {
  SceneOptions scene;
  std::optional<double> duration_s;
  bool unpaced = false;
  std::string trace_file, figure_file;
  bool json = false;
  std::optional<bool> serve;
  WebServerOptions web;
};

Scenario scenarioFor(const RunOptions& options) {
  Scenario scenario = scenarioFor(options.scene);
  scenario.loop.duration_s = options.duration_s.value_or(scenario.loop.duration_s);
  scenario.loop.paced = scenario.loop.paced && !options.unpaced;
  validate(scenario);
  return scenario;
}

/// Everything that follows the loop from a distance: trace, history for the figure, the status line.
class Follower {
 public:
  Follower(const RunOptions& options, const Scenario& scenario)
      : scenario_(scenario), keep_history_(!options.figure_file.empty()) {
    if (!options.trace_file.empty()) {
      trace_.emplace(options.trace_file);
    }
  }

  [[nodiscard]] bool wantsRecords() const noexcept { return trace_ || keep_history_; }

  void follow(Session& session, bool newer) {
    fresh_.clear();
    session.loop().takeRecords(fresh_);
    for (const TickRecord& record : fresh_) {
      if (trace_) {
        trace_->write(record);
      }
      recording_.write(record);
      if (keep_history_) {
        remember(record);
      }
    }
    if (newer) {
      const SceneSnapshot& now = session.snapshot();
      if (keep_history_ &&
          (history_.strongest.position.empty() || now.felt.force_n.norm() > history_.strongest.felt.force_n.norm())) {
        history_.strongest = now;
      }
      if (status_.visible()) {
        status_.update(statusText(now));
      }
    }
  }

  [[nodiscard]] StatusLine& status() noexcept { return status_; }

  [[nodiscard]] Recording& recording() noexcept { return recording_; }

  /// Saves the trace; whoever prints next finds a clean line.
  void finish() {
    status_.clear();
    if (trace_) {
      trace_->commit();
    }
    recording_.stop();
  }

  [[nodiscard]] const RunHistory& history() const noexcept { return history_; }

 private:
  /// Keeps every stride-th record; when there are too many, every second one goes and the stride doubles.
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
    const double wanted = scenario_.loop.duration_s;
    return fmt::format("{}{}  force {:6.2f} N  tick p99 {:5.0f} us  in time {:5.1f} %  misses {}  awake {}",
                       fmt::format("{:7.1f} s", now.time_s), wanted > 0 ? fmt::format(" of {:g} s", wanted) : "",
                       now.felt.force_n.norm(), now.tick_us_p99, 100 * now.success_rate, now.deadline_misses,
                       now.awake);
  }

  const Scenario& scenario_;
  bool keep_history_;
  std::optional<TraceFile> trace_;
  Recording recording_;
  StatusLine status_;
  std::vector<TickRecord> fresh_;
  RunHistory history_;
  std::uint64_t seen_ = 0, stride_ = 1;
};

/// What is left of a run when it is over.
struct RunSummary {
  LoopEnd end;
  RealTime real_time;
  std::uint64_t lost_records;
};

Json statisticsJson(const Histogram& h) {
  return {{"mean", h.mean()}, {"p99", h.percentile(0.99)}, {"max", h.max()}};
}

Json tickJson(const Histogram& h) {
  return {{"mean", h.mean()},
          {"p50", h.percentile(0.5)},
          {"p99", h.percentile(0.99)},
          {"p99_9", h.percentile(0.999)},
          {"max", h.max()}};
}

Json summaryJson(const Scenario& scenario, const Scene& scene, const HapticLoop& loop, const RunSummary& summary) {
  const LoopStatistics& statistics = loop.statistics();
  return {
      {"title", scenario.title},
      {"preset", scenario.preset},
      {"soil", scenario.soil_name.empty() ? Json(nullptr) : Json(scenario.soil_name)},
      {"friction", wordFor(kFrictionWords, scenario.bed.soil.friction)},
      {"body", scenario.body},
      {"particles", scene.bed().particles()},
      {"awake", scene.bed().awake()},
      {"substeps", scene.substeps()},
      {"threads", scenario.bed.threads},
      {"simd", simdTarget()},
      {"ticks", statistics.ticks()},
      {"duration_s", loop.time()},
      {"ended", text(summary.end)},
      {"tick_us", tickJson(statistics.tickUs())},
      {"deadline_misses", statistics.deadlineMisses()},
      {"success_rate_last_100", statistics.successRate()},
      {"force_n", statisticsJson(statistics.forceN())},
      {"torque_nm", statisticsJson(statistics.torqueNm())},
      {"largest_speed_m_s", scene.bed().largestSpeed()},
      {"lost_records", summary.lost_records},
      {"state_hash", fmt::format("{:016x}", stateHash(scene.bed().state()))},
      {"realtime", {{"scheduler", summary.real_time.scheduler}, {"memory_locked", summary.real_time.memory_locked}}}};
}

std::string soilText(const Scenario& scenario) {
  const std::string name = scenario.preset + scenario.soil_name;  // one of them at most
  return fmt::format("{}, {} friction", name.empty() ? "own soil" : name,
                     wordFor(kFrictionWords, scenario.bed.soil.friction));
}

std::string summaryText(const Scenario& scenario, const Scene& scene, const HapticLoop& loop,
                        const RunSummary& summary) {
  const LoopStatistics& s = loop.statistics();
  const Histogram& t = s.tickUs();
  return fmt::format(
      "{title}\n"
      "  soil       {particles} macroparticles of {radius:g} mm, {soil}, g = {g:g} m/s2, {substeps} step(s) a tick; in "
      "the end {awake} awake\n"
      "  time       {time:.3f} s in {ticks} ticks: {end}\n"
      "  tick       mean {mean:.1f}  p50 {p50:.1f}  p99 {p99:.1f}  p99.9 {p999:.1f}  max {max:.1f} us ({simd}, "
      "{threads} "
      "thread(s))\n"
      "  deadlines  {misses} missed; {success:.0f} % of the last 100 in time; {scheduler}, memory {locked}\n"
      "  force      mean {fmean:.2f}  p99 {fp99:.2f}  max {fmax:.2f} N\n"
      "  torque     mean {mmean:.4f}  p99 {mp99:.4f}  max {mmax:.4f} N m\n"
      "  state      {hash:016x}\n",
      fmt::arg("title", scenario.title), fmt::arg("particles", scene.bed().particles()),
      fmt::arg("awake", scene.bed().awake()), fmt::arg("radius", 1e3 * scenario.bed.soil.radius_m),
      fmt::arg("soil", soilText(scenario)), fmt::arg("g", scenario.bed.gravity_m_s2.norm()),
      fmt::arg("substeps", scene.substeps()), fmt::arg("time", loop.time()), fmt::arg("ticks", s.ticks()),
      fmt::arg("end", text(summary.end)), fmt::arg("mean", t.mean()), fmt::arg("p50", t.percentile(0.5)),
      fmt::arg("p99", t.percentile(0.99)), fmt::arg("p999", t.percentile(0.999)), fmt::arg("max", t.max()),
      fmt::arg("simd", simdTarget()), fmt::arg("threads", scenario.bed.threads), fmt::arg("misses", s.deadlineMisses()),
      fmt::arg("success", 100 * s.successRate()), fmt::arg("scheduler", summary.real_time.scheduler),
      fmt::arg("locked", summary.real_time.memory_locked ? "locked" : "not locked"),
      fmt::arg("fmean", s.forceN().mean()), fmt::arg("fp99", s.forceN().percentile(0.99)),
      fmt::arg("fmax", s.forceN().max()), fmt::arg("mmean", s.torqueNm().mean()),
      fmt::arg("mp99", s.torqueNm().percentile(0.99)), fmt::arg("mmax", s.torqueNm().max()),
      fmt::arg("hash", stateHash(scene.bed().state())));
}

/// A run that was to last a certain time and did not, or that went wrong, has failed; its trace is kept all the same.
void throwWhenItFailed(const Scenario& scenario, const HapticLoop& loop, LoopEnd end) {
  const bool cut_short = end == LoopEnd::kStopped && scenario.loop.duration_s > 0;
  if (cut_short || end == LoopEnd::kHandLeft || end == LoopEnd::kNotFinite || end == LoopEnd::kCollapsed) {
    throw Failure(cut_short ? fmt::format("interrupted after {:.3f} s of {:g} s", loop.time(), scenario.loop.duration_s)
                            : fmt::format("stopped at {:.3f} s: {}", loop.time(), text(end)));
  }
}

/// The view in the browser: unless somebody measures or a program reads what is printed. None when no port is free and
/// nobody has asked for it.
std::unique_ptr<LiveView> viewOf(Session& session, Follower& follower, const RunOptions& options) {
  try {
    Recording& recording = follower.recording();
    auto view = std::make_unique<LiveView>(session, options.web, HAPTOLITH_VERSION,
                                           LiveView::Recorder{.start = [&recording] { recording.start(); },
                                                              .stop = [&recording] { recording.stop(); },
                                                              .name = [&recording] { return recording.name(); }});
    printNotice(fmt::format("see and touch it at {}\n", view->url()));
    return view;
  } catch (const Failure& failure) {
    if (options.serve) {
      throw;
    }
    spdlog::warn("no view in the browser: {}", failure.what());
    return nullptr;
  }
}

void run(RunOptions options) {
  const StopOnSignal stop_on_signal;
  const Scenario scenario = scenarioFor(options);
  if (!isLoopback(options.web.bind) && options.web.token.empty()) {
    options.web.token = newToken();
  }
  validate(options.web);
  // Files that cannot be written are refused before the bed is made.
  Follower follower(options, scenario);
  std::optional<Figure> figure;
  if (!options.figure_file.empty()) {
    figure.emplace(options.figure_file, kRunFigureWidth_px, kRunFigureHeight_px);
  }
  const bool serves = options.serve.value_or(scenario.loop.paced && !options.json);
  Session session(scenario, follower.wantsRecords() || serves, settlingIn(follower.status()));
  const std::unique_ptr<LiveView> view = serves ? viewOf(session, follower, options) : nullptr;
  session.start(stopAsked());
  if (const std::string& advice = session.realTime().advice; !advice.empty()) {
    spdlog::warn("{}", advice);
  }
  const auto between_looks = !scenario.loop.paced ? 1ms : view ? 4ms : 20ms;
  while (!session.done()) {
    if (view) {
      view->obey();
    }
    const bool changed = session.poll();
    const bool newer = session.update();
    follower.follow(session, newer);
    if (view) {
      view->show(newer, changed);
    }
    std::this_thread::sleep_for(between_looks);
  }
  const RunSummary summary{session.join(), session.realTime(), session.loop().lostRecords()};
  session.poll();
  follower.follow(session, session.update());
  follower.finish();
  if (summary.lost_records > 0 && !options.trace_file.empty()) {
    spdlog::warn("{} ticks are missing in the trace: the disk was too slow for 8 s", summary.lost_records);
  }
  if (figure) {
    drawRun(*figure, session.shown(), follower.history(), session.loop().statistics());
  }
  if (options.json) {
    printJson(summaryJson(session.shown(), session.scene(), session.loop(), summary));
  } else {
    printText(summaryText(session.shown(), session.scene(), session.loop(), summary));
  }
  throwWhenItFailed(session.shown(), session.loop(), summary.end);
}

}  // namespace

void addRunCommand(CLI::App& app) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = app.add_subcommand("run", "Run a scene at 1 kHz under a hand, until Ctrl-C or --duration-s");
  command->footer(kExamples);
  options->scene.addTo(*command);
  command->add_option("--duration-s", options->duration_s, "Simulated time; default: until Ctrl-C")
      ->check(CLI::Range(1e-3, 1e7))
      ->option_text("SECONDS");
  command->add_flag("--unpaced", options->unpaced, "As fast as it can instead of in step with the clock");
  command->add_option("--trace", options->trace_file, "Write every tick to this CSV file")->option_text("FILE");
  command->add_option("--figure", options->figure_file, "Draw the run (.svg or .png)")->option_text("FILE");
  command->add_flag("--json", options->json, "Print the summary as one JSON object");
  CLI::Option* serve = command->add_flag_callback(
      "--serve", [options] { options->serve = true; }, "Show it in the browser; default: unless --unpaced or --json");
  command
      ->add_flag_callback(
          "--no-serve", [options] { options->serve = false; }, "Do not show it in the browser")
      ->excludes(serve);
  command->add_option("--port", options->web.port, "Port of the page, or the next that is free; 0: any [8080]")
      ->option_text("PORT");
  command
      ->add_option("--bind", options->web.bind,
                   "Address to listen on [127.0.0.1]; any but this machine's own wants a token")
      ->option_text("ADDRESS");
  command->add_option("--token", options->web.token, "What a browser must know; default beyond this machine: made up")
      ->option_text("TEXT");
  command->callback([options] { run(*options); });
}

}  // namespace haptolith
