#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/pluralise.h"
#include "haptolith/study/protocol/groups.h"
#include "haptolith/study/results/adaptive_results.h"
#include "haptolith/study/results/answers.h"
#include "haptolith/study/run/criteria.h"
#include "haptolith/study/store/participant_flow.h"
#include "haptolith/study/store/store.h"

#include "commands.h"
#include "shared/common_options.h"
#include "shared/output.h"
#include "study/session_report.h"
#include "study/teleop_report.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kStudyStatusExamples = R"(Examples:
  haptolith study status friction.study          also while the study runs
  haptolith study status friction.study --json)";

constexpr double kConfidence = 0.95;

struct StatusOptions {
  std::string file;
  bool json = false;
};

/// Returns the number of main trials of a block; empty if it depends on the responses.
std::optional<std::size_t> mainTrials(const StudyBlock& block) {
  return block.procedure == ProcedureKind::kConstant
             ? std::optional(block.levels.size() * static_cast<std::size_t>(block.repeats))
             : std::nullopt;
}

/// Returns the state of a participant; "stopped" if the last session ended before they finished.
std::string standing(const StudyStore& study, const ParticipantRow& participant, std::string_view state) {
  const std::vector<SessionRow> sessions = study.sessions();
  const auto last = std::find_if(sessions.rbegin(), sessions.rend(),
                                 [&](const SessionRow& row) { return row.participant == participant.id; });
  const bool ended = last != sessions.rend() && !last->ended_at.empty();
  return state == "running" && ended ? "stopped" : std::string(state);
}

std::size_t answered(const std::vector<TrialRow>& trials, std::int64_t participant, std::size_t block) {
  return static_cast<std::size_t>(std::ranges::count_if(trials, [&](const TrialRow& trial) {
    return trial.participant == participant && trial.block == block && trial.kind == TrialKind::kMain &&
           trial.state == TrialState::kAnswered;
  }));
}

/// Returns the trials of the participants that are included in the analysis.
std::vector<TrialRow> analysedOf(const StudyStore& study, std::vector<TrialRow> trials) {
  for (const ParticipantRow& participant : study.participants()) {
    if (isLeftOut(participant)) {
      std::erase_if(trials, [&](const TrialRow& trial) { return trial.participant == participant.id; });
    }
  }
  return trials;
}

std::string levelName(const StudyBlock& block, double value) {
  const auto level = std::ranges::find(block.levels, value, &Stimulus::value);
  return level == block.levels.end() ? "" : level->name;
}

Json estimateJson(const std::optional<Estimate>& estimate) {
  return estimate ? Json{{"value", estimate->value}, {"low", estimate->interval.low}, {"high", estimate->interval.high}}
                  : Json(nullptr);
}

Json resultJson(const AdaptiveResult& result) {
  Json json{{"trials", result.trials},
            {"finished", result.finished},
            {"threshold", estimateJson(result.threshold)},
            {"width", estimateJson(result.width)},
            {"jnd", estimateJson(result.jnd)},
            {"weber_fraction", estimateJson(result.weber_fraction)},
            {"reversals", nullptr},
            {"remark", result.remark}};
  if (result.reversals) {
    json["reversals"] = {{"threshold", result.reversals->threshold}, {"jnd", result.reversals->jnd}};
  }
  return json;
}

/// Returns the results of one participant in one block; null without any.
const AdaptiveResult* resultIn(const std::vector<AdaptiveResultOf>& results, std::int64_t participant,
                               std::size_t block) {
  const auto found = std::ranges::find_if(
      results, [&](const AdaptiveResultOf& of) { return of.participant == participant && of.block == block; });
  return found == results.end() ? nullptr : &found->result;
}

Json groupsJson(const StudyStore& study) {
  Json groups = Json::array();
  for (const GroupFlow& flow : groupFlowsOf(study)) {
    Json strata = Json::array();
    for (std::size_t stratum = 0; stratum < flow.strata.size() && strataOf(study.protocol()) > 1; ++stratum) {
      strata.push_back({{"stratum", stratumText(study.protocol(), stratum)}, {"assigned", flow.strata[stratum]}});
    }
    groups.push_back({{"group", flow.group},
                      {"assigned", flow.people.began()},
                      {"removed", flow.people.removed},
                      {"withdrew", flow.people.withdrew},
                      {"excluded", flow.people.excluded},
                      {"finished", flow.people.finished},
                      {"analysed", flow.people.analysed()},
                      {"strata", std::move(strata)}});
  }
  return groups;
}

/// Whether a participant's group includes a block.
bool goesThrough(const StudyProtocol& protocol, const ParticipantRow& participant, std::size_t block) {
  if (!participant.assignment) {
    return protocol.groups.empty();
  }
  const std::vector<std::size_t>& own = groupNamed(protocol, participant.assignment->group).blocks;
  return std::ranges::find(own, block) != own.end();
}

Json statusJson(const StudyStore& study, const std::vector<TrialRow>& trials) {
  const std::vector<AdaptiveResultOf> results = adaptiveResults(study, trials);
  const std::vector<StudyBlock>& blocks = study.protocol().blocks;
  Json json{{"file", study.file().string()},   {"title", study.title()},        {"seed", study.seed()},
            {"created_at", study.createdAt()}, {"participants", Json::array()}, {"blocks", Json::array()}};
  json["planned_participants"] =
      study.protocol().planned_participants > 0 ? Json(study.protocol().planned_participants) : Json(nullptr);
  json["finished"] = finishedParticipants(study.participants());
  if (!study.protocol().groups.empty()) {
    json["groups"] = groupsJson(study);
  }
  for (const ParticipantRow& participant : study.participants()) {
    Json row{{"participant", participant.code},
             {"number", participant.number},
             {"state", standing(study, participant, participant.state)},
             {"begun_at", participant.begun_at},
             {"ended_at", participant.ended_at},
             {"blocks", Json::array()}};
    row["excluded_for"] = participant.excluded_for.empty() ? Json(nullptr) : Json(participant.excluded_for);
    if (!study.protocol().groups.empty()) {
      row["group"] = participant.assignment ? Json(participant.assignment->group) : Json(nullptr);
      row["stratum"] =
          participant.assignment ? Json(stratumText(study.protocol(), participant.assignment->stratum)) : Json(nullptr);
    }
    row["consent"] = consentJson(study, participant);
    row["sessions"] = sessionsJson(study, participant);
    for (std::size_t block = 0; block < blocks.size(); ++block) {
      if (!goesThrough(study.protocol(), participant, block)) {
        continue;
      }
      const std::optional<std::size_t> of = mainTrials(blocks[block]);
      const AdaptiveResult* result = resultIn(results, participant.id, block);
      row["blocks"].push_back(
          {{"block", blocks[block].name},
           {"answered", answered(trials, participant.id, block)},
           {"trials", of ? Json(*of) : Json(nullptr)},
           {"not_met", criteriaNotMet(blocks[block], scoresOf(study.protocol(), trials, block, participant.id))},
           {"estimate", result != nullptr ? resultJson(*result) : Json(nullptr)}});
    }
    json["participants"].push_back(std::move(row));
  }
  const std::vector<TrialRow> analysed = analysedOf(study, trials);
  for (std::size_t block = 0; block < blocks.size(); ++block) {
    Json row{{"block", blocks[block].name},
             {"axis_label", blocks[block].axis_label},
             {"reference", blocks[block].reference.value},
             {"levels", Json::array()}};
    for (const Level& level : levelsOf(analysed, block)) {
      row["levels"].push_back(
          {{"level", levelName(blocks[block], level.x)}, {"x", level.x}, {"k", level.k}, {"n", level.n}});
    }
    json["blocks"].push_back(std::move(row));
  }
  json["teleop"] = teleopJson(study.protocol(), teleopResults(study, false), kConfidence);
  return json;
}

/// Returns the numbers of participants per stratum and group, for strata with participants.
std::string strataText(const StudyStore& study) {
  const std::vector<GroupFlow> flows = groupFlowsOf(study);
  if (flows.empty() || study.protocol().assignment.strata.empty()) {
    return "";
  }
  std::string text = fmt::format("\n{:<40}", "Assigned from each stratum");
  for (const GroupFlow& flow : flows) {
    text += fmt::format("{:>16}", flow.group);
  }
  text += '\n';
  for (std::size_t stratum = 0; stratum < flows.front().strata.size(); ++stratum) {
    if (std::ranges::any_of(flows, [stratum](const GroupFlow& flow) { return flow.strata[stratum] > 0; })) {
      text += fmt::format("  {:<38}", stratumText(study.protocol(), stratum));
      for (const GroupFlow& flow : flows) {
        text += fmt::format("{:>16}", flow.strata[stratum]);
      }
      text += '\n';
    }
  }
  return text;
}

std::string participantsText(const StudyStore& study, const std::vector<TrialRow>& trials) {
  const std::vector<ParticipantRow> participants = study.participants();
  if (participants.empty()) {
    return "There are no participants yet.\n";
  }
  const std::vector<StudyBlock>& blocks = study.protocol().blocks;
  std::string text = fmt::format("{:<18}{:<11}", "Participant", "");
  for (const StudyBlock& block : blocks) {
    text += fmt::format("{:>16}", block.name);
  }
  text += '\n';
  for (const ParticipantRow& participant : participants) {
    text += fmt::format("{:<18}{:<11}", participant.code, standing(study, participant, standingOf(participant)));
    for (std::size_t block = 0; block < blocks.size(); ++block) {
      const std::optional<std::size_t> of = mainTrials(blocks[block]);
      const std::size_t done = answered(trials, participant.id, block);
      const bool does = goesThrough(study.protocol(), participant, block);
      text += fmt::format("{:>16}", !does ? "-" : of ? fmt::format("{} of {}", done, *of) : fmt::format("{}", done));
    }
    text += participant.assignment ? "  " + participant.assignment->group : "";
    text += '\n';
  }
  text += "\n" + flowsText(study);
  return text + strataText(study);
}

std::string stoppingText(const StudyStore& study) {
  const int planned_participants = study.protocol().planned_participants;
  return planned_participants > 0
             ? fmt::format("\nThe study ends after {}; finished so far: {}.\n",
                           pluralise(planned_participants, "participant"), finishedParticipants(study.participants()))
             : "";
}

/// Returns the participants that do not meet the criteria, which matters for the use of their responses.
std::string notMetText(const StudyStore& study, const std::vector<TrialRow>& trials) {
  std::string text;
  for (const ParticipantRow& participant : study.participants()) {
    for (std::size_t block = 0; block < study.protocol().blocks.size(); ++block) {
      const StudyBlock& design = study.protocol().blocks[block];
      const std::string not_met = criteriaNotMet(design, scoresOf(study.protocol(), trials, block, participant.id));
      text += not_met.empty() ? "" : fmt::format("{} in {}: {}\n", participant.code, design.name, not_met);
    }
  }
  return text.empty() ? "" : "\n" + text;
}

std::string estimateText(const char* name, const std::optional<Estimate>& estimate) {
  return estimate ? fmt::format("  {} {:.3g} [{:.3g}, {:.3g}]", name, estimate->value, estimate->interval.low,
                                estimate->interval.high)
                  : "";
}

std::string resultsText(const StudyStore& study, const std::vector<TrialRow>& trials) {
  const std::vector<AdaptiveResultOf> results = adaptiveResults(study, trials);
  if (results.empty()) {
    return "";
  }
  std::string text = "\nResults of the procedures: medians and 95 % intervals\n";
  for (const ParticipantRow& participant : study.participants()) {
    for (std::size_t block = 0; block < study.protocol().blocks.size(); ++block) {
      if (const AdaptiveResult* result = resultIn(results, participant.id, block)) {
        text += fmt::format("  {:<8}{:<12}{}{}{}{}{}\n", participant.code, study.protocol().blocks[block].name,
                            pluralise(result->trials, "trial"), result->finished ? "" : " so far",
                            estimateText("threshold", result->threshold),
                            result->weber_fraction ? estimateText("Weber fraction", result->weber_fraction)
                                                   : estimateText("JND", result->jnd),
                            result->remark.empty() ? "" : "  (" + result->remark + ")");
      }
    }
  }
  return text;
}

std::string levelsText(const StudyBlock& block, const std::vector<Level>& levels) {
  std::string text = fmt::format("\n{}: {}, against {} ({})\n  level                  x    \"{}\"\n", block.name,
                                 block.axis_label, block.reference.name, block.reference.value, block.answers[1]);
  for (const Level& level : levels) {
    text += fmt::format("  {:<12}{:>12.4g}    {} of {}\n", levelName(block, level.x), level.x, level.k, level.n);
  }
  return levels.empty() ? "" : text;
}

void showStatus(const StatusOptions& options) {
  const StudyStore study(options.file, StudyStore::Access::kRead);
  const std::vector<TrialRow> trials = study.trials();
  if (options.json) {
    printJson(statusJson(study, trials));
    return;
  }
  std::string text =
      fmt::format("{}: {}\nseed {}, made {}\n\n", options.file, study.title(), study.seed(), study.createdAt());
  text += participantsText(study, trials) + stoppingText(study) + notMetText(study, trials);
  const std::vector<TrialRow> analysed = analysedOf(study, trials);
  for (std::size_t block = 0; block < study.protocol().blocks.size(); ++block) {
    text += levelsText(study.protocol().blocks[block], levelsOf(analysed, block));
  }
  text += teleopTable(study.protocol(), teleopResults(study, false), kConfidence);
  printText(text + resultsText(study, trials) + sessionsText(study) + pendingText(study));
}

}  // namespace

void addStudyStatusCommand(CLI::App& study) {
  auto options = std::make_shared<StatusOptions>();
  CLI::App* command = study.add_subcommand("status", "Show participants, progress and responses of a study");
  command->footer(kStudyStatusExamples);
  command->add_option("file", options->file, kStudyFileHelp)->required()->option_text("FILE");
  addJson(*command, options->json);
  command->callback([options] { showStatus(*options); });
}

}  // namespace haptolith
