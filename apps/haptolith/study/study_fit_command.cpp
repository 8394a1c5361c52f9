#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/psychometrics/answers_file.h"
#include "haptolith/psychometrics/fit.h"
#include "haptolith/psychometrics/fit_request.h"
#include "haptolith/psychometrics/group/group.h"
#include "haptolith/psychometrics/group/group_difference.h"
#include "haptolith/psychometrics/psychometric_figure.h"

#include "commands.h"
#include "shared/common_options.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/overwrite.h"
#include "shared/stop_on_signal.h"
#include "study/fit_report.h"

namespace haptolith {

namespace {

constexpr const char* kStudyFitExamples = R"(Examples:
  haptolith study fit --data answers.csv --sigmoid weber --reference 0.835
                                     fit the Weber function; only w is free
  haptolith study fit --data answers.csv --design 2afc --sigmoid norm --json
                                     fit as psignifit does
  haptolith study fit --data trials.csv --reference 1.625 --group --figure gravity.png --log-x

FILE has the columns x,k,n (stimulus, positive responses, responses), or x,response with one row
per trial. With a column participant, --group fits participants separately.
Models, priors and numbers: docs/reference/psychometrics.md)";

struct FitCommandOptions {
  std::string data, block, figure;
  FitRequest fit;
  double pool_tolerance = 0;
  bool compare = false;
  bool group = false;
  bool between_groups = false;
  Overwrite overwrite;
  bool json = false;
  std::string x_label = "x";
};

/// Returns the participants of one block.
std::vector<AnswersOf> answersOf(const FitCommandOptions& options) {
  Answers answers = readAnswersFile(options.data, options.pool_tolerance);
  for (const std::string& warning : answers.warnings) {
    spdlog::warn("{}", warning);
  }
  std::vector<AnswersOf> all = std::move(answers.people);
  std::string blocks;
  for (const AnswersOf& of : all) {
    if (blocks.find("'" + of.block + "'") == std::string::npos) {
      blocks += (blocks.empty() ? "'" : ", '") + of.block + "'";
    }
  }
  if (options.block.empty() && blocks.find(',') != std::string::npos) {
    throw InvalidParameter("--block", "not given", "one of " + blocks);
  }
  if (!options.block.empty()) {
    std::erase_if(all, [&](const AnswersOf& of) { return of.block != options.block; });
    if (all.empty()) {
      throw InvalidParameter("--block", "'" + options.block + "'", "one of " + blocks);
    }
  }
  return all;
}

/// Returns the sigmoids to compare with the wanted one: on its axis, and Weibull if there is a logarithm.
std::vector<Sigmoid> comparable(const FitOptions& wanted, const std::vector<Level>& levels) {
  std::vector<Sigmoid> sigmoids{Sigmoid::kNorm, Sigmoid::kLogistic, Sigmoid::kStudent, Sigmoid::kReversedGumbel};
  if (!wanted.log_axis) {
    sigmoids.push_back(Sigmoid::kGumbel);  // on a logarithmic axis it is Weibull
  }
  if (levels.front().x > 0) {
    sigmoids.push_back(Sigmoid::kWeibull);
  }
  if (std::ranges::find(sigmoids, wanted.sigmoid) == sigmoids.end()) {
    sigmoids.push_back(wanted.sigmoid);
  }
  return sigmoids;
}

/// Pools the responses of all participants.
std::vector<Level> pooledAnswers(const std::vector<std::vector<Level>>& participants, double tolerance) {
  if (tolerance == 0 || participants.size() == 1) {
    return pooled(participants);
  }
  std::vector<Level> all;
  for (const std::vector<Level>& levels : participants) {
    all.insert(all.end(), levels.begin(), levels.end());
  }
  return pooledWithin(all, tolerance);
}

/// Fit to the participants of one group.
struct GroupResult {
  std::string name;
  std::vector<std::string> people;
  GroupFit fit;
};

/// Result of the command.
struct Result {
  Fit fit;
  std::optional<GroupFit> group;
  std::vector<GroupResult> groups;  ///< groups of participants, for a comparison
  std::vector<Fit> comparison;
  std::vector<std::string> names;
};

/// Fits each group of participants separately, in the order of the table.
std::vector<GroupResult> fitGroups(const std::vector<AnswersOf>& answers, const FitOptions& options) {
  std::vector<GroupResult> groups;
  std::vector<std::vector<std::vector<Level>>> levels;
  for (const AnswersOf& of : answers) {
    if (of.group.empty()) {
      throw InvalidParameter("--between-groups", fmt::format("participant '{}' without a group", of.participant),
                             "left out, or given with a table whose column group is complete");
    }
    auto group = std::ranges::find(groups, of.group, &GroupResult::name);
    if (group == groups.end()) {
      groups.emplace_back().name = of.group;
      levels.emplace_back();
      group = groups.end() - 1;
    }
    group->people.push_back(of.participant);
    levels[static_cast<std::size_t>(group - groups.begin())].push_back(of.levels);
  }
  if (groups.size() < 2) {
    throw InvalidParameter("--between-groups", "one group", "left out: the table has only one group");
  }
  for (std::size_t i = 0; i < groups.size(); ++i) {
    groups[i].fit = fitGroup(levels[i], options);
  }
  return groups;
}

/// Reports ratios, for Weber fractions only.
template <class Tell>
void tellDifferences(const std::vector<GroupResult>& groups, double confidence, Tell tell) {
  for (std::size_t first = 0; first < groups.size(); ++first) {
    for (std::size_t second = first + 1; second < groups.size(); ++second) {
      const GroupFit& one = groups[first].fit;
      const GroupFit& other = groups[second].fit;
      if (isWeber(one.median_person.function.sigmoid)) {
        tell(groups[first].name, groups[second].name, changeBetweenGroups(one.scale, other.scale, confidence),
             one.threshold ? std::optional(changeBetweenGroups(*one.threshold, *other.threshold, confidence))
                           : std::nullopt);
      }
    }
  }
}

Result fitAll(const FitCommandOptions& options, const std::vector<AnswersOf>& answers) {
  const FitOptions wanted = fitOptionsOf(options.fit, "--");
  std::vector<std::vector<Level>> participants;
  participants.reserve(answers.size());
  Result result;
  result.names = namesOf(answers);
  for (const AnswersOf& of : answers) {
    participants.push_back(of.levels);
  }
  const std::vector<Level> all = pooledAnswers(participants, options.pool_tolerance);
  result.fit = fitAsAsked(all, options.fit, "--");
  if (options.group) {
    FitOptions quick = wanted;
    quick.simulations = 0;
    result.group = fitGroup(participants, quick);
  }
  if (options.between_groups) {
    FitOptions quick = wanted;
    quick.simulations = 0;
    result.groups = fitGroups(answers, quick);
  }
  if (options.compare) {
    result.comparison = compareSigmoids(all, wanted, comparable(wanted, all));
  }
  return result;
}

void draw(const FitCommandOptions& options, const Result& result) {
  PsychometricFigure figure{
      .x_label = options.x_label, .log_axis = options.fit.log_x, .reference = options.fit.reference};
  figure.group = FigureCurve{.title = result.names.size() > 1 ? "all" : "fit", .fit = result.fit};
  if (result.group) {
    for (std::size_t i = 0; i < result.names.size(); ++i) {
      figure.participants.push_back({.title = result.names[i], .fit = result.group->participants[i]});
    }
  }
  drawPsychometricFigure(options.overwrite(options.figure), figure);
}

void printGroups(const FitCommandOptions& options, const std::vector<GroupResult>& groups) {
  for (const GroupResult& group : groups) {
    printText(fmt::format("\nGroup {}:\n{}", group.name, groupText(group.fit, group.people)));
  }
  tellDifferences(groups, options.fit.confidence,
                  [&](const std::string& first, const std::string& second, const Change& scale,
                      const std::optional<Change>& threshold) {
                    const std::string heading =
                        fmt::format("group {} over group {}: different participants, population median", second, first);
                    printText("\n" + changesText(heading, scale, threshold, options.fit.confidence));
                  });
}

nlohmann::ordered_json groupsJson(const FitCommandOptions& options, const std::vector<GroupResult>& groups) {
  nlohmann::ordered_json json;
  for (const GroupResult& group : groups) {
    nlohmann::ordered_json fit{{"group", group.name}};
    fit.update(groupJson(group.fit, group.people));
    json["groups"].push_back(std::move(fit));
  }
  tellDifferences(groups, options.fit.confidence,
                  [&](const std::string& first, const std::string& second, const Change& scale,
                      const std::optional<Change>& threshold) {
                    nlohmann::ordered_json difference{{"first_group", first}, {"second_group", second}};
                    difference.update(changesJson(scale, threshold));
                    json["differences"].push_back(std::move(difference));
                  });
  return json;
}

void print(const FitCommandOptions& options, const Result& result) {
  if (!options.json) {
    printText(fitText(result.fit));
    printText(result.group ? groupText(*result.group, result.names) : "");
    printGroups(options, result.groups);
    printText(result.comparison.empty() ? "" : comparisonText(result.comparison));
    return;
  }
  nlohmann::ordered_json json = fitJson(result.fit);
  if (result.group) {
    json["group"] = groupJson(*result.group, result.names);
  }
  if (!result.groups.empty()) {
    json.update(groupsJson(options, result.groups));
  }
  for (const Fit& fit : result.comparison) {
    json["comparison"].push_back({{"sigmoid", nameOf(fit.function.sigmoid)},
                                  {"log_evidence", fit.log_evidence},
                                  {"aic", fit.aic},
                                  {"bic", fit.bic},
                                  {"deviance", fit.deviance},
                                  {"threshold", fit.threshold.value}});
  }
  printJson(json);
}

void runFit(const FitCommandOptions& options) {
  const StopOnSignal stop_on_signal;
  const Result result = fitAll(options, answersOf(options));
  if (!options.figure.empty()) {
    draw(options, result);
  }
  print(options, result);
}

void addModelOptions(CLI::App& command, FitCommandOptions& options) {
  command.add_option("--design", options.fit.design, "Design, which sets the asymptotes")
      ->check(oneOf(designNames()))
      ->capture_default_str();
  command
      .add_option("--alternatives", options.fit.alternatives, "Number of alternatives n of nafc; the guess rate is 1/n")
      ->check(wholeNumberIn({2, 1000}))
      ->capture_default_str();
  command.add_option("--sigmoid", options.fit.sigmoid, "Psychometric function")
      ->check(oneOf(sigmoidNames()))
      ->capture_default_str();
  command.add_flag("--log-x", options.fit.log_x,
                   "Use a logarithmic axis; always on with weber, as-printed and weibull");
  command.add_flag("--falling", options.fit.falling, "Expect fewer positive responses for larger stimuli");
  command.add_option("--reference", options.fit.reference,
                     "Reference p, drawn as a line; fixes the threshold of weber and as-printed");
  command.add_flag("--free-threshold", options.fit.free_threshold, "Fit the threshold of weber and as-printed");
  command.add_option(
      "--lapse", options.fit.lapse,
      "Lapse rate, 1 minus the upper asymptote: a number or free [0 with weber and as-printed, else free]");
  command.add_option("--guess", options.fit.guess, "Guess rate of yesno: a number or free [as --lapse]");
  command.add_option("--overdispersion", options.fit.overdispersion,
                     "Overdispersion eta of the beta-binomial: a number or free [as --lapse]");
}

}  // namespace

void addStudyFitCommand(CLI::App& study) {
  auto options = std::make_shared<FitCommandOptions>();
  CLI::App* command = study.add_subcommand("fit", "Fit a psychometric function to a table of responses");
  command->add_option("--data", options->data, "Table of responses (.csv or .tsv)")->required();
  command->add_option("--block", options->block, "Block of the table, when it has several");
  command->add_option("--pool-tolerance", options->pool_tolerance,
                      "Pool stimuli that differ by at most this from the first of them, in the unit of x");
  addModelOptions(*command, *options);
  command
      ->add_option("--method", options->fit.method,
                   "Estimate: map, median or ml (maximum likelihood) [median with weber, else map]")
      ->check(oneOf({"map", "median", "ml"}));
  command->add_option("--confidence", options->fit.confidence, "Confidence level of the intervals")
      ->capture_default_str();
  command->add_option("--simulations", options->fit.simulations, "Number of simulations for the p value")
      ->capture_default_str();
  command->add_flag("--compare", options->compare, "Also fit other functions and rank them");
  command->add_flag("--group", options->group, "Also fit each participant and the SD between participants");
  command->add_flag("--between-groups", options->between_groups,
                    "Also fit each group (column group) separately and compare the groups");
  command->add_option("--figure", options->figure, kFigureHelp);
  command->add_option("--x-label", options->x_label, "Label of the x axis of the figure")->capture_default_str();
  options->overwrite.addTo(*command);
  addJson(*command, options->json);
  command->footer(kStudyFitExamples);
  command->callback([options] { runFit(*options); });
}

}  // namespace haptolith
