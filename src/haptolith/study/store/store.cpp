#include "haptolith/study/store/store.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/core/platform/files.h"
#include "haptolith/study/protocol/form.h"
#include "haptolith/study/store/participant_code.h"
#include "haptolith/study/store/store_file.h"
#include "haptolith/study/store/store_implementation.h"
#include "haptolith/study/store/study_schema.h"
#include "haptolith/study/store/study_sql.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kLargestSeed =
    (std::uint64_t{1} << 53) - 1;  // JSON and other programs' tables store it exactly

// --- rows
// -------------------------------------------------------------------------------------------------------------

constexpr std::array<std::string_view, 3> kParticipantStates{"running", "finished", "withdrawn"};

ParticipantRow participantOf(const SQLite::Statement& row) {
  ParticipantRow participant{.id = row.getColumn(0).getInt64(),
                             .number = row.getColumn(1).getInt(),
                             .code = row.getColumn(2).getString(),
                             .state = row.getColumn(3).getString(),
                             .begun_at = row.getColumn(4).getString(),
                             .ended_at = row.getColumn(5).getString(),
                             .excluded_for = row.getColumn(6).getString()};
  if (!row.getColumn(7).isNull()) {
    participant.assignment = Assignment{.group = row.getColumn(7).getString(),
                                        .stratum = row.getColumn(8).getUInt(),
                                        .place = row.getColumn(9).getInt(),
                                        .row = row.getColumn(10).getInt()};
  }
  if (!isCode(participant.code)) {
    throwForeign("code", participant.code, kValidCode);
  }
  if (std::ranges::find(kParticipantStates, participant.state) == kParticipantStates.end()) {
    throwForeign("state", participant.state, "running, finished or withdrawn");
  }
  return participant;
}

constexpr const char* kParticipants =
    "SELECT id, number, code, state, begun_at, ended_at, "
    "coalesce((SELECT iif(excluded, reason, '') FROM exclusion WHERE exclusion.participant = participant.id "
    "ORDER BY exclusion.id DESC LIMIT 1), ''), group_name, stratum, place, block_row "
    "FROM participant LEFT JOIN assignment ON assignment.participant = participant.id";

/// Returns the maximum "number" of all participants, or the maximum in a "code", including removed participants.
int largestEver(SQLite::Database& database, std::string_view what) {
  return database.execAndGet(fmt::format("SELECT largest_{} FROM study", what)).getInt();
}

}  // namespace

std::string_view standingOf(const ParticipantRow& participant) {
  return participant.excluded_for.empty() ? std::string_view(participant.state) : "excluded";
}

bool isLeftOut(const ParticipantRow& participant) {
  return participant.state == "withdrawn" || !participant.excluded_for.empty();
}

// --- the store
// --------------------------------------------------------------------------------------------------------

StudyStore::Implementation::Implementation(const fs::path& path, Access access) : file(path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) {
    throw InvalidParameter("study", fmt::format("'{}'", path.string()),
                           "a study file made by `haptolith study new`; there is no such file");
  }
  if (access == Access::kRun) {
    requireOneName(path);
    lock.emplace(fs::canonical(path));  // canonical, because a file with another name is still the same study
  }
  tellWhatIsWrong(file, [&] { openDatabase(access); });
}

void StudyStore::Implementation::openDatabase(Access access) {
  database.emplace(access == Access::kRun ? openToRun(file) : openToRead(file));
  requireStudy(*database, file);
  requireWhole(*database, file);
  if (access == Access::kRun) {
    migrate(*database, studyMigrations());
    database->exec("PRAGMA journal_mode = WAL");
    finishRemovals();
  }
  requireVersion(*database, file);
  SQLite::Statement row(*database, "SELECT protocol, scene, seed, created_at FROM study");
  if (!row.executeStep()) {
    throw Failure(fmt::format("{} is damaged: it has no protocol", file.string()));
  }
  protocol_text = row.getColumn(0).getString();
  seed = static_cast<std::uint64_t>(row.getColumn(2).getInt64());
  created_at = row.getColumn(3).getString();
  const SceneFile scene = loadSceneFileText(row.getColumn(1).getString(), file.string() + " (scene)");
  protocol = loadProtocolText(protocol_text, file.string() + " (protocol)", &scene);
  title = protocol.title;
}

void StudyStore::Implementation::requireParticipant(std::int64_t id) {
  if (!prepared(*database, "SELECT 1 FROM participant WHERE id = ?", id).executeStep()) {
    throw Failure(fmt::format("{} has no participant with the id {}", file.string(), id));
  }
}

void StudyStore::create(const fs::path& file, const StudyProtocol& protocol, std::string_view protocol_text,
                        std::uint64_t seed) {
  if (seed > kLargestSeed) {
    throw InvalidParameter("seed", fmt::format("{}", seed), fmt::format("0 to {}", kLargestSeed));
  }
  if (fs::exists(fs::symlink_status(file))) {
    throw Failure(fmt::format("{} already exists: studies are never overwritten; choose another name", file.string()));
  }
  constexpr std::size_t kLongestStudyName_bytes = kLongestName_bytes - std::string_view("-recordings").size();
  if (const std::size_t bytes = file.filename().string().size(); bytes > kLongestStudyName_bytes) {
    throw InvalidParameter(
        "file", file.string(),
        fmt::format(
            "a name of at most {} bytes without its folder, not {}: other files of the study add an ending to it",
            kLongestStudyName_bytes, bytes));
  }
  // Only the owner may read the answers; SQLite's companion files get the permissions of this file.
  const fs::path made = temporaryBeside(file, "part", kLongestStudyName_bytes);
  const int descriptor = makeNewFile(made, Readers::kOwner);
  if (descriptor < 0) {
    throw Failure(fmt::format("cannot create {}: {}", file.string(), std::strerror(errno)));
  }
  closeFile(descriptor);
  try {
    tellWhatIsWrong(file, [&] { writeNewStudy(made, protocol, protocol_text, seed); });
    giveName(made, file, IfThere::kRefuse);
  } catch (...) {
    removeWithCompanions(made);
    throw;
  }
}

StudyStore::StudyStore(const fs::path& file, Access access)
    : implementation_(std::make_unique<Implementation>(file, access)) {}
StudyStore::~StudyStore() = default;
StudyStore::StudyStore(StudyStore&&) noexcept = default;
StudyStore& StudyStore::operator=(StudyStore&&) noexcept = default;

const fs::path& StudyStore::file() const noexcept {
  return implementation_->file;
}
const StudyProtocol& StudyStore::protocol() const noexcept {
  return implementation_->protocol;
}
const std::string& StudyStore::protocolText() const noexcept {
  return implementation_->protocol_text;
}
std::uint64_t StudyStore::seed() const noexcept {
  return implementation_->seed;
}
const std::string& StudyStore::title() const noexcept {
  return implementation_->title;
}
const std::string& StudyStore::createdAt() const noexcept {
  return implementation_->created_at;
}

// --- participants
// -----------------------------------------------------------------------------------------------------

std::vector<ParticipantRow> StudyStore::participants() const {
  return implementation_->read([&] {
    std::vector<ParticipantRow> rows;
    SQLite::Statement query(*implementation_->database, fmt::format("{} ORDER BY number", kParticipants));
    while (query.executeStep()) {
      rows.push_back(participantOf(query));
    }
    return rows;
  });
}

ParticipantRow StudyStore::addParticipant(std::string_view code) {
  if (!code.empty() && !isCode(code)) {
    throw InvalidParameter("participant", inQuotes(code), kValidCode);
  }
  SQLite::Database& database = *implementation_->database;
  const auto taken = [&](std::string_view name) {
    return prepared(database, "SELECT 1 FROM participant WHERE code = ?", name).executeStep();
  };
  return implementation_->write([&] {
    std::vector<int> kept;
    int last = largestEver(database, "number");
    for (const ParticipantRow& row : this->participants()) {
      last = std::max(last, row.number);
      if (!isLeftOut(row)) {
        kept.push_back(row.number);
      }
    }
    const int number = nextNumber(protocol(), kept, last);
    std::string name(code);
    int in_code = numberInCode(code);
    if (code.empty()) {
      in_code = largestEver(database, "code");
      do {
        name = fmt::format("S{:02}", ++in_code);
      } while (taken(name));
    } else if (taken(name)) {
      throw InvalidParameter("participant", inQuotes(name), "an unused code");
    } else if (!removedAt(name).empty()) {
      throw InvalidParameter("participant", inQuotes(name),
                             "an unused code; this one belonged to a participant who was removed");
    }
    execute(database, "UPDATE study SET largest_number = ?, largest_code = max(largest_code, ?)", number, in_code);
    const std::string now = nowText();
    execute(database, "INSERT INTO participant (number, code, state, begun_at) VALUES (?, ?, 'running', ?)", number,
            std::string_view(name), std::string_view(now));
    return ParticipantRow{.id = database.getLastInsertRowid(),
                          .number = number,
                          .code = name,
                          .state = "running",
                          .begun_at = now,
                          .ended_at = "",
                          .excluded_for = "",
                          .assignment = std::nullopt};
  });
}

void StudyStore::endParticipant(std::int64_t id, std::string_view state) {
  if (std::ranges::find(kParticipantStates, state) == kParticipantStates.end()) {
    throw InvalidParameter("state", fmt::format("'{}'", state), "running, finished or withdrawn");
  }
  implementation_->write([&] {
    implementation_->requireParticipant(id);
    return execute(*implementation_->database, "UPDATE participant SET state = ?, ended_at = ? WHERE id = ?", state,
                   std::string_view(state == "running" ? "" : nowText()), id);
  });
}

void StudyStore::markStep(std::int64_t participant, std::string_view step) {
  implementation_->write([&] {
    implementation_->requireParticipant(participant);
    return execute(*implementation_->database,
                   "INSERT INTO step (participant, step, at) VALUES (?, ?, ?) ON CONFLICT DO NOTHING", participant,
                   step, std::string_view(nowText()));
  });
}

std::set<std::string> StudyStore::steps(std::int64_t participant) const {
  return implementation_->read([&] {
    std::set<std::string> steps;
    SQLite::Statement query =
        prepared(*implementation_->database, "SELECT step FROM step WHERE participant = ?", participant);
    while (query.executeStep()) {
      steps.insert(query.getColumn(0).getString());
    }
    return steps;
  });
}

void StudyStore::setAnswers(std::int64_t participant, std::string_view form, const std::vector<FormItem>& items,
                            const std::map<std::string, std::string>& values) {
  requireFormValues(items, values);
  SQLite::Database& database = *implementation_->database;
  implementation_->write([&] {
    implementation_->requireParticipant(participant);
    for (const char* table : {"form_answer", "personal_answer"}) {
      execute(database, fmt::format("DELETE FROM {} WHERE participant = ? AND form = ?", table), participant, form);
    }
    int written = 0;
    for (const FormItem& item : items) {
      const auto value = values.find(item.key);
      if (value != values.end() && !value->second.empty()) {
        written += execute(database,
                           fmt::format("INSERT INTO {} (participant, form, key, value, at) VALUES (?, ?, ?, ?, ?)",
                                       item.personal ? "personal_answer" : "form_answer"),
                           participant, form, std::string_view(item.key), std::string_view(value->second),
                           std::string_view(nowText()));
      }
    }
    return written;
  });
}

std::vector<FormAnswerRow> StudyStore::formAnswers(bool personal) const {
  return implementation_->read([&] {
    std::vector<FormAnswerRow> rows;
    for (const bool of_personal : {false, true}) {
      if (of_personal && !personal) {
        break;
      }
      SQLite::Statement query(
          *implementation_->database,
          fmt::format("SELECT participant, form, key, value FROM {} ORDER BY participant, form, rowid",
                      of_personal ? "personal_answer" : "form_answer"));
      while (query.executeStep()) {
        rows.push_back({.participant = query.getColumn(0).getInt64(),
                        .form = query.getColumn(1).getString(),
                        .key = query.getColumn(2).getString(),
                        .value = query.getColumn(3).getString(),
                        .personal = of_personal});
      }
    }
    return rows;
  });
}

// --- notes
// ------------------------------------------------------------------------------------------------------------

void StudyStore::addNote(std::int64_t participant, std::string_view text, std::string_view kind) {
  implementation_->write([&] {
    const std::optional<std::int64_t> whose = participant == 0 ? std::nullopt : std::optional(participant);
    return execute(*implementation_->database, "INSERT INTO note (participant, at, kind, text) VALUES (?, ?, ?, ?)",
                   whose, std::string_view(nowText()), kind, text);
  });
}

std::vector<NoteRow> StudyStore::notes() const {
  return implementation_->read([&] {
    std::vector<NoteRow> rows;
    SQLite::Statement query(*implementation_->database, "SELECT id, participant, at, kind, text FROM note ORDER BY id");
    while (query.executeStep()) {
      rows.push_back({.id = query.getColumn(0).getInt64(),
                      .participant = query.getColumn(1).getInt64(),
                      .at = query.getColumn(2).getString(),
                      .kind = query.getColumn(3).getString(),
                      .text = query.getColumn(4).getString()});
    }
    return rows;
  });
}

}  // namespace haptolith
