#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/figure/figure.h"
#include "haptolith/study/study_plan.h"

#include "commands.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/overwrite.h"
#include "shared/stop_on_signal.h"
#include "study/lapse_options.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kExamples = R"(Examples:
  haptolith study plan --protocol paper-friction --weber 0.29
  haptolith study plan --protocol paper-friction --weber 0.29 --against 0.4 --participants 8,16,32 --figure power.svg)";

constexpr int kFigureWidth_px = 1100;
constexpr int kFigureHeight_px = 460;

struct Options {
  std::string protocol = "paper-friction", block, figure;
  std::vector<int> participants{4, 8, 16, 32}, repeats{3, 6, 12};
  PlanParameters parameters;
  Overwrite overwrite;
  bool json = false;
};

StudyBlock blockOf(const Options& options) {
  const ProtocolText text = findProtocol(options.protocol);
  const StudyProtocol protocol = loadProtocolText(text.text, text.name);
  const auto found = options.block.empty() ? protocol.blocks.begin()
                                           : std::ranges::find(protocol.blocks, options.block, &StudyBlock::name);
  if (found == protocol.blocks.end()) {
    throw InvalidParameter("block", options.block, fmt::format("one of {}", text.name));
  }
  return *found;
}

std::string tableText(const Options& options, const StudyBlock& block, const std::vector<PlanOutcome>& outcomes) {
  std::string table = fmt::format(
      "{}: {} simulated studies of each size, Weber fraction {:g}\n\n"
      "participants  repeats  answers   estimates: median, {:g} % range   interval, high/low   covered{}\n",
      block.name, options.parameters.studies, options.parameters.observer.weber_fraction, 95.0,
      options.parameters.against ? fmt::format("   against {:g}", *options.parameters.against) : "");
  for (const PlanOutcome& outcome : outcomes) {
    table += fmt::format("{:>12}{:>9}{:>9}   {:>10.3f}, {:.3f} to {:.3f}{:>19.2f}{:>14.0f} %{}\n",
                         outcome.size.participants, outcome.size.repeats, outcome.answers, outcome.median, outcome.low,
                         outcome.high, outcome.interval_ratio, 100 * outcome.covered,
                         outcome.power ? fmt::format("{:>11.0f} %", 100 * *outcome.power) : "");
  }
  return table;
}

Json jsonOf(const Options& options, const StudyBlock& block, const std::vector<PlanOutcome>& outcomes) {
  Json rows = Json::array();
  for (const PlanOutcome& outcome : outcomes) {
    rows.push_back({{"participants", outcome.size.participants},
                    {"repeats", outcome.size.repeats},
                    {"answers", outcome.answers},
                    {"weber_fraction", {{"median", outcome.median}, {"low", outcome.low}, {"high", outcome.high}}},
                    {"interval_ratio", outcome.interval_ratio},
                    {"covered", outcome.covered},
                    {"power", outcome.power ? Json(*outcome.power) : Json(nullptr)}});
  }
  return {{"block", block.name},
          {"studies", options.parameters.studies},
          {"weber_fraction", options.parameters.observer.weber_fraction},
          {"against", options.parameters.against ? Json(*options.parameters.against) : Json(nullptr)},
          {"sizes", std::move(rows)}};
}

/// How well a study of each size tells, over the number of participants; a curve for each number of repeats.
void draw(const Options& options, const std::vector<PlanOutcome>& outcomes) {
  Figure figure(options.overwrite(options.figure), kFigureWidth_px, kFigureHeight_px);
  const bool power = options.parameters.against.has_value();
  std::string plots, ranges;
  double shift = 1;  // bars beside each other
  for (const int repeats : options.repeats) {
    std::vector<std::vector<double>> rows;
    for (const PlanOutcome& outcome : outcomes) {
      if (outcome.size.repeats == repeats) {
        rows.push_back({static_cast<double>(outcome.size.participants), 100 * outcome.power.value_or(0), outcome.median,
                        outcome.low, outcome.high});
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
                             0.85 * std::ranges::min(options.participants),
                             1.2 * std::ranges::max(options.participants)));
  if (power) {
    figure.command(fmt::format(R"(
set key bottom right
set yrange [0:105]
set ylabel 'studies, %'
set title 'studies that tell it from {:g}'
{}, 80 with lines dt 2 lc '#666666' title '80 %')",
                               *options.parameters.against, plots));
  }
  figure.command("unset multiplot");
  figure.save();
}

void plan(const Options& options) {
  const StopOnSignal stop_on_signal;
  const StudyBlock block = blockOf(options);
  std::vector<StudySize> sizes;
  for (const int repeats : options.repeats) {
    for (const int participants : options.participants) {
      sizes.push_back({participants, repeats});
    }
  }
  StatusLine status;
  std::size_t done = 0;
  const std::size_t all = sizes.size() * static_cast<std::size_t>(options.parameters.studies);
  const std::vector<PlanOutcome> outcomes = planStudy(block, sizes, options.parameters, [&] {
    ++done;
    if (status.visible()) {
      status.update(fmt::format("study {} of {}", done, all));
    }
    return !stopAsked();
  });
  status.clear();
  if (!options.figure.empty()) {
    draw(options, outcomes);
  }
  if (options.json) {
    printJson(jsonOf(options, block, outcomes));
  } else {
    printText(tableText(options, block, outcomes));
  }
}

}  // namespace

void addStudyPlanCommand(CLI::App& study) {
  auto options = std::make_shared<Options>();
  CLI::App* command = study.add_subcommand("plan", "How many participants and trials a study needs, by simulation");
  command->footer(kExamples);
  command->add_option("--protocol", options->protocol, "A built-in protocol or a file [paper-friction]")
      ->option_text("NAME|FILE");
  command->add_option("--block", options->block, "Which block of it; default: the first")->option_text("NAME");
  command->add_option("--weber", options->parameters.observer.weber_fraction, "Weber fraction that is expected [0.29]")
      ->option_text("W");
  command->add_option("--against", options->parameters.against, "Another value that it is to be distinguished from")
      ->option_text("W");
  command->add_option("--participants", options->participants, "Numbers of participants [4,8,16,32]")
      ->delimiter(',')
      ->option_text("N,N,...");
  command->add_option("--repeats", options->repeats, "Numbers of trials with each level [3,6,12]")
      ->delimiter(',')
      ->option_text("N,N,...");
  command->add_option("--spread", options->parameters.spread, "Standard deviation of ln W between people [0]");
  addLapseOptions(*command, options->parameters.observer.lapse);
  command->add_option("--studies", options->parameters.studies, "Simulated studies of each size [200]");
  command->add_option("--confidence", options->parameters.confidence, "Of the intervals [0.95]")
      ->check(numberIn({0.01, 0.999}));
  command->add_option("--seed", options->parameters.seed, "Of the answers [1]")->option_text("N");
  command->add_option("--figure", options->figure, "Draw it (.svg or .png)")->option_text("FILE");
  options->overwrite.addTo(*command);
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { plan(*options); });
}

}  // namespace haptolith
