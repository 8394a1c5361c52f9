#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/study/export/export.h"
#include "haptolith/study/protocol/protocol.h"
#include "haptolith/study/store/provenance.h"
#include "haptolith/study/store/store.h"

namespace haptolith {

// Common parts of the exports to CSV and BIDS: columns, their contents and their descriptions.

/// Row of the table of trials.
struct TrialOf {
  const ParticipantRow& participant;
  const TrialRow& trial;
  const std::filesystem::path& recordings;  ///< folder
};

/// Row of the table of participants.
struct PersonOf {
  const StudyProtocol& protocol;
  const ParticipantRow& participant;
};

/// Row of the table of sessions.
struct SessionOf {
  const std::string& code;  ///< the participant's
  const SessionRow& session;
};

/// Column and the function that returns its contents.
template <class Of>
struct FilledColumn {
  ExportColumn column;
  std::function<std::string(const Of&)> text;
};

[[nodiscard]] const std::vector<FilledColumn<TrialOf>>& filledTrialColumns();
[[nodiscard]] const std::vector<FilledColumn<SessionOf>>& filledSessionColumns();
/// Returns the columns for group and stratum of a participant, if the protocol has groups and strata.
[[nodiscard]] std::vector<FilledColumn<PersonOf>> groupColumns(const StudyProtocol& protocol);

/// Column of the participants for one item of a form: "demographics_age".
struct FormColumn {
  std::string form, key;
  FormItem item;

  [[nodiscard]] std::string name() const { return form + "_" + key; }
};

/// Forms of a study and their answers, by participant and column.
struct Forms {
  std::vector<FormColumn> columns;
  std::map<std::pair<std::int64_t, std::string>, std::string> answers;

  [[nodiscard]] std::string text(const ParticipantRow& participant, const FormColumn& column) const;
};

/// Returns the forms. Every item of the protocol has a column, also one without answers.
[[nodiscard]] Forms formsOf(const StudyStore& study, bool personal);

/// Returns the description of a column: an object of a BIDS sidecar or of the data dictionary next to a CSV file.
[[nodiscard]] nlohmann::ordered_json described(const ExportColumn& column);
[[nodiscard]] nlohmann::ordered_json described(const FormColumn& column);

/// Puts an apostrophe before text that begins with = + - @, a tab or a carriage return. Spreadsheets would interpret it
/// as a formula, which may start programs. Numbers are left unchanged.
[[nodiscard]] std::string withoutFormula(std::string text);

[[nodiscard]] IfThere ifThere(const ExportOptions& options);
/// Returns the permitted readers: personal data are readable by the file's owner only.
[[nodiscard]] Readers readersOf(const ExportOptions& options);

}  // namespace haptolith
