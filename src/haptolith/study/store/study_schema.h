#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

namespace haptolith {

/// "HLST" in the file's header, by which `file` and other programs identify a study.
inline constexpr std::int32_t kStudyApplicationId = 0x484C5354;

/// Returns the SQL that changes version n of a study's file to version n + 1; version 0 is an empty file. Append-only.
[[nodiscard]] std::span<const char* const> studyMigrations();

/// Migrates a study's file to the newest version, completely or not at all.
/// @throws Failure for a version that is newer than these migrations.
void migrate(SQLite::Database& database, std::span<const char* const> migrations);

/// Returns PRAGMA user_version. @throws SQLite::Exception.
[[nodiscard]] int versionOf(SQLite::Database& database);

/// Runs `work` on a study's file; converts exceptions of SQLite to a Failure with cause and remedy.
void tellWhatIsWrong(const std::filesystem::path& file, const std::function<void()>& work);

}  // namespace haptolith
