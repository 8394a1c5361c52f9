#include "haptolith/study/protocol/groups.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/study/protocol/sequence.h"
#include "haptolith/study/run/conductor.h"
#include "haptolith/study/run/simulated_participant.h"
#include "haptolith/study/run/study_messages.h"
#include "haptolith/study/store/participant_flow.h"
#include "haptolith/study/store/store.h"

#include "a_study.h"
#include "a_study_with_groups.h"
#include "fake_rig.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using Access = StudyStore::Access;

StudyProtocol load(const std::string& text) {
  return loadProtocolText(text, "x.toml");
}

/// kTwoGroups with one text in place of another.
std::string with(const std::string& old_text, const std::string& new_text) {
  std::string text = kTwoGroups;
  const std::size_t at = text.find(old_text);
  return at == std::string::npos ? "no such text" : text.replace(at, old_text.size(), new_text);
}

// --- the protocol
// -----------------------------------------------------------------------------------------------------

TEST(Groups, AreReadWithTheirBlocksAndShares) {
  const StudyProtocol protocol =
      load(with("blocks = [\"gravity\"]", "blocks = [\"gravity\", \"friction\"]\nshare = 3"));
  ASSERT_EQ(protocol.groups.size(), 2U);
  EXPECT_EQ(protocol.groups[0].name, "both");
  EXPECT_THAT(protocol.groups[0].blocks, ElementsAre(0, 1)) << "left out: all";
  EXPECT_EQ(protocol.groups[0].share, 1);
  EXPECT_THAT(protocol.groups[1].blocks, ElementsAre(1, 0)) << "in the order of the list";
  EXPECT_EQ(protocol.groups[1].share, 3);
  EXPECT_EQ(protocol.assignment.method, AssignmentMethod::kStratified);
  EXPECT_EQ(protocol.assignment.block_size, 4);
  EXPECT_THAT(protocol.assignment.strata, ElementsAre("hand", "age"));
}

/// kTwoGroups with people who come into them without strata.
std::string withoutStrata(const std::string& assignment) {
  std::string text = with("method = \"stratified\"\nblock_size = 4\nstrata = [\"hand\", \"age\"]\n", assignment);
  const std::string cuts = "cut_points = [30, 50]\n";
  return text.erase(text.find(cuts), cuts.size());
}

TEST(Groups, ComeInPermutedBlocksOfTwiceTheSharesUnlessTheProtocolSaysOtherwise) {
  const StudyProtocol protocol = load(withoutStrata(""));
  EXPECT_EQ(protocol.assignment.method, AssignmentMethod::kRandom);
  EXPECT_EQ(protocol.assignment.block_size, 4);
}

struct Nonsense {
  const char* what;
  std::string text;
  const char* message;
};

class NonsenseOfGroups : public testing::TestWithParam<Nonsense> {};

TEST_P(NonsenseOfGroups, IsRefusedWithValueAndValidRange) {
  EXPECT_THAT(messageOf<InvalidParameter>([] { (void)load(GetParam().text); }),
              AllOf(HasSubstr("x.toml"), HasSubstr(GetParam().message)));
}

INSTANTIATE_TEST_SUITE_P(
    Groups, NonsenseOfGroups,
    testing::Values(
        Nonsense{"AnUnknownBlock", with("blocks = [\"gravity\"]", "blocks = [\"weight\"]"),
                 ":13: [[groups]] blocks = [ 'weight' ] is not valid: must be one or more of friction, gravity, each "
                 "once; there is no block 'weight'"},
        Nonsense{"NoBlocks", with("blocks = [\"gravity\"]", "blocks = []"),
                 "[[groups]] blocks = [] is not valid: must be one or more of friction, gravity"},
        Nonsense{"ABlockTwice", with("blocks = [\"gravity\"]", "blocks = [\"gravity\", \"gravity\"]"),
                 "'gravity' occurs twice"},
        Nonsense{"OneGroup", with("[[groups]]\nname = \"weight\"\nblocks = [\"gravity\"]\n", ""),
                 "[[groups]] = both alone is not valid: must be two or more"},
        Nonsense{"TwoGroupsOfOneName", with("name = \"weight\"", "name = \"both\""),
                 "[[groups]] name = 'both' is not valid: must be another one: a group above has it"},
        Nonsense{"ANameThatIsNone", with("name = \"weight\"", "name = \"weight 2\""), "[[groups]] name"},
        Nonsense{"NoName", with("name = \"weight\"\n", ""), "[[groups]] name is missing"},
        Nonsense{"AShareOfNothing", with("name = \"weight\"", "name = \"weight\"\nshare = 0"), "1 to 100"},
        Nonsense{"ABlockThatNobodyGoesThrough", with("name = \"both\"\n", "name = \"both\"\nblocks = \"gravity\"\n"),
                 "[[groups]] leave out the block 'friction'"},
        Nonsense{"AStratumThatIsNoItem", with("\"age\"]", "\"weight\"]"),
                 "[assignment] strata = [ 'hand', 'weight' ] is not valid: must be keys of [[demographics]] items; "
                 "'weight' does not exist"},
        Nonsense{"AStratumOfFreeText",
                 with("kind = \"choice\"\nchoices = [\"left\", \"right\"]\n", "kind = \"text\"\n"),
                 "'hand' is free text"},
        Nonsense{"AStratumOfUncutNumbers", with("cut_points = [30, 50]\n", ""), "'age' has no `cut_points`"},
        Nonsense{"AStratumThatNeedNotBeAnswered", with("required = true\n", ""), "'hand' must be `required`"},
        Nonsense{"AStratumThatTellsWhoItIs", with("required = true\n", "required = true\npersonal = true\n"),
                 "'hand' is `personal`"},
        Nonsense{"AStratumTwice", with("\"age\"]", "\"age\", \"hand\"]"), "'hand' occurs twice"},
        Nonsense{"NoStrata", with("strata = [\"hand\", \"age\"]\n", ""), "[assignment] strata"},
        Nonsense{"StrataOfAnotherMethod", with("\"stratified\"", "\"random\""),
                 "left out: only method = \"stratified\" has them"},
        Nonsense{"CutPointsThatCutNothing", with("\"hand\", \"age\"]", "\"hand\"]"),
                 "with 'age', which has `cut_points`"},
        Nonsense{"CutPointsInNoOrder", with("[30, 50]", "[50, 30]"), "in ascending order"},
        Nonsense{"CutPointsOutsideOfTheRange", with("[30, 50]", "[18, 50]"), "> low, 18, and <= high, 99"},
        Nonsense{"CutPointsOfAChoice", with("\"right\"]\n", "\"right\"]\ncut_points = 3\n"),
                 "only numbers and scales have them"},
        Nonsense{"AnUnknownMethod", with("\"stratified\"", "\"minimisation\""), "alternate, random or stratified"},
        Nonsense{"ABlockSizeThatSharesCannotFill", with("block_size = 4", "block_size = 5"),
                 "[assignment] block_size = 5 is not valid: must be a multiple of the sum of all shares, 2"},
        Nonsense{"ABlockSizeOfTurns", withoutStrata("method = \"alternate\"\nblock_size = 4\n"),
                 "alternating groups have no permuted blocks"},
        Nonsense{
            "AnAssignmentToNothing",
            "title = 'x'\n[assignment]\nmethod = 'random'\n" + kTwoBlocks.substr(kTwoBlocks.find("[[demographics]]")),
            "there are no [[groups]]"}),
    [](const auto& of) { return of.param.what; });

TEST(Groups, HaveStrataOfChoicesAndOfNumbersBetweenCutPoints) {
  const StudyProtocol protocol = load(kTwoGroups);
  EXPECT_EQ(strataOf(protocol), 6U);
  const auto text = [&](const char* hand, const char* age) {
    return stratumText(protocol, stratumOf(protocol, {{"hand", hand}, {"age", age}}));
  };
  EXPECT_EQ(text("left", "18"), "hand left; age < 30");
  EXPECT_EQ(text("left", "29.9"), "hand left; age < 30");
  EXPECT_EQ(text("right", "30"), "hand right; age 30 to < 50") << "a cut belongs to the part above it";
  EXPECT_EQ(text("right", "50"), "hand right; age >= 50");
  std::set<std::size_t> all;
  for (const char* hand : {"left", "right"}) {
    for (const char* age : {"20", "40", "60"}) {
      all.insert(stratumOf(protocol, {{"hand", hand}, {"age", age}}));
    }
  }
  EXPECT_THAT(all, ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_THROW((void)stratumOf(protocol, {{"hand", "left"}}), InvalidParameter);
}

// --- who comes into which
// ---------------------------------------------------------------------------------------------

/// Counts of each group in these places of a stratum's sequence.
std::array<int, 2> counted(const StudyProtocol& protocol, std::size_t stratum, std::size_t first, std::size_t count) {
  std::array<int, 2> counts{};
  for (std::size_t place = first; place < first + count; ++place) {
    ++counts.at(groupAt(protocol, 42, stratum, place));
  }
  return counts;
}

TEST(Groups, HaveTheirSharesOfEveryPermutedBlock) {
  StudyProtocol protocol = load(kTwoGroups);
  for (std::size_t stratum = 0; stratum < strataOf(protocol); ++stratum) {
    for (std::size_t block = 0; block < 50; ++block) {
      EXPECT_THAT(counted(protocol, stratum, 4 * block, 4), ElementsAre(2, 2)) << stratum << " " << block;
    }
  }
  protocol.groups[1].share = 2;
  protocol.assignment.block_size = 6;
  EXPECT_THAT(counted(protocol, 0, 0, 6), ElementsAre(2, 4));
  EXPECT_THAT(counted(protocol, 3, 60, 600), ElementsAre(200, 400));
}

TEST(Groups, ComeInEveryOrderOfAPermutedBlockEquallyOften) {
  const StudyProtocol protocol = load(kTwoGroups);
  std::map<std::string, int> orders;
  constexpr int kBlocks = 6000;
  for (std::size_t block = 0; block < kBlocks; ++block) {
    std::string order;
    for (std::size_t place = 0; place < 4; ++place) {
      order += groupAt(protocol, 42, 2, 4 * block + place) == 0 ? 'a' : 'b';
    }
    ++orders[order];
  }
  EXPECT_EQ(orders.size(), 6U) << "four over two";
  for (const auto& [order, times] : orders) {
    EXPECT_NEAR(times, kBlocks / 6.0, 4 * std::sqrt(kBlocks * (1.0 / 6) * (5.0 / 6))) << order;
  }
}

TEST(Groups, FollowFromTheStudysSeedAndTheStratum) {
  const StudyProtocol protocol = load(kTwoGroups);
  const auto sequence = [&](std::uint64_t seed, std::size_t stratum) {
    std::vector<std::size_t> groups;
    for (std::size_t place = 0; place < 100; ++place) {
      groups.push_back(groupAt(protocol, seed, stratum, place));
    }
    return groups;
  };
  EXPECT_EQ(sequence(42, 0), sequence(42, 0));
  EXPECT_NE(sequence(42, 0), sequence(43, 0));
  EXPECT_NE(sequence(42, 0), sequence(42, 1));
}

TEST(Groups, TakeTurnsWithoutChance) {
  StudyProtocol protocol = load(kTwoGroups);
  protocol.assignment = {.method = AssignmentMethod::kAlternate, .block_size = 6};
  protocol.groups[0].share = 2;
  std::string turns;
  for (std::size_t place = 0; place < 6; ++place) {
    turns += groupAt(protocol, 42, 0, place) == 0 ? 'a' : 'b';
  }
  EXPECT_EQ(turns, "abaaba");
}

// --- in the study's file
// ----------------------------------------------------------------------------------------------

class StudyWithGroups : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / fmt::format("haptolith_groups_{}", getpid());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    make(kTwoGroups);
  }
  void TearDown() override {
    conductor_.reset();
    store_.reset();
    fs::remove_all(folder_);
  }

  void make(const std::string& protocol) {
    conductor_.reset();
    store_.reset();
    fs::remove(folder_ / "a.study");
    StudyStore::create(folder_ / "a.study", load(protocol), protocol, 42);
    open();
  }
  /// As the program does after it has ended, however that came.
  void open() {
    conductor_.reset();
    store_.reset();
    store_ = std::make_unique<StudyStore>(folder_ / "a.study", Access::kRun);
    rig_ = std::make_unique<FakeRig>();
    conductor_ = std::make_unique<Conductor>(*store_, *rig_, ConductorOptions{.now_s = [this] { return now_s_; }});
  }

  /// Assigns a participant of the first stratum.
  ParticipantRow somebody() {
    const std::int64_t id = store_->addParticipant("").id;
    store_->setAnswers(id, "demographics", store_->protocol().demographics, {{"hand", "left"}, {"age", "20"}});
    (void)store_->assignGroup(id);
    const std::vector<ParticipantRow> all = store_->participants();
    return *std::ranges::find(all, id, &ParticipantRow::id);
  }
  [[nodiscard]] std::size_t expectedGroup(std::size_t place) const { return groupAt(store_->protocol(), 42, 0, place); }
  [[nodiscard]] std::string nameAt(std::size_t place) const {
    return store_->protocol().groups[expectedGroup(place)].name;
  }

  fs::path folder_;
  double now_s_ = 0;
  std::unique_ptr<StudyStore> store_;
  std::unique_ptr<FakeRig> rig_;
  std::unique_ptr<Conductor> conductor_;
};

TEST_F(StudyWithGroups, AGroupIsDecidedOnceAndStays) {
  const std::int64_t id = store_->addParticipant("").id;
  EXPECT_FALSE(store_->participants()[0].assignment);
  EXPECT_THROW((void)store_->assignGroup(id), InvalidParameter) << "nothing is known of the stratum";
  EXPECT_THAT(store_->placesGiven(), testing::Each(0));
  store_->setAnswers(id, "demographics", store_->protocol().demographics, {{"hand", "right"}, {"age", "61"}});
  const Assignment first = store_->assignGroup(id);
  store_->setAnswers(id, "demographics", store_->protocol().demographics, {{"hand", "left"}, {"age", "20"}});
  const Assignment second = store_->assignGroup(id);
  EXPECT_EQ(stratumText(store_->protocol(), second.stratum), "hand right; age >= 50");
  EXPECT_EQ(second.group, first.group);
  EXPECT_EQ(second.place, 0);
  EXPECT_THAT(store_->placesGiven(), ElementsAre(0, 0, 0, 0, 0, 1));
  store_.reset();
  conductor_.reset();
  for (const char* sql : {"UPDATE assignment SET group_name = 'both'", "DELETE FROM assignment",
                          "UPDATE allocation SET places = places - 1", "DELETE FROM allocation"}) {
    EXPECT_THROW(SQLite::Database((folder_ / "a.study").string(), SQLite::OPEN_READWRITE).exec(sql), SQLite::Exception)
        << sql;
  }
}

TEST_F(StudyWithGroups, NobodyGetsThePlaceOfWhoWasRemovedExcludedOrHasWithdrawn) {
  const ParticipantRow removed = somebody(), excluded = somebody(), withdrew = somebody();
  store_->removeParticipant(removed.id, "asked for it");
  store_->setExcluded(excluded.id, true, "asleep");
  store_->endParticipant(withdrew.id, "withdrawn");
  for (int place = 3; place < 12; ++place) {
    const ParticipantRow next = somebody();
    EXPECT_EQ(next.assignment->place, place);
    EXPECT_EQ(next.assignment->group, nameAt(static_cast<std::size_t>(place)));
  }
  EXPECT_EQ(store_->placesGiven()[0], 12);
}

TEST_F(StudyWithGroups, OrdersOfBlocksAreBalancedWithinEachGroup) {
  std::map<std::string, std::vector<int>> rows;
  for (int i = 0; i < 16; ++i) {
    const ParticipantRow row = somebody();
    rows[row.assignment->group].push_back(row.assignment->row);
  }
  EXPECT_THAT(rows["both"], ElementsAre(0, 1, 0, 1, 0, 1, 0, 1));
  EXPECT_THAT(rows["weight"], testing::Each(0)) << "one block has one order";
}

TEST_F(StudyWithGroups, WhoWithdrawsGivesTheirOrderOfBlocksBackWithinTheGroup) {
  std::vector<ParticipantRow> both;
  while (both.size() < 2) {
    if (const ParticipantRow row = somebody(); row.assignment->group == "both") {
      both.push_back(row);
    }
  }
  store_->endParticipant(both[1].id, "withdrawn");
  ParticipantRow next = somebody();
  while (next.assignment->group != "both") {
    next = somebody();
  }
  EXPECT_EQ(next.assignment->row, both[1].assignment->row);
}

TEST_F(StudyWithGroups, TheFlowOfEachGroupCountsEverybodyOnce) {
  std::map<std::string, std::vector<std::int64_t>> ids;
  for (int i = 0; i < 8; ++i) {
    const ParticipantRow row = somebody();
    ids[row.assignment->group].push_back(row.id);
  }
  store_->addParticipant("");
  store_->endParticipant(ids["both"][0], "withdrawn");
  store_->setExcluded(ids["both"][1], true, "asleep");
  store_->removeParticipant(ids["weight"][0]);
  store_->endParticipant(ids["weight"][1], "finished");
  EXPECT_EQ(flowsText(*store_),
            "9 began, 1 removed on request, 1 withdrew, 1 excluded (asleep), 6 analysed (5 not finished)\n"
            "  both: 4 assigned, 1 withdrew, 1 excluded (asleep), 2 analysed (2 not finished)\n"
            "  weight: 4 assigned, 1 removed on request, 3 analysed (2 not finished)\n");
  const std::vector<GroupFlow> flows = groupFlowsOf(*store_);
  EXPECT_THAT(flows[0].strata, ElementsAre(4, 0, 0, 0, 0, 0));
  EXPECT_THAT(flows[1].strata, ElementsAre(4, 0, 0, 0, 0, 0));
}

TEST_F(StudyWithGroups, SimulatedPeopleComeFromEveryStratumAndDifferByGroups) {
  std::string text = kTwoGroups;
  text = text.replace(text.find("blocks = [\"gravity\"]"), 20, "share = 1");
  for (std::size_t at = text.find("levels ="); at != std::string::npos; at = text.find("levels =", at + 20)) {
    text.insert(at, "repeats = 1\n");
  }
  make(text);
  std::map<std::string, std::array<int, 2>> right;  // counts over all responses
  for (unsigned person = 0; person < 24; ++person) {
    SimulatedParticipant participant({.weber_fraction = 0.1, .group_factor = 8}, person);
    Conductor conductor(*store_, *rig_, {.now_s = [&participant] { return participant.now(); }});
    conductor.begin("");
    participant.takePart(conductor);
    const ParticipantRow row = store_->participants().back();
    for (const TrialRow& trial : store_->trials(row.id)) {
      right[row.assignment->group][0] += trial.answer->correct.value_or(false) ? 1 : 0;
      right[row.assignment->group][1] += 1;
    }
  }
  EXPECT_THAT(store_->placesGiven(), testing::Each(testing::Gt(0)));
  const auto share = [&](const char* group) { return right[group][0] / static_cast<double>(right[group][1]); };
  EXPECT_GT(share("both"), share("weight") + 0.1);
}

// --- while it runs
// ----------------------------------------------------------------------------------------------------

TEST_F(StudyWithGroups, AParticipantIsAssignedWhenTheDemographicsAreThereAndGoesThroughTheGroupsBlocks) {
  for (int person = 0; person < 4; ++person) {
    conductor_->begin("");
    conductor_->proceed();
    ASSERT_EQ(conductor_->state().phase, StudyPhase::kForm);
    EXPECT_FALSE(store_->participants().back().assignment);
    conductor_->fill({{"hand", "left"}, {"age", "20"}});
    const std::string group = nameAt(static_cast<std::size_t>(person));
    EXPECT_EQ(store_->participants().back().assignment->group, group);
    EXPECT_EQ(conductor_->state().blocks, group == "both" ? 2U : 1U);
    SimulatedParticipant participant({}, 1);
    Conductor again(*store_, *rig_, {.now_s = [&participant] { return participant.now(); }});
    conductor_->stop();
    again.resumeParticipant("");
    participant.takePart(again);
    std::set<std::string> blocks;
    for (const TrialRow& trial : store_->trials(store_->participants().back().id)) {
      blocks.insert(trial.block_name);
    }
    EXPECT_EQ(blocks,
              group == "both" ? (std::set<std::string>{"friction", "gravity"}) : (std::set<std::string>{"gravity"}));
    EXPECT_EQ(store_->participants().back().state, "finished");
  }
}

TEST_F(StudyWithGroups, AStudyThatIsKilledGoesOnInTheSameGroup) {
  conductor_->begin("");
  conductor_->proceed();
  open();  // killed in the form
  conductor_->resumeParticipant("");
  EXPECT_EQ(conductor_->state().phase, StudyPhase::kForm);
  conductor_->fill({{"hand", "left"}, {"age", "20"}});
  const Assignment decided = *store_->participants()[0].assignment;
  EXPECT_EQ(decided.group, nameAt(0));
  open();  // killed in the first block
  conductor_->resumeParticipant("");
  EXPECT_EQ(conductor_->state().group, decided.group);
  EXPECT_EQ(conductor_->state().blocks, groupNamed(store_->protocol(), decided.group).blocks.size());
  EXPECT_THAT(store_->placesGiven(), ElementsAre(1, 0, 0, 0, 0, 0));
}

TEST_F(StudyWithGroups, AKillBetweenTheFormAndTheAssignmentIsMadeUpForAtTheResume) {
  const std::int64_t id = store_->addParticipant("").id;
  store_->markStep(id, "consent");
  store_->setAnswers(id, "demographics", store_->protocol().demographics, {{"hand", "left"}, {"age", "20"}});
  store_->markStep(id, "demographics");
  open();
  conductor_->resumeParticipant("");
  EXPECT_EQ(store_->participants()[0].assignment->group, nameAt(0));
  EXPECT_EQ(conductor_->state().text, "You continue where you were.");
}

TEST_F(StudyWithGroups, WithoutStrataAParticipantIsAssignedWhenConsentIsGiven) {
  std::string text = withoutStrata("");
  make(text);
  conductor_->begin("");
  EXPECT_FALSE(store_->participants()[0].assignment);
  conductor_->proceed();
  EXPECT_TRUE(store_->participants()[0].assignment);
  text.erase(text.find("consent = \"Do you agree?\"\n"), std::string("consent = \"Do you agree?\"\n").size());
  make(text);
  conductor_->begin("");
  EXPECT_TRUE(store_->participants()[0].assignment) << "at once where there is no consent page";
}

TEST_F(StudyWithGroups, NoMessageTellsAParticipantTheGroupOrTheStratum) {
  const std::string text = with("name = \"weight\"", "name = \"Qgroup2\"");
  std::string both = text;
  make(both.replace(both.find("name = \"both\""), 13, "name = \"Qgroup1\""));
  const auto expect_nothing_told = [this] {
    EXPECT_THAT(participantMessage(*conductor_), AllOf(Not(HasSubstr("Qgroup")), Not(HasSubstr("group\"")),
                                                       Not(HasSubstr("stratum")), Not(HasSubstr("30 to < 50"))));
  };
  conductor_->begin("");
  expect_nothing_told();
  EXPECT_THAT(participantMessage(*conductor_), HasSubstr("\"progress\":null")) << "of which blocks is not known";
  conductor_->proceed();
  expect_nothing_told();
  conductor_->fill({{"hand", "left"}, {"age", "20"}});
  for (int interval = 1; interval <= 2; ++interval) {
    expect_nothing_told();
    now_s_ += 1;
    conductor_->poll();
    ASSERT_EQ(conductor_->state().phase, StudyPhase::kInterval);
    expect_nothing_told();
    conductor_->proceed();
  }
  ASSERT_EQ(conductor_->state().phase, StudyPhase::kQuestion);
  expect_nothing_told();
  EXPECT_THAT(experimenterMessage(*conductor_, historyJson(*conductor_), 0, 0), HasSubstr("\"group\":\"Qgroup"));
  conductor_->withdraw();
  expect_nothing_told();
}

// --- without groups nothing has changed
// -------------------------------------------------------------------------------

TEST(WithoutGroups, OrdersAndSeedsAreAsTheyWereBeforeThereWereGroups) {
  const auto hashOf = [](const char* name) {
    const ProtocolText text = findProtocol(name);
    const StudyProtocol protocol = loadProtocolText(text.text, text.name);
    std::uint64_t hash = 14695981039346656037U;  // FNV-1a over numbers
    const auto add = [&hash](std::uint64_t number) { hash = (hash ^ number) * 1099511628211U; };
    for (int participant = 1; participant <= 8; ++participant) {
      for (const PlannedBlock& block : sequenceFor(protocol, 42, participant)) {
        add(block.block);
        for (const PlannedTrial& trial : block.trials) {
          add(static_cast<std::uint64_t>(trial.kind));
          add(trial.level);
          add(trial.test_first ? 1 : 0);
          add(trial.seed);
          add(static_cast<std::uint64_t>(trial.before_main));
        }
        add(procedureSeed(42, participant, block.block));
      }
    }
    return hash;
  };
  EXPECT_EQ(hashOf("icra2021"), 3887341813211468191U);
  EXPECT_EQ(hashOf("friction-quest"), 6998821044387551895U);
}

}  // namespace
}  // namespace haptolith
