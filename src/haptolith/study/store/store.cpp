#include "haptolith/study/store/store.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sqlite3.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstring>
#include <system_error>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/plain_text.h"
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
    (std::uint64_t{1} << 53) - 1;  // what JSON and other programs' tables keep exactly

constexpr std::array kKindWords{
    std::pair{TrialKind::kPractice, std::string_view("practice")},
    std::pair{TrialKind::kMain, std::string_view("main")},
    std::pair{TrialKind::kCatch, std::string_view("catch")},
};

constexpr std::array kStateWords{
    std::pair{TrialState::kBegun, std::string_view("begun")},
    std::pair{TrialState::kAnswered, std::string_view("answered")},
    std::pair{TrialState::kRepeated, std::string_view("repeated")},
    std::pair{TrialState::kLost, std::string_view("lost")},
};

constexpr std::array kSummaryColumns{
    SummaryColumn{"duration_s", "s", "How long the stimulus was felt.", &TrialSummary::duration_s},
    SummaryColumn{"path_m", "m", "Length of the tool's path.", &TrialSummary::path_m},
    SummaryColumn{"peak_speed_m_s", "m/s", "Largest speed of the tool.", &TrialSummary::peak_speed_m_s},
    SummaryColumn{"mean_speed_m_s", "m/s", "Mean speed of the tool.", &TrialSummary::mean_speed_m_s},
    SummaryColumn{"peak_force_n", "N", "Largest force on the hand.", &TrialSummary::peak_force_n},
    SummaryColumn{"mean_force_n", "N", "Mean force on the hand.", &TrialSummary::mean_force_n},
    SummaryColumn{"force_sd_n", "N", "Standard deviation of the force on the hand.", &TrialSummary::force_sd_n},
    SummaryColumn{"peak_torque_nm", "N m", "Largest torque on the hand.", &TrialSummary::peak_torque_nm},
    SummaryColumn{"work_j", "J", "Work that the hand did on the soil.", &TrialSummary::work_j},
};

constexpr std::array kTeleopColumns{
    TeleopColumn{"done", "",
                 "Whether it was seen to be done at the robot's site: 1, or 0 when the time was over before.",
                 &TeleopSummary::done},
    TeleopColumn{"time_s", "s", "Task time: until it was seen to be done, or the time was over.",
                 &TeleopSummary::time_s},
    TeleopColumn{"follows_s", "s", "Of that, until the robot was first heard to follow the hand; missing: never.",
                 &TeleopSummary::follows_s},
    TeleopColumn{"reached", "",
                 "What was seen to be reached: a trench's depth in m, or the force of a press or a load in N.",
                 &TeleopSummary::reached},
    TeleopColumn{"force_error", "",
                 "RMS of force felt less force met at the same command, over RMS of force met, in windows of 0.2 s.",
                 &TeleopSummary::force_error},
    TeleopColumn{"met_rms_n", "N", "RMS of the force on the robot's tool, in such windows.", &TeleopSummary::met_rms_n},
    TeleopColumn{"met_peak_n", "N", "Largest force on the robot's tool, in such windows.", &TeleopSummary::met_peak_n},
    TeleopColumn{"stops", "", "How often the robot was heard to stop by itself.", &TeleopSummary::stops},
    TeleopColumn{"friction_angle_deg", "deg", "Friction angle of the soil that the model has learned.",
                 &TeleopSummary::friction_angle_deg},
    TeleopColumn{"cohesion_pa", "Pa", "Its cohesion.", &TeleopSummary::cohesion_pa},
    TeleopColumn{"tool_friction_angle_deg", "deg", "Its friction angle on the tool.",
                 &TeleopSummary::tool_friction_angle_deg},
};

template <class Words, class Value>
std::string_view wordIn(const Words& words, Value value) {
  return std::ranges::find(words, value, [](const auto& entry) { return entry.first; })->second;
}

/// Somebody may have changed the file with another program. tellWhatIsWrong() adds the file's name, as to what SQLite
/// throws.
[[noreturn]] void throwForeign(std::string_view column, std::string_view value, std::string_view valid) {
  throw SQLite::Exception(
      fmt::format("it holds what haptolith does not write: {} = {}; must be {}", column, inQuotes(value), valid));
}

template <class Words>
auto valueIn(const Words& words, std::string_view column, std::string_view word) {
  const auto found = std::ranges::find(words, word, [](const auto& entry) { return entry.second; });
  if (found == words.end()) {
    std::vector<std::string_view> valid;
    std::ranges::transform(words, std::back_inserter(valid), [](const auto& entry) { return entry.second; });
    throwForeign(column, word, fmt::format("one of {}", fmt::join(valid, ", ")));
  }
  return found->first;
}

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

/// The columns of trial, answer, and twice felt, in the order in which trialOf() takes them.
std::string selectTrials() {
  std::string sql =
      "SELECT trial.id, participant, block, position, trial.trial, attempt, kind, block_name, level, reference, value, "
      "reference_value, test_first, seed, state, recording, reason, begun_at, answered_at, answer.trial, positive, "
      "correct, reaction_s, timed_out";
  for (const char* interval : {"first", "second"}) {
    for (const SummaryColumn& column : kSummaryColumns) {
      sql += fmt::format(", {}.{}", interval, column.name);
    }
    sql += fmt::format(", {}.deadline_misses", interval);
  }
  sql += ", teleop.trial";
  for (const TeleopColumn& column : kTeleopColumns) {
    sql += fmt::format(", teleop.{}", column.name);
  }
  return sql +
         " FROM trial LEFT JOIN answer ON answer.trial = trial.id"
         " LEFT JOIN felt AS first ON first.trial = answer.trial AND first.interval = 1"
         " LEFT JOIN felt AS second ON second.trial = answer.trial AND second.interval = 2"
         " LEFT JOIN teleop ON teleop.trial = answer.trial";
}

/// The columns of a row, one after the other.
class Columns {
 public:
  explicit Columns(SQLite::Statement& row) : row_(row) {}
  SQLite::Column next() { return row_.getColumn(at_++); }

 private:
  SQLite::Statement& row_;
  int at_ = 0;
};

TrialSummary summaryOf(Columns& columns) {
  TrialSummary summary;
  for (const SummaryColumn& column : kSummaryColumns) {
    summary.*column.value = numberOrNan(columns.next());
  }
  summary.deadline_misses = columns.next().getInt();
  return summary;
}

std::optional<TrialAnswer> answerOf(Columns& columns) {
  if (columns.next().isNull()) {
    return std::nullopt;
  }
  TrialAnswer answer;
  answer.positive = columns.next().getInt() != 0;
  const SQLite::Column correct = columns.next();
  answer.correct = correct.isNull() ? std::nullopt : std::optional(correct.getInt() != 0);
  answer.reaction_s = numberOrNan(columns.next());
  answer.timed_out = columns.next().getInt() != 0;
  answer.felt = {summaryOf(columns), summaryOf(columns)};
  if (!columns.next().isNull()) {
    answer.teleop.emplace();
    for (const TeleopColumn& column : kTeleopColumns) {
      (*answer.teleop).*column.value = numberOrNan(columns.next());
    }
  }
  return answer;
}

TrialRow trialOf(SQLite::Statement& statement) {
  Columns columns(statement);
  TrialRow row;
  row.id = columns.next().getInt64();
  row.participant = columns.next().getInt64();
  row.block = columns.next().getUInt();
  row.position = columns.next().getUInt();
  row.index = columns.next().getInt();
  row.attempt = columns.next().getInt();
  row.kind = valueIn(kKindWords, "kind", columns.next().getString());
  row.block_name = columns.next().getString();
  row.level = columns.next().getString();
  row.reference = columns.next().getString();
  row.value = columns.next().getDouble();
  row.reference_value = columns.next().getDouble();
  row.test_first = columns.next().getInt() != 0;
  row.seed = static_cast<std::uint64_t>(columns.next().getInt64());
  row.state = valueIn(kStateWords, "state", columns.next().getString());
  row.recording = columns.next().getString();
  row.reason = columns.next().getString();
  row.begun_at = columns.next().getString();
  row.answered_at = columns.next().getString();
  row.answer = answerOf(columns);
  return row;
}

std::vector<TrialRow> trialsOf(SQLite::Statement query) {
  std::vector<TrialRow> rows;
  while (query.executeStep()) {
    rows.push_back(trialOf(query));
  }
  return rows;
}

/// The largest "number" of all participants, or the largest in a "code", also of those who were removed.
int largestEver(SQLite::Database& database, std::string_view what) {
  return database.execAndGet(fmt::format("SELECT largest_{} FROM study", what)).getInt();
}

/// ", name, name" or ", ?, ?" of all columns.
template <class ColumnsOf>
std::string listed(const ColumnsOf& columns, bool as_marks) {
  std::string list;
  for (const auto& column : columns) {
    list += fmt::format(", {}", as_marks ? "?" : column.name);
  }
  return list;
}

void insertTeleop(SQLite::Database& database, std::int64_t trial, const TeleopSummary& summary) {
  SQLite::Statement query(database, fmt::format("INSERT INTO teleop (trial{}) VALUES (?{})",
                                                listed(kTeleopColumns, false), listed(kTeleopColumns, true)));
  int at = 0;
  bindAt(query, ++at, trial);
  for (const TeleopColumn& column : kTeleopColumns) {
    bindAt(query, ++at, summary.*column.value);
  }
  query.exec();
}

void insertFelt(SQLite::Database& database, std::int64_t trial, int interval, const TrialSummary& felt) {
  SQLite::Statement query(database,
                          fmt::format("INSERT INTO felt (trial, interval, deadline_misses{}) VALUES (?, ?, ?{})",
                                      listed(kSummaryColumns, false), listed(kSummaryColumns, true)));
  int at = 0;
  bindAt(query, ++at, trial);
  bindAt(query, ++at, interval);
  bindAt(query, ++at, felt.deadline_misses);
  for (const SummaryColumn& column : kSummaryColumns) {
    bindAt(query, ++at, felt.*column.value);
  }
  query.exec();
}

}  // namespace

std::string_view wordOf(TrialKind kind) {
  return wordIn(kKindWords, kind);
}

std::string_view wordOf(TrialState state) {
  return wordIn(kStateWords, state);
}

std::string_view standingOf(const ParticipantRow& participant) {
  return participant.excluded_for.empty() ? std::string_view(participant.state) : "excluded";
}

bool isLeftOut(const ParticipantRow& participant) {
  return participant.state == "withdrawn" || !participant.excluded_for.empty();
}

std::span<const TeleopColumn> teleopColumns() {
  return kTeleopColumns;
}

std::span<const SummaryColumn> summaryColumns() {
  return kSummaryColumns;
}

// --- the store
// --------------------------------------------------------------------------------------------------------

StudyStore::Implementation::Implementation(const fs::path& path, Access access) : file(path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) {
    throw InvalidParameter("study", fmt::format("'{}'", path.string()),
                           "a file that `haptolith study new` has made; there is no such file");
  }
  if (access == Access::kRun) {
    requireOneName(path);
    lock.emplace(fs::canonical(path));  // another name of the same file is the same study
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

TrialState StudyStore::Implementation::stateOf(std::int64_t trial) {
  SQLite::Statement query = prepared(*database, "SELECT state FROM trial WHERE id = ?", trial);
  if (!query.executeStep()) {
    throw Failure(fmt::format("{} has no trial {}", file.string(), trial));
  }
  return valueIn(kStateWords, "state", query.getColumn(0).getString());
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
    throw Failure(
        fmt::format("{} exists already: a study's answers are never overwritten; choose another name", file.string()));
  }
  constexpr std::size_t kLongestStudyName_bytes = kLongestName_bytes - std::string_view("-recordings").size();
  if (const std::size_t bytes = file.filename().string().size(); bytes > kLongestStudyName_bytes) {
    throw InvalidParameter(
        "file", file.string(),
        fmt::format("a name of at most {} bytes without its folder, not {}: files beside a study have its "
                    "name and an ending",
                    kLongestStudyName_bytes, bytes));
  }
  // Only the owner may read what people have answered; SQLite's files beside it are made alike.
  const fs::path made = temporaryBeside(file, "part", kLongestStudyName_bytes);
  const int descriptor = makeNewFile(made, Readers::kOwner);
  if (descriptor < 0) {
    throw Failure(fmt::format("cannot create {}: {}", file.string(), std::strerror(errno)));
  }
  close(descriptor);
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
      throw InvalidParameter("participant", inQuotes(name), "a code that nobody has yet");
    } else if (!removedAt(name).empty()) {
      throw InvalidParameter("participant", inQuotes(name), "a code that nobody has had; who had it was removed");
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

// --- trials
// -----------------------------------------------------------------------------------------------------------

std::int64_t StudyStore::beginTrial(const TrialBegun& trial) {
  SQLite::Database& database = *implementation_->database;
  return implementation_->write([&] {
    implementation_->requireParticipant(trial.participant);
    if (prepared(database, "SELECT 1 FROM trial WHERE participant = ? AND state = 'begun'", trial.participant)
            .executeStep()) {
      throw Failure(fmt::format("{}: a trial is under way: answer it or call it lost before the next one begins",
                                implementation_->file.string()));
    }
    if (prepared(database,
                 "SELECT 1 FROM trial WHERE participant = ? AND block = ? AND trial = ? AND state = 'answered'",
                 trial.participant, trial.block, trial.index)
            .executeStep()) {
      throw Failure(fmt::format("{}: trial {} of block '{}' has an answer already", implementation_->file.string(),
                                trial.index, trial.block_name));
    }
    execute(
        database,
        "INSERT INTO trial (participant, block, position, trial, attempt, kind, block_name, level, reference, value, "
        "reference_value, test_first, seed, recording, begun_at) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
        trial.participant, trial.block, trial.position, trial.index, trial.attempt, wordOf(trial.kind),
        std::string_view(trial.block_name), std::string_view(trial.level), std::string_view(trial.reference),
        trial.value, trial.reference_value, trial.test_first, static_cast<std::int64_t>(trial.seed),
        std::string_view(trial.recording), std::string_view(nowText()));
    return database.getLastInsertRowid();
  });
}

void StudyStore::answerTrial(std::int64_t id, const TrialAnswer& answer) {
  SQLite::Database& database = *implementation_->database;
  implementation_->write([&] {
    if (const TrialState state = implementation_->stateOf(id); state != TrialState::kBegun) {
      throw Failure(fmt::format("{}: trial {} is {}: only one that is under way takes an answer",
                                implementation_->file.string(), id, wordOf(state)));
    }
    execute(database, "INSERT INTO answer (trial, positive, correct, reaction_s, timed_out) VALUES (?, ?, ?, ?, ?)", id,
            answer.positive, answer.correct, answer.reaction_s, answer.timed_out);
    insertFelt(database, id, 1, answer.felt[0]);
    insertFelt(database, id, 2, answer.felt[1]);
    if (answer.teleop) {
      insertTeleop(database, id, *answer.teleop);
    }
    return execute(database, "UPDATE trial SET state = 'answered', answered_at = ? WHERE id = ?",
                   std::string_view(nowText()), id);
  });
}

void StudyStore::voidTrial(std::int64_t id, TrialState state, std::string_view reason) {
  if (state != TrialState::kRepeated && state != TrialState::kLost) {
    throw InvalidParameter("state", std::string(wordOf(state)), "repeated or lost");
  }
  implementation_->write([&] {
    const TrialState now = implementation_->stateOf(id);
    const bool allowed = now == TrialState::kBegun || (now == TrialState::kAnswered && state == TrialState::kRepeated);
    if (!allowed) {
      throw Failure(fmt::format("{}: trial {} is {}: it cannot be called {}", implementation_->file.string(), id,
                                wordOf(now), wordOf(state)));
    }
    return execute(*implementation_->database, "UPDATE trial SET state = ?, reason = ? WHERE id = ?", wordOf(state),
                   reason, id);
  });
}

std::vector<TrialRow> StudyStore::trials(std::int64_t participant) const {
  return implementation_->read([&] {
    return trialsOf(
        prepared(*implementation_->database, selectTrials() + " WHERE participant = ? ORDER BY trial.id", participant));
  });
}

std::vector<TrialRow> StudyStore::trials() const {
  return implementation_->read(
      [&] { return trialsOf(prepared(*implementation_->database, selectTrials() + " ORDER BY trial.id")); });
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
