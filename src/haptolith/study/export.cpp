#include "haptolith/study/export.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include "haptolith/core/atomic_file.h"
#include "haptolith/core/atomic_folder.h"
#include "haptolith/core/error.h"
#include "haptolith/study/analysis_scripts.h"
#include "haptolith/study/form.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::string_view kBidsVersion = "1.9.0";

// --- values
// -----------------------------------------------------------------------------------------------------------

/// The shortest text that reads back as the same number.
std::string textOf(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "";
}

std::string textOf(bool value) {
  return value ? "1" : "0";
}

// --- columns
// ----------------------------------------------------------------------------------------------------------

struct TrialOf {
  const ParticipantRow& participant;
  const TrialRow& trial;
};

/// A column and what stands in it.
struct FilledColumn {
  TrialColumn column;
  std::function<std::string(const TrialOf&)> text;
};

template <class Text>
std::function<std::string(const TrialOf&)> ofAnswer(Text text) {
  return [text](const TrialOf& of) { return of.trial.answer ? text(*of.trial.answer) : std::string(); };
}

std::vector<FilledColumn> designColumns() {
  return {
      {{"participant", "", "Pseudonym of the participant.", ""}, [](const TrialOf& of) { return of.participant.code; }},
      {{"participant_number", "", "The participant's place in the study: 1 is the first.", ""},
       [](const TrialOf& of) { return fmt::format("{}", of.participant.number); }},
      {{"participant_state",
        "",
        "What has become of the participant.",
        "",
        {{"running", "has not finished"}, {"finished", "has"}, {"withdrawn", "ended it; figures leave them out"}}},
       [](const TrialOf& of) { return of.participant.state; }},
      {{"block", "", "Name of the block.", ""}, [](const TrialOf& of) { return of.trial.block_name; }},
      {{"block_position", "block_position", "The block's place in this participant's order: 1 is the first.", ""},
       [](const TrialOf& of) { return fmt::format("{}", of.trial.position + 1); }},
      {{"trial", "trial", "The trial's place in its block: 1 is the first.", ""},
       [](const TrialOf& of) { return fmt::format("{}", of.trial.index + 1); }},
      {{"attempt", "attempt", "1, or more after a trial that was lost or repeated.", ""},
       [](const TrialOf& of) { return fmt::format("{}", of.trial.attempt + 1); }},
      {{"kind",
        "trial_type",
        "What the trial is for.",
        "",
        {{"practice", "before the others; counts for nothing"},
         {"main", "counts for the curve"},
         {"catch", "an easy one that shows whether the participant attends"}}},
       [](const TrialOf& of) { return std::string(wordOf(of.trial.kind)); }},
      {{"state",
        "state",
        "What became of it; only answered trials count.",
        "",
        {{"begun", "under way, or cut off by a crash"},
         {"answered", "has its answer"},
         {"repeated", "done again by the experimenter's wish; the answer, if any, does not count"},
         {"lost", "ended without an answer and done again"}}},
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

std::vector<FilledColumn> answerColumns() {
  return {
      {{"response",
        "response",
        "The answer, whichever way it was asked.",
        "",
        {{"0", "the test was said to have less than the reference"}, {"1", "the test was said to have more"}}},
       ofAnswer([](const TrialAnswer& a) { return a.timed_out ? "" : textOf(a.positive); })},
      {{"correct", "correct", "Whether that is so.", "", {{"0", "no"}, {"1", "yes"}}},
       ofAnswer([](const TrialAnswer& a) { return a.correct ? textOf(*a.correct) : ""; })},
      {{"response_time_s", "response_time", "From the question to the answer.", "s"},
       ofAnswer([](const TrialAnswer& a) { return textOf(a.reaction_s); })},
      {{"timed_out",
        "timed_out",
        "Whether the time for an answer was over before one came; such a trial is called lost and done again, so that "
        "it is "
        "always 0.",
        "",
        {{"0", "no"}, {"1", "yes"}}},
       ofAnswer([](const TrialAnswer& a) { return textOf(a.timed_out); })},
  };
}

std::vector<FilledColumn> feltColumns() {
  std::vector<FilledColumn> columns;
  for (const std::size_t interval : {0, 1}) {
    const std::string name = interval == 0 ? "first" : "second";
    for (const SummaryColumn& number : summaryColumns()) {
      const std::string full = fmt::format("{}_{}", name, number.name);
      columns.push_back(
          {{full, full, fmt::format("Of the {} stimulus: {}", name, number.meaning), std::string(number.unit)},
           ofAnswer([=](const TrialAnswer& a) { return textOf(a.felt[interval].*number.value); })});
    }
    const std::string full = name + "_deadline_misses";
    columns.push_back(
        {{full, full, fmt::format("Of the {} stimulus: ticks of the loop that came late.", name), ""},
         ofAnswer([=](const TrialAnswer& a) { return fmt::format("{}", a.felt[interval].deadline_misses); })});
  }
  return columns;
}

std::vector<FilledColumn> recordColumns() {
  return {
      {{"seed", "seed", "Drawn for the trial, for scenes that draw something; the beds of one stimulus are all alike.",
        ""},
       [](const TrialOf& of) { return fmt::format("{}", of.trial.seed); }},
      {{"recording", "recording",
        "Recordings of the trial: their names before -first.h5 and -second.h5, in the folder of the study's "
        "recordings.",
        ""},
       ofAnswer([](const TrialAnswer& a) { return a.recording; })},
      {{"begun_at", "begun_at", "When it began, UTC.", ""}, [](const TrialOf& of) { return of.trial.begun_at; }},
      {{"answered_at", "answered_at", "When it was answered, UTC.", ""},
       [](const TrialOf& of) { return of.trial.answered_at; }},
      {{"reason", "reason", "Why it was repeated or lost.", ""}, [](const TrialOf& of) { return of.trial.reason; }},
  };
}

const std::vector<FilledColumn>& filledColumns() {
  static const std::vector<FilledColumn> kColumns = [] {
    std::vector<FilledColumn> all = designColumns();
    for (const std::vector<FilledColumn>& more : {answerColumns(), feltColumns(), recordColumns()}) {
      all.insert(all.end(), more.begin(), more.end());
    }
    return all;
  }();
  return kColumns;
}

// --- forms
// ------------------------------------------------------------------------------------------------------------

/// An item of a form as a column of the participants: "demographics_age".
struct FormColumn {
  std::string form, key;
  FormItem item;

  [[nodiscard]] std::string name() const { return form + "_" + key; }
};

using FormAnswers = std::map<std::pair<std::int64_t, std::string>, std::string>;  // by participant and column

struct Forms {
  std::vector<FormColumn> columns;
  FormAnswers answers;

  [[nodiscard]] std::string text(const ParticipantRow& participant, const FormColumn& column) const {
    const auto answer = answers.find({participant.id, column.name()});
    return answer == answers.end() ? "" : answer->second;
  }
};

/// Every item of the protocol has its column, whether or not anybody has answered it.
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

// --- CSV
// --------------------------------------------------------------------------------------------------------------

/// Spreadsheets take text that begins like this for a formula, which may start programs: an apostrophe before it says
/// that it is text. Numbers stay numbers.
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

/// Quoted where it has to be (RFC 4180).
std::string csvField(std::string text) {
  text = withoutFormula(std::move(text));
  if (text.find_first_of(",\"\r\n") == std::string::npos) {
    return text;
  }
  std::string quoted = "\"";
  for (const char letter : text) {
    quoted.append(letter == '"' ? 2 : 1, letter);
  }
  return quoted + '"';
}

std::string csvLine(const std::vector<std::string>& fields) {
  std::string line;
  for (const std::string& field : fields) {
    line += csvField(field);
    line += ',';
  }
  line.back() = '\n';
  return line;
}

// --- BIDS
// -------------------------------------------------------------------------------------------------------------

/// A field of a TSV file, which knows no quotes.
std::string tsvField(std::string text) {
  text = withoutFormula(std::move(text));
  std::ranges::replace_if(
      text, [](char letter) { return letter == '\t' || letter == '\n' || letter == '\r'; }, ' ');
  return text.empty() ? "n/a" : text;
}

std::string tsvLine(const std::vector<std::string>& fields) {
  std::string line;
  for (const std::string& field : fields) {
    line += tsvField(field);
    line += '\t';
  }
  line.back() = '\n';
  return line;
}

Json described(const std::string& meaning, const std::string& unit,
               const std::vector<std::pair<std::string, std::string>>& levels) {
  Json json{{"Description", meaning}};
  if (!unit.empty()) {
    json["Units"] = unit;
  }
  for (const auto& [value, what] : levels) {
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

std::string subjectOf(const ParticipantRow& participant) {
  return "sub-" + participant.code;
}

Json datasetJson(const StudyStore& study) {
  return {{"Name", study.title()},
          {"BIDSVersion", kBidsVersion},
          {"DatasetType", "raw"},
          {"GeneratedBy", Json::array({{{"Name", "haptolith"}}})}};
}

std::string readmeOf(const StudyStore& study) {
  return fmt::format(
      "# {}\n\nA user study of soil that is felt through a haptic device, run with haptolith and begun on {}.\n\n"
      "participants.tsv holds who took part, by pseudonyms, and what they answered to the forms. Each sub-*/beh "
      "folder\n"
      "holds a participant's trials, a file for each block; its JSON file explains the columns.\n",
      study.title(), study.createdAt().substr(0, 10));
}

std::string participantsTsv(const std::vector<ParticipantRow>& participants, const Forms& forms) {
  std::vector<std::string> names{"participant_id", "number", "state", "begun_at", "ended_at"};
  std::ranges::transform(forms.columns, std::back_inserter(names), &FormColumn::name);
  std::string text = tsvLine(names);
  for (const ParticipantRow& participant : participants) {
    std::vector<std::string> fields{subjectOf(participant), fmt::format("{}", participant.number), participant.state,
                                    participant.begun_at, participant.ended_at};
    for (const FormColumn& column : forms.columns) {
      fields.push_back(forms.text(participant, column));
    }
    text += tsvLine(fields);
  }
  return text;
}

Json participantsJson(const Forms& forms) {
  Json json{
      {"participant_id", described("Pseudonym of the participant.", "", {})},
      {"number", described("The participant's place in the study: 1 is the first.", "", {})},
      {"state", described("How far the participant has come.", "",
                          {{"running", "not at the end yet"}, {"finished", "at the end"}, {"withdrawn", "has quit"}})},
      {"begun_at", described("When the participant began, UTC.", "", {})},
      {"ended_at", described("When the participant finished or quit, UTC.", "", {})},
  };
  for (const FormColumn& column : forms.columns) {
    json[column.name()] = described(column);
  }
  return json;
}

std::string behaviourTsv(const ParticipantRow& participant, const std::vector<TrialRow>& trials,
                         std::string_view block) {
  std::vector<std::string> names;
  for (const FilledColumn& column : filledColumns()) {
    if (!column.column.bids_name.empty()) {
      names.push_back(column.column.bids_name);
    }
  }
  std::string text = tsvLine(names);
  for (const TrialRow& trial : trials) {
    if (trial.block_name != block) {
      continue;
    }
    std::vector<std::string> fields;
    for (const FilledColumn& column : filledColumns()) {
      if (!column.column.bids_name.empty()) {
        fields.push_back(column.text({participant, trial}));
      }
    }
    text += tsvLine(fields);
  }
  return text;
}

Json behaviourJson(const StudyBlock& block) {
  Json json{{"TaskName", block.name}, {"TaskDescription", block.question}};
  if (!block.instructions.empty()) {
    json["Instructions"] = block.instructions;
  }
  for (const FilledColumn& column : filledColumns()) {
    if (!column.column.bids_name.empty()) {
      json[column.column.bids_name] = described(column.column.meaning, column.column.unit, column.column.levels);
    }
  }
  json["x"]["LongName"] = block.axis_label;
  json["x_reference"]["LongName"] = block.axis_label;
  return json;
}

IfThere ifThere(const ExportOptions& options) {
  return options.overwrite ? IfThere::kReplace : IfThere::kRefuse;
}

/// What tells who somebody is, is for the one who asked for it.
Readers readersOf(const ExportOptions& options) {
  return options.personal ? Readers::kOwner : Readers::kAsUsual;
}

/// A folder that somebody asks to be overwritten is deleted: nothing but an earlier export may be.
void requireEarlierExport(const fs::path& folder, bool overwrite) {
  if (fs::exists(folder) && !overwrite) {
    throw Failure(fmt::format("{} exists already: choose another name, or add --overwrite", folder.string()));
  }
  if (fs::exists(folder) && !fs::exists(folder / "dataset_description.json")) {
    throw Failure(fmt::format("{} is no earlier export, and is not overwritten: choose another name", folder.string()));
  }
}

}  // namespace

std::span<const TrialColumn> trialColumns() {
  static const std::vector<TrialColumn> kColumns = [] {
    std::vector<TrialColumn> columns;
    std::ranges::transform(filledColumns(), std::back_inserter(columns), &FilledColumn::column);
    return columns;
  }();
  return kColumns;
}

void exportCsv(const StudyStore& study, const fs::path& file, const ExportOptions& options) {
  AtomicFile out({file, ifThere(options), readersOf(options)});
  const Forms forms = formsOf(study, options.personal);
  std::map<std::int64_t, ParticipantRow> participants;
  for (const ParticipantRow& participant : study.participants()) {
    participants.emplace(participant.id, participant);
  }
  std::vector<std::string> names;
  std::ranges::transform(trialColumns(), std::back_inserter(names), &TrialColumn::name);
  std::ranges::transform(forms.columns, std::back_inserter(names), &FormColumn::name);
  std::string text = csvLine(names);
  for (const TrialRow& trial : study.trials()) {
    if (!participants.contains(trial.participant)) {
      continue;  // who has begun since the list was read
    }
    const ParticipantRow& participant = participants.at(trial.participant);
    std::vector<std::string> fields;
    for (const FilledColumn& column : filledColumns()) {
      fields.push_back(column.text({participant, trial}));
    }
    for (const FormColumn& column : forms.columns) {
      fields.push_back(forms.text(participant, column));
    }
    text += csvLine(fields);
  }
  out.write(text);
  writeAnalysisScripts(file, ifThere(options));
  out.commit();
}

void exportBids(const StudyStore& study, const fs::path& folder, const ExportOptions& options) {
  requireEarlierExport(folder, options.overwrite);
  const AtomicFolder made(folder, ifThere(options), readersOf(options));
  const Forms forms = formsOf(study, options.personal);
  const std::vector<ParticipantRow> participants = study.participants();
  made.write("dataset_description.json", datasetJson(study).dump(2) + "\n");
  made.write("README.md", readmeOf(study));
  made.write("participants.tsv", participantsTsv(participants, forms));
  made.write("participants.json", participantsJson(forms).dump(2) + "\n");
  for (const ParticipantRow& participant : participants) {
    const std::vector<TrialRow> trials = study.trials(participant.id);
    for (const StudyBlock& block : study.protocol().blocks) {
      if (std::ranges::find(trials, block.name, &TrialRow::block_name) == trials.end()) {
        continue;
      }
      const fs::path stem =
          fs::path(subjectOf(participant)) / "beh" / fmt::format("{}_task-{}_beh", subjectOf(participant), block.name);
      made.write(stem.string() + ".tsv", behaviourTsv(participant, trials, block.name));
      made.write(stem.string() + ".json", behaviourJson(block).dump(2) + "\n");
    }
  }
  for (const AnalysisScript& script : analysisScripts()) {
    made.write(fs::path("code") / script.name, script.text);
  }
  made.commit();
}

}  // namespace haptolith
