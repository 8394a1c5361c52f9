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
#include "haptolith/core/pluralise.h"
#include "haptolith/psychometrics/group/group.h"
#include "haptolith/psychometrics/group/group_difference.h"
#include "haptolith/psychometrics/psychometric_figure.h"
#include "haptolith/study/results/answers.h"
#include "haptolith/study/results/teleop_figure.h"
#include "haptolith/study/results/teleop_results.h"
#include "haptolith/study/store/participant_flow.h"
#include "haptolith/study/store/store.h"

#include "commands.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/overwrite.h"
#include "shared/stop_on_signal.h"
#include "study/fit_report.h"
#include "study/teleop_report.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kStudyFigureExamples = R"(Examples:
  haptolith study figure friction.study --out friction.svg
  haptolith study figure both.study --out figure.png        figure-friction.png and figure-gravity.png
  haptolith study figure friction.study --json              numbers alone

Of several participants the person in the middle stands first, by a model of all of them at once. docs/psychometrics.md
has the models and how well their intervals hold.)";

constexpr double kWide = 3;            // high over low end of an interval that hardly bounds anything
constexpr double kDoubtful = 1.0 / 3;  // Bayes factor of people alike below which they are said to differ

struct FigureOptions {
  std::string file, out, block;
  std::optional<std::string> sigmoid;
  bool fixed_threshold = false, pooled = false, json = false, withdrawn = false;
  double confidence = 0.95;
  Overwrite overwrite;
};

/// One block of a study, fitted.
struct BlockResult {
  const StudyBlock* block = nullptr;
  std::size_t index = 0;                     ///< of the block in the protocol
  const ParticipantGroup* people = nullptr;  ///< whose answers these are; none: everybody's
  std::vector<std::string> codes;
  std::vector<std::vector<Level>> levels;
  std::optional<GroupFit> group;  ///< of several participants
  std::optional<Fit> pooled;      ///< all answers as of one person: of a single participant, or when it is asked for
  std::optional<double> caught;

  /// "friction", or "friction of group seen".
  [[nodiscard]] std::string name() const {
    return block->name + (people == nullptr ? "" : fmt::format(" of group {}", people->name));
  }
  [[nodiscard]] const Fit& headline() const { return group ? group->median_person : *pooled; }
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
        fmt::format("{}: block {} has answers to one stimulus; a curve needs two", options.file, result.name()));
  }
  if (result.codes.size() > 1) {
    result.group = fitGroup(result.levels, groupOptions(fit));
  }
  if (options.pooled || !result.group) {
    result.pooled = fitPsychometric(all, fit);
  }
}

/// None when nobody has answered yet.
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

/// "figure.svg", or "figure-work.svg" where there are curves, too.
OutputFile workFileFor(const FigureOptions& options, bool alone) {
  std::filesystem::path file = options.out;
  if (!alone) {
    file.replace_filename(fmt::format("{}-work{}", file.stem().string(), file.extension().string()));
  }
  return options.overwrite(file.string());
}

/// "figure.svg", or "figure-friction.svg" where there are several blocks, "figure-friction-seen.svg" of a group.
OutputFile fileFor(const FigureOptions& options, const BlockResult& result, bool several) {
  std::filesystem::path file = options.out;
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
        fmt::format("People differ in their Weber fractions (Bayes factor of people alike {}, prior "
                    "half-normal {:g}).",
                    bayesFactorText(result.group->scale.alike), result.group->scale.prior.usual));
  }
  if (result.group && result.group->threshold && result.group->threshold->alike < kDoubtful) {
    remarks.push_back(
        fmt::format("People differ in their PSEs (Bayes factor of people alike {}, prior half-normal "
                    "{:.3g}).",
                    bayesFactorText(result.group->threshold->alike), result.group->threshold->prior.usual));
  }
  if (isWeber(fit.function.sigmoid) && w.interval.high > kWide * w.interval.low) {
    remarks.push_back(fmt::format("{} answers of {} hardly bound the Weber fraction: {:.3g} to {:.3g}.", fit.n_trials,
                                  result.group ? pluralise(result.codes.size(), "person", "people") : "one person",
                                  w.interval.low, w.interval.high));
  }
  const std::optional<Interval> shown = weberFractionsShownBy(*result.block);
  if (isWeber(fit.function.sigmoid) && shown && (w.value < shown->low || w.value > shown->high)) {
    remarks.push_back(
        fmt::format("The levels show Weber fractions of {:.3g} to {:.3g}; an estimate outside may be far off.",
                    shown->low, shown->high));
  }
  if (result.group && !fit.doubt.empty()) {
    remarks.push_back(fmt::format("Doubtful: {}", fit.doubt));
  }
  if (result.group && result.pooled) {
    remarks.emplace_back(
        "The pooled fit takes all answers for one person's: where people differ its curve is too flat and its "
        "intervals too narrow.");
  }
  return remarks;
}

std::string text(const BlockResult& result) {
  std::string told =
      fmt::format("{}: {}, reference {} ({:g})\n", result.name(), pluralise(result.codes.size(), "participant"),
                  result.block->reference.name, result.block->reference.value);
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
  if (result.people != nullptr) {
    json["of_group"] = result.people->name;
  }
  if (result.group) {
    json["group"] = groupJson(*result.group, result.codes);
  }
  if (result.pooled) {
    json["pooled"] = fitJson(*result.pooled);
  }
  return json;
}

/// What changes from one block to another within people, or from one group of people to another.
struct Difference {
  const BlockResult* first = nullptr;
  const BlockResult* second = nullptr;
  std::optional<std::size_t> in_both = {};  ///< people; none: between groups
  Change scale = {};
  std::optional<Change> threshold = {};  ///< of thresholds as shares of their references
};

/// Of each person the one and the other result. @param in_both  how many have both.
std::vector<UnderBoth> pairedPeople(const BlockResult& first, const BlockResult& second, std::size_t& in_both) {
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
      ++in_both;
    }
  }
  return people;
}

std::optional<Difference> differenceOf(const BlockResult& first, const BlockResult& second, double confidence) {
  if (!first.group || !second.group || !isWeber(first.group->median_person.function.sigmoid) ||
      !isWeber(second.group->median_person.function.sigmoid)) {
    return std::nullopt;
  }
  Difference difference{.first = &first, .second = &second};
  std::vector<UnderBoth> people;
  if (first.people == second.people) {
    people = pairedPeople(first, second, difference.in_both.emplace(0));
  }
  const auto change = [&](const Population& from, const Population& to, double offset) {
    return difference.in_both ? changeBetween(from, to, people, confidence, offset)
                              : changeBetweenGroups(from, to, confidence, offset);
  };
  difference.scale = change(first.group->scale, second.group->scale, 0);
  if (first.group->threshold && second.group->threshold) {
    const double offset = std::log(second.block->reference.value / first.block->reference.value);
    difference.threshold = change(*first.group->threshold, *second.group->threshold, offset);
  }
  return difference;
}

/// The results of one group, in the order of its blocks; of everybody where there are no groups.
std::vector<const BlockResult*> resultsIn(const std::vector<BlockResult>& results, const ParticipantGroup* people) {
  std::vector<const BlockResult*> own;
  for (const BlockResult& result : results) {
    if (result.people == people) {
      own.push_back(&result);
    }
  }
  if (people != nullptr) {
    std::ranges::sort(own, {}, [people](const BlockResult* of) {
      return std::ranges::find(people->blocks, of->index) - people->blocks.begin();
    });
  }
  return own;
}

/// What two groups are compared in: each block that both go through, and of the others the first with the first, the
/// second with the second and so on.
std::vector<std::pair<const BlockResult*, const BlockResult*>> comparable(std::vector<const BlockResult*> first,
                                                                          std::vector<const BlockResult*> second) {
  std::vector<std::pair<const BlockResult*, const BlockResult*>> pairs;
  for (auto one = first.begin(); one != first.end();) {
    const auto same = std::ranges::find(second, (*one)->index, &BlockResult::index);
    if (same == second.end()) {
      ++one;
    } else {
      pairs.emplace_back(*one, *same);
      second.erase(same);
      one = first.erase(one);
    }
  }
  for (std::size_t i = 0; i < std::min(first.size(), second.size()); ++i) {
    pairs.emplace_back(first[i], second[i]);
  }
  return pairs;
}

/// Within people the first block with each other one; between groups each with each that stands below it.
std::vector<Difference> differencesOf(const std::vector<BlockResult>& results, const StudyProtocol& protocol,
                                      double confidence) {
  std::vector<Difference> differences;
  const auto add = [&](const BlockResult& first, const BlockResult& second) {
    if (const std::optional<Difference> difference = differenceOf(first, second, confidence)) {
      differences.push_back(*difference);
    }
  };
  std::vector<std::vector<const BlockResult*>> by_group;
  for (const ParticipantGroup& group : protocol.groups) {
    by_group.push_back(resultsIn(results, &group));
  }
  if (protocol.groups.empty()) {
    by_group.push_back(resultsIn(results, nullptr));
  }
  for (const std::vector<const BlockResult*>& own : by_group) {
    for (std::size_t i = 1; i < own.size(); ++i) {
      add(*own.front(), *own[i]);
    }
  }
  for (std::size_t first = 0; first < by_group.size(); ++first) {
    for (std::size_t second = first + 1; second < by_group.size(); ++second) {
      for (const auto& [one, other] : comparable(by_group[first], by_group[second])) {
        add(*one, *other);
      }
    }
  }
  return differences;
}

std::string text(const Difference& difference, double confidence) {
  const std::string heading =
      fmt::format("{} over {}: {}, people's median", difference.second->name(), difference.first->name(),
                  difference.in_both ? fmt::format("{} in both", *difference.in_both) : "groups of different people");
  return changesText(heading, difference.scale, difference.threshold, confidence);
}

Json jsonOf(const Difference& difference) {
  Json json{{"first", difference.first->block->name}, {"second", difference.second->block->name}};
  if (difference.in_both) {
    json["participants_in_both"] = *difference.in_both;
  } else {
    json["first_group"] = difference.first->people->name;
    json["second_group"] = difference.second->people->name;
  }
  json.update(changesJson(difference.scale, difference.threshold));
  return json;
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
    (void)sigmoidNamed(*options.sigmoid);  // throws, whatever the study holds
  }
  const StudyStore study(options.file, StudyStore::Access::kRead);
  const std::vector<BlockResult> results = resultsOf(options, study);
  std::vector<TeleopBlockResult> works = teleopResults(study, options.withdrawn);
  std::erase_if(works, [&](const TeleopBlockResult& of) {
    return !options.block.empty() && study.protocol().blocks[of.block].name != options.block;
  });
  if (results.empty() && works.empty()) {
    throw Failure(fmt::format("{}: nobody has answered yet", options.file));
  }
  Json json{{"study", study.title()}, {"participants", flowText(flowOf(study))}, {"blocks", Json::array()}};
  std::string told = flowsText(study);
  for (const GroupFlow& flow : groupFlowsOf(study)) {
    json["groups"].push_back({{"group", flow.group}, {"participants", flowText(flow.people, "assigned")}});
  }
  for (const BlockResult& result : results) {
    if (!options.out.empty()) {
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
    if (!options.out.empty()) {
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
      "figure",
      "Psychometric curves and Weber fractions of a study, as in the paper's Fig. 5; task times and errors of "
      "force of work for a robot");
  command->footer(kStudyFigureExamples);
  command->add_option("study", options->file, "A study")->required()->option_text("FILE");
  command
      ->add_option("--out", options->out,
                   "Draw them (.svg or .png): a figure for each block, one for all work for a robot")
      ->option_text("FILE");
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
