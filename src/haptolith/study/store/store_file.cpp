#include "haptolith/study/store/store_file.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sqlite3.h>

#include <cctype>
#include <chrono>
#include <system_error>

#include "haptolith/core/error.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/study/store/study_schema.h"
#include "haptolith/study/store/study_sql.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;

constexpr int kBusyTimeout_ms = 2000;  // longer than another program's commit, shorter than a participant's patience

/// Returns a URI for a file that is not written by any process, in a read-only folder.
std::string immutableUri(const fs::path& file) {
  std::string uri = "file:";
  for (const char letter : fs::absolute(file).string()) {
    const bool plain = std::isalnum(static_cast<unsigned char>(letter)) != 0 ||
                       std::string_view("/-_.~").find(letter) != std::string_view::npos;
    uri += plain ? std::string(1, letter) : fmt::format("%{:02X}", static_cast<unsigned char>(letter));
  }
  return uri + "?immutable=1";
}

bool isEmptyOrMissing(const fs::path& file) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  return error || size == 0;
}

}  // namespace

SQLite::Database openToRead(const fs::path& file) {
  // Opened for writing if permitted, so that the last process to close the file removes -wal and -shm.
  SQLite::Database database(file.string(), SQLite::OPEN_READWRITE, kBusyTimeout_ms);
  try {
    database.exec("PRAGMA query_only = ON");
    (void)versionOf(database);
    return database;
  } catch (const SQLite::Exception& error) {
    const bool cannot_write = error.getErrorCode() == SQLITE_CANTOPEN || error.getErrorCode() == SQLITE_READONLY;
    if (!cannot_write || !isEmptyOrMissing(file.string() + "-wal")) {
      throw;
    }
  }
  return {immutableUri(file), SQLite::OPEN_READONLY | SQLite::OPEN_URI};
}

SQLite::Database openToRun(const fs::path& file) {
  SQLite::Database database(file.string(), SQLite::OPEN_READWRITE, kBusyTimeout_ms);
  (void)versionOf(database);
  if (sqlite3_db_readonly(database.getHandle(), "main") != 0) {
    throw Failure(fmt::format("cannot run {}: it is read-only; allow writing (`chmod u+w`) or copy it", file.string()));
  }
  database.exec("PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON; PRAGMA secure_delete = ON");
  return database;
}

void requireStudy(SQLite::Database& database, const fs::path& file) {
  if (database.execAndGet("PRAGMA application_id").getInt() != kStudyApplicationId) {
    throw Failure(fmt::format("{} is not a study: must be a file made by `haptolith study new`", file.string()));
  }
}

void requireWhole(SQLite::Database& database, const fs::path& file) {
  const std::string found = database.execAndGet("PRAGMA integrity_check(1)").getString();
  if (found != "ok") {
    throw Failure(
        fmt::format("{} is damaged ({}): continue with a backup; `sqlite3 FILE .recover` saves the readable part",
                    file.string(), found));
  }
}

void requireOneName(const fs::path& file) {
  if (const std::uintmax_t names = fs::hard_link_count(file); names > 1) {
    throw Failure(
        fmt::format("cannot run {}: the file has {} names (hard links), which can lose responses; remove the other "
                    "names, or copy the file",
                    file.string(), names));
  }
}

void requireVersion(SQLite::Database& database, const fs::path& file) {
  const int newest = static_cast<int>(studyMigrations().size());
  if (const int version = versionOf(database); version != newest) {
    throw Failure(fmt::format("{} was made by {} version of haptolith (its tables are version {}, not {}){}",
                              file.string(), version > newest ? "a newer" : "an older", version, newest,
                              version > newest ? ": use that one" : ": `haptolith study resume` brings it up to date"));
  }
}

void removeWithCompanions(const fs::path& file) {
  std::error_code ignored;
  for (const char* ending : {"", "-wal", "-shm", "-journal"}) {
    fs::remove(file.string() + ending, ignored);
  }
}

void writeNewStudy(const fs::path& file, const StudyProtocol& protocol, std::string_view protocol_text,
                   std::uint64_t seed) {
  SQLite::Database database(file.string(), SQLite::OPEN_READWRITE, kBusyTimeout_ms);
  database.exec(fmt::format("PRAGMA synchronous = FULL; PRAGMA application_id = {}", kStudyApplicationId));
  database.exec("PRAGMA journal_mode = WAL");
  migrate(database, studyMigrations());
  execute(database, "INSERT INTO study (id, title, protocol, scene, seed, created_at) VALUES (1, ?, ?, ?, ?, ?)",
          std::string_view(protocol.title), protocol_text, std::string_view(sceneFileText(protocol.scene)),
          static_cast<std::int64_t>(seed), std::string_view(nowText()));
}

std::string nowText() {
  const auto now = std::chrono::floor<std::chrono::milliseconds>(std::chrono::system_clock::now());
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(std::chrono::system_clock::to_time_t(now)),
                     now.time_since_epoch().count() % 1000);
}

}  // namespace haptolith
