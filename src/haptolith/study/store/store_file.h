#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "haptolith/study/protocol/protocol.h"

namespace haptolith {

// File of a study: an SQLite database with write-ahead log. All functions throw Failure and SQLite::Exception.

/// Opens a file for reading, also in a read-only folder.
[[nodiscard]] SQLite::Database openToRead(const std::filesystem::path& file);
/// Opens a file for reading and writing. @throws Failure for a read-only file.
[[nodiscard]] SQLite::Database openToRun(const std::filesystem::path& file);

/// @throws Failure if the database is not a study.
void requireStudy(SQLite::Database& database, const std::filesystem::path& file);
/// @throws Failure if the database is damaged.
void requireWhole(SQLite::Database& database, const std::filesystem::path& file);
/// @throws Failure if the database was made by another version.
void requireVersion(SQLite::Database& database, const std::filesystem::path& file);
/// Checks that the file has a single name (hard link). SQLite's log and the lock are next to the name by which the file
/// was opened: under another name the study would lack answers, and could be run twice. @throws Failure for a file with
/// several names.
void requireOneName(const std::filesystem::path& file);

/// Creates the tables of a new study in an empty file.
void writeNewStudy(const std::filesystem::path& file, const StudyProtocol& protocol, std::string_view protocol_text,
                   std::uint64_t seed);
/// Removes a database and SQLite's companion files.
void removeWithCompanions(const std::filesystem::path& file);

/// Returns the current time, "2026-01-31T12:00:00.000Z".
[[nodiscard]] std::string nowText();

}  // namespace haptolith
