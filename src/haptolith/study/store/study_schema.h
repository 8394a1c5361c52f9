#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

namespace haptolith {

/// "HLST" in the file's header: `file` and other programs tell a study by it.
inline constexpr std::int32_t kStudyApplicationId = 0x484C5354;

/// SQL that makes version n + 1 of a study's file out of version n; version 0 is an empty file. Only ever added to.
[[nodiscard]] std::span<const char* const> studyMigrations();

/// Brings a study's file to the newest version, whole or not at all.
/// @throws Failure for a version that is newer than these migrations know.
void migrate(SQLite::Database& database, std::span<const char* const> migrations);

/// PRAGMA user_version. @throws SQLite::Exception.
[[nodiscard]] int versionOf(SQLite::Database& database);

/// Runs `work` on a study's file; what SQLite throws becomes a Failure that says what is wrong and what to do.
void tellWhatIsWrong(const std::filesystem::path& file, const std::function<void()>& work);

}  // namespace haptolith
