#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/files/atomic_folder.h"
#include "haptolith/study/export/analysis_scripts.h"
#include "haptolith/study/export/export.h"
#include "haptolith/study/export/export_tables.h"
#include "haptolith/study/store/study_files.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::string_view kBidsVersion = "1.9.0";

/// Returns a field of a TSV file, a format without quotes.
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

std::string subjectOf(const ParticipantRow& participant) {
  return "sub-" + participant.code;
}

Json datasetJson(const StudyStore& study, const ExportOptions& options) {
  Json json{{"Name", study.title()}, {"BIDSVersion", kBidsVersion}, {"DatasetType", "raw"}};
  if (const std::vector<std::string>& authors = options.authors.empty() ? study.protocol().authors : options.authors;
      !authors.empty()) {
    json["Authors"] = authors;
  }
  json["GeneratedBy"] = Json::array({{{"Name", "haptolith"}, {"Version", options.program_version}}});
  return json;
}

std::string readmeOf(const StudyStore& study) {
  return fmt::format(
      "# {}\n\nA user study with simulated soil on a haptic device, run with haptolith and begun on "
      "{}.\n\nparticipants.tsv lists the participants by pseudonyms, and their answers to the forms. Each sub-*/beh "
      "folder\nholds a participant's trials, a file for each block; its JSON file explains the columns.\n",
      study.title(), study.createdAt().substr(0, 10));
}

const std::vector<ExportColumn>& participantColumns() {
  static const std::vector<ExportColumn> kColumns{
      {"", "participant_id", "Pseudonym of the participant.", ""},
      {"", "number", "The participant's place in the study: 1 is the first.", ""},
      {"",
       "state",
       "State of the participant.",
       "",
       {{"running", "not finished"},
        {"finished", "finished"},
        {"withdrawn", "withdrew"},
        {"excluded", "is left out by the experimenter"}}},
      {"", "excluded_for", "Why the participant is left out by the experimenter.", ""},
      {"", "begun_at", "When the participant began, UTC.", ""},
      {"", "ended_at", "When the participant finished or withdrew, UTC.", ""},
      {"", "consent_at", "When the participant agreed to take part, UTC.", ""},
      {"", "consent_version", "Version of the text that was agreed to, or its SHA-256.", ""},
      {"", "consent_language", "Language of that text.", ""},
  };
  return kColumns;
}

std::string participantsTsv(const StudyStore& study, const std::vector<ParticipantRow>& participants,
                            const Forms& forms) {
  const std::vector<ConsentRow> consents = study.consents();
  const std::vector<FilledColumn<PersonOf>> groups = groupColumns(study.protocol());
  std::vector<std::string> names;
  std::ranges::transform(participantColumns(), std::back_inserter(names), &ExportColumn::bids_name);
  for (const FilledColumn<PersonOf>& of : groups) {
    names.push_back(of.column.bids_name);
  }
  std::ranges::transform(forms.columns, std::back_inserter(names), &FormColumn::name);
  std::string text = tsvLine(names);
  for (const ParticipantRow& participant : participants) {
    std::vector<std::string> fields{subjectOf(participant),
                                    fmt::format("{}", participant.number),
                                    std::string(standingOf(participant)),
                                    participant.excluded_for,
                                    participant.begun_at,
                                    participant.ended_at};
    const auto found = std::ranges::find(consents, participant.id, &ConsentRow::participant);
    const ConsentRow consent = found == consents.end() ? ConsentRow() : *found;
    fields.insert(fields.end(), {consent.at, consent.version, consent.language});
    for (const FilledColumn<PersonOf>& of : groups) {
      fields.push_back(of.text({study.protocol(), participant}));
    }
    for (const FormColumn& column : forms.columns) {
      fields.push_back(forms.text(participant, column));
    }
    text += tsvLine(fields);
  }
  return text;
}

Json participantsJson(const StudyProtocol& protocol, const Forms& forms) {
  Json json;
  for (const ExportColumn& column : participantColumns()) {
    json[column.bids_name] = described(column);
  }
  for (const FilledColumn<PersonOf>& of : groupColumns(protocol)) {
    json[of.column.bids_name] = described(of.column);
  }
  for (const FormColumn& column : forms.columns) {
    json[column.name()] = described(column);
  }
  return json;
}

std::string behaviourTsv(const ParticipantRow& participant, const std::vector<TrialRow>& trials, std::string_view block,
                         const fs::path& recordings) {
  std::vector<std::string> names;
  for (const FilledColumn<TrialOf>& column : filledTrialColumns()) {
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
    for (const FilledColumn<TrialOf>& column : filledTrialColumns()) {
      if (!column.column.bids_name.empty()) {
        fields.push_back(column.text({.participant = participant, .trial = trial, .recordings = recordings}));
      }
    }
    text += tsvLine(fields);
  }
  return text;
}

/// Adds the sessions of a participant: BIDS fields describe the last session, an additional field lists the others.
void addSessions(Json& json, const ParticipantRow& participant, const std::vector<SessionRow>& sessions) {
  Json rows = Json::array();
  for (const SessionRow& session : sessions) {
    if (session.participant != participant.id) {
      continue;
    }
    json["StimulusPresentation"] = {
        {"OperatingSystem", fmt::format("{}, {}", session.machine.os, session.machine.kernel)},
        {"SoftwareName", "haptolith"},
        {"SoftwareVersion", session.program_version}};
    Json row;
    for (const FilledColumn<SessionOf>& column : filledSessionColumns()) {
      if (const std::string text = column.text({.code = participant.code, .session = session});
          !column.column.bids_name.empty() && !text.empty()) {
        row[column.column.bids_name] = text;
      }
    }
    rows.push_back(std::move(row));
  }
  if (!rows.empty()) {
    json["Sessions"] = std::move(rows);
  }
}

Json behaviourJson(const StudyBlock& block) {
  Json json{{"TaskName", block.name}, {"TaskDescription", block.teleop ? goalOf(block.teleop->task) : block.question}};
  if (!block.instructions.empty()) {
    json["Instructions"] = block.instructions;
  }
  for (const FilledColumn<TrialOf>& column : filledTrialColumns()) {
    if (!column.column.bids_name.empty()) {
      json[column.column.bids_name] = described(column.column);
    }
  }
  json["x"]["LongName"] = block.axis_label;
  json["x_reference"]["LongName"] = block.axis_label;
  return json;
}

/// Overwriting deletes the folder, so only an earlier export is accepted.
void requireEarlierExport(const fs::path& folder, bool overwrite) {
  if (fs::exists(folder) && !overwrite) {
    throw Failure(fmt::format("{} already exists: choose another name, or add --overwrite", folder.string()));
  }
  if (fs::exists(folder) && !fs::exists(folder / "dataset_description.json")) {
    throw Failure(
        fmt::format("cannot overwrite {}: it is not an earlier export; choose another name", folder.string()));
  }
}

}  // namespace

void exportBids(const StudyStore& study, const fs::path& folder, const ExportOptions& options) {
  requireEarlierExport(folder, options.overwrite);
  const AtomicFolder made(folder, ifThere(options), readersOf(options));
  const Forms forms = formsOf(study, options.personal);
  const std::vector<ParticipantRow> participants = study.participants();
  const std::vector<SessionRow> sessions = study.sessions();
  const fs::path recordings = recordingsFolder(study.file());
  made.write("dataset_description.json", datasetJson(study, options).dump(2) + "\n");
  made.write("README.md", readmeOf(study));
  made.write("participants.tsv", participantsTsv(study, participants, forms));
  made.write("participants.json", participantsJson(study.protocol(), forms).dump(2) + "\n");
  for (const ParticipantRow& participant : participants) {
    const std::vector<TrialRow> trials = study.trials(participant.id);
    for (const StudyBlock& block : study.protocol().blocks) {
      if (std::ranges::find(trials, block.name, &TrialRow::block_name) == trials.end()) {
        continue;
      }
      const fs::path stem =
          fs::path(subjectOf(participant)) / "beh" / fmt::format("{}_task-{}_beh", subjectOf(participant), block.name);
      made.write(stem.string() + ".tsv", behaviourTsv(participant, trials, block.name, recordings));
      Json sidecar = behaviourJson(block);
      addSessions(sidecar, participant, sessions);
      made.write(stem.string() + ".json", sidecar.dump(2) + "\n");
    }
  }
  for (const AnalysisScript& script : analysisScripts()) {
    made.write(fs::path("code") / script.name, script.text);
  }
  made.commit();
}

}  // namespace haptolith
