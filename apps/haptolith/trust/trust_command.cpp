#include <CLI/App.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "haptolith/bed/kernel/simd_target.h"
#include "haptolith/core/error.h"
#include "haptolith/core/platform/clock.h"
#include "haptolith/core/pluralise.h"
#include "haptolith/core/stop_asked.h"
#include "haptolith/lab/archive/report_folder.h"
#include "haptolith/scene_file/scene_words.h"
#include "haptolith/trust/trust_schedule.h"
#include "haptolith/trust/trust_verdict.h"

#include "commands.h"
#include "lab/lab_options.h"
#include "shared/common_options.h"
#include "shared/kept_work.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/overwrite.h"
#include "shared/saved.h"
#include "shared/scene_options.h"
#include "shared/stop_on_signal.h"
#include "workbench_commands.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr double kQuick_min = 2;
constexpr const char* kPage = "trust.md";
constexpr const char* kPageFigure = "trust.svg";

struct TrustOptions {
  SceneOptions scene;
  std::optional<double> duration_s;
  TrustExtent extent;
  std::string tool;  ///< name; empty: the first
  bool quick = false;
  std::string folder;
  bool resume = false, json = false;
  std::string figure_file;
  Overwrite overwrite;
};

/// Result of a run: what is saved and resumed.
struct TrustResult {
  std::optional<TrustForce> force;
  std::string why_not;
};

/// Name of a run's file.
std::string nameOf(const TrustRun& run) {
  return run.change == TrustChange::kRadius
             ? fmt::format("{}-{:.3g}-{}", nameOf(run.change), run.radius_ratio, run.specimen)
             : fmt::format("{}-{}", nameOf(run.change), run.specimen);
}

Json forceJson(const TrustForce& force) {
  return {{"mean_n", force.mean_n},
          {"peak_n", force.peak_n},
          {"depth_m", force.reach.depth_m},
          {"to_floor_m", force.reach.to_floor_m},
          {"to_wall_x_m", force.reach.to_wall_x_m},
          {"to_wall_y_m", force.reach.to_wall_y_m},
          {"surface_m", force.surface_m},
          {"particles", force.particles},
          {"substeps", force.substeps},
          {"settling_s", force.settling_s},
          {"movement_s", force.movement_s},
          {"work_j", force.work_j},
          {"energy_gain_j", force.energy_gain_j},
          {"stress_ratio", force.stress_ratio ? Json(*force.stress_ratio) : Json(nullptr)},
          {"hash", force.hash}};
}

TrustForce forceFrom(const Json& json) {
  TrustForce force;
  json.at("mean_n").get_to(force.mean_n);
  json.at("peak_n").get_to(force.peak_n);
  json.at("depth_m").get_to(force.reach.depth_m);
  json.at("to_floor_m").get_to(force.reach.to_floor_m);
  json.at("to_wall_x_m").get_to(force.reach.to_wall_x_m);
  json.at("to_wall_y_m").get_to(force.reach.to_wall_y_m);
  json.at("surface_m").get_to(force.surface_m);
  json.at("particles").get_to(force.particles);
  json.at("substeps").get_to(force.substeps);
  json.at("settling_s").get_to(force.settling_s);
  json.at("movement_s").get_to(force.movement_s);
  json.at("work_j").get_to(force.work_j);
  json.at("energy_gain_j").get_to(force.energy_gain_j);
  if (const Json& ratio = json.at("stress_ratio"); !ratio.is_null()) {
    force.stress_ratio = ratio.get<double>();
  }
  json.at("hash").get_to(force.hash);
  return force;
}

Json strengthJson(const TrustStrength& strength) {
  return {strength.asked_deg, strength.shown_deg, strength.error_deg,
          strength.asked_pa,  strength.shown_pa,  strength.error_pa};
}

TrustStrength strengthFrom(const Json& json) {
  const auto at = [&](std::size_t i) { return json.at(i).get<double>(); };
  return {at(0), at(1), at(2), at(3), at(4), at(5)};
}

/// The examination of one scene.
class Examination {
 public:
  explicit Examination(const TrustOptions& options);

  void complete();
  void report();

 private:
  [[nodiscard]] std::vector<TrustForce> measureFirst();
  [[nodiscard]] std::optional<TrustResult> saved(const TrustRun& run) const;
  [[nodiscard]] TrustResult measured(const TrustRun& run, int threads, const TrustProgress& progress) const;
  void measureStrengthOnce();
  [[nodiscard]] std::string heading() const;
  [[nodiscard]] std::string command() const;
  void savePage(const TrustVerdict& verdict) const;

  TrustOptions options_;
  StatusLine status_;
  SceneFile scene_;
  TrustExtent extent_;
  std::optional<ReportFolder> folder_;
  TrustSchedule schedule_;
  std::optional<TrustBits> bits_;
  std::optional<TrustStrength> strength_;
  double took_s_ = 0;
};

Examination::Examination(const TrustOptions& options)
    : options_(options), scene_(sceneFileFor(options.scene)), extent_(options.extent) {
  validate(scene_);
  exchangeFirst(scene_, options.tool.empty() ? 0 : toolNumber(scene_, options.tool));
  extent_.duration_s = options.duration_s.value_or(usualDuration(scene_));
  extent_.threads = threadsFor(options.scene.threads.value_or(0));
  extent_.minutes = options.quick ? kQuick_min : extent_.minutes;
  if (!options.folder.empty()) {
    const Json conditions{{"trust", "haptolith " HAPTOLITH_VERSION},
                          {"scene", sceneFileText(scene_)},
                          {"duration_s", extent_.duration_s},
                          {"simd", simdTarget()}};
    folder_.emplace(options.folder, conditions,
                    options.resume              ? ReportThere::kResume
                    : options.overwrite.allowed ? ReportThere::kReplace
                                                : ReportThere::kRefuse,
                    std::vector<std::string>{kPage, kPageFigure});
  }
}

std::optional<TrustResult> Examination::saved(const TrustRun& run) const {
  const std::optional<Json> json = folder_ ? folder_->result(nameOf(run)) : std::nullopt;
  if (!json) {
    return std::nullopt;
  }
  try {
    return json->contains("why_not") ? TrustResult{{}, json->at("why_not").get<std::string>()}
                                     : TrustResult{forceFrom(*json), {}};
  } catch (const Json::exception&) {
    throw Failure(fmt::format("{} is not a result of trust: remove it, and --resume repeats the run",
                              folder_->resultFile(nameOf(run)).string()));
  }
}

/// Also a run that fails is a result.
TrustResult Examination::measured(const TrustRun& run, int threads, const TrustProgress& progress) const {
  TrustResult result;
  try {
    result.force = measureForce(run, extent_.duration_s, threads, progress);
  } catch (const Failure& failure) {
    if (stopAsked()) {
      throw;
    }
    result.why_not = failure.what();
  } catch (const InvalidParameter& refused) {
    result.why_not = refused.what();
  }
  if (folder_) {
    folder_->save(nameOf(run), result.force ? forceJson(*result.force) : Json{{"why_not", result.why_not}});
  }
  return result;
}

std::vector<TrustForce> Examination::measureFirst() {
  std::vector<TrustForce> first;
  Progress progress(status_);
  for (const TrustRun& run : firstRuns(scene_)) {
    std::optional<TrustResult> result = saved(run);
    if (!result) {
      result = measured(run, extent_.threads, [&](std::string_view what, double fraction) {
        return progress.tell(fmt::format("the scene as it is: {}", what), fraction);
      });
    }
    if (!result->force) {
      throw Failure(fmt::format("the scene cannot be examined: {}", result->why_not));
    }
    first.push_back(*result->force);
  }
  status_.clear();
  return first;
}

void Examination::complete() {
  const std::int64_t began_ns = monotonicNs();
  const std::vector<TrustForce> first = measureFirst();
  schedule_ = scheduled(scene_, extent_, first);
  std::vector<std::size_t> missing;
  std::vector<double> lengths_s;
  for (std::size_t i = 0; i < schedule_.runs.size(); ++i) {
    const TrustScheduled& run = schedule_.runs[i];
    lengths_s.push_back(run.length_s);
    if (const std::optional<TrustResult> result = saved(run.run)) {
      take(schedule_, run, result->force, result->why_not);
    } else if (run.run.change == TrustChange::kNone && run.run.specimen < first.size()) {
      take(schedule_, run, first[run.run.specimen], {});
    } else {
      missing.push_back(i);
    }
  }
  KeptWork work(std::move(lengths_s), extent_.threads, status_);
  const auto simulate = [&](std::size_t index) {
    const TrustScheduled& run = schedule_.runs[index];
    const std::string title =
        fmt::format("{}, specimen {}", titleOf(run.run.change, run.run.radius_ratio), run.run.specimen + 1);
    const TrustResult result = measured(run.run, work.threadsEach(), work.progressOf(index, title));
    work.finish(index, [&] {
      take(schedule_, run, result.force, result.why_not);
      return result.force
                 ? fmt::format("{}: mean {:.3g}, peak {:.3g} N", title, result.force->mean_n, result.force->peak_n)
                 : fmt::format("{}: {}", title, result.why_not);
    });
  };
  try {
    work.run(missing, folder_ ? folder_->path() : "", simulate);
  } catch (const Failure&) {
    if (stopAsked() && !folder_) {
      throw Failure("interrupted: nothing was saved; with --out FOLDER results are kept, and --resume continues");
    }
    throw;
  }
  if (extent_.wants("bits")) {
    Progress progress(status_);
    bits_ = checkBits(firstRuns(scene_).front(), extent_.duration_s,
                      [&](std::string_view what, double fraction) { return progress.tell(what, fraction); });
  }
  if (extent_.wants("strength") && fitsStrength(extent_)) {
    measureStrengthOnce();
  }
  status_.clear();
  took_s_ = 1e-9 * static_cast<double>(monotonicNs() - began_ns);
}

void Examination::measureStrengthOnce() {
  const std::optional<SoilTarget> target = strengthAskedFor(scene_);
  if (!target) {
    return;
  }
  const std::string name = "strength";
  if (const std::optional<Json> saved = folder_ ? folder_->result(name) : std::nullopt) {
    try {
      strength_ = strengthFrom(*saved);
    } catch (const Json::exception&) {
      throw Failure(fmt::format("{} is not a result of trust: remove it, and --resume repeats the test",
                                folder_->resultFile(name).string()));
    }
    return;
  }
  Progress progress(status_);
  strength_ = measureStrength(scene_.bed.soil, *target, scene_.bed.gravity_m_s2.norm(), extent_.threads,
                              [&](std::string_view what, double fraction) { return progress.tell(what, fraction); });
  if (folder_) {
    folder_->save(name, strengthJson(*strength_));
  }
}

std::string Examination::heading() const {
  return fmt::format("{}: {}\n{} s of {}, {}, {}", options_.scene.scene(), scene_.title,
                     fmt::format("{:g}", extent_.duration_s), wordFor(kHandMotionWords, scene_.hand.motion),
                     sceneInWords(scene_), pluralise(extent_.specimens, "specimen"));
}

std::string Examination::command() const {
  std::string command = "haptolith trust " + options_.scene.scene();
  for (const std::string& key : options_.scene.overrides) {
    command += fmt::format(" --set {}", key);
  }
  const auto add = [&](std::string_view option, const auto& value) {
    command += value ? fmt::format(" --{} {}", option, *value) : "";
  };
  add("preset", options_.scene.preset);
  add("soil", options_.scene.soil);
  add("body", options_.scene.body);
  add("poses", options_.scene.poses_file);
  add("seed", options_.scene.seed);
  add("duration-s", options_.duration_s);
  if (options_.scene.friction) {
    command += fmt::format(" --friction-model {}", wordFor(kFrictionWords, *options_.scene.friction));
  }
  if (options_.scene.motion) {
    command += fmt::format(" --motion {}", wordFor(kHandMotionWords, *options_.scene.motion));
  }
  command += options_.tool.empty() ? "" : fmt::format(" --tool {}", options_.tool);
  command += extent_.only.empty() ? "" : fmt::format(" --only {}", fmt::join(extent_.only, ","));
  command += options_.quick                             ? " --quick"
             : extent_.minutes != TrustExtent{}.minutes ? fmt::format(" --minutes {:g}", extent_.minutes)
                                                        : "";
  command += extent_.specimens != TrustExtent{}.specimens ? fmt::format(" --specimens {}", extent_.specimens) : "";
  return command;
}

void Examination::savePage(const TrustVerdict& verdict) const {
  drawTrust({folder_->path() / kPageFigure, IfThere::kReplace}, verdict, scene_.title);
  AtomicFile file({folder_->page(), IfThere::kReplace});
  const std::string table = trustText(verdict);
  file.write(fmt::format("# {}\n\n    {}\n\n**{}**\n\n```\n{}```\n\n![Changes of the force]({})\n", scene_.title,
                         command(), verdict.sentence, table.substr(table.find('\n') + 1), kPageFigure));
  file.commit();
}

void Examination::report() {
  const TrustVerdict verdict = judgeTrust(scene_, schedule_.rows, strength_);
  if (!options_.figure_file.empty()) {
    drawTrust(options_.overwrite(options_.figure_file), verdict, scene_.title);
  }
  if (folder_) {
    savePage(verdict);
  }
  double work_j = 0, gain_j = 0;
  int specimens = 0;  // at least 2, or there is no verdict
  for (const std::optional<TrustForce>& force : schedule_.rows.front().specimens) {
    work_j += force ? force->work_j : 0;
    gain_j += force ? force->energy_gain_j : 0;
    specimens += force ? 1 : 0;
  }
  work_j /= specimens;
  gain_j /= specimens;
  if (options_.json) {
    Json json{{"scene", options_.scene.scene()},
              {"title", scene_.title},
              {"duration_s", extent_.duration_s},
              {"specimens", extent_.specimens},
              {"command", command()}};
    json.update(trustJson(verdict));
    if (bits_) {
      json["same_bits"] = {{"threads", bits_->threads}, {"restart", bits_->restart}};
      json["rounding"] = bits_->rounding ? Json(*bits_->rounding) : Json(nullptr);
    }
    json["energy_j"] = {{"work", work_j}, {"gain", gain_j}};
    json["took_s"] = took_s_;
    printJson(json);
    return;
  }
  std::string text = heading() + "\n\n" + trustText(verdict);
  if (bits_) {
    text += fmt::format("  Bits on one and two threads: {}. Continued from a saved state: {}.\n",
                        bits_->threads ? "equal" : "different", bits_->restart ? "equal" : "different");
    text += bits_->rounding ? fmt::format(
                                  "  A step in single precision differs from one in double by {:.1e} of the "
                                  "contact forces.\n",
                                  *bits_->rounding)
                            : "";
  }
  text +=
      fmt::format("  Work of the tools {:.3g} J; the soil holds {:.3g} J more at the end, friction took the rest.\n",
                  work_j, gain_j);
  text += fmt::format("  {}\n", durationText(took_s_));
  printText(text);
}

void runTrust(const TrustOptions& options) {
  const StopOnSignal stop_on_signal;
  if (!options.figure_file.empty()) {
    requireWritable({options.overwrite(options.figure_file)});
  }
  if (options.duration_s) {
    requireInRange("duration-s", *options.duration_s, TrustExtent::kDuration_s);
  }
  requireInRange("minutes", options.extent.minutes, TrustExtent::kMinutes);
  Examination examination(options);
  examination.complete();
  examination.report();
  const std::string saved = savedText();
  if (!saved.empty() && !options.json) {
    printText(saved);
  }
}

}  // namespace

void addTrustCommand(CLI::App& app) {
  auto options = std::make_shared<TrustOptions>();
  CLI::App* command = app.add_subcommand("trust", kTrustDescription);
  options->scene.addTo(*command);
  command->add_option("--tool", options->tool,
                      "Name of the tool whose force is judged, where there are several [the first]");
  command->add_option("--duration-s", options->duration_s, "Length of the movement [one motion of the hand]")
      ->option_text("SECONDS");
  command->add_option("--specimens", options->extent.specimens, "Number of specimens of each comparison, 2 to 100")
      ->check(wholeNumberIn(TrustExtent::kSpecimens))
      ->capture_default_str();
  CLI::Option* minutes = command
                             ->add_option("--minutes", options->extent.minutes,
                                          "Approximate time; what does not fit is left out, and named")
                             ->capture_default_str();
  command
      ->add_option("--only", options->extent.only,
                   "Only these comparisons: wide-x, wide-y, deep, radius, step, awake, stiff, mesh, bits, strength, or "
                   "specimen for none of them")
      ->delimiter(',')
      ->check(CLI::IsMember(std::vector<std::string>{"specimen", "wide-x", "wide-y", "deep", "radius", "step", "awake",
                                                     "stiff", "mesh", "bits", "strength"}));
  command->add_flag("--quick", options->quick, fmt::format("As --minutes {:g}", kQuick_min))->excludes(minutes);
  CLI::Option* folder =
      command->add_option("--out", options->folder, "Folder for each result as soon as it is there, and a page [none]");
  CLI::Option* resume = command->add_flag("--resume", options->resume, "Continue in that folder")->needs(folder);
  command->add_option("--figure", options->figure_file, kFigureHelp);
  options->overwrite.addTo(*command);
  command->get_option("--overwrite")->excludes(resume);
  addJson(*command, options->json);
  command->footer(
      "Examples:\n  haptolith trust regolith --quick\n  haptolith trust my-scene.toml --out my-trust --figure "
      "trust.svg\n"
      "  haptolith trust regolith --set bed.depth_mm=70 --set hand.motion=press");
  command->callback([options] { runTrust(*options); });
}

}  // namespace haptolith
