#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/psychometrics/group/group.h"
#include "haptolith/psychometrics/psychometric_figure.h"
#include "haptolith/study/results/answers.h"
#include "haptolith/study/results/teleop_figure.h"
#include "haptolith/study/results/teleop_results.h"
#include "haptolith/study/store/participant_flow.h"
#include "haptolith/study/store/store.h"

#include "commands.h"
#include "shared/common_options.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/overwrite.h"
#include "shared/stop_on_signal.h"
#include "study/block_result.h"
#include "study/teleop_report.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kStudyFigureExamples = R"(Examples:
  haptolith study figure friction.study --figure friction.svg
  haptolith study figure both.study --figure out.png     out-friction.png and out-gravity.png
  haptolith study figure friction.study --json           print numbers only

With several participants, the first result is the population median from a hierarchical model.
Models and coverage of their intervals: docs/reference/psychometrics.md)";

struct FigureOptions {
  std::string file, figure, block;
  std::optional<std::string> sigmoid;
  bool fixed_threshold = false, pooled = false, json = false, withdrawn = false;
  double confidence = 0.95;
  Overwrite overwrite;
};

FitOptions fitOptionsFor(const FigureOptions& options, const StudyBlock& block) {
  FitOptions fit = fitOptionsOf(block);
  if (options.sigmoid) {
    fit.sigmoid = sigmoidNamed(*options.sigmoid);
    if (!isWeber(fit.sigmoid)) {
      fit = FitOptions{.sigmoid = fit.sigmoid, .design = Design::kEqualAsymptote, .log_axis = block.log_axis};
    }
  }
  if (options.fixed_threshold) {
    fit.threshold = block.reference.value;
  }
  fit.confidence = options.confidence;
  return fit;
}

void fitTo(BlockResult& result, const FigureOptions& options) {
  const FitOptions fit = fitOptionsFor(options, *result.block);
  const std::vector<Level> all = pooled(result.levels);
  if (all.size() < 2 && !fit.threshold) {
    throw Failure(
        fmt::format("{}: block {} has responses to only one stimulus; a curve needs two", options.file, result.name()));
  }
  if (result.codes.size() > 1) {
    result.group = fitGroup(result.levels, groupOptions(fit));
  }
  if (options.pooled || !result.group) {
    result.pooled = fitPsychometric(all, fit);
  }
}

/// Returns the result; empty without responses.
std::optional<BlockResult> resultOf(const FigureOptions& options, const StudyStore& study, std::size_t index,
                                    const ParticipantGroup* people) {
  BlockResult result;
  result.block = &study.protocol().blocks[index];
  result.index = index;
  result.people = people;
  std::vector<TrialRow> trials = study.trials();
  for (const ParticipantRow& person : study.participants()) {
    const bool of_others = people != nullptr && (!person.assignment || person.assignment->group != people->name);
    if (!person.excluded_for.empty() || (person.state == "withdrawn" && !options.withdrawn) || of_others) {
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
  fitTo(result, options);
  result.caught = caught(trials, index);
  return result;
}

/// Returns "figure.svg", or "figure-work.svg" if there are also curves.
OutputFile workFileFor(const FigureOptions& options, bool alone) {
  std::filesystem::path file = options.figure;
  if (!alone) {
    file.replace_filename(fmt::format("{}-work{}", file.stem().string(), file.extension().string()));
  }
  return options.overwrite(file.string());
}

/// Returns "figure.svg", or "figure-friction.svg" for several blocks, "figure-friction-seen.svg" for a group.
OutputFile fileFor(const FigureOptions& options, const BlockResult& result, bool several) {
  std::filesystem::path file = options.figure;
  if (several) {
    const std::string group = result.people == nullptr ? "" : "-" + result.people->name;
    file.replace_filename(
        fmt::format("{}-{}{}{}", file.stem().string(), result.block->name, group, file.extension().string()));
  }
  return options.overwrite(file.string());
}

void draw(const OutputFile& file, const FigureOptions& options, const StudyStore& study, const BlockResult& result) {
  PsychometricFigure figure;
  figure.title =
      study.protocol().blocks.size() > 1 && !result.block->title.empty() ? result.block->title : study.title();
  if (result.people != nullptr) {
    figure.title += fmt::format(", group {}", result.people->name);
  }
  figure.x_label = result.block->axis_label;
  figure.y_label =
      fmt::format("fraction of responses \"{}\"",
                  result.block->task == TaskKind::kTwoInterval ? std::string("the test") : result.block->answers[1]);
  figure.log_axis = result.block->log_axis;
  figure.reference = result.block->reference.value;
  figure.group = FigureCurve{"median person", result.headline()};
  if (!result.group) {
    figure.group->title = result.codes.front();
  } else if (options.pooled) {
    figure.group = FigureCurve{"all, pooled", *result.pooled};
  }
  for (std::size_t i = 0; result.group && i < result.codes.size(); ++i) {
    figure.participants.push_back({result.codes[i], result.group->participants[i]});
  }
  drawPsychometricFigure(file, figure);
}

std::vector<BlockResult> resultsOf(const FigureOptions& options, const StudyStore& study) {
  const std::vector<StudyBlock>& blocks = study.protocol().blocks;
  if (!options.block.empty() && std::ranges::find(blocks, options.block, &StudyBlock::name) == blocks.end()) {
    std::string names;
    for (const StudyBlock& block : blocks) {
      names += (names.empty() ? "" : ", ") + block.name;
    }
    throw InvalidParameter("block", options.block, names);
  }
  std::vector<BlockResult> results;
  const auto add = [&](std::size_t block, const ParticipantGroup* people) {
    if (std::optional<BlockResult> result = resultOf(options, study, block, people)) {
      results.push_back(std::move(*result));
    }
  };
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (blocks[i].teleop || (!options.block.empty() && blocks[i].name != options.block)) {
      continue;
    }
    if (study.protocol().groups.empty()) {
      add(i, nullptr);
    }
    for (const ParticipantGroup& group : study.protocol().groups) {
      add(i, &group);
    }
  }
  return results;
}

void show(const FigureOptions& options) {
  const StopOnSignal stop_on_signal;
  if (options.sigmoid) {
    (void)sigmoidNamed(*options.sigmoid);  // throws independently of the study's content
  }
  const StudyStore study(options.file, StudyStore::Access::kRead);
  const std::vector<BlockResult> results = resultsOf(options, study);
  std::vector<TeleopBlockResult> works = teleopResults(study, options.withdrawn);
  std::erase_if(works, [&](const TeleopBlockResult& of) {
    return !options.block.empty() && study.protocol().blocks[of.block].name != options.block;
  });
  if (results.empty() && works.empty()) {
    throw Failure(fmt::format("{}: there are no responses yet", options.file));
  }
  Json json{{"study", study.title()}, {"participants", flowText(flowOf(study))}, {"blocks", Json::array()}};
  std::string told = flowsText(study);
  for (const GroupFlow& flow : groupFlowsOf(study)) {
    json["groups"].push_back({{"group", flow.group}, {"participants", flowText(flow.people, "assigned")}});
  }
  for (const BlockResult& result : results) {
    if (!options.figure.empty()) {
      draw(fileFor(options, result, results.size() > 1), options, study, result);
    }
    json["blocks"].push_back(jsonOf(result));
    told += "\n" + text(result);
  }
  for (const Difference& difference : differencesOf(results, study.protocol(), options.confidence)) {
    json["differences"].push_back(jsonOf(difference));
    told += "\n" + text(difference, options.confidence);
  }
  if (!works.empty()) {
    if (!options.figure.empty()) {
      drawTeleopFigure(workFileFor(options, results.empty()), study.protocol(), works, options.confidence,
                       study.title());
    }
    json["teleop"] = teleopJson(study.protocol(), works, options.confidence);
    told += teleopTable(study.protocol(), works, options.confidence);
  }
  if (options.json) {
    printJson(json);
  } else {
    printText(told);
  }
}

}  // namespace

void addStudyFigureCommand(CLI::App& study) {
  auto options = std::make_shared<FigureOptions>();
  CLI::App* command = study.add_subcommand(
      "figure", "Fit the psychometric curves of a study; report task times and force errors of robot tasks");
  command->footer(kStudyFigureExamples);
  command->add_option("study", options->file, kStudyFileHelp)->required()->option_text("FILE");
  command
      ->add_option("--figure", options->figure,
                   "Draw the result (.svg or .png): one figure per block, one for all robot tasks")
      ->option_text("FILE");
  command->add_option("--block", options->block, "Block of the protocol [all]")->option_text("NAME");
  command->add_option("--sigmoid", options->sigmoid, "Psychometric function [weber]")
      ->option_text("norm|logistic|weber|as-printed|weibull|gumbel");
  command->add_flag("--fixed-threshold", options->fixed_threshold,
                    "Fix the point of subjective equality at the reference");
  command->add_flag("--pooled", options->pooled, "Also fit and draw the pooled responses");
  command->add_option("--confidence", options->confidence, "Confidence level of the intervals [0.95]")
      ->check(numberIn({0.01, 0.999}));
  command->add_flag("--withdrawn", options->withdrawn, "Include participants who have withdrawn");
  options->overwrite.addTo(*command);
  addJson(*command, options->json);
  command->callback([options] { show(*options); });
}

}  // namespace haptolith
