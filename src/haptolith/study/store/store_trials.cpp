#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/study/store/store_file.h"
#include "haptolith/study/store/store_implementation.h"
#include "haptolith/study/store/study_schema.h"
#include "haptolith/study/store/study_sql.h"

namespace haptolith {

namespace {

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
    SummaryColumn{"duration_s", "s", "Duration of the stimulus.", &TrialSummary::duration_s},
    SummaryColumn{"path_m", "m", "Length of the tool's path.", &TrialSummary::path_m},
    SummaryColumn{"peak_speed_m_s", "m/s", "Largest speed of the tool.", &TrialSummary::peak_speed_m_s},
    SummaryColumn{"mean_speed_m_s", "m/s", "Mean speed of the tool.", &TrialSummary::mean_speed_m_s},
    SummaryColumn{"peak_force_n", "N", "Largest force on the hand.", &TrialSummary::peak_force_n},
    SummaryColumn{"mean_force_n", "N", "Mean force on the hand.", &TrialSummary::mean_force_n},
    SummaryColumn{"force_sd_n", "N", "Standard deviation of the force on the hand.", &TrialSummary::force_sd_n},
    SummaryColumn{"peak_torque_nm", "N m", "Largest torque on the hand.", &TrialSummary::peak_torque_nm},
    SummaryColumn{"work_j", "J", "Work of the hand on the soil.", &TrialSummary::work_j},
};

constexpr std::array kTeleopColumns{
    TeleopColumn{"done", "", "Whether the site's sensors reported the task as done: 1, or 0 at the time limit.",
                 &TeleopSummary::done},
    TeleopColumn{"time_s", "s", "Task time, or the time limit.", &TeleopSummary::time_s},
    TeleopColumn{"follows_s", "s", "Time until the robot first followed the hand; missing: never.",
                 &TeleopSummary::follows_s},
    TeleopColumn{"reached", "",
                 "Depth of the trench in m, or force of the press or load in N, as reported by the site.",
                 &TeleopSummary::reached},
    TeleopColumn{
        "force_error", "",
        "RMS of displayed minus remote force at the same command, over RMS of remote force, in windows of 0.2 s.",
        &TeleopSummary::force_error},
    TeleopColumn{"met_rms_n", "N", "RMS of the force on the robot's tool, in windows of 0.2 s.",
                 &TeleopSummary::met_rms_n},
    TeleopColumn{"met_peak_n", "N", "Largest force on the robot's tool, in windows of 0.2 s.",
                 &TeleopSummary::met_peak_n},
    TeleopColumn{"stops", "", "Automatic stops of the robot.", &TeleopSummary::stops},
    TeleopColumn{"friction_angle_deg", "deg", "Friction angle of the soil, as learned.",
                 &TeleopSummary::friction_angle_deg},
    TeleopColumn{"cohesion_pa", "Pa", "Cohesion of the soil, as learned.", &TeleopSummary::cohesion_pa},
    TeleopColumn{"tool_friction_angle_deg", "deg", "Friction angle on the tool, as learned.",
                 &TeleopSummary::tool_friction_angle_deg},
};

template <class Words, class Value>
std::string_view wordIn(const Words& words, Value value) {
  return std::ranges::find(words, value, [](const auto& entry) { return entry.first; })->second;
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

/// Selects the columns of trial, answer, and twice felt, in the order required by trialOf().
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

/// Reader of the columns of a row, one after the other.
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
  answer.summaries = {summaryOf(columns), summaryOf(columns)};
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

/// Returns ", name, name" or ", ?, ?" for all columns.
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

void insertSummary(SQLite::Database& database, std::int64_t trial, int interval, const TrialSummary& summary) {
  SQLite::Statement query(database,
                          fmt::format("INSERT INTO felt (trial, interval, deadline_misses{}) VALUES (?, ?, ?{})",
                                      listed(kSummaryColumns, false), listed(kSummaryColumns, true)));
  int at = 0;
  bindAt(query, ++at, trial);
  bindAt(query, ++at, interval);
  bindAt(query, ++at, summary.deadline_misses);
  for (const SummaryColumn& column : kSummaryColumns) {
    bindAt(query, ++at, summary.*column.value);
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

std::span<const TeleopColumn> teleopColumns() {
  return kTeleopColumns;
}

std::span<const SummaryColumn> summaryColumns() {
  return kSummaryColumns;
}

TrialState StudyStore::Implementation::stateOf(std::int64_t trial) {
  SQLite::Statement query = prepared(*database, "SELECT state FROM trial WHERE id = ?", trial);
  if (!query.executeStep()) {
    throw Failure(fmt::format("{} has no trial {}", file.string(), trial));
  }
  return valueIn(kStateWords, "state", query.getColumn(0).getString());
}

std::int64_t StudyStore::beginTrial(const TrialBegun& trial) {
  SQLite::Database& database = *implementation_->database;
  return implementation_->write([&] {
    implementation_->requireParticipant(trial.participant);
    if (prepared(database, "SELECT 1 FROM trial WHERE participant = ? AND state = 'begun'", trial.participant)
            .executeStep()) {
      throw Failure(
          fmt::format("{}: a trial is running: record its response or mark it as lost before the next one begins",
                      implementation_->file.string()));
    }
    if (prepared(database,
                 "SELECT 1 FROM trial WHERE participant = ? AND block = ? AND trial = ? AND state = 'answered'",
                 trial.participant, trial.block, trial.index)
            .executeStep()) {
      throw Failure(fmt::format("{}: trial {} of block '{}' already has a response", implementation_->file.string(),
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
      throw Failure(fmt::format("{}: trial {} is {}: only a running trial takes a response",
                                implementation_->file.string(), id, wordOf(state)));
    }
    execute(database, "INSERT INTO answer (trial, positive, correct, reaction_s, timed_out) VALUES (?, ?, ?, ?, ?)", id,
            answer.positive, answer.correct, answer.reaction_s, answer.timed_out);
    insertSummary(database, id, 1, answer.summaries[0]);
    insertSummary(database, id, 2, answer.summaries[1]);
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
      throw Failure(fmt::format("{}: trial {} is {}: it cannot be marked as {}", implementation_->file.string(), id,
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

}  // namespace haptolith
