#include "haptolith/study/export/export_tables.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>

#include "haptolith/core/error.h"
#include "haptolith/recording/recording_reader.h"
#include "haptolith/study/protocol/form.h"
#include "haptolith/study/protocol/groups.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

/// Returns the shortest text that reads back as exactly this number.
std::string textOf(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "";
}

std::string textOf(bool value) {
  return value ? "1" : "0";
}

template <class Text>
std::function<std::string(const TrialOf&)> ofAnswer(Text text) {
  return [text](const TrialOf& of) { return of.trial.answer ? text(*of.trial.answer) : std::string(); };
}

std::vector<FilledColumn<TrialOf>> designColumns() {
  return {
      {{"participant", "", "Pseudonym of the participant.", ""}, [](const TrialOf& of) { return of.participant.code; }},
      {{"participant_number", "", "Sequence number of the participant, from 1.", ""},
       [](const TrialOf& of) { return fmt::format("{}", of.participant.number); }},
      {{"participant_state",
        "",
        "State of the participant.",
        "",
        {{"running", "not finished"},
         {"finished", "finished"},
         {"withdrawn", "withdrew; left out of figures"},
         {"excluded", "excluded by the experimenter"}}},
       [](const TrialOf& of) { return std::string(standingOf(of.participant)); }},
      {{"excluded_for", "", "Reason of the exclusion.", ""},
       [](const TrialOf& of) { return of.participant.excluded_for; }},
      {{"block", "", "Name of the block.", ""}, [](const TrialOf& of) { return of.trial.block_name; }},
      {{"block_position", "block_position", "Position of the block in the participant's order, from 1.", ""},
       [](const TrialOf& of) { return fmt::format("{}", of.trial.position + 1); }},
      {{"trial", "trial", "Position of the trial in its block, from 1.", ""},
       [](const TrialOf& of) { return fmt::format("{}", of.trial.index + 1); }},
      {{"attempt", "attempt", "Attempt at the trial, from 1; higher after a lost or repeated trial.", ""},
       [](const TrialOf& of) { return fmt::format("{}", of.trial.attempt + 1); }},
      {{"kind",
        "trial_type",
        "Purpose of the trial.",
        "",
        {{"practice", "practice; not analysed"}, {"main", "analysed"}, {"catch", "easy trial that checks attention"}}},
       [](const TrialOf& of) { return std::string(wordOf(of.trial.kind)); }},
      {{"state",
        "state",
        "State of the attempt; only answered attempts are analysed.",
        "",
        {{"begun", "in progress, or interrupted by a crash"},
         {"answered", "answered"},
         {"repeated", "repeated by the experimenter; a response is not analysed"},
         {"lost", "ended without a response, then repeated"}}},
       [](const TrialOf& of) { return std::string(wordOf(of.trial.state)); }},
      {{"level", "level", "Name of the test stimulus.", ""}, [](const TrialOf& of) { return of.trial.level; }},
      {{"x", "x", "Value of the test stimulus on the block's axis.", ""},
       [](const TrialOf& of) { return textOf(of.trial.value); }},
      {{"reference", "reference", "Name of the reference.", ""}, [](const TrialOf& of) { return of.trial.reference; }},
      {{"x_reference", "x_reference", "Value of the reference on the block's axis.", ""},
       [](const TrialOf& of) { return textOf(of.trial.reference_value); }},
      {{"test_first",
        "test_first",
        "Order of the two stimuli.",
        "",
        {{"0", "reference, then test"}, {"1", "test, then reference"}}},
       [](const TrialOf& of) { return textOf(of.trial.test_first); }},
  };
}

std::vector<FilledColumn<TrialOf>> answerColumns() {
  return {
      {{"response",
        "response",
        "Response, independent of the order of the stimuli.",
        "",
        {{"0", "the test was judged to have less than the reference"}, {"1", "the test was judged to have more"}}},
       ofAnswer([](const TrialAnswer& a) { return a.timed_out || a.teleop ? "" : textOf(a.positive); })},
      {{"correct", "correct", "Whether the response is correct.", "", {{"0", "no"}, {"1", "yes"}}},
       ofAnswer([](const TrialAnswer& a) { return a.correct ? textOf(*a.correct) : ""; })},
      {{"response_time_s", "response_time", "Time from the question to the response.", "s"},
       ofAnswer([](const TrialAnswer& a) { return textOf(a.reaction_s); })},
      {{"timed_out",
        "timed_out",
        "Whether the time limit for a response was exceeded; such an attempt is lost and repeated, so always 0.",
        "",
        {{"0", "no"}, {"1", "yes"}}},
       ofAnswer([](const TrialAnswer& a) { return textOf(a.timed_out); })},
  };
}

/// Returns the columns of trials in which a robot performs a task.
std::vector<FilledColumn<TrialOf>> workColumns() {
  std::vector<FilledColumn<TrialOf>> columns;
  for (const TeleopColumn& number : teleopColumns()) {
    const std::string full = fmt::format("teleop_{}", number.name);
    columns.push_back(
        {{full, full, fmt::format("Robot task: {}", number.meaning), std::string(number.unit)},
         ofAnswer([=](const TrialAnswer& a) { return a.teleop ? textOf((*a.teleop).*number.value) : ""; })});
  }
  return columns;
}

std::vector<FilledColumn<TrialOf>> intervalColumns() {
  std::vector<FilledColumn<TrialOf>> columns;
  for (const std::size_t interval : {0, 1}) {
    const std::string name = interval == 0 ? "first" : "second";
    for (const SummaryColumn& number : summaryColumns()) {
      const std::string full = fmt::format("{}_{}", name, number.name);
      columns.push_back(
          {{full, full, fmt::format("The {} stimulus: {}", name, number.meaning), std::string(number.unit)},
           ofAnswer([=](const TrialAnswer& a) { return textOf(a.summaries[interval].*number.value); })});
    }
    const std::string full = name + "_deadline_misses";
    columns.push_back(
        {{full, full, fmt::format("The {} stimulus: late ticks of the loop.", name), ""},
         ofAnswer([=](const TrialAnswer& a) { return fmt::format("{}", a.summaries[interval].deadline_misses); })});
  }
  return columns;
}

/// An interval that never began has no recording; a trial without an answer can lack the second interval.
std::string recordingState(const TrialOf& of) {
  if (of.trial.recording.empty()) {
    return "";
  }
  int there = 0;
  for (const char* interval : {"first", "second"}) {
    const std::filesystem::path file = of.recordings / fmt::format("{}-{}.h5", of.trial.recording, interval);
    if (!std::filesystem::exists(file)) {
      continue;
    }
    ++there;
    try {
      if (!RecordingReader(file).finished()) {
        return "unfinished";
      }
    } catch (const Failure&) {  // even its beginning is incomplete
      return "unfinished";
    }
  }
  const bool both = of.trial.answer && !of.trial.answer->teleop;  // whether both recordings are expected
  return there == 2 || (there == 1 && !both) ? "whole" : "missing";
}

std::vector<FilledColumn<TrialOf>> recordColumns() {
  return {
      {{"seed", "seed", "Seed of the trial, for scenes with random parts; all beds of a stimulus are identical.", ""},
       [](const TrialOf& of) { return fmt::format("{}", of.trial.seed); }},
      {{"recording", "recording",
        "Name of the trial's recordings without -first.h5 and -second.h5, in the study's recordings folder.", ""},
       [](const TrialOf& of) { return of.trial.recording; }},
      {{"recording_state",
        "recording_state",
        "State of the recordings.",
        "",
        {{"whole", "complete"},
         {"unfinished", "one was interrupted when the program was killed; haptolith reads it, other programs may not"},
         {"missing", "one is not in the folder"}}},
       recordingState},
      {{"begun_at", "begun_at", "Start, UTC.", ""}, [](const TrialOf& of) { return of.trial.begun_at; }},
      {{"answered_at", "answered_at", "Time of the response, UTC.", ""},
       [](const TrialOf& of) { return of.trial.answered_at; }},
      {{"reason", "reason", "Reason of the repetition or loss.", ""},
       [](const TrialOf& of) { return of.trial.reason; }},
  };
}

std::string textOf(const std::optional<SessionCounts>& counts, std::uint64_t SessionCounts::*count) {
  return counts ? fmt::format("{}", (*counts).*count) : "";
}

std::vector<FilledColumn<SessionOf>> sessionColumnsMade() {
  return {
      {{"participant", "", "Pseudonym of the participant.", ""}, [](const SessionOf& of) { return of.code; }},
      {{"kind",
        "Kind",
        "Kind of session.",
        "",
        {{"run", "first session of the participant"},
         {"resume", "later session"},
         {"simulate", "simulated participant"}}},
       [](const SessionOf& of) { return of.session.kind; }},
      {{"begun_at", "BegunAt", "Start, UTC.", ""}, [](const SessionOf& of) { return of.session.begun_at; }},
      {{"ended_at", "EndedAt", "End, UTC; missing: in progress, or interrupted by a crash.", ""},
       [](const SessionOf& of) { return of.session.ended_at; }},
      {{"program_version", "SoftwareVersion", "Version of haptolith.", ""},
       [](const SessionOf& of) { return of.session.program_version; }},
      {{"device", "Device", "Driver and model of the haptic device.", ""},
       [](const SessionOf& of) { return of.session.device; }},
      {{"os", "OperatingSystem", "Operating system.", ""}, [](const SessionOf& of) { return of.session.machine.os; }},
      {{"kernel", "Kernel", "Kernel.", ""}, [](const SessionOf& of) { return of.session.machine.kernel; }},
      {{"cpu", "Processor", "Processor.", ""}, [](const SessionOf& of) { return of.session.machine.cpu; }},
      {{"loop_rate_hz", "LoopRate", "Rate of the haptic loop; missing: no loop.", "Hz"},
       [](const SessionOf& of) { return of.session.loop_rate_hz ? textOf(*of.session.loop_rate_hz) : ""; }},
      {{"ticks", "Ticks", "Ticks of the loop.", ""},
       [](const SessionOf& of) { return textOf(of.session.counts, &SessionCounts::ticks); }},
      {{"missed_ticks", "MissedTicks", "Ticks that missed their deadline.", ""},
       [](const SessionOf& of) { return textOf(of.session.counts, &SessionCounts::missed_ticks); }},
      {{"safety_trips", "SafetyTrips", "Safety trips (force cut-offs).", ""},
       [](const SessionOf& of) { return textOf(of.session.counts, &SessionCounts::safety_trips); }},
      {{"protocol_sha256", "ProtocolSHA256", "SHA-256 of the protocol's text.", ""},
       [](const SessionOf& of) { return of.session.protocol_sha256; }},
      {{"simulation", "Simulation", "Parameters of a simulated participant, as JSON; missing: a person.", ""},
       [](const SessionOf& of) { return of.session.simulation; }},
  };
}

template <class Of>
std::vector<ExportColumn> columnsAlone(const std::vector<FilledColumn<Of>>& filled) {
  std::vector<ExportColumn> columns;
  std::ranges::transform(filled, std::back_inserter(columns), &FilledColumn<Of>::column);
  return columns;
}

}  // namespace

const std::vector<FilledColumn<TrialOf>>& filledTrialColumns() {
  static const std::vector<FilledColumn<TrialOf>> kColumns = [] {
    std::vector<FilledColumn<TrialOf>> all = designColumns();
    for (const std::vector<FilledColumn<TrialOf>>& more :
         {answerColumns(), workColumns(), intervalColumns(), recordColumns()}) {
      all.insert(all.end(), more.begin(), more.end());
    }
    return all;
  }();
  return kColumns;
}

const std::vector<FilledColumn<SessionOf>>& filledSessionColumns() {
  static const std::vector<FilledColumn<SessionOf>> kColumns = sessionColumnsMade();
  return kColumns;
}

std::vector<FilledColumn<PersonOf>> groupColumns(const StudyProtocol& protocol) {
  if (protocol.groups.empty()) {
    return {};
  }
  FilledColumn<PersonOf> group{
      {"group", "group", "Group of the participant; missing: not assigned yet.", ""},
      [](const PersonOf& of) { return of.participant.assignment ? of.participant.assignment->group : ""; }};
  for (const ParticipantGroup& of : protocol.groups) {
    std::vector<std::string_view> blocks;
    for (const std::size_t block : of.blocks) {
      blocks.push_back(protocol.blocks[block].name);
    }
    group.column.levels.emplace_back(of.name, fmt::format("goes through {}", fmt::join(blocks, ", ")));
  }
  if (protocol.assignment.strata.empty()) {
    return {group};
  }
  return {
      group,
      {{"stratum", "stratum", "Stratum of the participant; missing: not assigned yet.", ""}, [](const PersonOf& of) {
         return of.participant.assignment ? stratumText(of.protocol, of.participant.assignment->stratum) : "";
       }}};
}

std::span<const ExportColumn> trialColumns() {
  static const std::vector<ExportColumn> kColumns = columnsAlone(filledTrialColumns());
  return kColumns;
}

std::span<const ExportColumn> sessionColumns() {
  static const std::vector<ExportColumn> kColumns = columnsAlone(filledSessionColumns());
  return kColumns;
}

std::string Forms::text(const ParticipantRow& participant, const FormColumn& column) const {
  const auto answer = answers.find({participant.id, column.name()});
  return answer == answers.end() ? "" : answer->second;
}

Forms formsOf(const StudyStore& study, bool personal) {
  Forms forms;
  for (const Form& form : formsOf(study.protocol())) {
    for (const FormItem& item : form.items) {
      if (personal || !item.personal) {
        forms.columns.push_back({form.name, item.key, item});
      }
    }
  }
  for (const FormAnswerRow& row : study.formAnswers(personal)) {
    forms.answers[{row.participant, row.form + "_" + row.key}] = row.value;
    const bool known = std::ranges::any_of(
        forms.columns, [&](const FormColumn& column) { return column.form == row.form && column.key == row.key; });
    if (!known) {
      forms.columns.push_back({row.form, row.key, {.key = row.key, .label = row.key}});
    }
  }
  return forms;
}

Json described(const ExportColumn& column) {
  Json json{{"Description", column.meaning}};
  if (!column.unit.empty()) {
    json["Units"] = column.unit;
  }
  for (const auto& [value, what] : column.levels) {
    json["Levels"][value] = what;
  }
  return json;
}

Json described(const FormColumn& column) {
  const FormItem& item = column.item;
  std::string meaning = item.label;
  if (item.kind == FormItem::Kind::kScale) {
    meaning += fmt::format(" ({}: {}, {}: {})", item.low, item.low_label, item.high, item.high_label);
  }
  Json json{{"Description", meaning}};
  for (const std::string& choice : item.choices) {
    json["Levels"][choice] = choice;
  }
  return json;
}

std::string withoutFormula(std::string text) {
  constexpr std::string_view kBeginnings = "=+-@\t\r";
  if (text.empty() || kBeginnings.find(text.front()) == std::string_view::npos) {
    return text;
  }
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_number = error == std::errc() && end == text.data() + text.size();
  return is_number ? text : "'" + text;
}

IfThere ifThere(const ExportOptions& options) {
  return options.overwrite ? IfThere::kReplace : IfThere::kRefuse;
}

Readers readersOf(const ExportOptions& options) {
  return options.personal ? Readers::kOwner : Readers::kAsUsual;
}

}  // namespace haptolith
