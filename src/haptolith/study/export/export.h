#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/study/store/store.h"

namespace haptolith {

struct ExportOptions {
  bool personal = false;   ///< includes the answers to personal items; the files are then readable by their owner only
  bool overwrite = false;  ///< may replace an earlier export
  std::vector<std::string> authors = {};  ///< authors of a BIDS folder, instead of the protocol's
  std::string program_version = {};       ///< for the BIDS folder
};

/// Column of an exported table.
struct ExportColumn {
  std::string name;       ///< name in CSV files
  std::string bids_name;  ///< name in BIDS folders; empty if folder and file names already hold the value
  std::string meaning, unit;
  std::vector<std::pair<std::string, std::string>> levels = {};  ///< values and meanings of a short list
};

// Columns of trials (before those of the forms) and of sessions. docs/reference/study-files.md lists them.
[[nodiscard]] std::span<const ExportColumn> trialColumns();
[[nodiscard]] std::span<const ExportColumn> sessionColumns();

// Both formats put an apostrophe before text that a spreadsheet would interpret as a formula: text other than a number
// that begins with = + - @, a tab or a carriage return.

/// Writes one table with a row for each attempt at a trial, in the order of their beginnings. Further columns hold the
/// participant's answers to the forms. Numbers read back exactly; missing values are empty. Next to "a.csv" it writes
/// "a-sessions.csv" (program, device and machine of each session) and "a-columns.json" (meaning of all columns).
/// @throws Failure if one of the three exists or cannot be written; then none has been written.
void exportCsv(const StudyStore& study, const std::filesystem::path& file, const ExportOptions& options);

/// Writes a folder in the Brain Imaging Data Structure (https://bids-specification.readthedocs.io): participants.tsv
/// with the forms, and a _beh.tsv with its _beh.json for each participant and block. Missing values are n/a.
/// @throws Failure if the folder exists or cannot be written; only an earlier export can be overwritten.
void exportBids(const StudyStore& study, const std::filesystem::path& folder, const ExportOptions& options);

}  // namespace haptolith
