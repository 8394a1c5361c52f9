#include <CLI/App.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/former_names.h"
#include "haptolith/core/platform/clock.h"
#include "haptolith/figure/figure.h"
#include "haptolith/lab/archive/report_folder.h"
#include "haptolith/lab/archive/report_results.h"
#include "haptolith/lab/catalogue/lab_test.h"
#include "haptolith/lab/report/report_page.h"
#include "haptolith/lab/report/specimen_statistics.h"
#include "haptolith/scene_file/scene_words.h"
#include "haptolith/soil/bodies.h"

#include "commands.h"
#include "lab/lab_options.h"
#include "shared/kept_work.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/saved.h"
#include "shared/stop_on_signal.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr Range kReportSeeds{1, 100};
constexpr std::array kModels{FrictionModel::kContact, FrictionModel::kIcra2021};

struct ReportOptions {
  LabOptions lab;
  std::string folder = "lab-report";
  std::vector<std::string> only;
  int seeds = 3;
  bool resume = false;
};

std::vector<LabTest> testsOfReports() {
  std::vector<LabTest> tests = labTests();
  std::erase_if(tests, [](const LabTest& test) { return !test.in_report; });
  return tests;
}

std::vector<LabTest> testsOf(const ReportOptions& options) {
  std::vector<LabTest> tests = testsOfReports();
  if (!options.only.empty()) {
    std::erase_if(
        tests, [&](const LabTest& test) { return std::ranges::find(options.only, test.name) == options.only.end(); });
  }
  return tests;
}

/// Returns all conditions of the results.
Json conditionsJson(const ReportOptions& options, const LabSoil& soil, const LabConditions& conditions) {
  std::vector<std::string> names;
  for (const LabTest& test : testsOf(options)) {
    names.push_back(test.name);
  }
  return {{"program", "haptolith " HAPTOLITH_VERSION},
          {"soil", soil.name},
          {"body", findBody(options.lab.body).name},
          {"gravity_m_s2", conditions.gravity_m_s2},
          {"seed", options.lab.seed},
          {"seeds", options.seeds},
          {"tests", fmt::format("{}", fmt::join(names, " "))},
          {"particles", soilJson(soil.soil)},
          {"target", targetJson(soil.target)}};
}

/// Returns "1 to 3", or "1".
std::string seedsText(const ReportOptions& options) {
  const std::uint64_t first = options.lab.seed;
  return options.seeds > 1 ? fmt::format("{} to {}", first, first + static_cast<std::uint64_t>(options.seeds) - 1)
                           : fmt::format("{}", first);
}

/// One test with one friction model and one seed: the unit that is run, saved and resumed.
struct ReportPiece {
  std::size_t test = 0;
  FrictionModel model{};
  std::uint64_t seed = 1;
};

/// Report in progress. Several threads run pieces.
class Report {
 public:
  /// @throws Failure as ReportFolder, if a result cannot be read, and without gnuplot.
  explicit Report(const ReportOptions& options);

  /// Runs the missing pieces. @throws Failure if a result cannot be saved, and when interrupted; finished pieces are
  /// saved.
  void complete();

 private:
  void measure(std::size_t index);
  [[nodiscard]] ReportResult tried(std::size_t index, Json& document);
  void keep(std::size_t index, ReportResult result, const Json& document);

  [[nodiscard]] LabSoil soilOf(const ReportPiece& piece) const;
  [[nodiscard]] LabConditions conditionsOf(const ReportPiece& piece, const LabSoil& soil) const;
  [[nodiscard]] std::string captionOf(const ReportPiece& piece) const;
  [[nodiscard]] std::string fileNameOf(const ReportPiece& piece) const;
  [[nodiscard]] std::string titleOf(const ReportPiece& piece) const;

  [[nodiscard]] std::size_t done() const;
  [[nodiscard]] ReportCell cellOf(std::size_t test, FrictionModel model) const;
  [[nodiscard]] std::string missingText() const;
  [[nodiscard]] ReportPage page() const;

  ReportOptions options_;
  StatusLine status_;
  LabSoil soil_;
  LabConditions conditions_;
  std::vector<LabTest> tests_;
  std::vector<ReportPiece> pieces_;  ///< the first seed first, so that a partial report has a value for each test
  std::optional<ReportFolder> folder_;
  std::vector<std::optional<ReportResult>> results_;  ///< one per piece
  std::optional<KeptWork> work_;
};

Report::Report(const ReportOptions& options)
    : options_(options),
      soil_(labSoil(options.lab, 0)),
      conditions_(labConditions(options.lab, soil_, {})),
      tests_(testsOf(options)) {
  for (int i = 0; i < options.seeds; ++i) {
    for (std::size_t test = 0; test < tests_.size(); ++test) {
      for (const FrictionModel model : kModels) {
        pieces_.push_back({test, model, options.lab.seed + static_cast<std::uint64_t>(i)});
      }
    }
  }
  // Fails here without gnuplot, not after the first test.
  const Figure drawable(temporaryBeside(std::filesystem::temp_directory_path() / "haptolith.png", "try"), 100, 100);
  folder_.emplace(options.folder, conditionsJson(options, soil_, conditions_),
                  options.resume                  ? ReportThere::kResume
                  : options.lab.overwrite.allowed ? ReportThere::kReplace
                                                  : ReportThere::kRefuse);
  results_.reserve(pieces_.size());
  for (const ReportPiece& piece : pieces_) {
    const std::optional<Json> saved = folder_->result(fileNameOf(piece));
    try {
      results_.push_back(saved ? std::optional(resultFrom(*saved)) : std::nullopt);
    } catch (const Json::exception&) {
      throw Failure(fmt::format("{} is not a result of lab report: remove it, and --resume repeats the test",
                                folder_->resultFile(fileNameOf(piece)).string()));
    }
  }
}

void Report::complete() {
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    if (!results_[i]) {
      missing.push_back(i);
    }
  }
  saveReport({folder_->page(), IfThere::kReplace}, page());
  std::vector<double> lengths_s(pieces_.size());
  std::ranges::transform(pieces_, lengths_s.begin(),
                         [&](const ReportPiece& piece) { return tests_[piece.test].typical_s; });
  work_.emplace(std::move(lengths_s), conditions_.threads, status_);
  work_->run(missing, folder_->path(), [this](std::size_t index) { measure(index); });
}

void Report::measure(std::size_t index) {
  const std::int64_t began_ns = monotonicNs();
  Json document;
  ReportResult result = tried(index, document);
  result.took_s = static_cast<double>(monotonicNs() - began_ns) / 1e9;
  keep(index, std::move(result), document);
}

/// Runs a piece. A failed test, for example without flow through a hopper, is a finding and does not end the report;
/// only an interruption does.
ReportResult Report::tried(std::size_t index, Json& document) {
  const ReportPiece& piece = pieces_[index];
  const LabSoil soil = soilOf(piece);
  LabConditions conditions = conditionsOf(piece, soil);
  conditions.threads = work_->threadsEach();
  conditions.progress = work_->progressOf(index, titleOf(piece));
  document = {{"test", tests_[piece.test].name}};
  document.update(circumstancesJson(options_.lab, soil, conditions));
  std::optional<LabOutput> output;
  try {
    if (work_->ends()) {
      throw Failure("interrupted");
    }
    output = tests_[piece.test].run(soil, conditions);
  } catch (const Failure& failure) {
    if (work_->ends()) {
      throw;
    }
    return {{}, failure.what(), 0};
  }
  document["result"] = output->json;
  if (piece.seed == options_.lab.seed) {
    output->draw({folder_->figure(fileNameOf(piece)), IfThere::kReplace}, captionOf(piece));
  }
  return {output->findings, "", 0};
}

void Report::keep(std::size_t index, ReportResult result, const Json& document) {
  Json whole = document;
  whole.update(jsonOf(result));
  folder_->save(fileNameOf(pieces_[index]), whole);
  work_->finish(index, [&] {
    results_[index] = std::move(result);
    saveReport({folder_->page(), IfThere::kReplace}, page());
    const ReportResult& kept = *results_[index];
    const std::string found = kept.findings.empty() ? kept.why_not
                                                    : fmt::format("{} {}", kept.findings.front().measured,
                                                                  overSeeds({kept.findings.front()}).text);
    return fmt::format("{}: {} ({})", titleOf(pieces_[index]), found, durationText(kept.took_s));
  });
}

LabSoil Report::soilOf(const ReportPiece& piece) const {
  LabSoil soil = soil_;
  const LabTest& test = tests_[piece.test];
  soil.soil.friction = piece.model;
  if (test.radius_mm > 0) {
    soil.soil = rescaled(soil.soil, test.radius_mm / 1e3);
  }
  if (test.without_cohesion) {
    soil.soil.contact_cohesion_n = 0;
    soil.soil.attraction_ratio = 1;
  }
  return soil;
}

LabConditions Report::conditionsOf(const ReportPiece& piece, const LabSoil& soil) const {
  LabConditions conditions = conditions_;
  conditions.soil = soil.soil;
  conditions.seed = piece.seed;
  return conditions;
}

/// Returns "shear: dry-sand, contact friction, Earth, particles of R = 7 mm, seed 1".
std::string Report::captionOf(const ReportPiece& piece) const {
  const LabSoil soil = soilOf(piece);
  return fmt::format("{}: {}", reportName(tests_[piece.test]),
                     circumstancesText(options_.lab, soil, conditionsOf(piece, soil)));
}

std::string Report::fileNameOf(const ReportPiece& piece) const {
  return fmt::format("{}-{}-{}", tests_[piece.test].name, wordFor(kFrictionWords, piece.model), piece.seed);
}

std::string Report::titleOf(const ReportPiece& piece) const {
  return fmt::format("{}, {}, seed {}", tests_[piece.test].name, wordFor(kFrictionWords, piece.model), piece.seed);
}

std::size_t Report::done() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(results_, [](const auto& result) { return result.has_value(); }));
}

ReportCell Report::cellOf(std::size_t test, FrictionModel model) const {
  ReportCell cell;
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    if (pieces_[i].test == test && pieces_[i].model == model) {
      cell.push_back(results_[i]);
    }
  }
  return cell;
}

/// Returns "shear (contact: seeds 2, 3; icra2021: seeds 1, 2, 3), free-fall (icra2021: seeds 1)"; empty if no piece is
/// missing.
std::string Report::missingText() const {
  std::vector<std::string> missing;
  for (std::size_t test = 0; test < tests_.size(); ++test) {
    std::vector<std::string> of_test;
    for (const FrictionModel model : kModels) {
      std::vector<std::uint64_t> seeds;
      for (std::size_t i = 0; i < pieces_.size(); ++i) {
        if (!results_[i] && pieces_[i].test == test && pieces_[i].model == model) {
          seeds.push_back(pieces_[i].seed);
        }
      }
      if (!seeds.empty()) {
        of_test.push_back(fmt::format("{}: seed{} {}", wordFor(kFrictionWords, model), seeds.size() > 1 ? "s" : "",
                                      fmt::join(seeds, ", ")));
      }
    }
    if (!of_test.empty()) {
      missing.push_back(fmt::format("{} ({})", tests_[test].name, fmt::join(of_test, "; ")));
    }
  }
  return fmt::format("{}", fmt::join(missing, ", "));
}

ReportPage Report::page() const {
  ReportPage page;
  const SoilParameters& soil = soil_.soil;
  const bool whole = done() == pieces_.size();
  page.title = fmt::format("Laboratory report: {}{}", soil_.name, whole ? "" : " (unfinished)");
  if (!whole) {
    page.introduction.push_back(fmt::format(
        "Unfinished: {} of {} results are available. Repeat the command with --resume to continue. Missing: {}.",
        done(), pieces_.size(), missingText()));
  }
  page.introduction.emplace_back(
      "Every test was run with the same soil and both friction models: friction between particles (contact), and the "
      "ICRA 2021 friction model (icra2021), which acts against absolute space. Tests without cohesion are marked.");
  page.introduction.emplace_back(options_.seeds > 1
                                     ? fmt::format("Values are means of {} seeds; ± is the standard deviation. A value "
                                                   "passes when its mean passes. Figures show seed {}.",
                                                   options_.seeds, options_.lab.seed)
                                     : "Values are of one seed; their standard deviation is unknown.");
  page.facts = {{"Soil", soil_.name},
                {"Gravity", fmt::format("{}, {:g} m/s²", findBody(options_.lab.body).name, conditions_.gravity_m_s2)},
                {options_.seeds > 1 ? "Seeds" : "Seed", seedsText(options_)},
                {"Contacts",
                 fmt::format("friction {:.3g}, cohesion {:.3g} N, stiffness {:.4g} N/m at R = {:g} mm",
                             soil.contact_friction, soil.contact_cohesion_n, soil.stiffness_n_m, soil.radius_m * 1e3)},
                {"Program", "haptolith " HAPTOLITH_VERSION}};
  for (std::size_t test = 0; test < tests_.size(); ++test) {
    std::ranges::move(
        reportRows(tests_[test], cellOf(test, FrictionModel::kContact), cellOf(test, FrictionModel::kIcra2021)),
        std::back_inserter(page.rows));
  }
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    if (pieces_[i].seed == options_.lab.seed && results_[i] && !results_[i]->findings.empty()) {
      page.figures.push_back({folder_->figure(fileNameOf(pieces_[i])), captionOf(pieces_[i])});
    }
  }
  return page;
}

/// Prints only the page, not the other files in the folder.
void tellOfPageAlone() {
  for (const std::filesystem::path& path : filesWritten()) {
    if (path.extension() != ".html") {
      static_cast<void>(savedText(path, ""));
    }
  }
}

void runReport(const ReportOptions& options) {
  const StopOnSignal stop_on_signal;
  if (std::filesystem::path(options.folder).extension() == ".html") {
    throw InvalidParameter("--out", options.folder, "the name of a folder, in which report.html will be");
  }
  try {
    Report(options).complete();
  } catch (...) {
    tellOfPageAlone();
    throw;
  }
  tellOfPageAlone();
}

std::vector<std::string> testNames() {
  std::vector<std::string> names;
  for (const LabTest& test : testsOfReports()) {
    names.push_back(test.name);
  }
  return names;
}

/// Returns a transform of the name of a test in an earlier version.
CLI::Validator toCurrentTest() {
  return {[](std::string& name) {
            name = std::string(currentNameReported(NameKind::kLabTest, name));
            return std::string();
          },
          ""};
}

}  // namespace

void addReport(CLI::App& lab) {
  auto options = std::make_shared<ReportOptions>();
  CLI::App* command =
      lab.add_subcommand("report", "Run all tests with both friction models and several seeds; write one HTML page");
  options->lab.addTo(*command);
  for (const char* unused : {"--figure", "--trace", "--json", "--friction-model", "--radius-mm"}) {
    command->remove_option(command->get_option(unused));
  }
  command->get_option("--seed")->description("First seed of the specimens");
  command->add_option("--seeds", options->seeds, "Number of specimens of each test, 1 to 100, each with its own seed")
      ->check(wholeNumberIn(kReportSeeds))
      ->capture_default_str();
  command->add_option("--only", options->only, "Run only these tests")
      ->delimiter(',')
      ->transform(toCurrentTest())
      ->check(oneOf(testNames()));
  command->add_option("--out", options->folder, "Folder for report.html and for each result as soon as it is available")
      ->capture_default_str();
  CLI::Option* resume = command->add_flag("--resume", options->resume, "Continue the report in that folder");
  command->get_option("--overwrite")->description("Restart the report in that folder")->excludes(resume);
  command->footer(
      "Examples:\n  haptolith lab report --soil dry-sand --body Earth --out sand\n  haptolith lab report --soil "
      "dry-sand --body Earth --out sand --resume   continue it\n  haptolith lab report --only shear,repose --seeds 5");
  command->callback([options] { runReport(*options); });
}

}  // namespace haptolith
