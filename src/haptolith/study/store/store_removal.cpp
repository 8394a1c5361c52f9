// Removal of participants. No other process has the file open meanwhile. The request is stored first, so that an
// interrupted removal is completed when the study is opened the next time.

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <sqlite3.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/study/store/participant_code.h"
#include "haptolith/study/store/store.h"
#include "haptolith/study/store/store_file.h"
#include "haptolith/study/store/store_implementation.h"
#include "haptolith/study/store/study_files.h"
#include "haptolith/study/store/study_sql.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr auto kPatience = 2s;  // for a program that reads the file briefly
constexpr auto kPause = 20ms;

/// Exclusive access without write-ahead log. SQLite permits leaving the write-ahead log only to the single process that
/// has the file open. There is then no log, and no reader that needs the deleted rows. The destructor restores both.
class Alone {
 public:
  /// @param otherwise  state of the removal while another program has the file open, for a message.
  Alone(SQLite::Database& database, const fs::path& file, std::string_view otherwise) : database_(database) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (!isAlone()) {
      if (std::chrono::steady_clock::now() > deadline) {
        goBack();
        throw Failure(
            fmt::format("{} is open in another program, which could keep the data to be deleted; {}: close that "
                        "program (a database browser, `haptolith study status` or `export`), then continue",
                        file.string(), otherwise));
      }
      std::this_thread::sleep_for(kPause);
    }
  }
  ~Alone() { goBack(); }
  Alone(const Alone&) = delete;
  Alone& operator=(const Alone&) = delete;

 private:
  bool isAlone() {
    try {
      database_.exec("PRAGMA locking_mode = NORMAL");
      if (database_.execAndGet("PRAGMA journal_mode = DELETE").getString() != "delete") {
        return false;
      }
      database_.exec("PRAGMA locking_mode = EXCLUSIVE; BEGIN EXCLUSIVE; COMMIT");
      return true;
    } catch (const SQLite::Exception& error) {
      if (error.getErrorCode() != SQLITE_BUSY && error.getErrorCode() != SQLITE_LOCKED) {
        throw;
      }
      return false;
    }
  }

  void goBack() noexcept {
    try {
      // The lock is released at the next reading.
      database_.exec("PRAGMA locking_mode = NORMAL; SELECT count(*) FROM study; PRAGMA journal_mode = WAL");
    } catch (const SQLite::Exception&) {  // NOLINT(bugprone-empty-catch): done at the next run of the study
    }
  }

  SQLite::Database& database_;
};

constexpr std::string_view kEverythingWord = "everything", kPersonalWord = "personal";

Removed removedOf(std::string_view word) {
  return word == kEverythingWord ? Removed::kEverything : Removed::kPersonal;
}

std::string codeOf(SQLite::Database& database, std::int64_t participant) {
  SQLite::Statement query = prepared(database, "SELECT code FROM participant WHERE id = ?", participant);
  query.executeStep();
  return query.getColumn(0).getString();
}

std::vector<std::string> recordedTrials(SQLite::Database& database, std::int64_t participant) {
  std::vector<std::string> names;
  SQLite::Statement query =
      prepared(database, "SELECT recording FROM trial WHERE participant = ? AND recording <> ''", participant);
  while (query.executeStep()) {
    names.push_back(query.getColumn(0).getString());
  }
  return names;
}

/// Incomplete removal of a participant, or of their personal answers.
struct Pending {
  std::int64_t id = 0, participant = 0;
  Removed what = Removed::kEverything;
  bool keeps_recordings = false;
  std::string code = {};  ///< empty: the rows are already deleted
};

std::vector<Pending> pendingRemovals(SQLite::Database& database) {
  std::vector<Pending> pending;
  SQLite::Statement query(database,
                          "SELECT removal.id, removal.participant, what, keeps_recordings, coalesce(code, '') "
                          "FROM removal LEFT JOIN participant ON participant.id = removal.participant "
                          "WHERE done_at = '' ORDER BY removal.id");
  while (query.executeStep()) {
    pending.push_back({.id = query.getColumn(0).getInt64(),
                       .participant = query.getColumn(1).getInt64(),
                       .what = removedOf(query.getColumn(2).getString()),
                       .keeps_recordings = query.getColumn(3).getInt() != 0,
                       .code = query.getColumn(4).getString()});
  }
  return pending;
}

/// Removes the code from notes and reasons of others.
void dropCode(SQLite::Database& database, std::string_view code) {
  for (const auto& [table, column] :
       {std::pair("note", "text"), std::pair("trial", "reason"), std::pair("exclusion", "reason")}) {
    std::vector<std::pair<std::int64_t, std::string>> named;
    SQLite::Statement query(database, fmt::format("SELECT id, {} FROM {}", column, table));
    while (query.executeStep()) {
      if (std::string text = query.getColumn(1).getString(); namesCode(text, code)) {
        named.emplace_back(query.getColumn(0).getInt64(), std::move(text));
      }
    }
    for (const auto& [id, text] : named) {
      execute(database, fmt::format("UPDATE {} SET {} = ? WHERE id = ?", table, column),
              std::string_view(withoutCode(text, code)), id);
    }
  }
}

void removeRows(SQLite::Database& database, const Pending& pending) {
  SQLite::Transaction transaction(database, SQLite::TransactionBehavior::IMMEDIATE);
  if (pending.what == Removed::kEverything) {
    execute(database, "DELETE FROM participant WHERE id = ?", pending.participant);
    dropCode(database, pending.code);
  } else {
    execute(database, "DELETE FROM personal_answer WHERE participant = ?", pending.participant);
  }
  transaction.commit();
}

/// Completes a removal. Recordings are deleted first, because the rows contain their names. VACUUM rewrites the
/// complete file, and so removes remains of moved rows from its pages.
void finish(SQLite::Database& database, const fs::path& study, const Pending& pending) {
  if (!pending.code.empty()) {
    if (pending.what == Removed::kEverything && !pending.keeps_recordings) {
      deleteFiles(recordingsOf(study, pending.code, recordedTrials(database, pending.participant)));
    }
    removeRows(database, pending);
  }
  database.exec("PRAGMA temp_store = MEMORY; VACUUM");
  execute(database,
          "UPDATE removal SET done_at = ?, participant = iif(what = 'everything', NULL, participant) "
          "WHERE id = ?",
          std::string_view(nowText()), pending.id);
}

constexpr std::string_view kNotAtItsEnd =
    "a removal is not completed; the next `haptolith study forget`, `run` or `resume` completes about";

void finishAll(SQLite::Database& database, const fs::path& study) {
  for (const Pending& pending : pendingRemovals(database)) {
    try {
      finish(database, study, pending);
    } catch (const Failure& failure) {
      throw Failure(fmt::format("{}; {}", failure.what(), kNotAtItsEnd));
    }
  }
}

}  // namespace

void StudyStore::Implementation::finishRemovals() {
  if (!pendingRemovals(*database).empty()) {
    const Alone alone(*database, file, kNotAtItsEnd);
    finishAll(*database, file);
  }
}

void StudyStore::Implementation::remove(std::int64_t participant, Removed what, std::string_view reason,
                                        Recordings recordings) {
  requireRun();
  tellWhatIsWrong(file, [&] {
    const Alone alone(*database, file, "nothing has been deleted");
    requireParticipant(participant);
    const std::string code = codeOf(*database, participant);
    execute(*database,
            "INSERT INTO removal (participant, what, reason, keeps_recordings, code_hash, at) "
            "VALUES (?, ?, ?, ?, ?, ?)",
            participant, what == Removed::kEverything ? kEverythingWord : kPersonalWord,
            std::string_view(withoutCode(reason, code)), recordings == Recordings::kKeep,
            std::string_view(what == Removed::kEverything ? hashOfCode(code) : ""), std::string_view(nowText()));
    finishAll(*database, file);
  });
}

int StudyStore::forgetPersonal(std::int64_t participant, std::string_view reason) {
  const auto answers = [&] {
    SQLite::Statement query =
        prepared(*implementation_->database, "SELECT count(*) FROM personal_answer WHERE participant = ?", participant);
    query.executeStep();
    return query.getColumn(0).getInt();
  };
  const int count = implementation_->read(answers);
  implementation_->remove(participant, Removed::kPersonal, reason, Recordings::kKeep);
  return count;
}

void StudyStore::removeParticipant(std::int64_t participant, std::string_view reason, Recordings recordings) {
  implementation_->remove(participant, Removed::kEverything, reason, recordings);
}

std::vector<RemovalRow> StudyStore::removals() const {
  return implementation_->read([&] {
    std::vector<RemovalRow> rows;
    SQLite::Statement query(*implementation_->database, "SELECT what, reason, at, done_at FROM removal ORDER BY id");
    while (query.executeStep()) {
      rows.push_back({.what = removedOf(query.getColumn(0).getString()),
                      .reason = query.getColumn(1).getString(),
                      .at = query.getColumn(2).getString(),
                      .done_at = query.getColumn(3).getString()});
    }
    return rows;
  });
}

std::string StudyStore::removedAt(std::string_view code) const {
  return implementation_->read([&] {
    SQLite::Statement query(*implementation_->database,
                            "SELECT code_hash, done_at FROM removal WHERE code_hash <> '' AND done_at <> ''");
    while (query.executeStep()) {
      if (isHashOfCode(query.getColumn(0).getString(), code)) {
        return query.getColumn(1).getString();
      }
    }
    return std::string();
  });
}

}  // namespace haptolith
