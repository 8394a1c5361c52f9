// What can happen to a study while it runs, or before: kills, full disks, locks, damage, other versions.

#include <SQLiteCpp/SQLiteCpp.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/study/store/store.h"
#include "haptolith/study/store/study_schema.h"

#include "a_pipe.h"
#include "a_study.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using Access = StudyStore::Access;
using StoreFaults = AStudy;

constexpr uid_t kNobody = 65534;

/// Runs `work` in a separate process, unprivileged if this is root; true when it returned true.
bool asSomebodyElse(const std::function<bool()>& work) {
  const pid_t child = fork();
  if (child == 0) {
    bool done = geteuid() != 0 || (setgid(kNobody) == 0 && setuid(kNobody) == 0);
    try {
      done = done && work();
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s\n", error.what());
      done = false;
    }
    _exit(done ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

std::string errorOfOpening(const fs::path& file, Access access) {
  return messageOf<std::exception>([&] { const StudyStore store(file, access); });
}

/// Changes the file behind the store's back.
void execute(const fs::path& file, const std::string& sql) {
  SQLite::Database(file.string(), SQLite::OPEN_READWRITE).exec(sql);
}

// --- kills
// ------------------------------------------------------------------------------------------------------------

/// Resumes a study, as the program does after a crash, until it is killed.
[[noreturn]] void answerUntilKilled(const fs::path& file, const Pipe& pipe) {
  StudyStore store(file, Access::kRun);
  const std::int64_t id = store.participants().front().id;
  int next = 0;
  int attempt = 0;
  for (const TrialRow& row : store.trials(id)) {
    if (row.state == TrialState::kBegun) {
      store.voidTrial(row.id, TrialState::kLost, "crash");
    }
    next = row.answer ? row.index + 1 : row.index;
    attempt = row.answer ? 0 : row.attempt + 1;
  }
  for (;; ++next, attempt = 0) {
    TrialBegun trial{.participant = id, .index = next, .attempt = attempt, .block_name = "friction", .seed = 5};
    const std::int64_t begun = store.beginTrial(trial);
    store.answerTrial(begun, {.positive = true, .reaction_s = 0.25 * next});
    pipe.tell(next);
  }
}

TEST_F(StoreFaults, AKillAtAnyMomentLosesNoAnswerAndDoublesNone) {
  { StudyStore(file_, Access::kRun).addParticipant(""); }
  std::mt19937_64 random(7);
  std::vector<int> told;
  constexpr std::size_t kKills = 40,
                        kMostKills = 1000;  // more where a busy machine lets a child answer only now and then
  for (std::size_t kill_number = 0; kill_number < kKills || (told.size() <= kKills && kill_number < kMostKills);
       ++kill_number) {
    Pipe pipe;
    const pid_t child = fork();
    if (child == 0) {
      answerUntilKilled(file_, pipe);
    }
    pipe.closeWriting();
    std::this_thread::sleep_for(std::chrono::microseconds(1000 + random() % 60000));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    for (const int number : pipe.told()) {
      told.push_back(number);
    }
    const StudyStore store(file_, Access::kRead);  // checks that the file is whole
    std::vector<int> kept;
    for (const TrialRow& row : store.trials()) {
      if (row.state == TrialState::kAnswered) {
        kept.push_back(row.index);
        EXPECT_EQ(row.answer->reaction_s, 0.25 * row.index);
      }
    }
    // All confirmed responses are there, once and in order; of unconfirmed ones at most the last.
    for (std::size_t i = 0; i < kept.size(); ++i) {
      ASSERT_EQ(kept[i], static_cast<int>(i));
    }
    for (const int number : told) {
      ASSERT_LT(number, static_cast<int>(kept.size()));
    }
    ASSERT_LE(kept.size(), told.size() + kill_number + 1);
  }
  EXPECT_GT(told.size(), kKills);
  EXPECT_TRUE(std::ranges::adjacent_find(told, std::greater_equal()) == told.end());
}

// --- full disks
// -------------------------------------------------------------------------------------------------------

TEST_F(StoreFaults, AFullDiskIsAClearErrorAndLosesNothing) {
  // A limit on the size of files replaces the full disk, in a separate process.
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    StudyStore store(file_, Access::kRun);
    const std::int64_t id = store.addParticipant("").id;
    store.answerTrial(store.beginTrial(trial(id, 0)), answer(1));
    const rlimit full{static_cast<rlim_t>(fs::file_size(file_.string() + "-wal")), RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &full);
    const std::string message = messageOf<Failure>([&] { store.beginTrial(trial(id, 1)); });
    const bool clear = message.find("the disk is full or failing: free some space") != std::string::npos;
    const rlimit room{RLIM_INFINITY, RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &room);
    const std::int64_t begun = store.beginTrial(trial(id, 1));  // the store continues once there is room
    setrlimit(RLIMIT_FSIZE, &full);
    const bool again = messageOf<Failure>([&] { store.answerTrial(begun, answer(2)); }) != "no error";
    setrlimit(RLIMIT_FSIZE, &room);
    store.answerTrial(begun, answer(2));
    std::fprintf(stderr, "%s", clear && again ? "" : (message + "\n").c_str());
    _exit(clear && again ? 0 : 1);  // without a farewell, like a crash
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  const StudyStore store(file_, Access::kRead);
  ASSERT_EQ(store.trials().size(), 2U);
  EXPECT_EQ(store.trials()[0].answer->reaction_s, 1);
  EXPECT_EQ(store.trials()[1].answer->reaction_s, 2);
}

TEST_F(StoreFaults, AFullDiskLeavesNoHalfAStudy) {
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit full{8192, RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &full);
    const std::string message = messageOf<Failure>(
        [&] { StudyStore::create(folder_ / "b.study", loadProtocolText(kTwoBlocks, "two.toml"), kTwoBlocks, 1); });
    _exit(message.find("b.study") != std::string::npos && message.find("free some space") != std::string::npos ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);  // a.study
}

// --- permissions
// ------------------------------------------------------------------------------------------------------

TEST_F(StoreFaults, AReadOnlyFileIsReadAndNotRun) {
  fs::permissions(file_, fs::perms::owner_read | fs::perms::group_read | fs::perms::others_read);
  fs::permissions(folder_, fs::perms::all);
  const fs::path file = file_;
  EXPECT_TRUE(asSomebodyElse([&] { return StudyStore(file, Access::kRead).title() == "A study"; }));
  EXPECT_TRUE(asSomebodyElse([&] {
    const std::string message = errorOfOpening(file, Access::kRun);
    return message.find("read-only") != std::string::npos;
  }));
}

/// Grants others access to a study, as its owner does.
void letOthersRead(const fs::path& file) {
  fs::permissions(file, fs::perms::group_read | fs::perms::others_read, fs::perm_options::add);
}

TEST_F(StoreFaults, AReadOnlyFolderIsReadAndNotRun) {
  letOthersRead(file_);
  {
    StudyStore store(file_, Access::kRun);
    store.answerTrial(store.beginTrial(trial(store.addParticipant("").id, 0)), answer(1));
  }
  const auto read_only =
      fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read | fs::perms::others_exec;
  fs::permissions(folder_, read_only);
  const fs::path file = file_;
  EXPECT_TRUE(asSomebodyElse([&] { return StudyStore(file, Access::kRead).trials().size() == 1; }));
  EXPECT_TRUE(asSomebodyElse(
      [&] { return errorOfOpening(file, Access::kRun).find("Permission denied") != std::string::npos; }));
  fs::permissions(folder_, fs::perms::owner_all);
}

TEST_F(StoreFaults, AStudyThatRunsInAReadOnlyFolderIsReadUpToItsLastAnswer) {
  letOthersRead(file_);
  StudyStore store(file_, Access::kRun);
  const std::int64_t id = store.addParticipant("").id;
  store.answerTrial(store.beginTrial(trial(id, 0)), answer(1));
  const auto read_only =
      fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read | fs::perms::others_exec;
  fs::permissions(folder_, read_only);
  const fs::path file = file_;
  EXPECT_TRUE(asSomebodyElse([&] { return StudyStore(file, Access::kRead).trials().size() == 1; }));
  fs::permissions(folder_, fs::perms::owner_all);
}

TEST_F(StoreFaults, AStudyAndAllBesideItIsForItsOwnerAlone) {
  constexpr fs::perms kOwner = fs::perms::owner_read | fs::perms::owner_write;
  StudyStore store(file_, Access::kRun);
  (void)store.addParticipant("");
  for (const char* ending : {"", "-wal", "-shm", "-lock"}) {
    EXPECT_EQ(fs::status(file_.string() + ending).permissions(), kOwner) << ending;
  }
}

// --- what another program has written
// -----------------------------------------------------------------------------------

/// Changes a study as no version of haptolith does: after its tables have lost what they check of words.
void forge(const fs::path& file, const std::string& sql) {
  {
    SQLite::Database database(file.string(), SQLite::OPEN_READWRITE);
    database.exec("PRAGMA writable_schema = ON");
    for (const char* check : {"CHECK (kind IN (''practice'', ''main'', ''catch''))",
                              "CHECK (state IN (''begun'', ''answered'', ''repeated'', ''lost''))",
                              "CHECK (state IN (''running'', ''finished'', ''withdrawn''))"}) {
      database.exec(fmt::format("UPDATE sqlite_schema SET sql = replace(sql, '{}', '')", check));
    }
  }
  SQLite::Database database(file.string(), SQLite::OPEN_READWRITE);
  ASSERT_GE(database.exec(sql), 1);
}

TEST_F(StoreFaults, ACodeThatIsNoneIsRefusedWhereverItIsRead) {
  {
    StudyStore store(file_, Access::kRun);
    store.answerTrial(store.beginTrial(trial(store.addParticipant("").id, 0)), answer(1));
  }
  for (const char* code :
       {"/../../../../tmp/escaped", "a/b", "..", "S01\ninjected", "S\x1b[31m", "12345678901234567"}) {
    forge(file_, fmt::format("UPDATE participant SET code = '{}'", code));
    const StudyStore store(file_, Access::kRead);
    const std::string error = messageOf<Failure>([&] { (void)store.participants(); });
    EXPECT_THAT(error, AllOf(HasSubstr("a.study: it holds what haptolith does not write: code = '"),
                             HasSubstr("1 to 16 letters and digits")));
    EXPECT_EQ(error.find('\x1b'), std::string::npos);
  }
}

TEST_F(StoreFaults, AWordThatIsInNoTableIsRefused) {
  std::int64_t id = 0;
  {
    StudyStore store(file_, Access::kRun);
    id = store.addParticipant("").id;
    store.answerTrial(store.beginTrial(trial(id, 0)), answer(1));
  }
  forge(file_, "UPDATE trial SET kind = 'other'");
  EXPECT_THAT(messageOf<Failure>([&] { (void)StudyStore(file_, Access::kRead).trials(); }),
              HasSubstr("kind = 'other'; must be one of practice, main, catch"));
  forge(file_, "UPDATE trial SET kind = 'main', state = 'gone'");
  EXPECT_THAT(messageOf<Failure>([&] { (void)StudyStore(file_, Access::kRead).trials(id); }),
              HasSubstr("state = 'gone'; must be one of begun, answered"));
  EXPECT_THAT(messageOf<Failure>([&] { StudyStore(file_, Access::kRun).answerTrial(1, answer(1)); }),
              HasSubstr("state = 'gone'"));
  forge(file_, "UPDATE participant SET state = 'lost'");
  EXPECT_THAT(messageOf<Failure>([&] { (void)StudyStore(file_, Access::kRead).participants(); }),
              HasSubstr("state = 'lost'"));
}

// --- others at the same file
// ------------------------------------------------------------------------------------------

TEST_F(StoreFaults, OneRunsAndOthersRead) {
  StudyStore runner(file_, Access::kRun);
  const std::int64_t id = runner.addParticipant("").id;
  const StudyStore reader(file_, Access::kRead);
  const std::int64_t begun = runner.beginTrial(trial(id, 0));
  runner.answerTrial(begun, answer(1));
  EXPECT_EQ(reader.trials().size(), 1U);
  const std::string error = errorOfOpening(file_, Access::kRun);
  EXPECT_THAT(error, AllOf(HasSubstr("already runs it"), HasSubstr(fmt::format("process {}", getpid()))));
}

TEST_F(StoreFaults, ASecondRunnerIsRefusedWhateverNameItGivesTheFile) {
  const StudyStore runner(file_, Access::kRun);
  fs::create_symlink(file_, folder_ / "link.study");
  EXPECT_THAT(errorOfOpening(folder_ / "link.study", Access::kRun), HasSubstr("already runs it"));
}

TEST_F(StoreFaults, AStudyWithTwoNamesIsRunByNeither) {
  fs::create_hard_link(file_, folder_ / "other.study");
  for (const char* name : {"a.study", "other.study"}) {
    EXPECT_THAT(errorOfOpening(folder_ / name, Access::kRun), HasSubstr("2 names (hard links)"));
    EXPECT_EQ(errorOfOpening(folder_ / name, Access::kRead), "no error");
  }
  fs::remove(folder_ / "other.study");
  EXPECT_EQ(errorOfOpening(file_, Access::kRun), "no error");
}

TEST_F(StoreFaults, TheNextRunnerNeedNotWaitForAKilledOne) {
  Pipe pipe;
  const pid_t child = fork();
  if (child == 0) {
    const StudyStore store(file_, Access::kRun);
    pipe.tell(1);
    pause();
    _exit(0);
  }
  ASSERT_TRUE(pipe.listen());
  EXPECT_THAT(errorOfOpening(file_, Access::kRun), HasSubstr(fmt::format("process {}", child)));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_EQ(errorOfOpening(file_, Access::kRun), "no error");
}

TEST_F(StoreFaults, AFileThatAnotherProgramHasLockedIsAClearError) {
  StudyStore store(file_, Access::kRun);
  const std::int64_t id = store.addParticipant("").id;
  {
    SQLite::Database browser(file_.string(), SQLite::OPEN_READWRITE);
    browser.exec("BEGIN IMMEDIATE");
    EXPECT_THAT(messageOf<Failure>([&] { store.beginTrial(trial(id, 0)); }),
                AllOf(HasSubstr("a.study"), HasSubstr("another program has locked it")));
  }
  store.beginTrial(trial(id, 0));
}

TEST_F(StoreFaults, AShortLockIsWaitedFor) {
  StudyStore store(file_, Access::kRun);
  SQLite::Database browser(file_.string(), SQLite::OPEN_READWRITE);
  browser.exec("BEGIN IMMEDIATE");
  std::thread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    browser.exec("COMMIT");
  });
  EXPECT_EQ(store.addParticipant("").code, "S01");
  later.join();
}

// --- files that are not what they should be
// ---------------------------------------------------------------------------

TEST_F(StoreFaults, ADamagedFileIsRefused) {
  {
    StudyStore store(file_, Access::kRun);
    const std::int64_t id = store.addParticipant("").id;
    for (int i = 0; i < 100; ++i) {
      store.answerTrial(store.beginTrial(trial(id, i)), answer(i));
    }
  }
  const auto size = static_cast<std::streamoff>(fs::file_size(file_));
  std::fstream file(file_, std::ios::in | std::ios::out | std::ios::binary);
  for (std::streamoff at = 8192; at < size; at += 1000) {
    file.seekp(at);
    file.write("rubbish rubbish rubbish", 23);
  }
  file.close();
  for (const Access access : {Access::kRead, Access::kRun}) {
    EXPECT_THAT(errorOfOpening(file_, access),
                AllOf(HasSubstr("a.study"), HasSubstr("damaged"), HasSubstr(".recover")));
  }
}

TEST_F(StoreFaults, AFileThatEndsEarlyIsRefused) {
  fs::resize_file(file_, fs::file_size(file_) / 2);
  EXPECT_THAT(errorOfOpening(file_, Access::kRun), HasSubstr("damaged"));
}

TEST_F(StoreFaults, FilesOfOtherKindsAreRefused) {
  const fs::path text = folder_ / "text";
  std::ofstream(text) << std::string(5000, 'x');
  const fs::path empty = folder_ / "empty";
  std::ofstream(empty).flush();
  const fs::path other = folder_ / "other.db";
  SQLite::Database(other.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE).exec("CREATE TABLE t (x)");
  for (const fs::path& file : {text, empty, other}) {
    for (const Access access : {Access::kRead, Access::kRun}) {
      EXPECT_THAT(errorOfOpening(file, access), HasSubstr("is not a study")) << file;
    }
  }
  EXPECT_EQ(fs::file_size(empty), 0U);
}

TEST_F(StoreFaults, AFileThatIsNotThereIsWrongUsage) {
  for (const fs::path& file : {folder_ / "b.study", folder_}) {
    EXPECT_THROW(StudyStore(file, Access::kRun), InvalidParameter) << file;
  }
  EXPECT_FALSE(fs::exists(folder_ / "b.study-lock"));
}

// --- versions
// ---------------------------------------------------------------------------------------------------------

TEST_F(StoreFaults, AFileOfANewerVersionIsRefused) {
  execute(file_, "PRAGMA user_version = 99");
  for (const Access access : {Access::kRead, Access::kRun}) {
    EXPECT_THAT(errorOfOpening(file_, access), AllOf(HasSubstr("newer version"), HasSubstr("99")));
  }
}

TEST_F(StoreFaults, AFileOfAnOlderVersionIsReadOnlyOnceARunnerHasMigratedIt) {
  execute(file_, "PRAGMA user_version = 0");
  EXPECT_THAT(errorOfOpening(file_, Access::kRead), HasSubstr("an older version"));
}

TEST(StudyMigrations, BringAnOlderFileUpToDateStepByStep) {
  SQLite::Database database(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  const std::vector<const char*> steps{"CREATE TABLE a (x); INSERT INTO a VALUES (7)", "ALTER TABLE a ADD COLUMN y",
                                       "UPDATE a SET y = 2 * x"};
  migrate(database, std::span(steps).first(1));
  EXPECT_EQ(versionOf(database), 1);
  migrate(database, steps);
  EXPECT_EQ(versionOf(database), 3);
  EXPECT_EQ(database.execAndGet("SELECT y FROM a").getInt(), 14);
  migrate(database, steps);  // nothing more to do
  EXPECT_EQ(database.execAndGet("SELECT count(*) FROM a").getInt(), 1);
  EXPECT_THROW(migrate(database, std::span(steps).first(2)), Failure);
}

TEST(StudyMigrations, AreDoneWholeOrNotAtAll) {
  SQLite::Database database(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  const std::vector<const char*> steps{"CREATE TABLE a (x)", "CREATE TABLE b (x)", "this is no SQL"};
  migrate(database, std::span(steps).first(1));
  EXPECT_THROW(migrate(database, steps), SQLite::Exception);
  EXPECT_EQ(versionOf(database), 1);
  EXPECT_TRUE(database.tableExists("a"));
  EXPECT_FALSE(database.tableExists("b"));
}

// --- the tables themselves
// --------------------------------------------------------------------------------------------

TEST_F(StoreFaults, TheTablesRefuseWhatOtherProgramsMightWrite) {
  {
    StudyStore store(file_, Access::kRun);
    store.answerTrial(store.beginTrial(trial(store.addParticipant("").id, 0)), answer(1));
  }
  const std::string on = "PRAGMA foreign_keys = ON; ";
  EXPECT_THROW(execute(file_, on + "INSERT INTO answer SELECT * FROM answer"), SQLite::Exception);
  EXPECT_THROW(execute(file_, on + "UPDATE answer SET positive = 0"), SQLite::Exception);
  EXPECT_THROW(execute(file_, on + "UPDATE participant SET state = 'asleep'"), SQLite::Exception);
  EXPECT_THROW(execute(file_, on + "INSERT INTO step VALUES (99, 'consent', '')"), SQLite::Exception);
  EXPECT_THROW(execute(file_, on + "INSERT INTO trial (participant, block, position, trial, attempt, kind, block_name, "
                                   "level, reference, value, reference_value, test_first, seed, begun_at, state) "
                                   "SELECT participant, block, position, trial, 1, kind, block_name, level, reference, "
                                   "value, reference_value, test_first, seed, begun_at, 'answered' FROM trial"),
               SQLite::Exception);
  EXPECT_EQ(StudyStore(file_, Access::kRead).trials().size(), 1U);
}

}  // namespace
}  // namespace haptolith
