#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/study/export/analysis_scripts.h"
#include "haptolith/study/export/export.h"
#include "haptolith/study/export/export_tables.h"
#include "haptolith/study/store/study_files.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Returns the text, quoted if necessary (RFC 4180).
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

/// Returns the fields of `columns` for `row`, followed by the participant's answers to the forms.
template <class Of>
std::vector<std::string> fieldsOf(const std::vector<FilledColumn<Of>>& columns, const Of& row) {
  std::vector<std::string> fields;
  std::ranges::transform(columns, std::back_inserter(fields), [&](const FilledColumn<Of>& c) { return c.text(row); });
  return fields;
}

template <class Of>
std::vector<std::string> namesOf(const std::vector<FilledColumn<Of>>& columns) {
  std::vector<std::string> names;
  std::ranges::transform(columns, std::back_inserter(names), [](const FilledColumn<Of>& c) { return c.column.name; });
  return names;
}

using People = std::map<std::int64_t, ParticipantRow>;

std::string trialsCsv(const StudyStore& study, const People& people, const Forms& forms) {
  const fs::path recordings = recordingsFolder(study.file());
  const std::vector<FilledColumn<PersonOf>> groups = groupColumns(study.protocol());
  std::vector<std::string> names = namesOf(filledTrialColumns());
  std::ranges::copy(namesOf(groups), std::back_inserter(names));
  std::ranges::transform(forms.columns, std::back_inserter(names), &FormColumn::name);
  std::string text = csvLine(names);
  for (const TrialRow& trial : study.trials()) {
    const auto found = people.find(trial.participant);
    if (found == people.end()) {
      continue;  // a participant who began after the list was read
    }
    std::vector<std::string> fields =
        fieldsOf(filledTrialColumns(), TrialOf{.participant = found->second, .trial = trial, .recordings = recordings});
    std::ranges::copy(fieldsOf(groups, PersonOf{study.protocol(), found->second}), std::back_inserter(fields));
    for (const FormColumn& column : forms.columns) {
      fields.push_back(forms.text(found->second, column));
    }
    text += csvLine(fields);
  }
  return text;
}

std::string sessionsCsv(const StudyStore& study, const People& people) {
  std::string text = csvLine(namesOf(filledSessionColumns()));
  for (const SessionRow& session : study.sessions()) {
    if (const auto found = people.find(session.participant); found != people.end()) {
      text += csvLine(fieldsOf(filledSessionColumns(), SessionOf{.code = found->second.code, .session = session}));
    }
  }
  return text;
}

/// Returns the data dictionary: the columns of each file, in the format of BIDS sidecars.
Json dictionary(const StudyProtocol& protocol, const fs::path& trials, const fs::path& sessions, const Forms& forms) {
  Json json;
  Json& of_trials = json[trials.filename().string()];
  for (const ExportColumn& column : trialColumns()) {
    of_trials[column.name] = described(column);
  }
  for (const FilledColumn<PersonOf>& of : groupColumns(protocol)) {
    of_trials[of.column.name] = described(of.column);
  }
  for (const FormColumn& column : forms.columns) {
    of_trials[column.name()] = described(column);
  }
  for (const ExportColumn& column : sessionColumns()) {
    json[sessions.filename().string()][column.name] = described(column);
  }
  return json;
}

fs::path beside(const fs::path& file, const char* ending) {
  fs::path other = file;
  return other.replace_filename(file.stem().string() + ending);
}

}  // namespace

void exportCsv(const StudyStore& study, const fs::path& file, const ExportOptions& options) {
  const fs::path sessions_file = beside(file, "-sessions.csv"), dictionary_file = beside(file, "-columns.json");
  const auto output = [&](const fs::path& path) { return OutputFile(path, ifThere(options), readersOf(options)); };
  AtomicFile trials(output(file)), sessions(output(sessions_file)), columns(output(dictionary_file));
  const Forms forms = formsOf(study, options.personal);
  People people;
  for (const ParticipantRow& participant : study.participants()) {
    people.emplace(participant.id, participant);
  }
  trials.write(trialsCsv(study, people, forms));
  sessions.write(sessionsCsv(study, people));
  columns.write(dictionary(study.protocol(), file, sessions_file, forms).dump(2) + "\n");
  writeAnalysisScripts(file, ifThere(options));
  for (AtomicFile* made : {&columns, &sessions, &trials}) {
    made->commit();
  }
}

}  // namespace haptolith
