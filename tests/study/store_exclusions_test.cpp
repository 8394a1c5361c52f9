#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>

#include <cstdint>
#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/study/store/participant_flow.h"
#include "haptolith/study/store/store.h"

#include "a_study.h"

namespace haptolith {
namespace {

using testing::HasSubstr;
using Access = StudyStore::Access;
using StoreExclusions = AStudy;

TEST_F(StoreExclusions, AreALogOfWhoWhenAndWhy) {
  {
    StudyStore store(file_, Access::kRun);
    const std::int64_t id = store.addParticipant("").id;
    EXPECT_FALSE(isLeftOut(store.participants()[0]));
    store.setExcluded(id, true, "catch trials");
    EXPECT_EQ(store.participants()[0].excluded_for, "catch trials");
    EXPECT_EQ(standingOf(store.participants()[0]), "excluded");
    EXPECT_EQ(store.participants()[0].state, "running");
    EXPECT_TRUE(isLeftOut(store.participants()[0]));
    store.setExcluded(id, false, "another criterion");
    EXPECT_FALSE(isLeftOut(store.participants()[0]));
    store.setExcluded(id, true, "asleep");
  }
  const StudyStore store(file_, Access::kRead);
  const std::vector<ExclusionRow> log = store.exclusions();
  ASSERT_EQ(log.size(), 3U);
  EXPECT_TRUE(log[0].excluded);
  EXPECT_EQ(log[0].reason, "catch trials");
  EXPECT_FALSE(log[1].excluded);
  EXPECT_EQ(log[2].reason, "asleep");
  EXPECT_NE(log[2].at, "");
}

TEST_F(StoreExclusions, NeedAReasonAndAChange) {
  StudyStore store(file_, Access::kRun);
  const std::int64_t id = store.addParticipant("").id;
  EXPECT_THAT(messageOf<InvalidParameter>([&] { store.setExcluded(id, true, " "); }), HasSubstr("reason"));
  EXPECT_THAT(messageOf<InvalidParameter>([&] { store.setExcluded(id, false, "none"); }), HasSubstr("is not excluded"));
  store.setExcluded(id, true, "catch trials");
  EXPECT_THAT(messageOf<InvalidParameter>([&] { store.setExcluded(id, true, "asleep"); }),
              HasSubstr("already excluded (reason: catch trials)"));
  EXPECT_EQ(store.exclusions().size(), 1U);
}

TEST_F(StoreExclusions, AreNeitherChangedNorDeletedButGoWithTheirParticipant) {
  std::int64_t id = 0;
  {
    StudyStore store(file_, Access::kRun);
    id = store.addParticipant("").id;
    const std::int64_t other = store.addParticipant("").id;
    store.setExcluded(id, true, "catch trials");
    store.setExcluded(other, true, "as bad as S01");
  }
  for (const char* sql : {"UPDATE exclusion SET reason = 'x'", "DELETE FROM exclusion",
                          "PRAGMA foreign_keys = ON; DELETE FROM participant"}) {
    EXPECT_THROW(SQLite::Database(file_.string(), SQLite::OPEN_READWRITE).exec(sql), SQLite::Exception) << sql;
  }
  StudyStore store(file_, Access::kRun);
  store.removeParticipant(id);
  ASSERT_EQ(store.exclusions().size(), 1U);
  EXPECT_EQ(store.exclusions()[0].reason, "as bad as [removed]");
}

TEST_F(StoreExclusions, TheFlowCountsEverybodyOnce) {
  StudyStore store(file_, Access::kRun);
  EXPECT_EQ(flowText(flowOf(store)), "0 began, 0 analysed");
  std::vector<std::int64_t> ids;
  for (int i = 0; i < 6; ++i) {
    ids.push_back(store.addParticipant("").id);
  }
  store.endParticipant(ids[0], "withdrawn");
  store.endParticipant(ids[1], "finished");
  store.setExcluded(ids[0], true, "catch trials");  // withdrew all the same
  store.setExcluded(ids[2], true, "catch trials");
  EXPECT_EQ(flowText(flowOf(store)), "6 began, 1 withdrew, 1 excluded (catch trials), 4 analysed (3 not finished)");
  store.setExcluded(ids[3], true, "asleep");
  store.removeParticipant(ids[4]);
  EXPECT_EQ(flowText(flowOf(store)),
            "6 began, 1 removed on request, 1 withdrew, 2 excluded (asleep: 1; catch trials: 1), "
            "2 analysed (1 not finished)");
}

TEST_F(StoreExclusions, GiveTheirRowOfTheSquareBack) {
  StudyStore store(file_, Access::kRun);
  const ParticipantRow first = store.addParticipant("");
  store.addParticipant("");
  store.setExcluded(first.id, true, "asleep");
  EXPECT_EQ(store.addParticipant("").number % 2, first.number % 2);
}

}  // namespace
}  // namespace haptolith
