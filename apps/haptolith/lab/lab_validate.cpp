#include <CLI/App.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/platform/clock.h"
#include "haptolith/core/pluralise.h"
#include "haptolith/lab/archive/report_folder.h"
#include "haptolith/lab/catalogue/lab_test.h"
#include "haptolith/lab/catalogue/option_reader.h"
#include "haptolith/lab/report/validation.h"
#include "haptolith/lab/tests/shear.h"
#include "haptolith/scene_file/scene_words.h"
#include "haptolith/scene_file/soil_file.h"
#include "haptolith/soil/bodies.h"

#include "commands.h"
#include "lab/claims_file.h"
#include "lab/lab_options.h"
#include "shared/common_options.h"
#include "shared/kept_work.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/saved.h"
#include "shared/stop_on_signal.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr Range kValidationSeeds{1, 100};
constexpr const char* kPage = "validation.md";

struct ValidateOptions {
  std::string claims_file, soil;
  std::vector<std::string> only;
  std::string folder = "evidence";
  std::uint64_t seed = 1;
  int seeds = 3;
  int threads = 0;
  bool resume = false;
  Overwrite overwrite;
};

/// Test with one seed: the unit that is run, saved and resumed. Several claims may use its result.
struct ClaimPiece {
  ClaimRun run;
  LabSoil soil;
  std::uint64_t seed = 1;
  std::string name;          ///< name of its file
  Json specification;        ///< all conditions of the result
  std::optional<Json> done;  ///< saved content: specification, took_s, and result or why_not
};

LabSoil soilOf(const ClaimRun& run) {
  const NamedSoil found = findSoilOrPreset(run.soil);
  LabSoil soil{found.name, soilForTest(found.soil, labTest(run.test).radius_mm, {.radius_mm = run.radius_mm}),
               found.file ? std::optional(found.file->target) : std::nullopt};
  soil.soil.stiffness_n_m *= run.stiffness_times;
  soil.soil.gamma_nm *= run.stiffness_times;
  return soil;
}

Json specificationOf(const ClaimRun& run, const LabSoil& soil, std::uint64_t seed) {
  std::ostringstream options;
  options << toml::json_formatter{run.options};
  return {{"test", run.test},
          {"soil", soil.name},
          {"body", findBody(run.body).name},
          {"options", Json::parse(options.str())},
          {"particles", soilJson(soil.soil)},
          {"friction", wordFor(kFrictionWords, soil.soil.friction)},
          {"seed", seed}};
}

/// Returns the hash of a specification as text (Fowler, Noll and Vo, FNV-1a, 64 bits).
std::string nameOf(const Json& specification) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char letter : specification.dump()) {
    hash = (hash ^ static_cast<unsigned char>(letter)) * 0x100000001b3U;
  }
  return fmt::format("{}-{:016x}", specification.at("test").get<std::string>(), hash);
}

/// Returns "blade, toyoura, Earth, seed 1".
std::string titleOf(const ClaimPiece& piece) {
  return fmt::format("{}, {}, {}, seed {}", piece.run.test, piece.soil.name, findBody(piece.run.body).name, piece.seed);
}

std::optional<double> numberAt(const Json& result, const MeasuredClaim& claim, const std::string& pointer) {
  const Json::json_pointer at(pointer);
  if (!result.contains(at)) {
    std::vector<std::string> there;
    for (const auto& [key, value] : result.items()) {
      if (value.is_number()) {
        there.push_back("/" + key);
      }
    }
    throw InvalidParameter(
        fmt::format("claim {}: ours or other", claim.claim.id), fmt::format("'{}'", pointer),
        fmt::format("where `haptolith lab {} --json` has a number: {}", claim.run.test, fmt::join(there, ", ")));
  }
  const Json& number = result.at(at);
  return number.is_number() ? std::optional(number.get<double>()) : std::nullopt;
}

/// Validation in progress. Several threads run pieces.
class Validation {
 public:
  explicit Validation(const ValidateOptions& options);

  /// Runs the missing pieces, then further specimens of the claims with a wide spread. @throws Failure if a result
  /// cannot be saved, and when interrupted.
  void complete();

 private:
  void addSpecimen(std::size_t claim, std::int64_t seed_index);
  void loadSaved();
  [[nodiscard]] std::vector<std::size_t> missingPieces() const;
  void runMissing();
  [[nodiscard]] std::size_t pieceFor(const ClaimRun& run, std::uint64_t seed);
  void measure(std::size_t index);
  [[nodiscard]] Json tried(std::size_t index);
  [[nodiscard]] std::size_t done() const;

  [[nodiscard]] ClaimSpecimen specimenOf(const MeasuredClaim& measured, std::size_t seed_index) const;
  [[nodiscard]] JudgedClaim judged(std::size_t claim) const;
  [[nodiscard]] std::vector<JudgedClaim> judgedClaims() const;
  void savePage() const;

  ValidateOptions options_;
  StatusLine status_;
  std::vector<MeasuredClaim> claims_;
  std::vector<ClaimPiece> pieces_;
  std::vector<std::vector<std::size_t>> runs_, overs_;  ///< per claim, one piece per seed
  std::optional<ReportFolder> folder_;
  int threads_ = 1;
  ShearMemory shear_memory_;  ///< strengths of a soil, which many claims need
  std::optional<KeptWork> work_;
};

bool isChosen(const MeasuredClaim& measured, const ValidateOptions& options) {
  const auto named = [&](const std::string& name) {
    return std::ranges::find(options.only, name) != options.only.end();
  };
  return (options.only.empty() || named(measured.claim.id) || named(measured.claim.group)) &&
         (options.soil.empty() || measured.any_soil);
}

std::vector<MeasuredClaim> allClaims(const ValidateOptions& options) {
  return options.claims_file.empty() ? shippedClaims() : readClaims(options.claims_file);
}

std::vector<MeasuredClaim> chosenClaims(const ValidateOptions& options) {
  std::vector<MeasuredClaim> claims = allClaims(options);
  for (const std::string& name : options.only) {
    const auto is = [&](const MeasuredClaim& m) { return m.claim.id == name || m.claim.group == name; };
    if (std::ranges::none_of(claims, is)) {
      std::set<std::string> groups;
      for (const MeasuredClaim& measured : claims) {
        groups.insert(measured.claim.group);
      }
      throw InvalidParameter("--only", fmt::format("'{}'", name),
                             fmt::format("the id of a claim, or a group: {}", fmt::join(groups, ", ")));
    }
  }
  std::erase_if(claims, [&](const MeasuredClaim& measured) { return !isChosen(measured, options); });
  if (claims.empty()) {
    throw InvalidParameter("--soil", fmt::format("'{}'", options.soil),
                           "a soil for claims with any_soil = true, of which none was chosen");
  }
  for (MeasuredClaim& measured : claims) {
    if (!options.soil.empty()) {
      measured.run.soil = options.soil;
      if (measured.over) {
        measured.over->soil = options.soil;
      }
    }
  }
  return claims;
}

std::vector<Claim> claimsOf(const std::vector<MeasuredClaim>& measured) {
  std::vector<Claim> claims(measured.size());
  std::ranges::transform(measured, claims.begin(), &MeasuredClaim::claim);
  return claims;
}

/// Returns the page and the figures of all groups, also of those not selected, because an earlier run may have selected
/// them.
std::vector<std::string> filesOf(const ValidateOptions& options) {
  std::vector<std::string> files = figureNamesOf(groupsOf(claimsOf(allClaims(options))));
  files.insert(files.begin(), kPage);
  return files;
}

Validation::Validation(const ValidateOptions& options) : options_(options), claims_(chosenClaims(options)) {
  runs_.resize(claims_.size());
  overs_.resize(claims_.size());
  for (int i = 0; i < options.seeds; ++i) {
    for (std::size_t claim = 0; claim < claims_.size(); ++claim) {
      addSpecimen(claim, i);
    }
  }
  threads_ = threadsFor(options.threads);
  folder_.emplace(options.folder, Json{{"validation", "haptolith " HAPTOLITH_VERSION}},
                  options.resume              ? ReportThere::kResume
                  : options.overwrite.allowed ? ReportThere::kReplace
                                              : ReportThere::kRefuse,
                  filesOf(options));
  loadSaved();
}

void Validation::addSpecimen(std::size_t claim, std::int64_t seed_index) {
  const std::uint64_t seed = options_.seed + static_cast<std::uint64_t>(seed_index);
  runs_[claim].push_back(pieceFor(claims_[claim].run, seed));
  if (claims_[claim].over) {
    overs_[claim].push_back(pieceFor(*claims_[claim].over, seed));
  }
}

/// Loads the pieces that an earlier run of this validation has saved.
void Validation::loadSaved() {
  for (ClaimPiece& piece : pieces_) {
    std::optional<Json> saved = piece.done ? std::nullopt : folder_->result(piece.name);
    if (saved && saved->value("specification", Json()) == piece.specification) {
      piece.done = std::move(saved);
    } else if (saved) {
      throw Failure(fmt::format("{} is not a result of lab validate: remove it, and --resume repeats the test",
                                folder_->resultFile(piece.name).string()));
    }
  }
}

/// Returns the piece of a run; equal runs share one.
std::size_t Validation::pieceFor(const ClaimRun& run, std::uint64_t seed) {
  ClaimPiece piece{.run = run, .soil = soilOf(run), .seed = seed, .name = {}, .specification = {}, .done = {}};
  piece.specification = specificationOf(run, piece.soil, seed);
  piece.name = nameOf(piece.specification);
  const auto found = std::ranges::find(pieces_, piece.name, &ClaimPiece::name);
  if (found != pieces_.end()) {
    return static_cast<std::size_t>(found - pieces_.begin());
  }
  pieces_.push_back(std::move(piece));
  return pieces_.size() - 1;
}

/// Returns the missing pieces by seed, those of one soil apart: the first of a soil simulates its strength, which the
/// others share without waiting for it.
std::vector<std::size_t> Validation::missingPieces() const {
  std::map<std::tuple<std::string, std::string, std::string, std::uint64_t>, int> seen;
  std::vector<std::pair<std::pair<std::uint64_t, int>, std::size_t>> ordered;
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    const ClaimPiece& piece = pieces_[i];
    const int earlier = seen[{piece.run.test, piece.run.soil, piece.run.body, piece.seed}]++;
    if (!piece.done) {
      ordered.push_back({{piece.seed, earlier}, i});
    }
  }
  std::ranges::sort(ordered);
  std::vector<std::size_t> missing(ordered.size());
  std::ranges::transform(ordered, missing.begin(), [](const auto& entry) { return entry.second; });
  return missing;
}

void Validation::runMissing() {
  const std::vector<std::size_t> missing = missingPieces();
  savePage();
  std::vector<double> lengths_s(pieces_.size());
  std::ranges::transform(pieces_, lengths_s.begin(),
                         [](const ClaimPiece& piece) { return labTest(piece.run.test).typical_s; });
  work_.emplace(std::move(lengths_s), threads_, status_);
  work_->run(missing, folder_->path(), [this](std::size_t index) { measure(index); });
}

void Validation::complete() {
  runMissing();
  std::size_t wide = 0;
  for (std::size_t claim = 0; claim < claims_.size(); ++claim) {
    if (judged(claim).outcome->spread > kWideSpread) {
      ++wide;
      for (std::size_t more = 0; more < kMoreSpecimens; ++more) {
        addSpecimen(claim, options_.seeds + static_cast<std::int64_t>(more));
      }
    }
  }
  if (wide > 0) {
    post(fmt::format("{} with a spread above {:g} %: {} more specimens of each\n", pluralise(wide, "claim"),
                     100 * kWideSpread, kMoreSpecimens));
    loadSaved();
    runMissing();
  }
  const std::vector<JudgedClaim> claims = judgedClaims();
  const std::vector<std::string> groups = groupsOf(claimsOf(claims_));
  const std::vector<std::string> figures = figureNamesOf(groups);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    drawValidation({folder_->path() / figures[i], IfThere::kReplace}, claims, groups[i]);
  }
  savePage();
}

void Validation::measure(std::size_t index) {
  const std::int64_t began_ns = monotonicNs();
  Json document = tried(index);
  const double took_s = static_cast<double>(monotonicNs() - began_ns) / 1e9;
  document["took_s"] = took_s;
  folder_->save(pieces_[index].name, document);
  work_->finish(index, [&] {
    pieces_[index].done = std::move(document);
    savePage();
    const ClaimPiece& piece = pieces_[index];
    return fmt::format("{} ({})", titleOf(piece), durationText(took_s));
  });
}

/// Runs a piece. A failed test is a finding and does not end the validation.
Json Validation::tried(std::size_t index) {
  const ClaimPiece& piece = pieces_[index];
  Json document{{"specification", piece.specification}};
  try {
    if (work_->ends()) {
      throw Failure("interrupted");
    }
    LabTest test = labTest(piece.run.test);
    setOptions(piece.run.options, test.options);
    const LabConditions conditions{.soil = piece.soil.soil,
                                   .gravity_m_s2 = findBody(piece.run.body).gravity_m_s2,
                                   .seed = piece.seed,
                                   .threads = work_->threadsEach(),
                                   .progress = work_->progressOf(index, titleOf(piece)),
                                   .shear_memory = &shear_memory_};
    document["result"] = test.run(piece.soil, conditions).json;
  } catch (const Failure& failure) {
    if (work_->ends()) {
      throw;
    }
    document["why_not"] = failure.what();
  } catch (const InvalidParameter& refused) {
    document["why_not"] = refused.what();
  }
  return document;
}

std::size_t Validation::done() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(pieces_, [](const ClaimPiece& piece) { return piece.done.has_value(); }));
}

ClaimSpecimen Validation::specimenOf(const MeasuredClaim& measured, std::size_t seed_index) const {
  const auto claim = static_cast<std::size_t>(&measured - claims_.data());
  const Json& run = *pieces_[runs_[claim][seed_index]].done;
  const Json* over = measured.over ? &*pieces_[overs_[claim][seed_index]].done : nullptr;
  ClaimSpecimen specimen;
  for (const Json* document : {&run, over}) {
    if (document != nullptr && document->contains("why_not")) {
      specimen.why_not = document->at("why_not").get<std::string>();
      return specimen;
    }
  }
  specimen.ours = numberAt(run.at("result"), measured, measured.ours);
  if (!measured.other.empty()) {
    specimen.other = numberAt(run.at("result"), measured, measured.other);
  }
  if (over != nullptr && specimen.ours) {
    const std::optional<double> divisor = numberAt(over->at("result"), measured, measured.ours);
    specimen.ours = divisor && *divisor != 0 ? std::optional(*specimen.ours / *divisor) : std::nullopt;
  }
  if (!specimen.ours || (!measured.other.empty() && !specimen.other)) {
    specimen.why_not = "the test gave no number";
  }
  return specimen;
}

/// Judges a claim by the finished seeds.
JudgedClaim Validation::judged(std::size_t claim) const {
  const MeasuredClaim& measured = claims_[claim];
  std::vector<ClaimSpecimen> specimens;
  for (std::size_t i = 0; i < runs_[claim].size(); ++i) {
    if (pieces_[runs_[claim][i]].done && (!measured.over || pieces_[overs_[claim][i]].done)) {
      specimens.push_back(specimenOf(measured, i));
    }
  }
  return {measured.claim, specimens.empty() ? std::nullopt : std::optional(judge(measured.claim, specimens))};
}

std::vector<JudgedClaim> Validation::judgedClaims() const {
  std::vector<JudgedClaim> all;
  for (std::size_t claim = 0; claim < claims_.size(); ++claim) {
    all.push_back(judged(claim));
  }
  return all;
}

void Validation::savePage() const {
  const bool whole = done() == pieces_.size();
  double sum_s = 0;
  for (const ClaimPiece& piece : pieces_) {
    sum_s += piece.done ? piece.done->value("took_s", 0.0) : 0;
  }
  std::string command = "haptolith lab validate";
  command += options_.claims_file.empty() ? "" : fmt::format(" --claims {}", options_.claims_file);
  command += options_.soil.empty() ? "" : fmt::format(" --soil {}", options_.soil);
  command += options_.only.empty() ? "" : fmt::format(" --only '{}'", fmt::join(options_.only, ","));
  command += options_.seeds != ValidateOptions{}.seeds ? fmt::format(" --seeds {}", options_.seeds) : "";
  std::vector<std::string> introduction{
      fmt::format("    {}", command),
      fmt::format(
          "Values are means of n specimens, ± is the standard error of the mean. Claims have {} specimens, {} where "
          "the SD\n"
          "of one is above {:g} % of the reference. haptolith {}; {} simulated tests, {:.1f} hours of one core.",
          options_.seeds, options_.seeds > 1 ? options_.seeds + static_cast<int>(kMoreSpecimens) : options_.seeds,
          100 * kWideSpread, HAPTOLITH_VERSION, pieces_.size(), sum_s / 3600)};
  if (options_.claims_file.empty()) {
    introduction.emplace_back("Depth counts from the level surface (docs/reports/accuracy.md).");
  }
  AtomicFile file({folder_->page(), IfThere::kReplace});
  file.write(validationPage(judgedClaims(), introduction, whole));
  file.commit();
}

void runValidate(const ValidateOptions& options) {
  const StopOnSignal stop_on_signal;
  const auto tell_of_page_alone = [] {
    for (const std::filesystem::path& path : filesWritten()) {
      if (path.extension() != ".md" && path.extension() != ".svg") {
        static_cast<void>(savedText(path, ""));
      }
    }
  };
  try {
    Validation(options).complete();
  } catch (...) {
    tell_of_page_alone();
    throw;
  }
  tell_of_page_alone();
}

}  // namespace

void addValidate(CLI::App& lab) {
  auto options = std::make_shared<ValidateOptions>();
  CLI::App* command =
      lab.add_subcommand("validate", "Compare simulated soil with published measurements and theory; write one page");
  command->add_option("--claims", options->claims_file,
                      "File of claims (docs/reference/claims-file.md) [all that are built in]");
  command->add_option("--soil", options->soil,
                      "Soil for claims about any soil: a name, a soil file, or P1 to P6 [each claim's]");
  command->add_option("--only", options->only, "Check only these claims or groups of claims")->delimiter(',');
  command
      ->add_option("--seeds", options->seeds,
                   "Number of specimens of each test, 1 to 100; from 2 on, two more where they scatter")
      ->check(wholeNumberIn(kValidationSeeds))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "First seed of the specimens")
      ->check(wholeNumberIn(BedRanges::seed))
      ->capture_default_str();
  command->add_option("--threads", options->threads, fmt::format("{} [all]", kThreadsHelp))
      ->check(wholeNumberIn(BedRanges::threads));
  command
      ->add_option("--out", options->folder,
                   "Folder for validation.md, its figures and each result as soon as it is available")
      ->capture_default_str();
  CLI::Option* resume =
      command->add_flag("--resume", options->resume, "Continue in that folder; claims can be added or changed");
  options->overwrite.addTo(*command);
  command->get_option("--overwrite")->description("Restart the validation in that folder")->excludes(resume);
  command->footer(
      "Examples:\n  haptolith lab validate --out evidence\n  haptolith lab validate --out evidence --resume    "
      "continue it\n  haptolith lab validate --only Blades\n  haptolith lab validate --soil my-sand.toml");
  command->callback([options] { runValidate(*options); });
}

}  // namespace haptolith
