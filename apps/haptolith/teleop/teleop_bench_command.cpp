#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/former_names.h"
#include "haptolith/core/pluralise.h"
#include "haptolith/core/process/in_parallel.h"
#include "haptolith/core/stop_asked.h"
#include "haptolith/identify/training/training_file.h"
#include "haptolith/scene_file/site_task.h"
#include "haptolith/teleop/bench/simulation.h"
#include "haptolith/teleop/operator/agreement_figure.h"
#include "haptolith/teleop/operator/learning_model.h"
#include "haptolith/teleop/operator/site_probe.h"
#include "haptolith/teleop/operator/surface_mender.h"

#include "identify/belief_report.h"
#include "shared/common_options.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/overwrite.h"
#include "shared/progress.h"
#include "shared/saved.h"
#include "shared/stop_on_signal.h"
#include "teleop/link_options.h"
#include "teleop/operator_report.h"
#include "teleop/teleop_commands.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kTeleopBenchExamples = R"(Examples:
  haptolith teleop bench                            six round trips, four cases: some minutes
  haptolith teleop bench --round-trip-s 2.6 --case static,oracle --duration-s 20
  haptolith teleop bench --task trench --round-trip-s 0,2.6     completion time of a task
  haptolith teleop bench --case adaptive,oracle --set soil.radius_mm=4 --set-site soil.radius_mm=3
                                                    finer particles: less noise in the forces
  haptolith teleop bench --site teleop-model --set soil.radius_mm=5      model and site swapped

Results and definitions: docs/reports/teleop-bench.md)";

constexpr double kBenchMm = 1e-3;
constexpr double kMillijoule = 1e-3;
constexpr double kLast_s = 10;  ///< final part of a run, after a model has learned

/// Compared cases.
enum class Case { kStatic, kCalibrated, kAdaptive, kCalibratedAdaptive, kNone, kBilateral, kOracle };

const char* text(Case which) {
  switch (which) {
    case Case::kStatic: return "static";
    case Case::kCalibrated: return "calibrated";
    case Case::kAdaptive: return "adaptive";
    case Case::kCalibratedAdaptive: return "calibrated+adaptive";
    case Case::kNone: return "none";
    case Case::kBilateral: return "bilateral";
    case Case::kOracle: return "oracle";
  }
  return "?";
}

const std::map<std::string, Case> kCaseWords{
    {"static", Case::kStatic},     {"calibrated", Case::kCalibrated},
    {"adaptive", Case::kAdaptive}, {"calibrated+adaptive", Case::kCalibratedAdaptive},
    {"none", Case::kNone},         {"bilateral", Case::kBilateral},
    {"oracle", Case::kOracle}};

bool isCalibrated(Case which) {
  return which == Case::kCalibrated || which == Case::kCalibratedAdaptive;
}

bool adapts(Case which) {
  return which == Case::kAdaptive || which == Case::kCalibratedAdaptive;
}

struct TeleopBenchOptions {
  std::string model = "teleop-model", site = "teleop-site";
  std::vector<std::string> cases;  ///< empty: those suitable for the model
  std::vector<std::string> model_overrides, site_overrides;
  std::vector<double> round_trips_s{0, 0.1, 0.4, 0.85, 2.6, 5};
  LinkOptions link;
  std::optional<double> duration_given_s;
  std::optional<double> release_s;
  std::string task;  ///< empty: the scene's motion
  int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  std::string csv_file, figure_file;
  Overwrite overwrite;
  bool json = false;
  std::optional<bool> mends;  ///< whether a model's surface is adapted; default: if it learns

  [[nodiscard]] double duration() const {
    constexpr double kOfMotion_s = 40, kOfTask_s = 180;
    return duration_given_s.value_or(task.empty() ? kOfMotion_s : kOfTask_s);
  }
};

struct Row {
  double round_trip_s;
  Case which;
  TeleopResult result = {};
  bool is_done = false;
};

/// Estimated duration on one thread for a second of two beds.
constexpr double kThreadSecondsPerSecond = 5;

/// Robot's probe of its site, and the resulting model.
struct Probed {
  ProbedSoil soil;
  SceneFile model;
};

Probed probe(const TeleopBenchOptions& options, StatusLine& status) {
  Progress progress(status);
  const SceneFile site = findSceneFile(options.site, options.site_overrides);
  const Training& training = probeTraining();
  const ProbedSoil soil = probeSite(site, {}, training, progress.part(0, 1));
  return {soil, withBelievedSoil(findSceneFile(options.model, options.model_overrides), soil.belief,
                                 StrengthMap(training.runs))};
}

double gravityOf(const Probed& probed) {
  return probed.model.bed.gravity_m_s2.norm();
}

TeleopSetup setupFor(const TeleopBenchOptions& options, double round_trip_s, Case which,
                     const std::optional<Probed>& probed) {
  TeleopSetup setup;
  setup.model = isCalibrated(which) ? probed->model : findSceneFile(options.model, options.model_overrides);
  setup.site = findSceneFile(options.site, options.site_overrides);
  if (which == Case::kOracle) {
    setup.model.bed = setup.site.bed;
    setup.model.tool = setup.site.tool;
    ++setup.model.bed.seed;
  }
  LinkOptions link = options.link;
  link.round_trip_s = round_trip_s;
  const LinkProfile profile = link.link();
  setup.up = profile.up;
  setup.down = profile.down;
  setup.sending = sendingOver(setup.up, setup.down);
  setup.feedback = which == Case::kBilateral ? Feedback::kBilateral
                   : which == Case::kNone    ? Feedback::kNone
                                             : Feedback::kModel;
  setup.duration_s = options.duration();
  setup.release_s = options.release_s;
  if (!options.task.empty()) {
    setup.task = valueOf(kSiteTaskWords, options.task);
  }
  if (adapts(which)) {
    setup.model = readyToLearn(setup.model);
    setup.learns.emplace(probeTraining().runs);
  }
  setup.mends = options.mends.value_or(adapts(which)) && setup.feedback == Feedback::kModel && canMend(setup.model.bed);
  return setup;
}

Json rowJson(const Row& row) {
  const TeleopResult& result = row.result;
  const double duration_s = result.duration_s;
  return {{"round_trip_s", row.round_trip_s},
          {"case", text(row.which)},
          {"force_error_share", result.agreement.share(0, duration_s)},
          {"force_error_share_last_10_s", result.agreement.share(duration_s - kLast_s, duration_s)},
          {"met_rms_n", result.agreement.rmsMet(0, duration_s)},
          {"off_in_air_m", result.free_m},
          {"off_in_soil_m", result.soil_m},
          {"given_j", result.given_j},
          {"behind_s", result.behind_s},
          {"followed_share", result.followed_share},
          {"taken_back_j", result.taken_back_j},
          {"ran_out", result.ran_out},
          {"stops", result.stops},
          {"known_surface_m", result.known_surface_m},
          {"apart_surface_m", result.apart_surface_m},
          {"task_s", result.task ? Json(result.task->done_s) : Json(nullptr)},
          {"task_strokes", result.task ? Json(result.task->strokes) : Json(nullptr)},
          {"task_reached", result.task ? Json(result.task->reached) : Json(nullptr)},
          {"mended_grains", result.mended},
          {"updates", result.updates},
          {"update_j", result.update_j},
          {"update_jump", result.update_jump},
          {"most_update_jumps", result.most_update_jumps},
          {"lost", result.up.lost + result.up.cut_off + result.down.lost + result.down.cut_off}};
}

/// Formats a percentage; "-" for NaN, without contact.
std::string percentText(double share) {
  return std::isnan(share) ? "-" : fmt::format("{:.1f}", 100 * share);
}

/// Returns the width of the column with the case.
std::size_t caseWidth(const std::vector<Row>& rows) {
  std::size_t width = 10;
  for (const Row& row : rows) {
    width = std::max(width, std::string_view(text(row.which)).size());
  }
  return width;
}

/// @param width  width of the column with the case
std::string rowText(const Row& row, std::size_t width) {
  const TeleopResult& result = row.result;
  const double duration_s = result.duration_s;
  return fmt::format(
      "{:8.2f}  {:{}} {:>7} {:>9} {:8.2f} {:8.3f} {:8.3f} {:8.2f} {:8.2f} {:9.4f} {:8.2f} {:8.1f} {:6}\n",
      row.round_trip_s, text(row.which), width, percentText(result.agreement.share(0, duration_s)),
      percentText(result.agreement.share(duration_s - kLast_s, duration_s)), result.agreement.rmsMet(0, duration_s),
      result.free_m / kBenchMm, result.soil_m / kBenchMm, result.known_surface_m / kBenchMm,
      result.apart_surface_m / kBenchMm, result.given_j / kMillijoule, result.behind_s, 100 * result.followed_share,
      result.stops);
}

/// Returns the result of the task; empty without a task.
std::string taskText(const Row& row, const TeleopBenchOptions& options) {
  const std::optional<TaskResult>& task = row.result.task;
  if (!task) {
    return "";
  }
  const bool trench = options.task == "trench";
  const std::string when = std::isnan(task->done_s) ? fmt::format("not done in {:g} s", options.duration())
                                                    : fmt::format("done after {:.1f} s", task->done_s);
  return fmt::format(
      "{}, {:g} s: {} {}, {}, {} in the end\n", text(row.which), row.round_trip_s, options.task, when,
      pluralise(task->strokes, "try", "tries"),
      trench ? fmt::format("{:.1f} mm", task->reached / kBenchMm) : fmt::format("{:.3f} N", task->reached));
}

/// Returns the learned soil of a model, and the energy and force steps of its updates; empty: it does not learn.
std::string learnedText(const Row& row) {
  const TeleopResult& result = row.result;
  return result.learned ? fmt::format(
                              "{}, {:g} s: in the end {}; {} updates gave {:.4f} mJ, and changed the force within 0.1 "
                              "s by at most {:.2f} times the detection threshold, 95 % of them by {:.2f}\n",
                              text(row.which), row.round_trip_s, soilText(*result.learned), result.updates,
                              result.update_j / kMillijoule, result.update_jump, result.most_update_jumps)
                        : "";
}

/// Writes displayed and measured force per window.
void writeCsv(const OutputFile& file, const std::vector<Row>& rows) {
  AtomicFile table(file);
  table.write("round_trip_s,case,t_s,felt_x_n,felt_y_n,felt_z_n,met_x_n,met_y_n,met_z_n\n");
  for (const Row& row : rows) {
    for (const AgreementPoint& window : row.result.agreement.windows()) {
      const Vec3& displayed = window.displayed_n;
      const Vec3& met = window.met_n;
      table.write(fmt::format("{:g},{},{:.3f},{:.5g},{:.5g},{:.5g},{:.5g},{:.5g},{:.5g}\n", row.round_trip_s,
                              text(row.which), window.time_s, displayed.x(), displayed.y(), displayed.z(), met.x(),
                              met.y(), met.z()));
    }
  }
  table.commit();
}

std::vector<std::string> casesOf(const TeleopBenchOptions& options) {
  if (!options.cases.empty()) {
    return options.cases;
  }
  std::vector<std::string> cases{"static", "oracle"};
  if (canLearn(findSceneFile(options.model, options.model_overrides))) {
    cases.insert(cases.begin() + 1, "adaptive");
  }
  if (!options.release_s) {
    cases.insert(cases.end() - 1, "bilateral");
  }
  return cases;
}

std::vector<Row> rowsFor(const TeleopBenchOptions& options) {
  const std::vector<std::string> cases = casesOf(options);
  std::vector<Row> rows;
  for (const double round_trip_s : options.round_trips_s) {
    for (const std::string& word : cases) {
      const Case which = kCaseWords.at(word);
      const bool delay_counts = which != Case::kOracle || options.mends.value_or(false);  // delay of the height map
      if (delay_counts || round_trip_s == options.round_trips_s.front()) {
        rows.push_back({round_trip_s, which});
      }
    }
  }
  return rows;
}

std::vector<AgreementPanel> panelsOf(const std::vector<Row>& rows) {
  std::vector<AgreementPanel> panels;
  for (const Row& row : rows) {
    const ForceAgreement& agreement = row.result.agreement;
    panels.push_back({fmt::format("{}, round trip {:g} s: {:.0f} %", text(row.which), row.round_trip_s,
                                  100 * agreement.share(0, TeleopRanges::duration_s.highest)),
                      agreement.windows()});
  }
  return panels;
}

/// Writes, draws and prints the results.
void show(const TeleopBenchOptions& options, const std::vector<Row>& rows, const std::optional<Probed>& probed) {
  if (!options.csv_file.empty()) {
    writeCsv(options.overwrite(options.csv_file), rows);
  }
  if (!options.figure_file.empty()) {
    drawAgreement(options.overwrite(options.figure_file), panelsOf(rows));
  }
  if (options.json) {
    Json list = Json::array();
    for (const Row& row : rows) {
      list.push_back(rowJson(row));
    }
    Json json{{"model", options.model}, {"site", options.site}, {"duration_s", options.duration()}, {"runs", list}};
    if (probed) {
      json["identified"] = beliefJson(probed->soil.belief, {}, gravityOf(*probed));
    }
    printJson(json);
    return;
  }
  std::string table =
      probed ? fmt::format("the robot's probe, {} of {} windows match:\n{}\n", probed->soil.windows,
                           probed->soil.of_windows, beliefText(probed->soil.belief, {}, gravityOf(*probed)))
             : "";
  const std::size_t width = caseWidth(rows);
  table += fmt::format("{:{}}force error, %       remote  tracking, mm      surface, mm    energy   behind  follows\n",
                       "round", width + 10);
  table += fmt::format(
      "trip, s   {:{}} total  last 10 s   RMS, N   in air  in soil   known    apart        mJ        s        %  "
      "stops\n",
      "case", width);
  for (const Row& row : rows) {
    table += rowText(row, width);
  }
  for (const Row& row : rows) {
    table += taskText(row, options) + learnedText(row);
  }
  printText(table);
  printNotice(savedText());
}

void runTeleopBench(const TeleopBenchOptions& options) {
  const StopOnSignal stop;
  StatusLine status;
  for (const std::string& file : {options.csv_file, options.figure_file}) {
    if (!file.empty()) {
      requireFree(options.overwrite(file));  // before minutes of work
    }
  }
  std::vector<Row> rows = rowsFor(options);
  const bool feels_robot = std::ranges::any_of(rows, [](const Row& row) { return row.which == Case::kBilateral; });
  if (options.release_s && (feels_robot || !options.task.empty())) {
    throw InvalidParameter("--release-s", fmt::format("{:g}", *options.release_s),
                           "left out with --task and with --case bilateral");
  }
  const bool probes = std::ranges::any_of(rows, [](const Row& row) { return isCalibrated(row.which); });
  const std::optional<Probed> probed = probes ? std::optional(probe(options, status)) : std::nullopt;
  Progress all(status);
  all.expect(static_cast<double>(rows.size()) * options.duration() * kThreadSecondsPerSecond, options.threads);
  std::vector<std::atomic<double>> done(rows.size());
  const std::size_t wanted = rows.size();
  try {
    inParallel(wanted, options.threads, [&](std::size_t row) {
      const auto progress = [&](double share) {
        done[row] = share;
        const double sum = std::accumulate(done.begin(), done.end(), 0.0);
        return all.tell(pluralise(wanted, "run"), sum / static_cast<double>(wanted));
      };
      rows[row].result = simulateTeleop(setupFor(options, rows[row].round_trip_s, rows[row].which, probed), progress);
      rows[row].is_done = true;
      done[row] = 1;
    });
  } catch (const Failure&) {
    std::erase_if(rows, [](const Row& row) { return !row.is_done; });
    if (!stopAsked() || rows.empty()) {
      throw;
    }
  }
  status.clear();
  show(options, rows, probed);
  if (rows.size() < wanted) {
    throw Failure(fmt::format("interrupted after {} of {}", rows.size(), pluralise(wanted, "run")));
  }
}

}  // namespace

void addTeleopBench(CLI::App& teleop) {
  auto options = std::make_shared<TeleopBenchOptions>();
  CLI::App* command = teleop.add_subcommand("bench", "Simulate delayed teleoperation: force error and tracking error");
  command->footer(kTeleopBenchExamples);
  command->add_option("--model", options->model, "Scene of the operator: its hand digs, its soil is rendered")
      ->option_text("SCENE [teleop-model]");
  command->add_option("--set", options->model_overrides, "Set a key of the operator's scene; can be repeated")
      ->option_text("TABLE.KEY=VALUE");
  command->add_option("--site", options->site, "Scene of the robot's site")->option_text("SCENE [teleop-site]");
  command->add_option("--set-site", options->site_overrides, "Set a key of the site's scene; can be repeated")
      ->option_text("TABLE.KEY=VALUE");
  command->add_option("--round-trip-s", options->round_trips_s, "Round-trip delays")
      ->option_text("SECONDS,... [0,0.1,0.4,0.85,2.6,5]")
      ->delimiter(',')
      ->check(numberIn({0, 2 * LinkRanges::delay_s.highest}));
  command
      ->add_option("--profile", options->link.profile,
                   "Link profile with jitter, loss and rate (haptolith teleop link --list)")
      ->option_text("NAME [lan]");
  options->link.addTo(*command);
  command
      ->add_option(
          "--case", options->cases,
          "Cases to compare. static: model of the soil that does not change; calibrated: model calibrated by the "
          "robot's probe; adaptive: model adapted to the robot's forces; calibrated+adaptive: calibrated, "
          "then adapted; none: no force; bilateral: delayed measured force; oracle: model with the robot's "
          "soil, another realisation")
      ->option_text("CASE,... [static,adaptive,bilateral,oracle]")
      ->delimiter(',')
      ->transform([](const std::string& word) { return std::string(currentNameReported(NameKind::kTeleopCase, word)); },
                  "")
      ->check(oneOf({"static", "calibrated", "adaptive", "calibrated+adaptive", "none", "bilateral", "oracle"}));
  command
      ->add_option("--task", options->task,
                   "Task that ends the run. trench: dig 40 mm deep; press: press the tool's face on the soil with 8 N; "
                   "scoop: lift 0.1 N of soil")
      ->option_text("trench|press|scoop [the scene's motion]")
      ->check(oneOf({"trench", "press", "scoop"}));
  command->add_option("--release-s", options->release_s, "Time at which the hand releases the tool; only with a model")
      ->option_text("SECONDS [never]")
      ->check(numberIn(TeleopRanges::release_s));
  command->add_option("--duration-s", options->duration_given_s, "Simulated time of each run; the maximum with a task")
      ->option_text("SECONDS [40; with a task 180]")
      ->check(numberIn(TeleopRanges::duration_s));
  CLI::Option* mend = command->add_flag_callback(
      "--mend", [options] { options->mends = true; },
      "Correct the surface of every model by the robot's camera [of those that learn]");
  command
      ->add_flag_callback(
          "--no-mend", [options] { options->mends = false; }, "Do not correct the surface of the model")
      ->excludes(mend);
  command->add_option("--threads", options->threads, "Number of runs at the same time")
      ->option_text("N [one per core]")
      ->check(wholeNumberIn({1, 256}));
  command->add_option("--csv", options->csv_file, "Write rendered and remote force over time")->option_text("FILE.csv");
  command->add_option("--figure", options->figure_file, "Draw rendered and remote force to this file (.svg or .png)")
      ->option_text("FILE");
  options->overwrite.addTo(*command);
  addJson(*command, options->json);
  command->callback([options] { runTeleopBench(*options); });
}

}  // namespace haptolith
