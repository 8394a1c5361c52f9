#include "haptolith/study/run/conductor.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/study/run/criteria.h"
#include "haptolith/study/store/provenance.h"

#include "fake_rig.h"

namespace haptolith {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

constexpr const char* kShort = R"(
title = "A short study"
consent = "Do you agree?"
instructions = "Dig."
thanks = "Thank you."
order = "latin-square"

[[demographics]]
key = "age"
label = "Age"
kind = "number"
low = 18
high = 99
required = true

[[block]]
name = "friction"
instructions = "Stir."
question = "Was the second more resistant?"
answers = ["less", "more"]
varies = "preset"
reference = "P3"
levels = ["P1", "P2", "P4"]
repeats = 2
practice_trials = 1
break_every_trials = 3
break_s = 30
interval_s = 20
answer_limit_s = 10
between_intervals_s = 0.05
between_trials_s = 0.05

[[block]]
name = "gravity"
question = "Which was heavier?"
answers = ["the first", "the second"]
varies = "body"
reference = "Moon"
levels = ["Ceres", "Earth"]
repeats = 2
task = "two-interval"
between_intervals_s = 0.05
between_trials_s = 0.05
questionnaire = "nasa-tlx"
)";

/// A staircase whose trials come at once.
constexpr const char* kStaircase = R"(
title = "A staircase"
[[block]]
name = "friction"
question = "Was the second more resistant?"
answers = ["less", "more"]
varies = "friction_angle_deg"
reference = 40
levels = [30, 34, 38, 39, 41, 42, 46, 50]
procedure = "staircase"
between_intervals_s = 0
between_trials_s = 0
)";

class ConductorTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) / ("conductor_" + std::to_string(getpid()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directory(folder_);
    make(kShort);
  }
  void TearDown() override {
    conductor_.reset();
    store_.reset();
    std::filesystem::remove_all(folder_);
  }

  void make(const char* protocol) {
    conductor_.reset();
    store_.reset();
    const std::filesystem::path file = folder_ / "a.study";
    std::filesystem::remove(file);
    StudyStore::create(file, loadProtocolText(protocol, "test"), protocol, 7);
    open();
  }
  /// As the program does after it has ended, however that came.
  void open() {
    conductor_.reset();
    store_.reset();
    store_ = std::make_unique<StudyStore>(folder_ / "a.study", StudyStore::Access::kRun);
    rig_ = std::make_unique<FakeRig>();
    conductor_ = std::make_unique<Conductor>(
        *store_, *rig_, ConductorOptions{.now_s = [this] { return now_s_; }, .recordings = folder_});
  }
  void wait(double time_s) {
    now_s_ += time_s;
    conductor_->poll();
  }
  [[nodiscard]] StudyPhase phase() const { return conductor_->state().phase; }

  /// Through consent, form and instructions to the first trial.
  void comeToTheTrials() {
    conductor_->begin("");
    conductor_->proceed();
    conductor_->fill({{"age", "30"}});
    conductor_->proceed();
    if (phase() == StudyPhase::kInstructions) {
      conductor_->proceed();
    }
  }
  void feelBoth() {
    for (int interval = 1; interval <= 2; ++interval) {
      ASSERT_EQ(phase(), StudyPhase::kPreparing);
      wait(0.1);
      ASSERT_EQ(phase(), StudyPhase::kInterval);
      ASSERT_EQ(conductor_->state().interval, interval);
      wait(1);
      conductor_->proceed();
    }
    ASSERT_EQ(phase(), StudyPhase::kQuestion);
  }
  void doTrial(int choice = 1) {
    feelBoth();
    wait(0.5);
    conductor_->answer(choice);
    if (phase() == StudyPhase::kFeedback) {
      wait(2);
    }
  }
  /// One step on, whatever comes next.
  void doWhateverComes() {
    switch (phase()) {
      case StudyPhase::kPreparing: doTrial(); break;
      case StudyPhase::kBreak:
        wait(31);
        conductor_->proceed();
        break;
      case StudyPhase::kForm: fillForm(); break;
      default: conductor_->proceed();
    }
  }
  void fillForm() {
    std::map<std::string, std::string> values;
    for (const FormItem& item : *conductor_->state().form) {
      values[item.key] = item.kind == FormItem::Kind::kScale ? "50" : "30";
    }
    conductor_->fill(values);
  }
  [[nodiscard]] TrialRow lastAnswered() const {
    const std::vector<TrialRow> rows = store_->trials();
    return *std::find_if(rows.rbegin(), rows.rend(),
                         [](const TrialRow& row) { return row.state == TrialState::kAnswered; });
  }
  [[nodiscard]] std::size_t countOf(TrialState state) const {
    const std::vector<TrialRow> rows = store_->trials();
    return static_cast<std::size_t>(std::ranges::count(rows, state, &TrialRow::state));
  }

  std::filesystem::path folder_;
  double now_s_ = 100;
  std::unique_ptr<StudyStore> store_;
  std::unique_ptr<FakeRig> rig_;
  std::unique_ptr<Conductor> conductor_;
};

TEST_F(ConductorTest, LeadsFromConsentThroughEveryTrialToThanks) {
  EXPECT_EQ(phase(), StudyPhase::kWaiting);
  conductor_->begin("");
  EXPECT_EQ(conductor_->state().participant, "S01");
  EXPECT_EQ(phase(), StudyPhase::kConsent);
  for (int steps = 0; !conductor_->over() && steps < 100; ++steps) {
    doWhateverComes();
  }
  EXPECT_EQ(phase(), StudyPhase::kFinished);
  EXPECT_EQ(conductor_->state().text, "Thank you.");
  EXPECT_EQ(countOf(TrialState::kAnswered), 1U + 3 * 2 + 2 * 2);
  EXPECT_EQ(store_->trials().size(), countOf(TrialState::kAnswered));
  EXPECT_EQ(store_->participants().front().state, "finished");
  EXPECT_THAT(store_->formAnswers(true), SizeIs(1 + 6));
}

TEST_F(ConductorTest, KeepsWhatWasAgreedTo) {
  comeToTheTrials();
  ASSERT_EQ(store_->consents().size(), 1U);
  const ConsentRow consent = store_->consents().front();
  EXPECT_EQ(consent.text, store_->protocol().consent);
  EXPECT_EQ(consent.language, "en");
  EXPECT_EQ(consent.version, "sha256:" + sha256Of(consent.text));
  EXPECT_NE(consent.at, "");
}

TEST_F(ConductorTest, NeverRecordsIntoAFileThatIsThere) {
  std::ofstream(folder_ / "S01-friction-001-1-second.h5") << "of somebody else";
  comeToTheTrials();
  doTrial();
  EXPECT_THAT(rig_->recordings, ElementsAre("S01-friction-001-1-2-first.h5", "S01-friction-001-1-2-second.h5"));
  EXPECT_EQ(store_->trials().front().recording, "S01-friction-001-1-2");
}

TEST_F(ConductorTest, ShowsReferenceAndTestInThePlannedOrder) {
  comeToTheTrials();
  const ShownTrial first = *conductor_->state().now;
  feelBoth();
  EXPECT_THAT(rig_->shown, ElementsAre("friction P3", "friction " + first.test->name));
  EXPECT_THAT(rig_->recordings, ElementsAre("S01-friction-001-1-first.h5", "S01-friction-001-1-second.h5"));
  conductor_->answer(1);
  const TrialRow row = store_->trials().front();
  EXPECT_EQ(row.level, first.test->name);
  EXPECT_EQ(row.kind, TrialKind::kPractice);
  EXPECT_TRUE(row.answer->positive);
  EXPECT_EQ(row.recording, "S01-friction-001-1");
  EXPECT_EQ(row.answer->summaries[0].mean_force_n, 1);  // as the rig says: how many stimuli it had shown
  EXPECT_EQ(row.answer->summaries[1].mean_force_n, 2);
}

TEST_F(ConductorTest, AnswersAboutTheTwoIntervalsAreTurnedToTheTest) {
  conductor_->begin("S01");
  while (conductor_->state().block == nullptr || conductor_->state().block->name != "gravity" ||
         phase() != StudyPhase::kPreparing) {
    doWhateverComes();
  }
  bool seen[2] = {false, false};
  while (phase() == StudyPhase::kPreparing && conductor_->state().block->name == "gravity") {
    const bool test_first = conductor_->state().now->test_first;
    seen[test_first ? 1 : 0] = true;
    doTrial(0);  // "the first"
    const TrialRow row = lastAnswered();
    EXPECT_EQ(row.answer->positive, test_first);
    EXPECT_EQ(row.answer->correct, test_first == (row.level == "Earth"));
  }
  EXPECT_TRUE(seen[0] && seen[1]);
}

TEST_F(ConductorTest, ACrashAtAnyMomentLosesTheTrialUnderWayAtMost) {
  conductor_->begin("");
  std::mt19937_64 random(3);
  for (int steps = 0; !conductor_->over() && steps < 300; ++steps) {
    const std::size_t before = countOf(TrialState::kAnswered);
    const auto chance = random() % 3;
    if (phase() == StudyPhase::kPreparing && chance == 1) {
      wait(0.1);  // in an interval
      open();
      conductor_->resumeParticipant("");
      EXPECT_EQ(countOf(TrialState::kBegun), 0U);
    } else if (phase() == StudyPhase::kPreparing && chance == 2) {
      feelBoth();  // before the answer
      open();
      conductor_->resumeParticipant("S01");
    } else {
      doWhateverComes();
      if (!conductor_->over() && random() % 2 == 0) {
        open();
        conductor_->resumeParticipant("");
      }
    }
    EXPECT_GE(countOf(TrialState::kAnswered), before);
  }
  EXPECT_EQ(countOf(TrialState::kAnswered), 1U + 3 * 2 + 2 * 2);
  EXPECT_GT(countOf(TrialState::kLost), 3U);
  std::map<std::pair<std::size_t, int>, int> answers;
  for (const TrialRow& row : store_->trials()) {
    answers[{row.position, row.index}] += row.state == TrialState::kAnswered ? 1 : 0;
  }
  for (const auto& [trial, count] : answers) {
    EXPECT_EQ(count, 1) << trial.first << " " << trial.second;
  }
}

TEST_F(ConductorTest, WhoComesBackGoesOnInTheSameSequence) {
  std::vector<std::string> whole;
  const auto levels = [this] {
    std::vector<std::string> names;
    for (const TrialRow& row : store_->trials()) {
      if (row.state == TrialState::kAnswered) {
        names.push_back(row.level);
      }
    }
    return names;
  };
  conductor_->begin("");
  while (!conductor_->over()) {
    doWhateverComes();
  }
  whole = levels();
  make(kShort);
  conductor_->begin("");
  for (int steps = 0; !conductor_->over() && steps < 200; ++steps) {
    doWhateverComes();
    if (steps % 2 == 0 && !conductor_->over()) {
      open();
      conductor_->resumeParticipant("");
    }
  }
  EXPECT_EQ(levels(), whole);
}

TEST_F(ConductorTest, APauseDropsTheTrialUnderWayAndDoesItAgain) {
  comeToTheTrials();
  wait(0.1);
  const std::string level = conductor_->state().now->test->name;
  conductor_->pause();
  EXPECT_TRUE(rig_->paused);
  EXPECT_TRUE(conductor_->state().paused);
  EXPECT_THROW(conductor_->proceed(), InvalidParameter);
  wait(1000);
  conductor_->resume();
  EXPECT_FALSE(rig_->paused);
  EXPECT_EQ(conductor_->state().now->test->name, level);
  doTrial();
  EXPECT_EQ(countOf(TrialState::kRepeated), 1U);
  EXPECT_EQ(store_->trials()[1].attempt, 1);
}

TEST_F(ConductorTest, AnAnswerOrATrialUnderWayIsRepeatedForAReason) {
  comeToTheTrials();
  EXPECT_THROW(conductor_->repeat(Conductor::Again::kNow, ""), InvalidParameter);
  doTrial();  // practice
  doTrial();
  const std::string level = store_->trials()[1].level;
  conductor_->repeat(Conductor::Again::kNow, "somebody came in");  // the one that has just begun
  EXPECT_EQ(store_->trials()[2].state, TrialState::kRepeated);
  EXPECT_EQ(store_->trials()[2].reason, "somebody came in");
  doTrial();  // after three trials comes a break
  ASSERT_EQ(phase(), StudyPhase::kBreak);
  conductor_->repeat(Conductor::Again::kNow, "pressed the wrong key");  // the last answer
  EXPECT_EQ(countOf(TrialState::kRepeated), 2U);
}

TEST_F(ConductorTest, TheLastAnswerIsRepeatedThoughTheNextTrialHasBegun) {
  comeToTheTrials();
  doTrial();  // practice
  doTrial();
  wait(0.1);
  const std::string level = store_->trials()[1].level;
  conductor_->repeat(Conductor::Again::kLast, "pressed the wrong key");
  EXPECT_EQ(store_->trials()[1].state, TrialState::kRepeated);
  EXPECT_EQ(store_->trials()[2].state, TrialState::kLost);
  EXPECT_EQ(conductor_->state().now->test->name, level);
}

TEST_F(ConductorTest, TimeEndsIntervalsAndQuestionsAndKeepsBreaksLong) {
  comeToTheTrials();
  wait(0.1);
  EXPECT_NEAR(*conductor_->state().remaining_s, 20, 1e-9);
  wait(20);
  wait(0.1);
  EXPECT_EQ(conductor_->state().interval, 2);
  wait(20);
  EXPECT_EQ(phase(), StudyPhase::kQuestion);
  wait(10);
  EXPECT_EQ(phase(), StudyPhase::kPreparing);
  EXPECT_EQ(store_->trials().front().state, TrialState::kLost);
  EXPECT_THAT(store_->trials().front().reason, HasSubstr("10 s"));
  for (int i = 0; i < 3; ++i) {
    doTrial();
  }
  ASSERT_EQ(phase(), StudyPhase::kBreak);
  EXPECT_THROW(conductor_->proceed(), InvalidParameter);
  wait(30);
  conductor_->proceed();
  EXPECT_EQ(phase(), StudyPhase::kPreparing);
}

TEST_F(ConductorTest, TheDevicesButtonsGoOnAndAnswer) {
  comeToTheTrials();
  const auto press = [this](double time_s) {
    wait(0.4);
    rig_->down = 1;
    wait(0.01);
    wait(time_s);
    rig_->down = 0;
    wait(0.01);
  };
  wait(0.1);
  press(0.1);
  ASSERT_EQ(phase(), StudyPhase::kPreparing);
  wait(0.1);
  ASSERT_EQ(conductor_->state().interval, 2);
  press(0.1);
  ASSERT_EQ(phase(), StudyPhase::kQuestion);
  press(1);  // long: the right one
  EXPECT_TRUE(store_->trials().front().answer->positive);
}

TEST_F(ConductorTest, FeedbackIsGivenWhereTheProtocolSays) {
  comeToTheTrials();
  feelBoth();
  const bool more = conductor_->state().now->test->value > 0.835;
  conductor_->answer(more ? 0 : 1);
  ASSERT_EQ(phase(), StudyPhase::kFeedback);  // practice
  EXPECT_EQ(conductor_->state().right, false);
  wait(2);
  feelBoth();
  conductor_->answer(1);
  EXPECT_EQ(phase(), StudyPhase::kPreparing);  // no feedback in the others
}

TEST_F(ConductorTest, WhenABedCannotBeMadeTheStudyPausesAndGoesOnLater) {
  comeToTheTrials();
  wait(0.1);
  wait(1);
  rig_->fails_to_show = true;
  conductor_->proceed();
  EXPECT_TRUE(conductor_->state().paused);
  EXPECT_EQ(conductor_->state().problem, "the bed cannot be made");
  rig_->fails_to_show = false;
  conductor_->resume();
  EXPECT_EQ(conductor_->state().problem, "");
  doTrial();
  EXPECT_EQ(countOf(TrialState::kAnswered), 1U);
  EXPECT_EQ(countOf(TrialState::kLost), 1U);
}

TEST_F(ConductorTest, WithoutAThreadForARecordingTheStudyPausesAndGoesOnLater) {
  comeToTheTrials();
  rig_->has_no_thread = true;
  wait(0.1);
  EXPECT_TRUE(conductor_->state().paused);
  EXPECT_NE(conductor_->state().problem, "");
  rig_->has_no_thread = false;
  conductor_->resume();
  doTrial();
  EXPECT_EQ(countOf(TrialState::kAnswered), 1U);
}

TEST_F(ConductorTest, ARecordingThatFailsCostsNoAnswer) {
  comeToTheTrials();
  rig_->fails_to_record = true;
  doTrial();
  EXPECT_EQ(countOf(TrialState::kAnswered), 1U);
  EXPECT_THAT(conductor_->state().problem, HasSubstr("the disk is full"));
}

TEST_F(ConductorTest, WhoWithdrawsKeepsTheirAnswersAndDoesNotComeBack) {
  comeToTheTrials();
  doTrial();
  wait(0.1);
  conductor_->withdraw();
  EXPECT_EQ(phase(), StudyPhase::kWithdrawn);
  EXPECT_FALSE(rig_->feels);
  EXPECT_EQ(store_->participants().front().state, "withdrawn");
  EXPECT_EQ(countOf(TrialState::kAnswered), 1U);
  open();
  EXPECT_THROW(conductor_->resumeParticipant("S01"), InvalidParameter);
}

TEST_F(ConductorTest, WhoWithdrawsInAPauseIsDoneAndReadsSo) {
  comeToTheTrials();
  conductor_->pause();
  conductor_->withdraw();
  EXPECT_FALSE(conductor_->state().paused);
  EXPECT_FALSE(rig_->paused);
  EXPECT_EQ(phase(), StudyPhase::kWithdrawn);
}

TEST_F(ConductorTest, StoppedForTodayIsNotFinished) {
  comeToTheTrials();
  doTrial();
  wait(0.1);
  conductor_->stop();
  EXPECT_TRUE(conductor_->stopped());
  EXPECT_EQ(phase(), StudyPhase::kStopped);
  EXPECT_EQ(conductor_->state().participant, "S01");
  EXPECT_EQ(conductor_->state().trial, 1);
  EXPECT_EQ(store_->participants().front().state, "running");
  conductor_->resumeParticipant("");
  EXPECT_FALSE(conductor_->stopped());
  EXPECT_EQ(conductor_->state().title, "Welcome back");
  conductor_->proceed();
  doTrial();
  EXPECT_EQ(countOf(TrialState::kAnswered), 2U);
}

TEST_F(ConductorTest, WhatCannotBeDoneNowIsRefusedAndChangesNothing) {
  EXPECT_THROW(conductor_->proceed(), InvalidParameter);
  EXPECT_THROW(conductor_->answer(1), InvalidParameter);
  EXPECT_THROW(conductor_->resumeParticipant("S01"), InvalidParameter);
  conductor_->begin("");
  EXPECT_THROW(conductor_->fill({}), InvalidParameter);
  conductor_->proceed();
  EXPECT_THROW(conductor_->fill({{"age", "17"}}), InvalidParameter);
  EXPECT_THROW(conductor_->fill({}), InvalidParameter);
  EXPECT_EQ(phase(), StudyPhase::kForm);
  EXPECT_THROW(conductor_->resume(), InvalidParameter);
  EXPECT_THROW(conductor_->note(""), InvalidParameter);
}

TEST_F(ConductorTest, AnAdaptiveBlockAsksUntilItsProcedureHasEnough) {
  make((kStaircase + std::string("practice_trials = 2\ncatch_trials = 2\n")).c_str());
  conductor_->begin("");
  int trials = 0;
  for (; !conductor_->over() && trials < 500; ++trials) {
    const double value = conductor_->state().now->test->value;
    doTrial(value > 40 ? 1 : 0);
    if (trials % 7 == 0 && !conductor_->over()) {
      open();
      conductor_->resumeParticipant("");
      conductor_->proceed();
    }
  }
  EXPECT_TRUE(conductor_->over());
  EXPECT_GT(trials, 10);
  std::vector<TrialRow> rows = store_->trials();
  std::erase_if(rows, [](const TrialRow& row) { return row.state != TrialState::kAnswered; });
  EXPECT_EQ(std::ranges::count(rows, TrialKind::kPractice, &TrialRow::kind), 2);
  EXPECT_EQ(std::ranges::count(rows, TrialKind::kCatch, &TrialRow::kind), 2);
}

TEST_F(ConductorTest, EachParticipantHasTheSidesOfAStaircaseInAnotherOrder) {
  make(kStaircase);
  std::set<std::string> orders;
  constexpr int kPeople = 5, kTrials = 16;
  for (int person = 0; person < kPeople; ++person) {
    conductor_->begin("");
    std::string sides;
    for (int trial = 0; trial < kTrials; ++trial) {
      const double value = conductor_->state().now->test->value;
      sides += value > 40 ? '+' : '-';
      doTrial(trial % 3 == 0 ? 0 : 1);
    }
    orders.insert(sides);
    conductor_->withdraw();
    open();
  }
  EXPECT_EQ(orders.size(), kPeople);
}

// --- soils, pauses and criteria

TEST_F(ConductorTest, EverySoilOfABlockIsPreparedBeforeItsFirstTrial) {
  rig_->is_ready = false;
  comeToTheTrials();
  const bool friction_first = rig_->prepared.front() == "P3";
  const int soils = friction_first ? 4 : 3;
  EXPECT_EQ(conductor_->state().soil, 1);
  EXPECT_EQ(conductor_->state().soils, soils);
  EXPECT_FALSE(conductor_->state().now) << "no trial has begun";
  wait(3);
  EXPECT_THAT(rig_->prepared, SizeIs(1)) << "one after the other";
  EXPECT_THROW(conductor_->proceed(), InvalidParameter);
  rig_->is_ready = true;
  wait(0.01);
  EXPECT_THAT(rig_->prepared, SizeIs(soils));
  EXPECT_EQ(conductor_->state().soils, 0);
  EXPECT_THAT(rig_->shown, SizeIs(1));
  conductor_->pause();
  conductor_->resume();
  EXPECT_THAT(rig_->prepared, SizeIs(soils)) << "not once more";
  doTrial();
  EXPECT_EQ(countOf(TrialState::kAnswered), 1U);
}

TEST_F(ConductorTest, APauseWhileSoilsArePreparedBeginsThemAgain) {
  rig_->is_ready = false;
  comeToTheTrials();
  conductor_->pause();
  rig_->is_ready = true;
  wait(1);
  EXPECT_THAT(rig_->prepared, SizeIs(1));
  conductor_->resume();
  doTrial();
  EXPECT_EQ(countOf(TrialState::kAnswered), 1U);
}

TEST_F(ConductorTest, PausesAreAsLongForEverySoil) {
  make((std::string(kShort).substr(0, std::string(kShort).find("between_intervals_s")) +
        "between_intervals_s = 0.5\nbetween_trials_s = 0.8\n")
           .c_str());
  comeToTheTrials();
  constexpr double kPoll_s = 0.004;
  for (int interval = 0; interval < 12; ++interval) {
    rig_->is_ready = false;
    const double begin_s = now_s_;
    while (phase() == StudyPhase::kPreparing) {
      wait(kPoll_s);
      rig_->is_ready = now_s_ - begin_s > 0.1 * (interval % 4);  // some soils are there sooner than others
    }
    EXPECT_NEAR(now_s_ - begin_s, interval % 2 == 0 ? 0.8 : 0.5, 1.1 * kPoll_s) << interval;
    conductor_->proceed();
    if (phase() == StudyPhase::kQuestion) {
      conductor_->answer(1);
    }
    if (phase() == StudyPhase::kFeedback) {
      wait(2);
    }
    if (phase() == StudyPhase::kBreak) {
      wait(31);
      conductor_->proceed();
    }
  }
}

TEST_F(ConductorTest, PracticeGoesOnUntilEnoughIsRight) {
  make((kStaircase + std::string("practice_trials = 4\npractice_criterion = 0.75\npractice_rounds = 3\n")).c_str());
  const auto practise = [this](int right) {
    for (int trial = 0; trial < 4; ++trial) {
      ASSERT_EQ(conductor_->state().now->kind, TrialKind::kPractice);
      doTrial((conductor_->state().now->test->value > 40) == (trial < right) ? 1 : 0);
    }
  };
  conductor_->begin("");
  practise(2);
  practise(3);
  EXPECT_EQ(conductor_->state().now->kind, TrialKind::kMain);
  EXPECT_EQ(criteriaNotMet(store_->protocol().blocks[0], scoresOf(store_->protocol(), store_->trials(), 0, 1)), "");
  conductor_->withdraw();
  open();
  conductor_->begin("");
  practise(1);
  practise(2);
  practise(2);
  EXPECT_EQ(conductor_->state().now->kind, TrialKind::kMain) << "there is no fourth round";
  EXPECT_EQ(criteriaNotMet(store_->protocol().blocks[0], scoresOf(store_->protocol(), store_->trials(), 0, 2)),
            "practice criterion not met: 2 of 4 correct, 0.75 required");
}

TEST_F(ConductorTest, RoundsOfPracticeAreLeftOutOfAListToo) {
  make(R"(
title = "Practice"
[[block]]
name = "friction"
question = "Was the second more resistant?"
answers = ["less", "more"]
varies = "preset"
reference = "P3"
levels = ["P1", "P6"]
repeats = 2
practice_trials = 2
practice_criterion = 1
practice_rounds = 3
practice_levels = ["P2", "P5"]
catch_trials = 2
catch_levels = ["P2"]
catch_criterion = 0.9
between_intervals_s = 0
between_trials_s = 0
)");
  conductor_->begin("");
  const auto trials = [this] { return conductor_->state().trials; };
  EXPECT_EQ(trials(), 2 + 4 + 2);
  for (int trial = 0; trial < 2; ++trial) {
    doTrial(conductor_->state().now->test->value > 0.835 ? 0 : 1);  // wrong
  }
  EXPECT_EQ(trials(), 2 + 2 + 4 + 2);
  while (!conductor_->over()) {
    const ShownTrial now = *conductor_->state().now;
    if (now.kind == TrialKind::kPractice) {
      EXPECT_THAT(now.test->name, testing::AnyOf("P2", "P5"));
    } else {
      EXPECT_EQ(now.test->name == "P2", now.kind == TrialKind::kCatch);
    }
    const bool right = now.kind != TrialKind::kCatch;
    doTrial((now.test->value > 0.835) == right ? 1 : 0);
  }
  EXPECT_EQ(countOf(TrialState::kAnswered), 10U);
  EXPECT_EQ(criteriaNotMet(store_->protocol().blocks[0], scoresOf(store_->protocol(), store_->trials(), 0, 1)),
            "catch criterion not met: 0 of 2 correct, 0.9 required");
}

}  // namespace
}  // namespace haptolith
