#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "haptolith/study/protocol/protocol.h"

namespace haptolith {

// The file of a study: an SQLite database with write-ahead log. All functions throw Failure and SQLite::Exception.

/// Opened for reading, also where nothing may be written.
[[nodiscard]] SQLite::Database openToRead(const std::filesystem::path& file);
/// Opened for reading and writing. @throws Failure for one that is read-only.
[[nodiscard]] SQLite::Database openToRun(const std::filesystem::path& file);

/// @throws Failure when this database is no study, is damaged, or was made by another version.
void requireStudy(SQLite::Database& database, const std::filesystem::path& file);
void requireWhole(SQLite::Database& database, const std::filesystem::path& file);
void requireVersion(SQLite::Database& database, const std::filesystem::path& file);
/// SQLite keeps what it has just written beside the name by which the file was opened, and so lies the lock: by another
/// name the same study would lack answers, and could be run twice. @throws Failure for a file with several names.
void requireOneName(const std::filesystem::path& file);

/// Makes the tables of a new study in an empty file.
void writeNewStudy(const std::filesystem::path& file, const StudyProtocol& protocol, std::string_view protocol_text,
                   std::uint64_t seed);
/// Removes a database and the files that SQLite keeps beside it.
void removeWithCompanions(const std::filesystem::path& file);

/// The time now, "2026-01-31T12:00:00.000Z".
[[nodiscard]] std::string nowText();

}  // namespace haptolith
