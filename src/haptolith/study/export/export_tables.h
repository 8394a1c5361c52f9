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

// What exports to CSV and to BIDS share: columns, what stands in them, and what explains them.

/// A row of a study's trials.
struct TrialOf {
  const ParticipantRow& participant;
  const TrialRow& trial;
  const std::filesystem::path& recordings;  ///< folder
};

/// A participant, of a study.
struct PersonOf {
  const StudyProtocol& protocol;
  const ParticipantRow& participant;
};

/// A row of its sessions.
struct SessionOf {
  const std::string& code;  ///< of the participant
  const SessionRow& session;
};

/// A column and what stands in it.
template <class Of>
struct FilledColumn {
  ExportColumn column;
  std::function<std::string(const Of&)> text;
};

[[nodiscard]] const std::vector<FilledColumn<TrialOf>>& filledTrialColumns();
[[nodiscard]] const std::vector<FilledColumn<SessionOf>>& filledSessionColumns();
/// Group and stratum of a participant, where the protocol has groups and strata.
[[nodiscard]] std::vector<FilledColumn<PersonOf>> groupColumns(const StudyProtocol& protocol);

/// An item of a form as a column of the participants: "demographics_age".
struct FormColumn {
  std::string form, key;
  FormItem item;

  [[nodiscard]] std::string name() const { return form + "_" + key; }
};

/// The forms of a study and what was answered, by participant and column.
struct Forms {
  std::vector<FormColumn> columns;
  std::map<std::pair<std::int64_t, std::string>, std::string> answers;

  [[nodiscard]] std::string text(const ParticipantRow& participant, const FormColumn& column) const;
};

/// Every item of the protocol has its column, whether or not anybody has answered it.
[[nodiscard]] Forms formsOf(const StudyStore& study, bool personal);

/// What explains a column: an object of a BIDS sidecar, and of the data dictionary beside a CSV file.
[[nodiscard]] nlohmann::ordered_json described(const ExportColumn& column);
[[nodiscard]] nlohmann::ordered_json described(const FormColumn& column);

/// Spreadsheets take text that begins with = + - @, a tab or a carriage return for a formula, which may start programs:
/// an apostrophe before it says that it is text. Numbers stay numbers.
[[nodiscard]] std::string withoutFormula(std::string text);

[[nodiscard]] IfThere ifThere(const ExportOptions& options);
/// What tells who somebody is, is for the one who asked for it.
[[nodiscard]] Readers readersOf(const ExportOptions& options);

}  // namespace haptolith
