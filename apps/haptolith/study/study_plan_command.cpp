#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/pluralise.h"
#include "haptolith/figure/figure.h"
#include "haptolith/study/run/study_plan.h"

#include "commands.h"
#include "shared/common_options.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/overwrite.h"
#include "shared/progress.h"
#include "shared/stop_on_signal.h"
#include "study/lapse_options.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kStudyPlanExamples = R"(Examples:
  haptolith study plan --protocol icra2021-friction --weber 0.29
  haptolith study plan --weber 0.29 --alternative 0.4 --participants 8,16,32 --figure power.svg
  haptolith study plan --weber 0.29 --alternative 0.4 --between-sd 0.3 --repeats 12 --find-n
  haptolith study plan --weber 0.29 --width 0.5 --repeats 12 --find-n)";

constexpr int kFigureWidth_px = 1100;
constexpr int kFigureHeight_px = 460;

struct PlanOptions {
  std::string protocol = "icra2021-friction", block, figure;
  std::vector<int> participants{4, 8, 16, 32}, repeats{3, 6, 12};
  PlanParameters parameters;
  Overwrite overwrite;
  bool json = false;
  bool search = false;  ///< whether to search for the min. number of participants
  double power = 0.8;   ///< required power of the search
};

StudyBlock blockOf(const PlanOptions& options) {
  const ProtocolText text = findProtocol(options.protocol);
  const StudyProtocol protocol = loadProtocolText(text.text, text.name);
  const auto found = options.block.empty() ? protocol.blocks.begin()
                                           : std::ranges::find(protocol.blocks, options.block, &StudyBlock::name);
  if (found == protocol.blocks.end()) {
    throw InvalidParameter("block", options.block, fmt::format("one of {}", text.name));
  }
  if (found->teleop) {
    throw InvalidParameter("block", found->name,
                           "a block that compares stimuli; for task times and force errors, run a pilot study");
  }
  return *found;
}

std::string shareText(const SimulatedShare& share) {
  return fmt::format("{:.0f} % ({:.0f} to {:.0f})", 100 * share.value, 100 * share.interval.low,
                     100 * share.interval.high);
}

std::string tableText(const PlanOptions& options, const StudyBlock& block, const std::vector<PlanOutcome>& outcomes) {
  const PlanParameters& parameters = options.parameters;
  std::string table = fmt::format(
      "{}: {} simulated studies of each size, Weber fraction {:g}, fitted as in `study figure`\nIn brackets: 95 % "
      "intervals of the fractions.\n\nparticipants  repeats  responses estimates: median, 95 % range   interval's "
      "width   covered",
      block.name, parameters.studies, parameters.observer.weber_fraction);
  table += parameters.alternative ? fmt::format("        distinguished from {:g}", *parameters.alternative) : "";
  table += parameters.width ? fmt::format("            width <= {:g}", *parameters.width) : "";
  table += "\n";
  for (const PlanOutcome& outcome : outcomes) {
    table += fmt::format("{:>12}{:>9}{:>9}   {:>10.3f}, {:.3f} to {:.3f}{:>17.0f} %   {:<19}{}{}\n",
                         outcome.size.participants, outcome.size.repeats, outcome.answers, outcome.median, outcome.low,
                         outcome.high, 100 * outcome.interval_width, shareText(outcome.covered),
                         outcome.power ? fmt::format("  {:<19}", shareText(*outcome.power)) : "",
                         outcome.narrow ? fmt::format("  {}", shareText(*outcome.narrow)) : "");
  }
  return table;
}

/// Returns the min. number of participants among those that were tried.
std::string searchText(const PlanOptions& options, const std::vector<PlanOutcome>& outcomes) {
  std::string text = "\n";
  for (const int repeats : options.repeats) {
    const auto found = std::ranges::find_if(outcomes, [&](const PlanOutcome& outcome) {
      return outcome.size.repeats == repeats && successOf(outcome).value >= options.power;
    });
    text += fmt::format("{} with {} per level: sufficient in {:g} % of studies\n",
                        pluralise(found->size.participants, "participant"), pluralise(repeats, "trial"),
                        100 * options.power);
  }
  return text;
}

Json jsonOf(const SimulatedShare& share) {
  return {{"share", share.value}, {"interval", {share.interval.low, share.interval.high}}};
}

Json jsonOf(const PlanOptions& options, const StudyBlock& block, const std::vector<PlanOutcome>& outcomes) {
  Json rows = Json::array();
  for (const PlanOutcome& outcome : outcomes) {
    rows.push_back({{"participants", outcome.size.participants},
                    {"repeats", outcome.size.repeats},
                    {"answers", outcome.answers},
                    {"weber_fraction", {{"median", outcome.median}, {"low", outcome.low}, {"high", outcome.high}}},
                    {"interval_width", outcome.interval_width},
                    {"covered", jsonOf(outcome.covered)},
                    {"power", outcome.power ? jsonOf(*outcome.power) : Json(nullptr)},
                    {"narrow", outcome.narrow ? jsonOf(*outcome.narrow) : Json(nullptr)}});
  }
  const auto json_or_null = [](const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); };
  return {{"block", block.name},
          {"studies", options.parameters.studies},
          {"weber_fraction", options.parameters.observer.weber_fraction},
          {"between_sd", options.parameters.between_sd},
          {"alternative", json_or_null(options.parameters.alternative)},
          {"width", json_or_null(options.parameters.width)},
          {"sizes", std::move(rows)}};
}

/// Draws the power of a study over the number of participants; one curve per number of repeats.
void draw(const PlanOptions& options, const std::vector<PlanOutcome>& outcomes) {
  Figure figure(options.overwrite(options.figure), kFigureWidth_px, kFigureHeight_px);
  const bool power = options.parameters.alternative.has_value();
  std::string plots, ranges;
  double shift = 1;  // bars side by side
  for (const int repeats : options.repeats) {
    std::vector<std::vector<double>> rows;
    for (const PlanOutcome& outcome : outcomes) {
      if (outcome.size.repeats == repeats) {
        rows.push_back({static_cast<double>(outcome.size.participants), outcome.power ? 100 * outcome.power->value : 0,
                        outcome.median, outcome.low, outcome.high});
      }
    }
    figure.data(fmt::format("r{}", repeats), rows);
    const char* joint = plots.empty() ? "plot " : ", ";
    plots +=
        fmt::format("{}$r{} using 1:2 with linespoints pt 7 lw 2 title '{} of each level'", joint, repeats, repeats);
    ranges += fmt::format("{}$r{} using ($1*{}):3:4:5 with yerrorlines pt 7 lw 2 title '{} of each level'", joint,
                          repeats, shift, repeats);
    shift *= 1.04;
  }
  const auto [least, most] =
      std::ranges::minmax_element(outcomes, {}, [](const PlanOutcome& outcome) { return outcome.size.participants; });
  figure.command(fmt::format(R"(
set multiplot layout 1,{0}
set logscale x 2
set xrange [{3}:{4}]
set key top right
set xlabel 'participants'
set ylabel 'estimated Weber fraction'
set title 'median and 95 % range of the estimates'
{1}, {2} with lines dt 2 lc '#666666' title 'true')",
                             power ? 2 : 1, ranges, options.parameters.observer.weber_fraction,
                             0.85 * least->size.participants, 1.2 * most->size.participants));
  if (power) {
    figure.command(fmt::format(R"(
set key bottom right
set yrange [0:105]
set ylabel 'studies, %'
set title 'studies that distinguish it from {:g}'
{}, 80 with lines dt 2 lc '#666666' title '80 %')",
                               *options.parameters.alternative, plots));
  }
  figure.command("unset multiplot");
  figure.save();
}

std::vector<PlanOutcome> outcomesOf(const PlanOptions& options, const StudyBlock& block,
                                    const std::function<bool()>& goes_on) {
  std::vector<PlanOutcome> outcomes;
  std::vector<StudySize> sizes;
  for (const int repeats : options.repeats) {
    if (options.search) {
      std::ranges::copy(leastParticipants(block, repeats, options.parameters, options.power, goes_on),
                        std::back_inserter(outcomes));
    }
    for (const int participants : options.participants) {
      sizes.push_back({participants, repeats});
    }
  }
  return options.search ? outcomes : planStudy(block, sizes, options.parameters, goes_on);
}

void plan(const PlanOptions& options) {
  const StopOnSignal stop_on_signal;
  const StudyBlock block = blockOf(options);
  StatusLine status;
  std::size_t done = 0;
  // The number of steps of a search is not known in advance.
  const std::size_t all =
      options.participants.size() * options.repeats.size() * static_cast<std::size_t>(options.parameters.studies);
  Progress progress(status);
  const std::vector<PlanOutcome> outcomes = outcomesOf(options, block, [&] {
    ++done;
    if (!options.search) {
      return progress.tell(fmt::format("study {} of {}", done, all),
                           static_cast<double>(done) / static_cast<double>(all));
    }
    status.tell([&] { return fmt::format("study {}", done); });
    return !stopAsked();
  });
  status.clear();
  if (!options.figure.empty()) {
    draw(options, outcomes);
  }
  if (options.json) {
    printJson(jsonOf(options, block, outcomes));
  } else {
    printText(tableText(options, block, outcomes) + (options.search ? searchText(options, outcomes) : ""));
  }
}

}  // namespace

void addStudyPlanCommand(CLI::App& study) {
  auto options = std::make_shared<PlanOptions>();
  CLI::App* command = study.add_subcommand("plan", "Simulate how many participants and trials a study needs");
  command->footer(kStudyPlanExamples);
  command
      ->add_option("protocol,--protocol", options->protocol, "Protocol: a built-in name or a file [icra2021-friction]")
      ->option_text("NAME|FILE");
  command->add_option("--block", options->block, "Block of the protocol [the first]")->option_text("NAME");
  command->add_option("--weber", options->parameters.observer.weber_fraction, "Expected Weber fraction [0.29]")
      ->option_text("W");
  command
      ->add_option("--alternative", options->parameters.alternative,
                   "Alternative Weber fraction that the study should reject")
      ->option_text("W");
  command
      ->add_option("--width", options->parameters.width,
                   "Target width of the interval, as a fraction of the Weber fraction")
      ->option_text("SHARE");
  CLI::Option* participants =
      command->add_option("--participants", options->participants, "Numbers of participants [4,8,16,32]")
          ->delimiter(',')
          ->option_text("N,N,...");
  command
      ->add_flag("--find-n", options->search,
                 "Find the smallest sample that reaches --power for --alternative or --width")
      ->excludes(participants);
  command->add_option("--power", options->power, "Fraction of studies that should reach the target [0.8]")
      ->check(numberIn({0.05, 0.99}))
      ->option_text("SHARE");
  command->add_option("--repeats", options->repeats, "Numbers of trials per level [3,6,12]")
      ->delimiter(',')
      ->option_text("N,N,...");
  command->add_option("--between-sd", options->parameters.between_sd,
                      "Standard deviation of ln W between participants [0]");
  addLapseOptions(*command, options->parameters.observer.lapse);
  command
      ->add_option("--bias", options->parameters.observer.bias,
                   "Bias: the test is perceived as 1 + BIAS times its value [0]")
      ->option_text("BIAS");
  command->add_option("--studies", options->parameters.studies, "Number of simulated studies of each size [200]");
  command->add_option("--confidence", options->parameters.confidence, "Confidence level of the intervals [0.95]")
      ->check(numberIn({0.01, 0.999}));
  command->add_option("--seed", options->parameters.seed, fmt::format("{} [1]", kSeedHelp))->option_text("N");
  command->add_option("--figure", options->figure, kFigureHelp)->option_text("FILE");
  options->overwrite.addTo(*command);
  addJson(*command, options->json);
  command->callback([options] { plan(*options); });
}

}  // namespace haptolith
