#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/pluralise.h"
#include "haptolith/study/results/answers.h"
#include "haptolith/study/run/simulated_participant.h"
#include "haptolith/study/run/simulated_rig.h"
#include "haptolith/study/store/participant_flow.h"
#include "haptolith/study/store/provenance.h"

#include "commands.h"
#include "shared/common_options.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/stop_on_signal.h"
#include "study/lapse_options.h"
#include "study/teleop_work.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kStudySimulateExamples = R"(Examples:
  haptolith study new try.study --protocol icra2021-friction
  haptolith study simulate try.study --participants 8 --weber 0.29
  haptolith study figure try.study --figure try.svg
  haptolith study simulate try.study --motion stir --judge mean-force --weber 0.1
                                     judge the force of a simulated exploration
  haptolith study simulate dig.study --participants 2
                                     robot tasks with a virtual operator: some minutes)";

struct SimulateOptions {
  std::string file;
  int participants = 8;
  ObserverParameters observer;
  double between_sd = 0;
  std::uint64_t seed = 1;
  std::optional<HandMotion> motion;
};

/// Returns the motions with which a simulated hand can explore.
const std::map<std::string, HandMotion>& motionChoices() {
  static const std::map<std::string, HandMotion> kChoices{
      {"stir", HandMotion::kStir}, {"press", HandMotion::kPress}, {"scoop", HandMotion::kScoop}};
  return kChoices;
}

const std::map<std::string, JudgedBy>& judgeChoices() {
  static const std::map<std::string, JudgedBy> kChoices{
      {"mean-force", JudgedBy::kMeanForce}, {"peak-force", JudgedBy::kPeakForce}, {"work", JudgedBy::kWork}};
  return kChoices;
}

/// Returns the rig of a simulated study: its hand explores with --motion, otherwise there is no bed.
std::unique_ptr<Rig> rigFor(const SimulateOptions& options, const StudyProtocol& protocol, std::uint64_t people_before,
                            const TeleopProgress& progress) {
  std::unique_ptr<Rig> rig = std::make_unique<RigWithoutBed>();
  if (options.motion) {
    rig = std::make_unique<SimulatedRig>(protocol, ExplorationOptions{.motion = *options.motion, .seed = options.seed});
  }
  // Offsets of seeds, so that a resumed study has other soils than before.
  constexpr std::uint64_t kTrialsOfSeed = 1'000'000, kTrialsOfPerson = 1000;
  return std::make_unique<SimulatedTeleopRig>(protocol, std::move(rig),
                                              options.seed * kTrialsOfSeed + people_before * kTrialsOfPerson, progress);
}

template <class Choices, class Value>
std::string nameIn(const Choices& choices, const Value& value, std::string_view otherwise) {
  const auto found = std::ranges::find(choices, value, [](const auto& choice) { return choice.second; });
  return found == choices.end() ? std::string(otherwise) : found->first;
}

/// Returns the text for the table of sessions: the options by name, and the Weber fraction of this participant.
std::string simulationText(const SimulateOptions& options, const ObserverParameters& who) {
  Json json{{"weber", options.observer.weber_fraction},
            {"between_sd", options.between_sd},
            {"bias", who.bias},
            {"lapse", who.lapse},
            {"learning", who.learning},
            {"judge", nameIn(judgeChoices(), who.judged_by, "value")},
            {"hand", options.motion ? nameIn(motionChoices(), *options.motion, "none") : "none"},
            {"seed", options.seed},
            {"own_weber", who.weber_fraction}};
  if (who.group_factor != 1) {
    json["group_factor"] = who.group_factor;
  }
  return json.dump();
}

/// Checks that the study has no human participants, because simulated responses must not be mixed with theirs.
void requireNobody(const StudyStore& study) {
  for (const ParticipantRow& row : study.participants()) {
    if (!row.code.starts_with(kSimulatedCode)) {
      throw Failure(
          fmt::format("{} has participated in {}: simulate in another study file", row.code, study.file().string()));
    }
  }
}

void simulate(const SimulateOptions& options) {
  const StopOnSignal stop_on_signal;
  validate(options.observer);
  StudyStore study(options.file, StudyStore::Access::kRun);
  if (options.observer.group_factor != 1 && study.protocol().groups.empty()) {
    throw InvalidParameter("group_factor", options.observer.group_factor, {1, 1});
  }
  requireNobody(study);
  requireRatios(study.protocol(), options.observer.judged_by);
  StatusLine status;
  std::mt19937_64 random(options.seed);
  const std::size_t before = flowOf(study).began();  // includes removed participants, so that codes are unique
  int person = 0;
  const std::unique_ptr<Rig> rig = rigFor(options, study.protocol(), before, [&](double share) {
    status.tell([&] {
      return fmt::format("participant {} of {}, a trial with the robot: {:.0f} %", person + 1, options.participants,
                         100 * share);
    });
    return !stopAsked();
  });
  for (; person < options.participants; ++person) {
    if (stopAsked()) {
      throw Failure(fmt::format("interrupted after {} of {}", person, pluralise(options.participants, "participant")));
    }
    status.tell([&] { return fmt::format("participant {} of {}", person + 1, options.participants); });
    ObserverParameters who = options.observer;
    who.weber_fraction *= std::exp(options.between_sd * normal(random));
    SimulatedParticipant participant(who, random());
    Conductor conductor(study, *rig, {.now_s = [&participant] { return participant.now(); }});
    conductor.begin(fmt::format("{}{:03}", kSimulatedCode, before + static_cast<std::size_t>(person) + 1));
    const std::int64_t session =
        study.beginSession(study.participants().back().id, {.kind = "simulate",
                                                            .program_version = HAPTOLITH_VERSION,
                                                            .device = rig->deviceName(),
                                                            .machine = thisMachine(),
                                                            .simulation = simulationText(options, who)});
    try {
      participant.takePart(conductor);
    } catch (const Failure&) {
      if (!stopAsked()) {
        throw;
      }
      throw Failure(fmt::format("interrupted after {} of {}; the responses so far are in {}", person,
                                pluralise(options.participants, "participant"), options.file));
    }
    study.endSession(session, std::nullopt);
  }
  status.clear();
  std::size_t answers = 0, works = 0;
  for (const TrialRow& row : study.trials()) {
    answers += counts(row) ? 1 : 0;
    works +=
        row.kind == TrialKind::kMain && row.state == TrialState::kAnswered && row.answer && row.answer->teleop ? 1 : 0;
  }
  printText(fmt::format("{}: {}, {}{}\n", options.file, pluralise(study.participants().size(), "simulated participant"),
                        pluralise(answers, "counted response", "counted responses"),
                        works > 0 ? fmt::format(", {} of robot tasks", pluralise(works, "trial")) : ""));
}

}  // namespace

void addStudySimulateCommand(CLI::App& study) {
  auto options = std::make_shared<SimulateOptions>();
  CLI::App* command = study.add_subcommand("simulate", "Test a study with simulated participants");
  command->footer(kStudySimulateExamples);
  command->add_option("study", options->file, "Study file without human participants")->required()->option_text("FILE");
  command->add_option("--participants", options->participants, "Number of simulated participants [8]")
      ->check(wholeNumberIn({1, 10'000}));
  command->add_option("--weber", options->observer.weber_fraction, "Weber fraction of the participants [0.29]")
      ->option_text("W");
  command->add_option("--between-sd", options->between_sd, "Standard deviation of ln W between participants [0]")
      ->check(numberIn({0.0, 5.0}));
  command->add_option("--bias", options->observer.bias, "Bias: the test is perceived as 1 + BIAS times its value [0]")
      ->option_text("BIAS");
  addLapseOptions(*command, options->observer.lapse);
  command->add_option("--learning", options->observer.learning, "Learning: W starts 1 + LEARNING times as large [0]")
      ->option_text("LEARNING");
  command
      ->add_option("--group-factor", options->observer.group_factor,
                   "Ratio of W between a group of the protocol and the group before it [1]")
      ->option_text("F");
  CLI::Option* judge = command
                           ->add_option("--judge", options->observer.judged_by,
                                        "Quantity that is compared with Weber fraction W [the stimulus' value]")
                           ->transform(wordOf(judgeChoices()))
                           ->option_text("mean-force|peak-force|work");
  CLI::Option* motion = command->add_option("--motion", options->motion, "Motion of the exploration, with --judge")
                            ->transform(wordOf(motionChoices()))
                            ->option_text("stir|press|scoop")
                            ->needs(judge);
  judge->needs(motion);
  command->add_option("--seed", options->seed, fmt::format("{} [1]", kSeedHelp))->option_text("N");
  command->callback([options] { simulate(*options); });
}

}  // namespace haptolith
