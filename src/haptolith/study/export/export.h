#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/study/store/store.h"

namespace haptolith {

struct ExportOptions {
  bool personal = false;   ///< with the answers to personal items; only the owner may read the files then
  bool overwrite = false;  ///< may take the place of an earlier export
  std::vector<std::string> authors = {};  ///< of a BIDS folder, instead of the protocol's
  std::string program_version = {};       ///< for the BIDS folder
};

/// A column of a table that is exported.
struct ExportColumn {
  std::string name;       ///< in CSV files
  std::string bids_name;  ///< in BIDS folders, where some names are given; empty: the folders and files tell it
  std::string meaning, unit;
  std::vector<std::pair<std::string, std::string>> levels = {};  ///< values and what they mean, where there are few
};

// The columns of trials, before those of the forms, and of sessions. docs/reference/study-files.md lists them.
[[nodiscard]] std::span<const ExportColumn> trialColumns();
[[nodiscard]] std::span<const ExportColumn> sessionColumns();

/// Text that a spreadsheet would take for a formula (it begins with = + - @, a tab or a carriage return, and is no
/// number) has an apostrophe before it in both formats.

/// One table: a row for each attempt at a trial, in the order in which they began, with what its participant answered
/// to the forms in further columns. Numbers read back as the same; what is missing is empty. Beside "a.csv" lie
/// "a-sessions.csv", what ran each participant's part, and "a-columns.json", which explains the columns of both.
/// @throws Failure when one of the three exists or cannot be written; then none has been.
void exportCsv(const StudyStore& study, const std::filesystem::path& file, const ExportOptions& options);

/// A folder as the Brain Imaging Data Structure has them (https://bids-specification.readthedocs.io): participants.tsv
/// with the forms, and a _beh.tsv with its _beh.json for each participant and block. What is missing is n/a.
/// @throws Failure when the folder exists (to be overwritten it must be an earlier export) or cannot be written.
void exportBids(const StudyStore& study, const std::filesystem::path& folder, const ExportOptions& options);

}  // namespace haptolith
