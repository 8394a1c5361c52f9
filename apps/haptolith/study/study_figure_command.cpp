#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/psychometrics/group.h"
#include "haptolith/psychometrics/psychometric_figure.h"
#include "haptolith/study/answers.h"
#include "haptolith/study/participant_flow.h"
#include "haptolith/study/store.h"

#include "commands.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/overwrite.h"
#include "study/fit_report.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kExamples = R"(Examples:
  haptolith study figure friction.study --out friction.svg
  haptolith study figure both.study --out figure.png        figure-friction.png and figure-gravity.png
  haptolith study figure friction.study --json              numbers alone)";

struct Options {
  std::string file, out, block;
  std::optional<std::string> sigmoid;
  bool free_threshold = false, json = false, withdrawn = false;
  double confidence = 0.95;
  Overwrite overwrite;
};

/// One block of a study, fitted.
struct BlockResult {
  const StudyBlock* block = nullptr;
  std::vector<std::string> codes;
  std::vector<std::vector<Level>> levels;
  GroupFit group;
  std::optional<double> caught;
};

FitOptions fitOptionsFor(const Options& options, const StudyBlock& block) {
  FitOptions fit = fitOptionsOf(block);
  if (options.sigmoid) {
    fit.sigmoid = sigmoidNamed(*options.sigmoid);
    if (!isWeber(fit.sigmoid)) {
      fit = FitOptions{.sigmoid = fit.sigmoid, .design = Design::kEqualAsymptote, .log_axis = block.log_axis};
    }
  }
  if (options.free_threshold) {
    fit.threshold.reset();
  }
  fit.confidence = options.confidence;
  return fit;
}

/// None when nobody has answered yet.
std::optional<BlockResult> resultOf(const Options& options, const StudyStore& study, std::size_t index) {
  BlockResult result;
  result.block = &study.protocol().blocks[index];
  std::vector<TrialRow> trials = study.trials();
  for (const ParticipantRow& person : study.participants()) {
    if (!person.excluded_for.empty() || (person.state == "withdrawn" && !options.withdrawn)) {
      std::erase_if(trials, [&person](const TrialRow& trial) { return trial.participant == person.id; });
    }
    std::vector<Level> levels = levelsOf(trials, index, person.id);
    if (!levels.empty()) {
      result.codes.push_back(person.code);
      result.levels.push_back(std::move(levels));
    }
  }
  if (result.levels.empty()) {
    return std::nullopt;
  }
  result.group = fitGroup(result.levels, fitOptionsFor(options, *result.block));
  result.caught = caught(trials, index);
  return result;
}

/// "figure.svg", or "figure-friction.svg" where there are several blocks.
OutputFile fileFor(const Options& options, const StudyBlock& block, bool several) {
  std::filesystem::path file = options.out;
  if (several) {
    file.replace_filename(fmt::format("{}-{}{}", file.stem().string(), block.name, file.extension().string()));
  }
  return options.overwrite(file.string());
}

void draw(const OutputFile& file, const StudyStore& study, const BlockResult& result) {
  PsychometricFigure figure;
  figure.title =
      study.protocol().blocks.size() > 1 && !result.block->title.empty() ? result.block->title : study.title();
  figure.x_label = result.block->axis_label;
  figure.y_label =
      fmt::format("share of answers \"{}\"",
                  result.block->task == TaskKind::kTwoInterval ? std::string("the test") : result.block->answers[1]);
  figure.log_axis = result.block->log_axis;
  figure.reference = result.block->reference.value;
  figure.group = FigureCurve{"all", result.group.pooled};
  if (result.codes.size() > 1) {
    for (std::size_t i = 0; i < result.codes.size(); ++i) {
      figure.participants.push_back({result.codes[i], result.group.participants[i]});
    }
  }
  drawPsychometricFigure(file, figure);
}

std::string text(const BlockResult& result) {
  std::string told = fmt::format("{}: {} participant(s), reference {} ({:g})\n", result.block->name,
                                 result.codes.size(), result.block->reference.name, result.block->reference.value);
  told += fitText(result.group.pooled);
  if (result.codes.size() > 1) {
    told += "\n" + groupText(result.group, result.codes);
  }
  if (result.caught) {
    told += fmt::format("catch trials answered right: {:.0f} %\n", 100 * *result.caught);
  }
  return told;
}

Json jsonOf(const BlockResult& result) {
  Json json{{"block", result.block->name},
            {"axis_label", result.block->axis_label},
            {"reference", result.block->reference.value},
            {"caught", result.caught ? Json(*result.caught) : Json(nullptr)},
            {"pooled", fitJson(result.group.pooled)}};
  if (result.codes.size() > 1) {
    json["group"] = groupJson(result.group, result.codes);
  }
  return json;
}

std::vector<BlockResult> resultsOf(const Options& options, const StudyStore& study) {
  const std::vector<StudyBlock>& blocks = study.protocol().blocks;
  if (!options.block.empty() && std::ranges::find(blocks, options.block, &StudyBlock::name) == blocks.end()) {
    std::string names;
    for (const StudyBlock& block : blocks) {
      names += (names.empty() ? "" : ", ") + block.name;
    }
    throw InvalidParameter("block", options.block, names);
  }
  std::vector<BlockResult> results;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (options.block.empty() || blocks[i].name == options.block) {
      if (std::optional<BlockResult> result = resultOf(options, study, i)) {
        results.push_back(std::move(*result));
      }
    }
  }
  if (results.empty()) {
    throw Failure(fmt::format("{}: nobody has answered yet", options.file));
  }
  return results;
}

void show(const Options& options) {
  if (options.sigmoid) {
    (void)sigmoidNamed(*options.sigmoid);  // throws, whatever the study holds
  }
  const StudyStore study(options.file, StudyStore::Access::kRead);
  const std::vector<BlockResult> results = resultsOf(options, study);
  Json json{{"study", study.title()}, {"participants", flowText(flowOf(study))}, {"blocks", Json::array()}};
  std::string told = flowText(flowOf(study)) + "\n";
  for (const BlockResult& result : results) {
    if (!options.out.empty()) {
      draw(fileFor(options, *result.block, results.size() > 1), study, result);
    }
    json["blocks"].push_back(jsonOf(result));
    told += "\n" + text(result);
  }
  if (options.json) {
    printJson(json);
  } else {
    printText(told);
  }
}

}  // namespace

void addStudyFigureCommand(CLI::App& study) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      study.add_subcommand("figure", "Psychometric curves and Weber fractions of a study, as in the paper's Fig. 5");
  command->footer(kExamples);
  command->add_option("study", options->file, "A study")->required()->option_text("FILE");
  command->add_option("--out", options->out, "Draw them (.svg or .png), one figure a block")->option_text("FILE");
  command->add_option("--block", options->block, "Only this one")->option_text("NAME");
  command->add_option("--sigmoid", options->sigmoid, "Another curve than (paper 22)")
      ->option_text("norm|logistic|weber|as-printed|weibull|gumbel");
  command->add_flag("--free-threshold", options->free_threshold,
                    "Fit the point of subjective equality too, instead of taking the reference for it");
  command->add_option("--confidence", options->confidence, "Of all intervals [0.95]")->check(numberIn({0.01, 0.999}));
  command->add_flag("--withdrawn", options->withdrawn, "Count those, too, who have withdrawn");
  options->overwrite.addTo(*command);
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { show(*options); });
}

}  // namespace haptolith
