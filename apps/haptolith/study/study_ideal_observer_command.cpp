#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/former_names.h"
#include "haptolith/scene_file/scene_words.h"
#include "haptolith/scene_file/toml/file_keys.h"
#include "haptolith/study/perception/perception.h"
#include "haptolith/study/perception/perception_figure.h"
#include "haptolith/study/perception/task_perception.h"

#include "commands.h"
#include "lab/lab_options.h"
#include "shared/common_options.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/overwrite.h"
#include "shared/progress.h"
#include "shared/stop_on_signal.h"
#include "study/task_report.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kIdealObserverExamples = R"(Examples:
  haptolith study ideal-observer                             all stimuli: some minutes
  haptolith study ideal-observer --block gravity --friction-model icra2021 --motion stir
  haptolith study ideal-observer --csv explorations.csv --figure forces.png --weber-figure weber.png
  haptolith study ideal-observer --protocol buried-stone     information in force and in view

Results and definitions: docs/reports/perception.md)";

struct IdealObserverOptions {
  PerceptionOptions perception;
  PerceiveOptions perceive;
  std::string block = "both", friction = "both", motion = "all";
  std::string csv_file, figure_file, weber_figure_file;
  std::vector<std::string> protocols;  ///< empty: the stimuli of icra2021
  Overwrite overwrite;
  bool json = false;
};

PerceptionOptions perceptionOf(const IdealObserverOptions& options) {
  PerceptionOptions wanted = options.perception;
  if (options.block != "both") {
    wanted.blocks = {options.block};
  }
  if (options.friction != "both") {
    wanted.frictions = {options.friction == "icra2021" ? FrictionModel::kIcra2021 : FrictionModel::kContact};
  }
  if (options.motion != "all") {
    std::erase_if(wanted.hands, [&](HandMotion motion) {
      return wordFor(kHandMotionWords, motion) != std::string_view(options.motion);
    });
  }
  wanted.threads =
      wanted.threads > 0 ? wanted.threads : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  return wanted;
}

std::string weberText(double fraction, double most) {
  return std::isinf(fraction) ? fmt::format("> {:.2g}", most) : fmt::format("{:.2f}", fraction);
}

std::string tableOf(const PerceptionBlock& block, const std::vector<PerceivedCue>& perceived) {
  const std::string& reference = block.stimuli[block.reference].name;
  std::string text = fmt::format(
      "{}, {} friction: JNDs from {} (> 0: \"more\"), and the Weber fraction of an observer who has this to judge by,\n"
      "with the 95 % interval of {} explorations\n  {:22} {:>9}       SD",
      block.name, wordFor(kFrictionWords, block.friction), reference, block.explorations.front().front().size(),
      "hand, cue", reference);
  for (std::size_t i = 0; i < block.stimuli.size(); ++i) {
    text += i == block.reference ? "" : fmt::format(" {:>7}", block.stimuli[i].name);
  }
  text += "       w    interval\n";
  for (const PerceivedCue& one : perceived) {
    text += fmt::format("  {:22}", nameOf(one));
    text += one.cue != nullptr ? fmt::format(" {:>7.3f} {} ±{:>7.3f}", one.means[block.reference], one.cue->unit,
                                             one.deviations[block.reference])
                               : fmt::format(" {:18}", "");
    for (std::size_t i = 0; i < block.stimuli.size(); ++i) {
      text += i == block.reference ? "" : fmt::format(" {:>7.1f}", one.discrimination.jnds[i]);
    }
    const Discrimination& of = one.discrimination;
    text += fmt::format(" {:>7}    {} to {}{}\n", weberText(of.weber_fraction, of.most),
                        weberText(of.interval.low, of.most), weberText(of.interval.high, of.most),
                        one.cue != nullptr && of.weights.front() < 0 ? "  (falls)" : "");
  }
  const ParticipantsWeberFraction people = participantsWeberFraction(block.name);
  return text + fmt::format(
                    "  the paper's participants, if (22) was fitted as meant: w = {:.2f}; as printed: {:.2f}, with the "
                    "decimal logarithm {:.2f}\n\n",
                    people.as_meant, people.as_printed, people.as_printed_log10);
}

Json numberOrNull(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json jsonOf(const PerceptionBlock& block, const std::vector<PerceivedCue>& perceived) {
  Json stimuli = Json::array();
  for (const PerceptionStimulus& stimulus : block.stimuli) {
    stimuli.push_back({{"name", stimulus.name}, {"x", stimulus.x}});
  }
  Json all = Json::array();
  for (const PerceivedCue& one : perceived) {
    const Discrimination& of = one.discrimination;
    Json row = {{"hand", one.hand ? wordFor(kHandMotionWords, *one.hand) : "all"},
                {"cue", one.cue != nullptr ? one.cue->name : "all"}};
    if (one.cue != nullptr) {
      row.update(
          {{"unit", one.cue->unit}, {"mean", one.means}, {"sd", one.deviations}, {"rises", of.weights.front() >= 0}});
    }
    row.update({{"weights", of.weights},
                {"jnds_from_reference", of.jnds},
                {"jnds_between_neighbours", of.steps},
                {"weber_fraction", numberOrNull(of.weber_fraction)},
                {"weber_fraction_low", numberOrNull(of.interval.low)},
                {"weber_fraction_high", numberOrNull(of.interval.high)},
                {"greatest_weber_fraction", of.most}});
    all.push_back(std::move(row));
  }
  const ParticipantsWeberFraction people = participantsWeberFraction(block.name);
  return {{"block", block.name},
          {"friction", wordFor(kFrictionWords, block.friction)},
          {"reference", block.stimuli[block.reference].name},
          {"participants_weber_fraction",
           {{"as_meant", people.as_meant},
            {"as_printed", people.as_printed},
            {"as_printed_log10", people.as_printed_log10}}},
          {"stimuli", stimuli},
          {"cues", all}};
}

void saveCsv(const IdealObserverOptions& options, const PerceptionOptions& wanted,
             const std::vector<PerceptionBlock>& blocks) {
  AtomicFile file(options.overwrite(options.csv_file));
  file.write("block,friction,stimulus,x,hand,repeat,duration_s,path_m,work_j");
  for (const Cue& cue : cues()) {
    std::string name(cue.name);
    std::ranges::replace(name, ' ', '_');
    file.write(fmt::format(",{}_n", name));
  }
  file.write(",carried_kg\n");
  for (const PerceptionBlock& block : blocks) {
    for (std::size_t i = 0; i < block.stimuli.size(); ++i) {
      for (std::size_t hand = 0; hand < wanted.hands.size(); ++hand) {
        for (std::size_t repeat = 0; repeat < block.explorations[i][hand].size(); ++repeat) {
          const Exploration& one = block.explorations[i][hand][repeat];
          file.write(fmt::format("{},{},{},{},{},{},{:.7g},{:.7g},{:.7g}", block.name,
                                 wordFor(kFrictionWords, block.friction), block.stimuli[i].name, block.stimuli[i].x,
                                 wordFor(kHandMotionWords, wanted.hands[hand]), repeat + 1, one.summary.duration_s,
                                 one.summary.path_m, one.summary.work_j));
          for (const Cue& cue : cues()) {
            file.write(fmt::format(",{:.7g}", cue.value(one)));
          }
          file.write(fmt::format(",{:.7g}\n", one.carried_kg));
        }
      }
    }
  }
  file.commit();
}

/// Runs the first block of each protocol: blocks of one task differ in the visual cues, not in the soils.
void runTasks(const IdealObserverOptions& options) {
  const StopOnSignal stop_on_signal;
  const PerceptionOptions wanted = perceptionOf(options);
  const TaskOptions task_options{.repeats = wanted.repeats,
                                 .rounds = wanted.rounds,
                                 .seed = wanted.seed,
                                 .threads = wanted.threads,
                                 .perceive = options.perceive};
  std::vector<std::pair<std::string, StudyProtocol>> protocols;  // all are loaded before the first one takes minutes
  for (const std::string& name : options.protocols) {
    const ProtocolText source = findProtocol(name);
    protocols.emplace_back(source.name, loadProtocolText(source.text, source.name));
    if (protocols.back().second.blocks.front().teleop) {
      throw InvalidParameter("protocol", name, "one whose first block compares");
    }
  }
  Json json = {{"tasks", Json::array()}};
  for (const auto& known : protocols) {
    const std::string& name = known.first;
    const StudyProtocol& protocol = known.second;
    StatusLine status;
    Progress progress(status);
    const TaskPerception task = perceiveTask(protocol, protocol.blocks.front(), task_options, [&](double share) {
      return progress.tell(fmt::format("exploring {}", name), share);
    });
    status.clear();
    if (options.json) {
      json["tasks"].push_back(taskJson(name, task, task_options));
    } else {
      printText(taskTable(name, task, task_options));
    }
  }
  if (options.json) {
    printJson(json);
  }
}

void runIdealObserver(const IdealObserverOptions& options) {
  if (!options.protocols.empty()) {
    return runTasks(options);
  }
  const StopOnSignal stop_on_signal;
  requireWritable({options.overwrite(options.csv_file), options.overwrite(options.figure_file),
                   options.overwrite(options.weber_figure_file)});
  const PerceptionOptions wanted = perceptionOf(options);
  StatusLine status;
  Progress progress(status);
  const std::vector<PerceptionBlock> blocks =
      explorePaperStimuli(wanted, [&](double share) { return progress.tell("exploring", share); });
  status.clear();
  std::vector<std::vector<PerceivedCue>> perceived;
  Json json = {{"repeats", wanted.repeats},
               {"rounds", wanted.rounds},
               {"seed", wanted.seed},
               {"sense_scale", options.perceive.sense_scale},
               {"resamplings", options.perceive.observer.resamplings},
               {"contact_cohesion_n", wanted.contact_cohesion_n},
               {"blocks", Json::array()}};
  std::string text;
  for (const PerceptionBlock& block : blocks) {
    perceived.push_back(perceive(block, wanted.hands, options.perceive));
    text += tableOf(block, perceived.back());
    json["blocks"].push_back(jsonOf(block, perceived.back()));
  }
  if (!options.csv_file.empty()) {
    saveCsv(options, wanted, blocks);
  }
  if (!options.figure_file.empty()) {
    drawForces(options.overwrite(options.figure_file), blocks, perceived);
  }
  if (!options.weber_figure_file.empty()) {
    drawWeberFractions(options.overwrite(options.weber_figure_file), blocks, perceived);
  }
  options.json ? printJson(json) : printText(text);
}

}  // namespace

void addStudyIdealObserverCommand(CLI::App& study) {
  auto options = std::make_shared<IdealObserverOptions>();
  options->perception.threads = 0;
  PerceptionOptions& perception = options->perception;
  CLI::App* command =
      study.add_subcommand("ideal-observer", "Estimate how well an ideal observer discriminates the stimuli");
  CLI::Option* protocols =
      command
          ->add_option("--protocol", options->protocols,
                       "Protocols whose first block is explored by the [hand] of its scene, instead of the stimuli of "
                       "the ICRA 2021 paper; reports force and view separately")
          ->option_text("NAME|FILE ...");
  command->add_option("--block", options->block, "Stimuli")
      ->check(oneOf({"friction", "gravity", "both"}))
      ->excludes(protocols)
      ->capture_default_str();
  command->add_option("--friction-model", options->friction, "Friction model")
      ->transform([](const std::string& word) { return std::string(currentNameReported(NameKind::kWord, word)); }, "")
      ->check(oneOf({"icra2021", "contact", "both"}))
      ->excludes(protocols)
      ->capture_default_str();
  command->add_option("--motion", options->motion, "Motion of the hand")
      ->check(oneOf({"stir", "press", "scoop", "all"}))
      ->excludes(protocols)
      ->capture_default_str();
  command
      ->add_option("--contact-cohesion-n", perception.contact_cohesion_n,
                   "Contact cohesion of soil with contact friction in N")
      ->check(numberIn({0.0, 1.0}))
      ->excludes(protocols)
      ->capture_default_str();
  command->add_option("--repeats", perception.repeats, "Number of explorations of each stimulus and motion")
      ->check(wholeNumberIn({2, 1000}))
      ->capture_default_str();
  command->add_option("--rounds", perception.rounds, "Rounds of the motion in each exploration, 4 s each")
      ->check(wholeNumberIn({1, 1000}))
      ->capture_default_str();
  command->add_option("--seed", perception.seed, kSeedHelp)
      ->check(wholeNumberIn(BedRanges::seed))
      ->capture_default_str();
  command
      ->add_option("--sense-scale", options->perceive.sense_scale,
                   "Factor on sensory thresholds: 0.6 for the finest measured, 1.8 for the coarsest")
      ->check(numberIn({0.1, 10.0}))
      ->capture_default_str();
  command
      ->add_option("--resamplings", options->perceive.observer.resamplings, "Number of resamplings for the intervals")
      ->check(wholeNumberIn({20, 100'000}))
      ->capture_default_str();
  command->add_option("--threads", perception.threads, "Number of explorations at the same time [all cores]")
      ->check(wholeNumberIn({1, 256}));
  command->add_option("--csv", options->csv_file, "Write every exploration (.csv)")->excludes(protocols);
  command->add_option("--figure", options->figure_file, "Draw the forces to this file (.svg or .png)")
      ->excludes(protocols);
  command
      ->add_option("--weber-figure", options->weber_figure_file, "Draw the Weber fractions to this file (.svg or .png)")
      ->excludes(protocols);
  options->overwrite.addTo(*command);
  addJson(*command, options->json);
  command->footer(kIdealObserverExamples);
  command->callback([options] { runIdealObserver(*options); });
}

}  // namespace haptolith
