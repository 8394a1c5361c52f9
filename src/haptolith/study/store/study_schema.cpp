#include "haptolith/study/store/study_schema.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <array>
#include <string_view>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

// docs/reference/study-files.md describes the tables.
constexpr std::array kMigrations{
    R"sql(
CREATE TABLE study (
  id INTEGER PRIMARY KEY CHECK (id = 1),
  title TEXT NOT NULL,
  protocol TEXT NOT NULL,
  scene TEXT NOT NULL,
  seed INTEGER NOT NULL CHECK (seed >= 0),
  created_at TEXT NOT NULL
) STRICT;

CREATE TABLE participant (
  id INTEGER PRIMARY KEY,
  number INTEGER NOT NULL UNIQUE CHECK (number >= 1),
  code TEXT NOT NULL COLLATE NOCASE UNIQUE CHECK (code <> ''),
  state TEXT NOT NULL CHECK (state IN ('running', 'finished', 'withdrawn')),
  begun_at TEXT NOT NULL,
  ended_at TEXT NOT NULL DEFAULT ''
) STRICT;

CREATE TABLE step (
  participant INTEGER NOT NULL REFERENCES participant ON DELETE CASCADE,
  step TEXT NOT NULL CHECK (step <> ''),
  at TEXT NOT NULL,
  PRIMARY KEY (participant, step)
) STRICT;

CREATE TABLE form_answer (
  participant INTEGER NOT NULL REFERENCES participant ON DELETE CASCADE,
  form TEXT NOT NULL,
  key TEXT NOT NULL,
  value TEXT NOT NULL,
  at TEXT NOT NULL,
  PRIMARY KEY (participant, form, key)
) STRICT;

CREATE TABLE personal_answer (
  participant INTEGER NOT NULL REFERENCES participant ON DELETE CASCADE,
  form TEXT NOT NULL,
  key TEXT NOT NULL,
  value TEXT NOT NULL,
  at TEXT NOT NULL,
  PRIMARY KEY (participant, form, key)
) STRICT;

CREATE TABLE trial (
  id INTEGER PRIMARY KEY,
  participant INTEGER NOT NULL REFERENCES participant ON DELETE CASCADE,
  block INTEGER NOT NULL CHECK (block >= 0),
  position INTEGER NOT NULL CHECK (position >= 0),
  trial INTEGER NOT NULL CHECK (trial >= 0),
  attempt INTEGER NOT NULL CHECK (attempt >= 0),
  kind TEXT NOT NULL CHECK (kind IN ('practice', 'main', 'catch')),
  block_name TEXT NOT NULL,
  level TEXT NOT NULL,
  reference TEXT NOT NULL,
  value REAL NOT NULL,
  reference_value REAL NOT NULL,
  test_first INTEGER NOT NULL CHECK (test_first IN (0, 1)),
  seed INTEGER NOT NULL CHECK (seed >= 0),
  state TEXT NOT NULL DEFAULT 'begun' CHECK (state IN ('begun', 'answered', 'repeated', 'lost')),
  reason TEXT NOT NULL DEFAULT '',
  begun_at TEXT NOT NULL,
  answered_at TEXT NOT NULL DEFAULT '',
  UNIQUE (participant, block, trial, attempt)
) STRICT;
CREATE UNIQUE INDEX one_answer ON trial (participant, block, trial) WHERE state = 'answered';
CREATE UNIQUE INDEX one_under_way ON trial (participant) WHERE state = 'begun';

CREATE TABLE answer (
  trial INTEGER PRIMARY KEY REFERENCES trial ON DELETE CASCADE,
  positive INTEGER NOT NULL CHECK (positive IN (0, 1)),
  correct INTEGER CHECK (correct IN (0, 1)),
  reaction_s REAL,
  timed_out INTEGER NOT NULL CHECK (timed_out IN (0, 1)),
  recording TEXT NOT NULL
) STRICT;
CREATE TRIGGER answers_stay BEFORE UPDATE ON answer BEGIN SELECT raise(ABORT, 'an answer is never changed'); END;

CREATE TABLE felt (
  trial INTEGER NOT NULL REFERENCES answer ON DELETE CASCADE,
  interval INTEGER NOT NULL CHECK (interval IN (1, 2)),
  duration_s REAL,
  path_m REAL,
  peak_speed_m_s REAL,
  mean_speed_m_s REAL,
  peak_force_n REAL,
  mean_force_n REAL,
  force_sd_n REAL,
  peak_torque_nm REAL,
  work_j REAL,
  deadline_misses INTEGER NOT NULL,
  PRIMARY KEY (trial, interval)
) STRICT;

CREATE TABLE note (
  id INTEGER PRIMARY KEY,
  participant INTEGER REFERENCES participant ON DELETE CASCADE,
  at TEXT NOT NULL,
  kind TEXT NOT NULL CHECK (kind <> ''),
  text TEXT NOT NULL
) STRICT;
)sql",
    R"sql(
ALTER TABLE study ADD COLUMN largest_number INTEGER NOT NULL DEFAULT 0;
ALTER TABLE study ADD COLUMN largest_code INTEGER NOT NULL DEFAULT 0;
UPDATE study SET
  largest_number = (SELECT coalesce(max(number), 0) FROM participant),
  largest_code = (SELECT coalesce(max(CAST(substr(code, 2) AS INTEGER)), 0) FROM participant
                  WHERE code GLOB '[Ss][0-9]*' AND substr(code, 2) NOT GLOB '*[^0-9]*' AND length(code) <= 7);

CREATE TABLE removal (
  id INTEGER PRIMARY KEY,
  participant INTEGER,
  what TEXT NOT NULL CHECK (what IN ('everything', 'personal')),
  reason TEXT NOT NULL,
  keeps_recordings INTEGER NOT NULL CHECK (keeps_recordings IN (0, 1)),
  code_hash TEXT NOT NULL,
  at TEXT NOT NULL,
  done_at TEXT NOT NULL DEFAULT ''
) STRICT;
)sql",
    R"sql(
CREATE TABLE session (
  id INTEGER PRIMARY KEY,
  participant INTEGER NOT NULL REFERENCES participant ON DELETE CASCADE,
  kind TEXT NOT NULL CHECK (kind IN ('run', 'resume', 'simulate')),
  begun_at TEXT NOT NULL,
  ended_at TEXT NOT NULL DEFAULT '',
  program_version TEXT NOT NULL,
  device TEXT NOT NULL,
  os TEXT NOT NULL,
  kernel TEXT NOT NULL,
  cpu TEXT NOT NULL,
  loop_rate_hz REAL,
  ticks INTEGER,
  missed_ticks INTEGER,
  safety_trips INTEGER,
  protocol_sha256 TEXT NOT NULL,
  simulation TEXT NOT NULL
) STRICT;

CREATE TABLE consent (
  participant INTEGER PRIMARY KEY REFERENCES participant ON DELETE CASCADE,
  at TEXT NOT NULL,
  version TEXT NOT NULL,
  language TEXT NOT NULL,
  text TEXT NOT NULL
) STRICT;

ALTER TABLE trial ADD COLUMN recording TEXT NOT NULL DEFAULT '';
UPDATE trial SET recording = coalesce((SELECT recording FROM answer WHERE answer.trial = trial.id), '');
ALTER TABLE answer DROP COLUMN recording;
)sql",
    R"sql(
CREATE TABLE exclusion (
  id INTEGER PRIMARY KEY,
  participant INTEGER NOT NULL REFERENCES participant ON DELETE CASCADE,
  at TEXT NOT NULL,
  excluded INTEGER NOT NULL CHECK (excluded IN (0, 1)),
  reason TEXT NOT NULL CHECK (reason <> '')
) STRICT;
CREATE TRIGGER exclusions_stay BEFORE UPDATE ON exclusion WHEN NOT EXISTS (SELECT 1 FROM removal WHERE done_at = '')
BEGIN SELECT raise(ABORT, 'an exclusion is never changed'); END;
CREATE TRIGGER exclusions_are_kept BEFORE DELETE ON exclusion WHEN NOT EXISTS (SELECT 1 FROM removal WHERE done_at = '')
BEGIN SELECT raise(ABORT, 'an exclusion is never deleted'); END;
)sql",
    R"sql(
CREATE TABLE allocation (
  stratum INTEGER PRIMARY KEY CHECK (stratum >= 0),
  places INTEGER NOT NULL CHECK (places >= 1)
) STRICT;
CREATE TRIGGER places_only_go_up BEFORE UPDATE ON allocation WHEN NEW.places <= OLD.places
BEGIN SELECT raise(ABORT, 'a place is never given twice'); END;
CREATE TRIGGER places_are_kept BEFORE DELETE ON allocation
BEGIN SELECT raise(ABORT, 'a place is never given twice'); END;

CREATE TABLE assignment (
  participant INTEGER PRIMARY KEY REFERENCES participant ON DELETE CASCADE,
  stratum INTEGER NOT NULL CHECK (stratum >= 0),
  place INTEGER NOT NULL CHECK (place >= 0),
  group_name TEXT NOT NULL CHECK (group_name <> ''),
  block_row INTEGER NOT NULL CHECK (block_row >= 0),
  at TEXT NOT NULL,
  UNIQUE (stratum, place)
) STRICT;
CREATE TRIGGER assignments_stay BEFORE UPDATE ON assignment
BEGIN SELECT raise(ABORT, 'an assignment is never changed'); END;
CREATE TRIGGER assignments_are_kept BEFORE DELETE ON assignment
WHEN NOT EXISTS (SELECT 1 FROM removal WHERE done_at = '')
BEGIN SELECT raise(ABORT, 'an assignment is never deleted'); END;
)sql",
    R"sql(
CREATE TABLE teleop (
  trial INTEGER PRIMARY KEY REFERENCES answer ON DELETE CASCADE,
  done REAL,
  time_s REAL,
  follows_s REAL,
  reached REAL,
  force_error REAL,
  met_rms_n REAL,
  met_peak_n REAL,
  stops REAL,
  friction_angle_deg REAL,
  cohesion_pa REAL,
  tool_friction_angle_deg REAL
) STRICT;
)sql",
};

/// Returns the remedy for an error, by SQLite's code.
std::string_view remedyFor(int code) {
  switch (code) {
    case SQLITE_FULL:
    case SQLITE_IOERR:
      return "the disk is full or failing: free some space, then continue; all responses so far are saved";
    case SQLITE_BUSY:
    case SQLITE_LOCKED: return "another program has locked it: close that program (a database browser?), then continue";
    case SQLITE_READONLY: return "it cannot be written: check the permissions of the file and of its folder";
    case SQLITE_CANTOPEN:
      return "it cannot be opened: check the permissions of the file and of its folder; a folder that cannot be "
             "written "
             "needs the files FILE-wal and FILE-shm, if there is a FILE-wal";
    case SQLITE_CORRUPT:
      return "it is damaged: continue with a backup; `sqlite3 FILE .recover` saves the readable part";
    case SQLITE_NOTADB: return "it is not a study: must be a file made by `haptolith study new`";
    default: return "";
  }
}

}  // namespace

std::span<const char* const> studyMigrations() {
  return kMigrations;
}

int versionOf(SQLite::Database& database) {
  return database.execAndGet("PRAGMA user_version").getInt();
}

void migrate(SQLite::Database& database, std::span<const char* const> migrations) {
  const int newest = static_cast<int>(migrations.size());
  const int version = versionOf(database);
  if (version > newest) {
    throw Failure(fmt::format(
        "{}: made by a newer version of haptolith (table version {}; this program supports up to {}): use that version",
        database.getFilename(), version, newest));
  }
  if (version == newest) {
    return;
  }
  SQLite::Transaction transaction(database, SQLite::TransactionBehavior::IMMEDIATE);
  for (int next = version; next < newest; ++next) {
    database.exec(migrations[static_cast<std::size_t>(next)]);
  }
  database.exec(fmt::format("PRAGMA user_version = {}", newest));
  transaction.commit();
}

void tellWhatIsWrong(const std::filesystem::path& file, const std::function<void()>& work) {
  try {
    work();
  } catch (const SQLite::Exception& error) {
    const std::string_view remedy = remedyFor(error.getErrorCode() & 0xFF);
    throw Failure(fmt::format("{}: {}{}{}", file.string(), error.what(), remedy.empty() ? "" : "; ", remedy));
  }
}

}  // namespace haptolith
