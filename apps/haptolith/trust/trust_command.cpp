#include <CLI/App.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "haptolith/bed/kernel/simd_target.h"
#include "haptolith/core/clock.h"
#include "haptolith/core/error.h"
#include "haptolith/core/pluralise.h"
#include "haptolith/lab/archive/report_folder.h"
#include "haptolith/scene_file/scene_words.h"
#include "haptolith/scene_file/soil_file.h"
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

constexpr Range kTrustSpecimens{2, 100};
constexpr Range kTrustMinutes{0.1, 1e4};
constexpr double kQuick_min = 2;
constexpr const char* kPage = "trust.md";
constexpr const char* kPageFigure = "trust.svg";

struct TrustOptions {
  SceneOptions scene;
  std::optional<double> duration_s;
  int specimens = 5;
  double minutes = 30;
  std::vector<std::string> only;
  bool quick = false;
  std::string folder;
  bool resume = false, json = false;
  std::string figure_file;
  Overwrite overwrite;
};

/// A simulation: the unit that is run, saved and resumed.
struct TrustPiece {
  std::size_t row = 0;
  TrustRun run;
  std::string name;
  double length_s = 0;
  std::optional<TrustForce> force;
  std::string why_not;
};

Json forceJson(const TrustForce& force) {
  return {{"mean_n", force.mean_n},
          {"peak_n", force.peak_n},
          {"windows_n", force.window_n},
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
          {"hash", force.hash}};
}

TrustForce forceFrom(const Json& json) {
  TrustForce force;
  json.at("mean_n").get_to(force.mean_n);
  json.at("peak_n").get_to(force.peak_n);
  json.at("windows_n").get_to(force.window_n);
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
  void measureOnce();
  void plan();
  void add(TrustChange change, int specimens, double radius_ratio = 1);
  void take(TrustPiece& piece);
  [[nodiscard]] bool takeSaved(TrustPiece& piece) const;
  void measure(TrustPiece& piece, int threads, const TrustProgress& progress) const;
  void measureStrengthOnce();
  [[nodiscard]] bool isWanted(std::string_view what) const {
    return options_.only.empty() || std::ranges::find(options_.only, what) != options_.only.end();
  }
  [[nodiscard]] double budget() const { return 60 * (options_.quick ? kQuick_min : options_.minutes); }
  [[nodiscard]] std::vector<TrustForces> forces() const;
  [[nodiscard]] std::string heading() const;
  [[nodiscard]] std::string command() const;
  void savePage(const TrustVerdict& verdict) const;

  TrustOptions options_;
  StatusLine status_;
  SceneFile scene_;
  double duration_s_ = 0;
  int threads_ = 1;
  std::optional<ReportFolder> folder_;
  std::vector<TrustForces> rows_;
  std::vector<TrustPiece> pieces_;
  double alone_s_ = 0;  ///< of the scene itself, once
  std::optional<double> surface_over_soil_m_;
  std::optional<TrustBits> bits_;
  std::optional<TrustStrength> strength_;
  double took_s_ = 0;
};

/// One motion of the scene's hand, or 2 s of a still one.
double usualDuration(const SceneFile& scene) {
  return scene.hand.motion == HandMotion::kStill ? 2 : scene.hand.period_s;
}

Examination::Examination(const TrustOptions& options)
    : options_(options),
      scene_(sceneFileFor(options.scene)),
      duration_s_(options.duration_s.value_or(usualDuration(scene_))),
      threads_(threadsFor(options.scene.threads.value_or(0))) {
  requireOneTool(scene_, "a verdict");
  validate(scene_);
  if (!options.folder.empty()) {
    const Json conditions{{"trust", "haptolith " HAPTOLITH_VERSION},
                          {"scene", sceneFileText(scene_)},
                          {"duration_s", duration_s_},
                          {"simd", simdTarget()}};
    folder_.emplace(options.folder, conditions,
                    options.resume              ? ReportThere::kResume
                    : options.overwrite.allowed ? ReportThere::kReplace
                                                : ReportThere::kRefuse,
                    std::vector<std::string>{kPage, kPageFigure});
  }
}

bool Examination::takeSaved(TrustPiece& piece) const {
  const std::optional<Json> saved = folder_ ? folder_->result(piece.name) : std::nullopt;
  if (!saved) {
    return false;
  }
  try {
    if (saved->contains("why_not")) {
      piece.why_not = saved->at("why_not").get<std::string>();
    } else {
      piece.force = forceFrom(*saved);
    }
  } catch (const Json::exception&) {
    throw Failure(fmt::format("{} is not a result of trust: remove it, and --resume repeats the run",
                              folder_->resultFile(piece.name).string()));
  }
  return true;
}

void Examination::measure(TrustPiece& piece, int threads, const TrustProgress& progress) const {
  try {
    piece.force = measureForce(piece.run, duration_s_, threads, progress);
  } catch (const Failure& failure) {
    if (std::string_view(failure.what()) == "interrupted") {
      throw;
    }
    piece.why_not = failure.what();
  } catch (const InvalidParameter& refused) {
    piece.why_not = refused.what();
  }
  if (folder_) {
    folder_->save(piece.name, piece.force ? forceJson(*piece.force) : Json{{"why_not", piece.why_not}});
  }
}

/// Adds a row with its runs, or with the reason why there are none.
void Examination::add(TrustChange change, int specimens, double radius_ratio) {
  TrustForces row{.change = change, .radius_ratio = radius_ratio, .specimens = {}, .why_not = {}};
  row.specimens.resize(static_cast<std::size_t>(specimens));
  for (int i = 0; i < specimens; ++i) {
    PlannedRun plan = planned(scene_, change, static_cast<std::size_t>(i), radius_ratio);
    if (!plan.run) {
      row.why_not = plan.why_not;
      row.specimens.clear();
      break;
    }
    TrustPiece piece{
        .row = rows_.size(), .run = std::move(*plan.run), .name = {}, .length_s = {}, .force = {}, .why_not = {}};
    piece.run.surface_over_soil_m = change == TrustChange::kDeep ? surface_over_soil_m_ : std::nullopt;
    piece.name = change == TrustChange::kRadius ? fmt::format("{}-{:.3g}-{}", nameOf(change), radius_ratio, i)
                                                : fmt::format("{}-{}", nameOf(change), i);
    piece.length_s = alone_s_ * relativeCost(change, radius_ratio);
    pieces_.push_back(std::move(piece));
  }
  rows_.push_back(std::move(row));
}

/// The scene as it is: how long it takes decides what there is time for.
void Examination::measureOnce() {
  PlannedRun plan = planned(scene_, TrustChange::kNone, 0);
  if (!plan.run) {
    throw Failure(fmt::format("the scene cannot be examined: {}", plan.why_not));
  }
  TrustPiece piece{
      .row = 0, .run = std::move(*plan.run), .name = "specimen-0", .length_s = {}, .force = {}, .why_not = {}};
  if (!takeSaved(piece)) {
    Progress progress(status_);
    measure(piece, 1, [&](std::string_view what, double fraction) {
      return progress.tell(fmt::format("the scene as it is: {}", what), fraction);
    });
    status_.clear();
  }
  if (!piece.force) {
    throw Failure(fmt::format("the scene cannot be examined: {}", piece.why_not));
  }
  constexpr double kLeast_s = 0.2;
  alone_s_ = std::max(kLeast_s, piece.force->settling_s + piece.force->movement_s);
  if (scene_.hand.surface_m) {
    surface_over_soil_m_ = *scene_.hand.surface_m - piece.force->surface_m;
  }
}

/// What fits into the time, most telling first.
void Examination::plan() {
  const double budget_s = budget() * threads_;
  double planned_s = 0;
  const auto fits = [&](TrustChange change, int specimens, double radius_ratio) {
    const double cost_s = alone_s_ * relativeCost(change, radius_ratio) * specimens;
    if (planned_s + cost_s > budget_s) {
      return false;
    }
    planned_s += cost_s;
    return true;
  };
  const int specimens = options_.specimens;
  const int some = std::min(specimens, 3);
  (void)fits(TrustChange::kNone, specimens, 1);
  add(TrustChange::kNone, specimens);
  const auto addIfItFits = [&](TrustChange change) {
    if (!isWanted(nameOf(change))) {
      return;
    }
    const int count = fits(change, specimens, 1) ? specimens : fits(change, some, 1) ? some : 0;
    if (count > 0) {
      add(change, count);
    } else {
      rows_.push_back({.change = change, .radius_ratio = 1, .specimens = {}, .why_not = "no time; see --minutes"});
    }
  };
  addIfItFits(TrustChange::kWideX);
  addIfItFits(TrustChange::kWideY);
  addIfItFits(TrustChange::kDeep);
  const auto addRadius = [&] {
    for (const double ratio : {0.5, 0.71, 1.5}) {
      for (const int count : {specimens, some}) {
        if (fits(TrustChange::kRadius, count, ratio)) {
          add(TrustChange::kRadius, count, ratio);
          return;
        }
      }
    }
    rows_.push_back(
        {.change = TrustChange::kRadius, .radius_ratio = 0.5, .specimens = {}, .why_not = "no time; see --minutes"});
  };
  if (isWanted(nameOf(TrustChange::kRadius))) {
    addRadius();
  }
  for (const TrustChange change : {TrustChange::kStep, TrustChange::kStiff, TrustChange::kAwake, TrustChange::kMesh}) {
    addIfItFits(change);
  }
}

void Examination::take(TrustPiece& piece) {
  TrustForces& row = rows_[piece.row];
  row.specimens[piece.run.specimen] = piece.force;
  if (!piece.why_not.empty()) {
    row.why_not = piece.why_not;
  }
}

void Examination::complete() {
  const std::int64_t began_ns = monotonicNs();
  measureOnce();
  plan();
  std::vector<std::size_t> missing;
  std::vector<double> lengths_s;
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    lengths_s.push_back(pieces_[i].length_s);
    if (!takeSaved(pieces_[i])) {
      missing.push_back(i);
    }
  }
  KeptWork work(std::move(lengths_s), threads_, status_);
  work.run(missing, folder_ ? folder_->path() : "no folder (see --out)", [&](std::size_t index) {
    TrustPiece& piece = pieces_[index];
    const std::string title =
        fmt::format("{}, specimen {}", titleOf(piece.run.change, piece.run.radius_ratio), piece.run.specimen + 1);
    measure(piece, work.threadsEach(), work.progressOf(index, title));
    work.finish(index, [&] {
      return piece.force
                 ? fmt::format("{}: mean {:.3g}, peak {:.3g} N", title, piece.force->mean_n, piece.force->peak_n)
                 : fmt::format("{}: {}", title, piece.why_not);
    });
  });
  for (TrustPiece& piece : pieces_) {
    take(piece);
  }
  if (isWanted("bits")) {
    Progress progress(status_);
    bits_ = checkBits(*planned(scene_, TrustChange::kNone, 0).run, std::min(duration_s_, 1.0),
                      [&](std::string_view what, double fraction) { return progress.tell(what, fraction); });
  }
  if (isWanted("strength")) {
    measureStrengthOnce();
  }
  status_.clear();
  took_s_ = 1e-9 * static_cast<double>(monotonicNs() - began_ns);
}

/// Of a soil with a name: of others nobody said how strong they should be.
void Examination::measureStrengthOnce() {
  constexpr double kTypical_s = 150;
  if (scene_.soil_name.empty() || scene_.bed.soil.friction != FrictionModel::kContact ||
      (options_.only.empty() && kTypical_s > 0.25 * budget() * threads_)) {
    return;
  }
  const NamedSoil soil = findSoilOrPreset(scene_.soil_name);
  if (!soil.file) {
    return;
  }
  const std::string name = "strength";
  if (const std::optional<Json> saved = folder_ ? folder_->result(name) : std::nullopt) {
    strength_ = strengthFrom(*saved);
    return;
  }
  Progress progress(status_);
  strength_ = measureStrength(scene_.bed.soil, soil.file->target, scene_.bed.gravity_m_s2.norm(), threads_,
                              [&](std::string_view what, double fraction) { return progress.tell(what, fraction); });
  if (folder_) {
    folder_->save(name, strengthJson(*strength_));
  }
}

std::string Examination::heading() const {
  return fmt::format("{}: {}\n{} s of {}, {}, {}", options_.scene.scene(), scene_.title,
                     fmt::format("{:g}", duration_s_), wordFor(kHandMotionWords, scene_.hand.motion),
                     sceneInWords(scene_), pluralise(options_.specimens, "specimen"));
}

std::string Examination::command() const {
  std::string command = "haptolith trust " + options_.scene.scene();
  for (const std::string& key : options_.scene.overrides) {
    command += fmt::format(" --set {}", key);
  }
  command += options_.quick                               ? " --quick"
             : options_.minutes != TrustOptions{}.minutes ? fmt::format(" --minutes {:g}", options_.minutes)
                                                          : "";
  command += options_.specimens != TrustOptions{}.specimens ? fmt::format(" --specimens {}", options_.specimens) : "";
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
  const TrustVerdict verdict = judgeTrust(scene_, rows_, strength_);
  if (!options_.figure_file.empty()) {
    drawTrust(options_.overwrite(options_.figure_file), verdict, scene_.title);
  }
  if (folder_) {
    savePage(verdict);
  }
  double work_j = 0, gain_j = 0;
  for (const std::optional<TrustForce>& force : rows_.front().specimens) {
    work_j += force ? force->work_j : 0;
    gain_j += force ? force->energy_gain_j : 0;
  }
  if (options_.json) {
    Json json{{"scene", options_.scene.scene()},
              {"title", scene_.title},
              {"duration_s", duration_s_},
              {"specimens", options_.specimens},
              {"command", command()}};
    json.update(trustJson(verdict));
    if (bits_) {
      json["same_bits"] = {{"threads", bits_->threads}, {"restart", bits_->restart}};
    }
    json["energy_j"] = {{"work", work_j / options_.specimens}, {"gain", gain_j / options_.specimens}};
    json["took_s"] = took_s_;
    printJson(json);
    return;
  }
  std::string text = heading() + "\n\n" + trustText(verdict);
  if (bits_) {
    text += fmt::format("  Bits on one and two threads: {}. Continued from a saved state: {}.\n",
                        bits_->threads ? "the same" : "they differ", bits_->restart ? "the same" : "they differ");
  }
  text += fmt::format("  Work of the tool {:.3g} J; the soil holds {:.3g} J more at the end, friction took the rest.\n",
                      work_j / options_.specimens, gain_j / options_.specimens);
  text += fmt::format("  {}\n", durationText(took_s_));
  printText(text);
}

void runTrust(const TrustOptions& options) {
  const StopOnSignal stop_on_signal;
  if (!options.figure_file.empty()) {
    requireWritable({options.overwrite(options.figure_file)});
  }
  if (options.duration_s) {
    requireInRange("duration-s", *options.duration_s, {TrustForce::kWindow_s, 3600});
  }
  requireInRange("minutes", options.minutes, kTrustMinutes);
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
  command->add_option("--duration-s", options->duration_s, "Length of the movement [one motion of the hand]")
      ->option_text("SECONDS");
  command->add_option("--specimens", options->specimens, "Number of specimens of each comparison, 2 to 100")
      ->check(wholeNumberIn(kTrustSpecimens))
      ->capture_default_str();
  CLI::Option* minutes =
      command->add_option("--minutes", options->minutes, "Approximate time; what does not fit is left out, and named")
          ->capture_default_str();
  command
      ->add_option("--only", options->only,
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
