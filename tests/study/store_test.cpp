#include "haptolith/study/store/store.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "haptolith/core/error.h"

#include "a_study.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using Access = StudyStore::Access;

using Store = AStudy;

std::string bytesOf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

TEST_F(Store, KeepsTheProtocolItsSceneAndItsSeed) {
  const StudyStore store(file_, Access::kRead);
  EXPECT_EQ(store.title(), "A study");
  EXPECT_EQ(store.seed(), 42U);
  EXPECT_EQ(store.protocolText(), kTwoBlocks);
  ASSERT_EQ(store.protocol().blocks.size(), 2U);
  EXPECT_EQ(store.protocol().blocks[1].name, "gravity");
  EXPECT_EQ(sceneFileText(store.protocol().scene), sceneFileText(SceneFile()));
}

TEST_F(Store, KeepsAnotherSceneThanThePapersWhenItsFileHasGone) {
  const fs::path scene = folder_ / "scene.toml";
  std::ofstream(scene) << "title = 'other'\n[gravity]\nbody = 'Mars'\n";
  const std::string text = "scene = 'scene.toml'\n" + kTwoBlocks;
  StudyStore::create(folder_ / "b.study", loadProtocolText(text, (folder_ / "b.toml").string()), text, 1);
  fs::remove(scene);
  const StudyStore store(folder_ / "b.study", Access::kRead);
  EXPECT_EQ(store.protocol().scene.title, "other");
  EXPECT_EQ(store.protocol().scene.body, "Mars");
}

TEST_F(Store, IsNeverOverwritten) {
  const std::string before = bytesOf(file_);
  EXPECT_THAT(
      messageOf<Failure>([&] { StudyStore::create(file_, loadProtocolText(kTwoBlocks, "two.toml"), kTwoBlocks, 1); }),
      HasSubstr("a.study already exists"));
  EXPECT_EQ(bytesOf(file_), before);
}

TEST_F(Store, TakesNamesThatLeaveRoomForTheFilesBesideIt) {
  const auto create = [this](std::size_t bytes) {
    const fs::path file = folder_ / (std::string(bytes - 6, 'x') + ".study");
    StudyStore::create(file, loadProtocolText(kTwoBlocks, "two.toml"), kTwoBlocks, 1);
    return file;
  };
  EXPECT_EQ(StudyStore(create(244), Access::kRun).seed(), 1U);
  const auto files = [this] { return std::distance(fs::directory_iterator(folder_), {}); };
  const auto before = files();
  EXPECT_THAT(messageOf<InvalidParameter>([&] { create(245); }), HasSubstr("at most 244 bytes"));
  EXPECT_EQ(files(), before) << "nothing is left of it";
}

TEST_F(Store, LeavesNothingBesideItsFileWhenItIsClosed) {
  { const StudyStore store(file_, Access::kRead); }
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
    names.push_back(entry.path().filename().string());
  }
  EXPECT_THAT(names, ElementsAre("a.study"));
}

TEST_F(Store, RefusesASeedThatOtherProgramsWouldRound) {
  const StudyProtocol protocol = loadProtocolText(kTwoBlocks, "two.toml");
  EXPECT_THAT(messageOf<InvalidParameter>(
                  [&] { StudyStore::create(folder_ / "b.study", protocol, kTwoBlocks, std::uint64_t{1} << 53); }),
              HasSubstr("seed"));
  EXPECT_FALSE(fs::exists(folder_ / "b.study"));
}

// --- participants
// -----------------------------------------------------------------------------------------------------

TEST_F(Store, NumbersParticipantsAndGivesThemPseudonyms) {
  StudyStore store(file_, Access::kRun);
  EXPECT_EQ(store.addParticipant("").code, "S01");
  const ParticipantRow second = store.addParticipant("S03");
  EXPECT_EQ(second.number, 2);
  EXPECT_EQ(store.addParticipant("").code, "S04");  // S03 is taken
  EXPECT_EQ(store.addParticipant("pilot7").number, 4);
  EXPECT_EQ(store.participants().size(), 4U);
  EXPECT_EQ(store.participants()[1].state, "running");
}

TEST_F(Store, RefusesCodesThatAreTakenOrNoFileNames) {
  StudyStore store(file_, Access::kRun);
  store.addParticipant("S07");
  for (const char* code : {"s07", "S07", "../x", "Jo Doe", "ü", "12345678901234567"}) {
    EXPECT_THROW(store.addParticipant(code), InvalidParameter) << code;
  }
  EXPECT_EQ(store.participants().size(), 1U);
}

TEST_F(Store, RemembersHowFarSomebodyIs) {
  const std::int64_t id = [&] {
    StudyStore store(file_, Access::kRun);
    const std::int64_t added = store.addParticipant("").id;
    store.markStep(added, "consent");
    store.markStep(added, "block 0 done");
    store.markStep(added, "consent");
    store.endParticipant(added, "withdrawn");
    return added;
  }();
  StudyStore store(file_, Access::kRun);
  EXPECT_THAT(store.steps(id), ElementsAre("block 0 done", "consent"));
  EXPECT_EQ(store.participants().front().state, "withdrawn");
  EXPECT_NE(store.participants().front().ended_at, "");
  store.endParticipant(id, "running");
  EXPECT_EQ(store.participants().front().ended_at, "");
  EXPECT_THROW(store.endParticipant(id, "tired"), InvalidParameter);
  EXPECT_THROW(store.endParticipant(id + 1, "finished"), Failure);
}

// --- forms
// ------------------------------------------------------------------------------------------------------------

TEST_F(Store, KeepsPersonalAnswersApart) {
  StudyStore store(file_, Access::kRun);
  const std::int64_t id = store.addParticipant("").id;
  store.setAnswers(id, "demographics", store.protocol().demographics, {{"name", "Ada"}, {"age", "36"}});
  ASSERT_EQ(store.formAnswers(false).size(), 1U);
  EXPECT_EQ(store.formAnswers(false)[0].key, "age");
  ASSERT_EQ(store.formAnswers(true).size(), 2U);
  EXPECT_EQ(store.formAnswers(true)[1].value, "Ada");
  EXPECT_TRUE(store.formAnswers(true)[1].personal);
}

TEST_F(Store, ReplacesAFormThatIsFilledInAgain) {
  StudyStore store(file_, Access::kRun);
  const std::int64_t id = store.addParticipant("").id;
  store.setAnswers(id, "demographics", store.protocol().demographics, {{"name", "Ada"}, {"age", "36"}});
  store.setAnswers(id, "demographics", store.protocol().demographics, {{"name", ""}, {"age", "37"}});
  ASSERT_EQ(store.formAnswers(true).size(), 1U);
  EXPECT_EQ(store.formAnswers(true)[0].value, "37");
}

TEST_F(Store, RefusesFormsThatAreIncompleteOrWrong) {
  StudyStore store(file_, Access::kRun);
  const std::int64_t id = store.addParticipant("").id;
  const std::vector<FormItem>& items = store.protocol().demographics;
  const auto refusal = [&](const std::map<std::string, std::string>& values) {
    return messageOf<InvalidParameter>([&] { store.setAnswers(id, "demographics", items, values); });
  };
  EXPECT_THAT(refusal({{"name", "Ada"}}), HasSubstr("age"));
  EXPECT_THAT(refusal({{"age", "17"}}), HasSubstr("18 to 99"));
  EXPECT_THAT(refusal({{"age", "thirty"}}), HasSubstr("a number"));
  EXPECT_THAT(refusal({{"age", "36"}, {"shoe", "42"}}), HasSubstr("not have this item"));
  EXPECT_TRUE(store.formAnswers(true).empty());
}

// --- trials
// -----------------------------------------------------------------------------------------------------------

TEST_F(Store, GivesBackWhatATrialWasAndWhatWasAnswered) {
  std::int64_t id = 0;
  {
    StudyStore store(file_, Access::kRun);
    id = store.addParticipant("").id;
    store.answerTrial(store.beginTrial(trial(id, 7)), answer(0.8125));
  }
  const StudyStore store(file_, Access::kRead);
  const std::vector<TrialRow> rows = store.trials(id);
  ASSERT_EQ(rows.size(), 1U);
  const TrialRow& row = rows[0];
  const TrialBegun begun = trial(id, 7);
  EXPECT_EQ(row.participant, id);
  EXPECT_EQ(row.position, 1U);
  EXPECT_EQ(row.index, 7);
  EXPECT_EQ(row.kind, TrialKind::kMain);
  EXPECT_EQ(row.level, "P1");
  EXPECT_EQ(row.reference, "P3");
  EXPECT_EQ(row.value, 1.21);
  EXPECT_EQ(row.reference_value, 0.835);
  EXPECT_TRUE(row.test_first);
  EXPECT_EQ(row.seed, begun.seed);
  EXPECT_EQ(row.state, TrialState::kAnswered);
  EXPECT_GE(row.answered_at, row.begun_at);
  ASSERT_TRUE(row.answer);
  EXPECT_TRUE(row.answer->positive);
  EXPECT_EQ(row.answer->correct, true);
  EXPECT_EQ(row.answer->reaction_s, 0.8125);
  EXPECT_EQ(row.recording, "S01-friction");
  EXPECT_EQ(row.answer->summaries[0].peak_force_n, 7.5);
  EXPECT_TRUE(std::isnan(row.answer->summaries[0].work_j));
  EXPECT_EQ(row.answer->summaries[1].work_j, -0.5);
  EXPECT_EQ(row.answer->summaries[1].deadline_misses, 3);
}

TEST_F(Store, TakesOneAnswerForATrial) {
  StudyStore store(file_, Access::kRun);
  const std::int64_t id = store.addParticipant("").id;
  const std::int64_t begun = store.beginTrial(trial(id, 0));
  store.answerTrial(begun, answer(1));
  EXPECT_THAT(messageOf<Failure>([&] { store.answerTrial(begun, answer(2)); }), HasSubstr("is answered"));
  EXPECT_THAT(messageOf<Failure>([&] { store.beginTrial(trial(id, 0, 1)); }), HasSubstr("already has a response"));
  ASSERT_EQ(store.trials(id).size(), 1U);
  EXPECT_EQ(store.trials(id)[0].answer->reaction_s, 1);
}

TEST_F(Store, HasOneTrialUnderWayForEachParticipant) {
  StudyStore store(file_, Access::kRun);
  const std::int64_t one = store.addParticipant("").id;
  const std::int64_t other = store.addParticipant("").id;
  const std::int64_t begun = store.beginTrial(trial(one, 0));
  EXPECT_THAT(messageOf<Failure>([&] { store.beginTrial(trial(one, 1)); }), HasSubstr("is running"));
  store.beginTrial(trial(other, 0));
  store.voidTrial(begun, TrialState::kLost, "crash");
  store.beginTrial(trial(one, 0, 1));
  EXPECT_THROW(store.answerTrial(begun, answer(1)), Failure);
}

TEST_F(Store, KeepsTheAnswerToATrialThatIsRepeated) {
  StudyStore store(file_, Access::kRun);
  const std::int64_t id = store.addParticipant("").id;
  const std::int64_t first = store.beginTrial(trial(id, 0));
  store.answerTrial(first, answer(1));
  store.voidTrial(first, TrialState::kRepeated, "the phone rang");
  store.answerTrial(store.beginTrial(trial(id, 0, 1)), answer(2));
  const std::vector<TrialRow> rows = store.trials(id);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].state, TrialState::kRepeated);
  EXPECT_EQ(rows[0].reason, "the phone rang");
  ASSERT_TRUE(rows[0].answer);
  EXPECT_EQ(rows[0].answer->reaction_s, 1);
  EXPECT_EQ(rows[1].state, TrialState::kAnswered);
  EXPECT_THROW(store.voidTrial(rows[1].id, TrialState::kLost, ""), Failure);
  EXPECT_THROW(store.voidTrial(rows[0].id, TrialState::kRepeated, ""), Failure);
  EXPECT_THROW(store.voidTrial(rows[1].id, TrialState::kAnswered, ""), InvalidParameter);
}

TEST_F(Store, KeepsNotesInTheirOrder) {
  StudyStore store(file_, Access::kRun);
  const std::int64_t id = store.addParticipant("").id;
  store.addNote(id, "left-handed", "note");
  store.addNote(0, "new chair", "note");
  const std::vector<NoteRow> notes = store.notes();
  ASSERT_EQ(notes.size(), 2U);
  EXPECT_EQ(notes[0].participant, id);
  EXPECT_EQ(notes[0].text, "left-handed");
  EXPECT_EQ(notes[1].participant, 0);
  EXPECT_THROW(store.addNote(id + 5, "nobody", "note"), Failure);
}

TEST_F(Store, DoesNotWriteWhenItIsOnlyRead) {
  StudyStore store(file_, Access::kRead);
  EXPECT_THAT(messageOf<Failure>([&] { store.addParticipant(""); }), HasSubstr("read only"));
}

}  // namespace
}  // namespace haptolith
