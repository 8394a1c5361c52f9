#pragma once

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "haptolith/core/error.h"
#include "haptolith/study/protocol/protocol.h"
#include "haptolith/study/store/runner_lock.h"
#include "haptolith/study/store/store.h"
#include "haptolith/study/store/study_schema.h"

namespace haptolith {

/// Open file of a study, common to the sources of the store.
class StudyStore::Implementation {
 public:
  Implementation(const std::filesystem::path& path, Access access);

  /// Runs `work` in a transaction: either everything is written or nothing.
  template <class Work>
  auto write(Work work) {
    requireRun();
    std::invoke_result_t<Work> result{};
    tellWhatIsWrong(file, [&] {
      SQLite::Transaction transaction(*database, SQLite::TransactionBehavior::IMMEDIATE);
      result = work();
      transaction.commit();
    });
    return result;
  }

  template <class Work>
  auto read(Work work) {
    std::invoke_result_t<Work> result{};
    tellWhatIsWrong(file, [&] { result = work(); });
    return result;
  }

  /// @throws Failure if the file has been opened with kRead.
  void requireRun() const {
    if (!lock) {
      throw Failure(fmt::format("{} has been opened to be read only", file.string()));
    }
  }
  [[nodiscard]] TrialState stateOf(std::int64_t trial);
  void requireParticipant(std::int64_t id);

  // store_removal.cpp:
  /// Completes all interrupted removals.
  void finishRemovals();
  void remove(std::int64_t participant, Removed what, std::string_view reason, Recordings recordings);

  std::filesystem::path file;
  std::optional<RunnerLock> lock;  // destroyed last
  std::optional<SQLite::Database> database;
  std::string title, protocol_text, created_at;
  std::uint64_t seed = 0;
  StudyProtocol protocol;

 private:
  void openDatabase(Access access);
};

}  // namespace haptolith
