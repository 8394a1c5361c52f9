// Nothing stays of a removed participant, for any reader, and whenever the program is killed.

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/study/store/participant_code.h"
#include "haptolith/study/store/store.h"
#include "haptolith/study/store/study_files.h"
#include "haptolith/study/store/study_schema.h"

#include "a_pipe.h"
#include "a_study.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using Access = StudyStore::Access;

std::string bytesOf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// A study with a participant whose strings are unique.
class StoreRemoval : public AStudy {
 protected:
  static constexpr std::string_view kCode = "Qzx7", kName = "Adalovelace", kSaid = "wackelpudding";
  static constexpr int kTrials = 5;

  [[nodiscard]] fs::path recording(int trial) const {
    return recordingsFolder(file_) / fmt::format("{}-friction-{:03}-1-first.h5", kCode, trial);
  }

  /// A participant with responses of every kind, notes and recordings; others before and after.
  std::int64_t somebody(StudyStore& store) const {
    const std::int64_t before = store.addParticipant("").id;
    const std::int64_t id = store.addParticipant(kCode).id;
    const std::int64_t after = store.addParticipant("").id;
    fs::create_directories(recordingsFolder(file_));
    for (int i = 0; i < kTrials; ++i) {
      for (const std::int64_t each : {before, id, after}) {
        TrialBegun begun = trial(each, i);
        begun.recording = each == id ? fmt::format("{}-friction-{:03}-1", kCode, i) : "S01-friction-001-1";
        store.answerTrial(store.beginTrial(begun), answer(1));
      }
      std::ofstream(recording(i)) << "movements of " << kCode;
    }
    store.setAnswers(id, "demographics", store.protocol().demographics, {{"name", std::string(kName)}, {"age", "36"}});
    store.beginSession(id, {.kind = "simulate", .simulation = std::string(kSaid)});
    store.giveConsent(id);
    store.addNote(id, fmt::format("said {}", kSaid), "note");
    store.markStep(id, "consent");
    store.voidTrial(store.beginTrial(trial(id, kTrials)), TrialState::kLost, kSaid);
    return id;
  }

  /// Files that hold a string of that person, in their bytes or in their names.
  [[nodiscard]] std::vector<std::string> traces() const {
    std::vector<std::string> found;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder_)) {
      const std::string name = entry.path().filename().string();
      const std::string all = name + (entry.is_regular_file() ? bytesOf(entry.path()) : "");
      if (std::ranges::any_of(std::array{kCode, kName, kSaid},
                              [&](std::string_view text) { return all.find(text) != std::string::npos; })) {
        found.push_back(name);
      }
    }
    return found;
  }
};

TEST_F(StoreRemoval, LeavesNoTraceInAnyFile) {
  StudyStore store(file_, Access::kRun);
  const std::int64_t id = somebody(store);
  ASSERT_FALSE(traces().empty());
  store.removeParticipant(id, "withdrew");
  EXPECT_THAT(traces(), IsEmpty());
  EXPECT_EQ(store.participants().size(), 2U);
  EXPECT_EQ(store.trials().size(), 2U * kTrials);
  ASSERT_EQ(store.removals().size(), 1U);
  EXPECT_EQ(store.removals()[0].reason, "withdrew");
  EXPECT_NE(store.removals()[0].done_at, "");
  store.addParticipant("");  // the store continues
}

TEST_F(StoreRemoval, LeavesNoTraceOfPersonalAnswers) {
  StudyStore store(file_, Access::kRun);
  const std::int64_t id = somebody(store);
  EXPECT_EQ(store.forgetPersonal(id), 1);
  for (const char* ending : {"", "-wal", "-shm"}) {
    EXPECT_THAT(bytesOf(file_.string() + ending), Not(HasSubstr(std::string(kName)))) << ending;
  }
  EXPECT_EQ(store.formAnswers(true).size(), 1U);
  EXPECT_EQ(store.trials(id).size(), kTrials + 1U);
  EXPECT_EQ(store.removedAt(kCode), "");
}

TEST_F(StoreRemoval, TakesTheCodeOutOfWhatOthersSay) {
  StudyStore store(file_, Access::kRun);
  const std::int64_t id = somebody(store);
  const std::int64_t other = store.participants().front().id;
  store.addNote(0, "qzx7 came late; Qzx77 did not", "note");
  store.voidTrial(store.beginTrial(trial(other, 9)), TrialState::kLost, "Qzx7 came in");
  store.removeParticipant(id, "Qzx7 withdrew");
  EXPECT_EQ(store.notes().back().text, "[removed] came late; Qzx77 did not");
  EXPECT_EQ(store.trials(other).back().reason, "[removed] came in");
  EXPECT_EQ(store.removals()[0].reason, "[removed] withdrew");
}

TEST_F(StoreRemoval, KeepsRecordingsThatAreAskedFor) {
  StudyStore store(file_, Access::kRun);
  store.removeParticipant(somebody(store), "", Recordings::kKeep);
  EXPECT_EQ(recordingsOf(file_, kCode, {}).size(), std::size_t{kTrials});
  EXPECT_EQ(store.participants().size(), 2U);
}

TEST_F(StoreRemoval, FindsRecordingsByTheWholeCodeAlsoThoseThatWereCutOff) {
  fs::create_directory(recordingsFolder(file_));
  for (const char* name : {"S1-a-001-1-first.h5", ".S1-a-001-1-second.part-1.h5", "S11-a-001-1-first.h5", "S1-x.csv"}) {
    std::ofstream(recordingsFolder(file_) / name) << "x";
  }
  std::vector<std::string> names;
  for (const fs::path& path : recordingsOf(file_, "S1", {})) {
    names.push_back(path.filename().string());
  }
  EXPECT_THAT(names, ElementsAre(".S1-a-001-1-second.part-1.h5", "S1-a-001-1-first.h5"));
  EXPECT_THAT(recordingsOf(folder_ / "other.study", "S1", {}), IsEmpty());
}

TEST_F(StoreRemoval, LeavesTheRecordingsOfAnotherStudyInTheSameFolder) {
  StudyStore store(file_, Access::kRun);
  const std::int64_t id = somebody(store);
  fs::path other = file_;
  std::ofstream(other.replace_extension("db")) << "SQLite format 3";
  std::vector<fs::path> of_others;
  for (const char* name : {"-friction-900-1-first.h5", "-friction-001-1-2-first.h5"}) {
    of_others.push_back(recordingsFolder(file_) / fmt::format("{}{}", kCode, name));
    std::ofstream(of_others.back()) << "movements of somebody else";
  }
  std::ranges::sort(of_others);
  store.removeParticipant(id, "");
  EXPECT_EQ(othersThatName(file_, kCode), of_others);
}

TEST_F(StoreRemoval, NamesExportsThatHoldTheCode) {
  std::ofstream(folder_ / "a.csv") << "participant,x\nS01,1\nS02,2\n";
  std::ofstream(folder_ / "b.csv") << "participant,x\nS021,1\n";
  fs::create_directories(folder_ / "bids/sub-S02/beh");
  EXPECT_THAT(othersThatName(file_, "S02"), ElementsAre(folder_ / "a.csv", folder_ / "bids"));
}

// --- numbers and codes
// ------------------------------------------------------------------------------------------------------

TEST_F(StoreRemoval, GivesNoNumberAndNoCodeASecondTime) {
  int last = 0;
  {
    StudyStore store(file_, Access::kRun);
    store.removeParticipant(store.addParticipant("pilot7").id);
    const ParticipantRow row = store.addParticipant("S09");
    last = row.number;
    store.removeParticipant(row.id);
  }
  StudyStore store(file_, Access::kRun);
  for (const char* code : {"PILOT7", "s09"}) {
    EXPECT_THAT(messageOf<InvalidParameter>([&] { store.addParticipant(code); }), HasSubstr("was removed")) << code;
  }
  EXPECT_NE(store.removedAt("pilot7"), "");
  const ParticipantRow next = store.addParticipant("");
  EXPECT_EQ(next.code, "S10");
  EXPECT_GT(next.number, last);
  EXPECT_EQ(store.addParticipant("S03").code, "S03");  // it was never used
  EXPECT_THAT(bytesOf(file_) + bytesOf(file_.string() + "-wal"), Not(HasSubstr("pilot7")));
}

TEST(ParticipantCodes, AreFoundAsWordsOfTheirOwn) {
  EXPECT_TRUE(namesCode("a,S01,b", "s01"));
  EXPECT_FALSE(namesCode("S011 xS01", "S01"));
  EXPECT_EQ(withoutCode("S01: not S012, but s01", "S01"), "[removed]: not S012, but [removed]");
  EXPECT_EQ(numberInCode("S07"), 7);
  EXPECT_EQ(numberInCode("s123456"), 123456);
  for (const char* code : {"S", "S00", "S1234567", "T07", "S07b", "07"}) {
    EXPECT_EQ(numberInCode(code), 0) << code;
  }
}

TEST_F(StoreRemoval, AStudyOfTheFirstVersionGivesNoCodeASecondTimeEither) {
  const fs::path old = folder_ / "old.study";
  {
    SQLite::Database database(old.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    migrate(database, studyMigrations().first(1));
    database.exec(fmt::format("PRAGMA application_id = {}", kStudyApplicationId));
    SQLite::Statement study(database, "INSERT INTO study VALUES (1, 'A study', ?, ?, 42, 'then')");
    study.bind(1, kTwoBlocks);
    study.bind(2, sceneFileText(SceneFile()));
    study.exec();
    database.exec("INSERT INTO participant (number, code, state, begun_at) VALUES (3, 'S07', 'finished', 'then')");
  }
  StudyStore store(old, Access::kRun);
  store.removeParticipant(store.participants().front().id);
  const ParticipantRow next = store.addParticipant("");
  EXPECT_EQ(next.code, "S08");
  EXPECT_GT(next.number, 3);
}

// --- others at the same file
// ------------------------------------------------------------------------------------------

/// Tries both ways to delete, which fail and delete nothing.
class WhileAnotherReads : public StoreRemoval {
 protected:
  void expectNothingDeleted(StudyStore& store, std::int64_t id) const {
    for (const std::string& message : {messageOf<Failure>([&] { store.removeParticipant(id); }),
                                       messageOf<Failure>([&] { (void)store.forgetPersonal(id); })}) {
      EXPECT_THAT(message, AllOf(HasSubstr("a.study is open in another program"), HasSubstr("nothing has been deleted"),
                                 HasSubstr("close that program")));
    }
    EXPECT_EQ(store.trials(id).size(), kTrials + 1U);
    EXPECT_EQ(recordingsOf(file_, kCode, {}).size(), std::size_t{kTrials});
    EXPECT_THAT(store.removals(), IsEmpty());
    store.addNote(0, "the study goes on", "note");
  }
};

TEST_F(WhileAnotherReads, NothingIsRemoved) {
  StudyStore store(file_, Access::kRun);
  const std::int64_t id = somebody(store);
  {
    SQLite::Database browser(file_.string(), SQLite::OPEN_READWRITE);
    browser.exec("BEGIN; SELECT count(*) FROM trial");
    expectNothingDeleted(store, id);
  }
  store.removeParticipant(id);
  EXPECT_THAT(traces(), IsEmpty());
}

TEST_F(WhileAnotherReads, NothingIsRemovedWhicheverProcessItIs) {
  Pipe to_child, to_parent;
  const pid_t child = fork();  // before this process opens the file: SQLite's locks would be taken for the child's own
  if (child == 0) {
    (void)to_child.listen();
    const StudyStore reader(file_, Access::kRead);
    to_parent.tell(static_cast<int>(reader.trials().size()));
    pause();
    _exit(0);
  }
  StudyStore store(file_, Access::kRun);
  const std::int64_t id = somebody(store);
  to_child.tell(1);
  ASSERT_GT(to_parent.listen(), 0);
  expectNothingDeleted(store, id);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  store.removeParticipant(id);
  EXPECT_THAT(traces(), IsEmpty());
}

TEST_F(StoreRemoval, WaitsForAProgramThatOnlyLooks) {
  StudyStore store(file_, Access::kRun);
  const std::int64_t id = somebody(store);
  auto browser = std::make_unique<SQLite::Database>(file_.string(), SQLite::OPEN_READWRITE);
  browser->exec("SELECT count(*) FROM trial");
  std::thread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    browser.reset();
  });
  store.removeParticipant(id);
  later.join();
  EXPECT_THAT(traces(), IsEmpty());
}

// --- what comes between
// -----------------------------------------------------------------------------------------------

TEST_F(StoreRemoval, OneThatFailsHalfWayIsBroughtToItsEndByTheNextRun) {
  {
    StudyStore store(file_, Access::kRun);
    const std::int64_t id = somebody(store);
    fs::create_directories(recording(99) / "not empty");  // cannot be deleted
    const std::string message = messageOf<Failure>([&] { store.removeParticipant(id); });
    EXPECT_THAT(message, AllOf(HasSubstr("cannot delete"), HasSubstr("not completed")));
    EXPECT_EQ(store.removals()[0].done_at, "");
  }
  EXPECT_THAT(messageOf<Failure>([&] { const StudyStore store(file_, Access::kRun); }), HasSubstr("not completed"));
  EXPECT_EQ(StudyStore(file_, Access::kRead).removals()[0].done_at, "");
  fs::remove_all(recording(99));
  const StudyStore store(file_, Access::kRun);
  EXPECT_NE(store.removals()[0].done_at, "");
  EXPECT_THAT(traces(), IsEmpty());
}

TEST_F(StoreRemoval, AKillAtAnyMomentLeavesAllOrNothing) {
  std::mt19937_64 random(11);
  std::chrono::microseconds whole{0};
  constexpr int kRuns = 41, kMostRuns = 400;  // more where a busy machine lets no kill come between
  int claimed = 0, kept = 0, between = 0;
  for (int kill_number = 0; kill_number < kRuns || (kill_number < kMostRuns && (kept == 0 || between == 0));
       ++kill_number) {
    fs::remove_all(recordingsFolder(file_));
    fs::remove(file_);
    StudyStore::create(file_, loadProtocolText(kTwoBlocks, "two.toml"), kTwoBlocks, 42);
    std::int64_t id = 0;
    {
      StudyStore store(file_, Access::kRun);
      id = somebody(store);
    }
    Pipe pipe;
    const pid_t child = fork();
    if (child == 0) {
      StudyStore store(file_, Access::kRun);
      pipe.tell(0);
      store.removeParticipant(id);
      pipe.tell(1);
      _exit(0);
    }
    pipe.closeWriting();
    ASSERT_EQ(pipe.listen(), 0);
    const auto begun = std::chrono::steady_clock::now();
    if (kill_number > 0) {  // the first measures its duration
      std::this_thread::sleep_for(whole * (random() % 1000) / 1000);
      kill(child, SIGKILL);
    }
    waitpid(child, nullptr, 0);
    const bool claims = !pipe.told().empty();
    if (kill_number == 0) {
      ASSERT_TRUE(claims);
      whole = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - begun);
    }
    if (claims) {
      ++claimed;
      ASSERT_THAT(traces(), IsEmpty()) << "it was said to be deleted";
    }
    const StudyStore store(file_, Access::kRun);
    if (store.participants().size() == 3) {
      ++kept;
      ASSERT_FALSE(claims);
      ASSERT_THAT(store.removals(), IsEmpty());
      ASSERT_EQ(store.trials(id).size(), kTrials + 1U);
      ASSERT_EQ(store.formAnswers(true).size(), 2U);
      ASSERT_EQ(recordingsOf(file_, kCode, {}).size(), std::size_t{kTrials});
    } else {
      between += claims ? 0 : 1;
      ASSERT_THAT(traces(), IsEmpty());
      ASSERT_EQ(store.trials().size(), 2U * kTrials);
    }
  }
  RecordProperty("said_to_be_deleted", claimed);
  EXPECT_GT(kept, 0);
  EXPECT_GT(between, 0);
}

}  // namespace
}  // namespace haptolith
