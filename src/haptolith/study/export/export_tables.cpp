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

/// The shortest text that reads back as the same number.
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
      {{"participant_number", "", "The participant's place in the study: 1 is the first.", ""},
       [](const TrialOf& of) { return fmt::format("{}", of.participant.number); }},
      {{"participant_state",
        "",
        "State of the participant.",
        "",
        {{"running", "has not finished"},
         {"finished", "has"},
         {"withdrawn", "withdrew; figures leave them out"},
         {"excluded", "is left out by the experimenter"}}},
       [](const TrialOf& of) { return std::string(standingOf(of.participant)); }},
      {{"excluded_for", "", "Why the participant is left out by the experimenter.", ""},
       [](const TrialOf& of) { return of.participant.excluded_for; }},
      {{"block", "", "Name of the block.", ""}, [](const TrialOf& of) { return of.trial.block_name; }},
      {{"block_position", "block_position", "The block's place in this participant's order: 1 is the first.", ""},
       [](const TrialOf& of) { return fmt::format("{}", of.trial.position + 1); }},
      {{"trial", "trial", "The trial's place in its block: 1 is the first.", ""},
       [](const TrialOf& of) { return fmt::format("{}", of.trial.index + 1); }},
      {{"attempt", "attempt", "1, or more after a trial that was lost or repeated.", ""},
       [](const TrialOf& of) { return fmt::format("{}", of.trial.attempt + 1); }},
      {{"kind",
        "trial_type",
        "Purpose of the trial.",
        "",
        {{"practice", "before the others; does not count"},
         {"main", "counts for the curve"},
         {"catch", "an easy one that shows whether the participant attends"}}},
       [](const TrialOf& of) { return std::string(wordOf(of.trial.kind)); }},
      {{"state",
        "state",
        "State of the trial; only answered trials count.",
        "",
        {{"begun", "running, or interrupted by a crash"},
         {"answered", "has its answer"},
         {"repeated", "repeated by the experimenter; the answer, if any, does not count"},
         {"lost", "ended without an answer and repeated"}}},
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
        "The answer, independent of the form of the question.",
        "",
        {{"0", "the participant judged the test to have less than the reference"},
         {"1", "the participant judged the test to have more"}}},
       ofAnswer([](const TrialAnswer& a) { return a.timed_out || a.teleop ? "" : textOf(a.positive); })},
      {{"correct", "correct", "Whether the answer is correct.", "", {{"0", "no"}, {"1", "yes"}}},
       ofAnswer([](const TrialAnswer& a) { return a.correct ? textOf(*a.correct) : ""; })},
      {{"response_time_s", "response_time", "From the question to the answer.", "s"},
       ofAnswer([](const TrialAnswer& a) { return textOf(a.reaction_s); })},
      {{"timed_out",
        "timed_out",
        "Whether the time for an answer ended without one; such a trial is marked as lost and repeated, so this is "
        "always 0.",
        "",
        {{"0", "no"}, {"1", "yes"}}},
       ofAnswer([](const TrialAnswer& a) { return textOf(a.timed_out); })},
  };
}

/// Of trials that are work for a robot.
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
          {{full, full, fmt::format("{} stimulus: {}", interval == 0 ? "First" : "Second", number.meaning),
            std::string(number.unit)},
           ofAnswer([=](const TrialAnswer& a) { return textOf(a.summaries[interval].*number.value); })});
    }
    const std::string full = name + "_deadline_misses";
    columns.push_back(
        {{full, full, fmt::format("{} stimulus: number of late ticks of the loop.", interval == 0 ? "First" : "Second"),
          ""},
         ofAnswer([=](const TrialAnswer& a) { return fmt::format("{}", a.summaries[interval].deadline_misses); })});
  }
  return columns;
}

/// An interval that was never felt has no recording, and a trial without an answer need not have had both.
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
    } catch (const Failure&) {  // not even its beginning is whole
      return "unfinished";
    }
  }
  const bool both = of.trial.answer && !of.trial.answer->teleop;  // should be there
  return there == 2 || (there == 1 && !both) ? "whole" : "missing";
}

std::vector<FilledColumn<TrialOf>> recordColumns() {
  return {
      {{"seed", "seed", "Drawn for the trial, for scenes that draw something; the beds of one stimulus are all alike.",
        ""},
       [](const TrialOf& of) { return fmt::format("{}", of.trial.seed); }},
      {{"recording", "recording",
        "Recordings of the trial: their names before -first.h5 and -second.h5, in the folder of the study's "
        "recordings.",
        ""},
       [](const TrialOf& of) { return of.trial.recording; }},
      {{"recording_state",
        "recording_state",
        "State of the recordings.",
        "",
        {{"whole", "complete"},
         {"unfinished",
          "one was interrupted when the program was killed; haptolith can read it, other programs may not"},
         {"missing", "one is missing in the folder"}}},
       recordingState},
      {{"begun_at", "begun_at", "When it began, UTC.", ""}, [](const TrialOf& of) { return of.trial.begun_at; }},
      {{"answered_at", "answered_at", "When it was answered, UTC.", ""},
       [](const TrialOf& of) { return of.trial.answered_at; }},
      {{"reason", "reason", "Why it was repeated or lost.", ""}, [](const TrialOf& of) { return of.trial.reason; }},
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
        "Start of the session.",
        "",
        {{"run", "the participant began"},
         {"resume", "the participant returned"},
         {"simulate", "the participant was simulated"}}},
       [](const SessionOf& of) { return of.session.kind; }},
      {{"begun_at", "BegunAt", "When it began, UTC.", ""}, [](const SessionOf& of) { return of.session.begun_at; }},
      {{"ended_at", "EndedAt", "When it ended, UTC; missing: running, or interrupted by a crash.", ""},
       [](const SessionOf& of) { return of.session.ended_at; }},
      {{"program_version", "SoftwareVersion", "Version of haptolith.", ""},
       [](const SessionOf& of) { return of.session.program_version; }},
      {{"device", "Device", "Driver and model of the haptic device.", ""},
       [](const SessionOf& of) { return of.session.device; }},
      {{"os", "OperatingSystem", "Operating system of the machine.", ""},
       [](const SessionOf& of) { return of.session.machine.os; }},
      {{"kernel", "Kernel", "Its kernel.", ""}, [](const SessionOf& of) { return of.session.machine.kernel; }},
      {{"cpu", "Processor", "Its processor.", ""}, [](const SessionOf& of) { return of.session.machine.cpu; }},
      {{"loop_rate_hz", "LoopRate", "Ticks of the haptic loop in a second; missing: there was no loop.", "Hz"},
       [](const SessionOf& of) { return of.session.loop_rate_hz ? textOf(*of.session.loop_rate_hz) : ""; }},
      {{"ticks", "Ticks", "Ticks of the loop in the session.", ""},
       [](const SessionOf& of) { return textOf(of.session.counts, &SessionCounts::ticks); }},
      {{"missed_ticks", "MissedTicks", "Number of late ticks.", ""},
       [](const SessionOf& of) { return textOf(of.session.counts, &SessionCounts::missed_ticks); }},
      {{"safety_trips", "SafetyTrips", "Number of safety trips.", ""},
       [](const SessionOf& of) { return textOf(of.session.counts, &SessionCounts::safety_trips); }},
      {{"protocol_sha256", "ProtocolSHA256", "SHA-256 of the protocol's text.", ""},
       [](const SessionOf& of) { return of.session.protocol_sha256; }},
      {{"simulation", "Simulation", "Parameters of the simulated participant, as JSON; missing: a person participated.",
        ""},
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
      {"group", "group", "The group that the participant was assigned to; missing: none yet.", ""},
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
  return {group,
          {{"stratum", "stratum", "The stratum within which the participant was assigned; missing: not yet.", ""},
           [](const PersonOf& of) {
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
