#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/psychometrics/group.h"
#include "haptolith/psychometrics/group_difference.h"
#include "haptolith/psychometrics/psychometric_figure.h"
#include "haptolith/study/answers.h"
#include "haptolith/study/store/participant_flow.h"
#include "haptolith/study/store/store.h"

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
  haptolith study figure friction.study --json              numbers alone

Of several participants the person in the middle stands first, by a model of all of them at once. docs/psychometrics.md
has the models and how well their intervals hold.)";

constexpr double kWide = 3;            // high over low end of an interval that hardly bounds anything
constexpr double kDoubtful = 1.0 / 3;  // Bayes factor of people alike below which they are said to differ

struct Options {
  std::string file, out, block;
  std::optional<std::string> sigmoid;
  bool fixed_threshold = false, pooled = false, json = false, withdrawn = false;
  double confidence = 0.95;
  Overwrite overwrite;
};

/// One block of a study, fitted.
struct BlockResult {
  const StudyBlock* block = nullptr;
  std::vector<std::string> codes;
  std::vector<std::vector<Level>> levels;
  std::optional<GroupFit> group;  ///< of several participants
  std::optional<Fit> pooled;      ///< all answers as of one person: of a single participant, or when it is asked for
  std::optional<double> caught;

  [[nodiscard]] const Fit& headline() const { return group ? group->median_person : *pooled; }
};

FitOptions fitOptionsFor(const Options& options, const StudyBlock& block) {
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

void fitTo(BlockResult& result, const Options& options) {
  const FitOptions fit = fitOptionsFor(options, *result.block);
  const std::vector<Level> all = pooled(result.levels);
  if (all.size() < 2 && !fit.threshold) {
    throw Failure(
        fmt::format("{}: block {} has answers to one stimulus; a curve needs two", options.file, result.block->name));
  }
  if (result.codes.size() > 1) {
    result.group = fitGroup(result.levels, groupOptions(fit));
  }
  if (options.pooled || !result.group) {
    result.pooled = fitPsychometric(all, fit);
  }
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
  fitTo(result, options);
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

void draw(const OutputFile& file, const Options& options, const StudyStore& study, const BlockResult& result) {
  PsychometricFigure figure;
  figure.title =
      study.protocol().blocks.size() > 1 && !result.block->title.empty() ? result.block->title : study.title();
  figure.x_label = result.block->axis_label;
  figure.y_label =
      fmt::format("share of answers \"{}\"",
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

/// Least and largest JND, as shares of the reference, that the levels show: to the nearest and to the farthest.
std::optional<Interval> weberFractionsShownBy(const StudyBlock& block) {
  std::optional<Interval> shown;
  for (const Stimulus& level : block.levels) {
    const double distance = std::abs(std::log(level.value / block.reference.value));
    if (std::isfinite(distance) && distance > 0) {
      shown = shown ? Interval{std::min(shown->low, distance), std::max(shown->high, distance)}
                    : Interval{distance, distance};
    }
  }
  return shown ? std::optional(Interval{std::expm1(shown->low), std::expm1(shown->high)}) : std::nullopt;
}

/// What to beware of in a block's numbers.
std::vector<std::string> remarksOn(const BlockResult& result) {
  std::vector<std::string> remarks;
  const Fit& fit = result.headline();
  const Estimate& w = fit.weber_fraction;
  const bool lapse_fixed = fit.lapse.interval.low == fit.lapse.interval.high;
  remarks.push_back(lapse_fixed ? fmt::format("Lapses: a rate of {:g} is assumed.", fit.lapse.value)
                                : "Lapses: the rate is fitted with the rest; docs/psychometrics.md has its prior.");
  const double reference = result.block->reference.value;
  const Interval& pse = fit.threshold.interval;
  if (pse.high < reference || pse.low > reference) {
    remarks.push_back(
        fmt::format("The PSE differs from the reference, {:g}, which its interval leaves out: tests seem {} "
                    "than they are.",
                    reference, pse.high < reference ? "more" : "less"));
  }
  if (result.group && result.group->scale.alike < kDoubtful) {
    remarks.push_back(
        fmt::format("People differ in their Weber fractions (Bayes factor of people alike {:.2g}, prior "
                    "half-normal {:g}).",
                    result.group->scale.alike, result.group->scale.prior.usual));
  }
  if (result.group && result.group->threshold && result.group->threshold->alike < kDoubtful) {
    remarks.push_back(
        fmt::format("People differ in their PSEs (Bayes factor of people alike {:.2g}, prior half-normal "
                    "{:.3g}).",
                    result.group->threshold->alike, result.group->threshold->prior.usual));
  }
  if (isWeber(fit.function.sigmoid) && w.interval.high > kWide * w.interval.low) {
    remarks.push_back(fmt::format("{} answers of {} hardly bound the Weber fraction: {:.3g} to {:.3g}.", fit.n_trials,
                                  result.group ? fmt::format("{} people", result.codes.size()) : "one person",
                                  w.interval.low, w.interval.high));
  }
  const std::optional<Interval> shown = weberFractionsShownBy(*result.block);
  if (isWeber(fit.function.sigmoid) && shown && (w.value < shown->low || w.value > shown->high)) {
    remarks.push_back(
        fmt::format("The levels show Weber fractions of {:.3g} to {:.3g}; an estimate outside may be far off.",
                    shown->low, shown->high));
  }
  if (result.group && result.pooled) {
    remarks.emplace_back(
        "The pooled fit takes all answers for one person's: where people differ its curve is too flat and its "
        "intervals too narrow.");
  }
  return remarks;
}

std::string text(const BlockResult& result) {
  std::string told = fmt::format("{}: {} participant(s), reference {} ({:g})\n", result.block->name,
                                 result.codes.size(), result.block->reference.name, result.block->reference.value);
  if (result.group) {
    told += groupText(*result.group, result.codes);
  }
  if (result.pooled) {
    told += (result.group ? "\nAll answers pooled. " : "") + fitText(*result.pooled);
  }
  told += "\n";
  for (const std::string& remark : remarksOn(result)) {
    told += remark + "\n";
  }
  if (result.caught) {
    told += fmt::format("Catch trials answered right: {:.0f} %\n", 100 * *result.caught);
  }
  return told;
}

Json jsonOf(const BlockResult& result) {
  const Fit& fit = result.headline();
  const auto interval = [](const Interval& it) { return Json::array({it.low, it.high}); };
  Json json{{"block", result.block->name},
            {"axis_label", result.block->axis_label},
            {"reference", result.block->reference.value},
            {"participants", result.codes.size()},
            {"caught", result.caught ? Json(*result.caught) : Json(nullptr)},
            {"headline",
             {{"of", result.group ? "median person" : "one person"},
              {"weber_fraction", fit.weber_fraction.value},
              {"weber_fraction_interval", interval(fit.weber_fraction.interval)},
              {"pse", fit.threshold.value},
              {"pse_interval", interval(fit.threshold.interval)},
              {"jnd", fit.jnd.value},
              {"jnd_interval", interval(fit.jnd.interval)},
              {"lapse", fit.lapse.value},
              {"lapse_interval", interval(fit.lapse.interval)},
              {"n_trials", std::llround(fit.n_trials)}}},
            {"remarks", remarksOn(result)}};
  if (result.group) {
    json["group"] = groupJson(*result.group, result.codes);
  }
  if (result.pooled) {
    json["pooled"] = fitJson(*result.pooled);
  }
  return json;
}

/// What changes from one block to another, of people.
struct Difference {
  const BlockResult* first = nullptr;
  const BlockResult* second = nullptr;
  std::size_t in_both = 0;
  Change scale;
  std::optional<Change> threshold;  ///< of thresholds as shares of their references
};

std::optional<Difference> differenceOf(const BlockResult& first, const BlockResult& second, double confidence) {
  if (!first.group || !second.group || !isWeber(first.group->median_person.function.sigmoid) ||
      !isWeber(second.group->median_person.function.sigmoid)) {
    return std::nullopt;
  }
  Difference difference;
  difference.first = &first;
  difference.second = &second;
  std::vector<UnderBoth> people;
  for (std::size_t i = 0; i < first.codes.size(); ++i) {
    people.push_back({.first = i});
  }
  for (std::size_t i = 0; i < second.codes.size(); ++i) {
    const auto found = std::ranges::find(first.codes, second.codes[i]);
    if (found == first.codes.end()) {
      people.push_back({.second = i});
    } else {
      people[static_cast<std::size_t>(found - first.codes.begin())].second = i;
      ++difference.in_both;
    }
  }
  difference.scale = changeBetween(first.group->scale, second.group->scale, people, confidence);
  if (first.group->threshold && second.group->threshold) {
    const double offset = std::log(second.block->reference.value / first.block->reference.value);
    difference.threshold = changeBetween(*first.group->threshold, *second.group->threshold, people, confidence, offset);
  }
  return difference;
}

/// The first block with each other one.
std::vector<Difference> differencesOf(const std::vector<BlockResult>& results, double confidence) {
  std::vector<Difference> differences;
  for (std::size_t i = 1; i < results.size(); ++i) {
    if (std::optional<Difference> difference = differenceOf(results.front(), results[i], confidence)) {
      differences.push_back(*difference);
    }
  }
  return differences;
}

std::string text(const Difference& difference, double confidence) {
  const auto line = [&](std::string_view what, const Change& change) {
    return fmt::format(
        "  {:<16} {:>9.4g}   {:<22} Bayes factor of no difference {:.2g}, prior of its logarithm "
        "normal(0, {:.3g})\n",
        what, std::exp(change.mean.value),
        fmt::format("{:.4g} to {:.4g}", std::exp(change.mean.interval.low), std::exp(change.mean.interval.high)),
        change.same, change.prior.usual);
  };
  std::string told = fmt::format("{} over {}: {} in both, people's median\n\n{:>28}   {:g} % credible interval\n",
                                 difference.second->block->name, difference.first->block->name, difference.in_both,
                                 "ratio", 100 * confidence);
  told += line("Weber fraction", difference.scale);
  if (difference.threshold) {
    told += line("PSE / reference", *difference.threshold);
  }
  return told;
}

Json jsonOf(const Difference& difference) {
  const auto change_json = [](const Change& change) {
    return Json{{"ratio", std::exp(change.mean.value)},
                {"interval", {std::exp(change.mean.interval.low), std::exp(change.mean.interval.high)}},
                {"bayes_factor_same", change.same},
                {"prior_log_deviation", change.prior.usual}};
  };
  Json json{{"first", difference.first->block->name},
            {"second", difference.second->block->name},
            {"participants_in_both", difference.in_both},
            {"weber_fraction", change_json(difference.scale)}};
  if (difference.threshold) {
    json["pse_over_reference"] = change_json(*difference.threshold);
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
      draw(fileFor(options, *result.block, results.size() > 1), options, study, result);
    }
    json["blocks"].push_back(jsonOf(result));
    told += "\n" + text(result);
  }
  for (const Difference& difference : differencesOf(results, options.confidence)) {
    json["differences"].push_back(jsonOf(difference));
    told += "\n" + text(difference, options.confidence);
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
  command->add_flag("--fixed-threshold", options->fixed_threshold,
                    "Take the reference for the point of subjective equality, as (paper 22) does");
  command->add_flag("--pooled", options->pooled, "Also fit all answers as if of one person, and draw that");
  command->add_option("--confidence", options->confidence, "Of all intervals [0.95]")->check(numberIn({0.01, 0.999}));
  command->add_flag("--withdrawn", options->withdrawn, "Count those, too, who have withdrawn");
  options->overwrite.addTo(*command);
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { show(*options); });
}

}  // namespace haptolith
