// Blocks whose trials are work for a robot.

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/study/export/export.h"
#include "haptolith/study/export/preregistration.h"
#include "haptolith/study/results/answers.h"
#include "haptolith/study/results/teleop_results.h"
#include "haptolith/study/run/simulated_participant.h"
#include "haptolith/study/run/study_messages.h"

#include "a_study.h"
#include "fake_rig.h"

namespace haptolith {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

const std::string kHead = "title = 'Far away'\nscene = 'teleop-model'\nrecord = false\n";
const std::string kDig = R"toml([[block]]
name = "dig"
instructions = "Dig."
interval_s = 60
repeats = 2
practice_trials = 1
between_trials_s = 0
[block.teleop]
task = "trench"
felt = "learning"
round_trip_s = 2.6
[[block.item]]
key = "trust"
label = "How far did you trust it?"
kind = "scale"
low = 0
high = 100
required = true
)toml";

StudyProtocol load(const std::string& text) {
  return loadProtocolText(text, "x.toml");
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), with);
}

TEST(TeleopProtocol, HasBlocksThatCompareNothing) {
  const StudyBlock block = load(kHead + kDig).blocks.front();
  ASSERT_TRUE(block.teleop);
  EXPECT_EQ(block.teleop->task, SiteTask::kTrench);
  EXPECT_EQ(block.teleop->force, TeleopForce::kLearning);
  EXPECT_EQ(block.teleop->round_trip_s, 2.6);
  EXPECT_EQ(block.teleop->site, "teleop-site");
  EXPECT_EQ(block.reference.name, "learning 2.6 s");
  EXPECT_THAT(block.levels, SizeIs(1));
  EXPECT_THAT(block.questionnaire, SizeIs(1));
  EXPECT_THAT(sequenceFor(load(kHead + kDig), 1, 1).front().trials, SizeIs(3));
}

TEST(TeleopProtocol, ReadsTheNamesOfScenesOfAnEarlierVersion) {
  const std::string head = replaced(kHead, "teleop-model", "dig");
  const StudyBlock block = load(head + replaced(kDig, "2.6", "2.6\nsite = 'dig-site'")).blocks.front();
  EXPECT_EQ(block.teleop->site, "teleop-site");
}

TEST(TeleopProtocol, ShipsWithEachFeelingUnderTwoDelays) {
  const ProtocolText text = findProtocol("teleop");
  std::map<TeleopForce, std::vector<double>> delays_s;
  for (const StudyBlock& block : loadProtocolText(text.text, text.name).blocks) {
    ASSERT_TRUE(block.teleop);
    delays_s[block.teleop->force].push_back(block.teleop->round_trip_s);
    const bool asks_trust =
        std::ranges::find(block.questionnaire, kTrustKey, &FormItem::key) != block.questionnaire.end();
    EXPECT_EQ(asks_trust, block.teleop->force != TeleopForce::kNone) << "what is not felt is not trusted";
  }
  EXPECT_THAT(delays_s, SizeIs(3));
  for (const auto& [felt, of] : delays_s) {
    EXPECT_THAT(of, ElementsAre(0.4, 2.6));
  }
}

TEST(TeleopProtocol, NonsenseIsRefusedWithItsLine) {
  const auto error = [](const std::string& text) { return messageOf<InvalidParameter>([&] { (void)load(text); }); };
  EXPECT_THAT(error(kHead + replaced(kDig, "2.6", "21")),
              HasSubstr("x.toml:14: [block.teleop] round_trip_s = 21 is not valid: must be 0 to 20"));
  EXPECT_THAT(error(kHead + replaced(kDig, "2.6", "-1")), HasSubstr("must be 0 to 20"));
  EXPECT_THAT(error(kHead + replaced(kDig, "trench", "hole")), HasSubstr("must be trench, press or scoop"));
  EXPECT_THAT(error(kHead + replaced(kDig, "learning", "all")), HasSubstr("must be none, model or learning"));
  EXPECT_THAT(error(kHead + replaced(kDig, "felt = \"learning\"\n", "")), HasSubstr("[block.teleop] felt is missing"));
  EXPECT_THAT(error(kHead + replaced(kDig, "interval_s = 60\n", "")), HasSubstr("interval_s is missing"));
  EXPECT_THAT(error(kHead + replaced(kDig, "interval_s = 60", "interval_s = 0")), HasSubstr("time limit"));
  EXPECT_THAT(error(kHead + replaced(kDig, "repeats", "question = 'Which?'\nrepeats")), HasSubstr("left out"));
  EXPECT_THAT(error(kHead + replaced(kDig, "2.6", "2.6\nsite = 'mars'")), HasSubstr("a built-in scene"));
  EXPECT_THAT(error("title = 'x'\n" + kDig), HasSubstr("no contact friction")) << "the scene icra2021 cannot learn";
}

class TeleopStudy : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) / ("teleop_" + std::to_string(getpid()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directory(folder_);
    make(kHead + kDig);
  }
  void TearDown() override {
    conductor_.reset();
    store_.reset();
    std::filesystem::remove_all(folder_);
  }
  void make(const std::string& protocol) {
    conductor_.reset();
    store_.reset();
    const std::filesystem::path file = folder_ / "a.study";
    std::filesystem::remove(file);
    StudyStore::create(file, load(protocol), protocol, 7);
    store_ = std::make_unique<StudyStore>(file, StudyStore::Access::kRun);
    conductor_ = std::make_unique<Conductor>(*store_, rig_, ConductorOptions{.now_s = [this] { return now_s_; }});
  }
  void wait(double time_s) {
    now_s_ += time_s;
    conductor_->poll();
  }
  [[nodiscard]] StudyPhase phase() const { return conductor_->state().phase; }
  void comeToWork() {
    conductor_->begin("");
    conductor_->proceed();
    wait(0.1);
    ASSERT_EQ(phase(), StudyPhase::kInterval);
  }
  [[nodiscard]] json page() const { return json::parse(participantMessage(*conductor_)); }

  std::filesystem::path folder_;
  double now_s_ = 0;
  FakeRig rig_;
  std::unique_ptr<StudyStore> store_;
  std::unique_ptr<Conductor> conductor_;
};

TEST_F(TeleopStudy, ATrialEndsWhenTheWorkIsSeenToBeDone) {
  comeToWork();
  EXPECT_EQ(page()["label"], "Dig a trench, 40 mm deep and 60 mm long");
  EXPECT_EQ(page()["work"], "23 of 40 mm");
  EXPECT_EQ(page()["button"], nullptr);
  EXPECT_EQ(page()["intervals"], 1);
  rig_.down = 1;
  wait(1);
  rig_.down = 0;
  EXPECT_EQ(phase(), StudyPhase::kInterval) << "a button does not end work";
  EXPECT_THROW(conductor_->proceed(), InvalidParameter);
  rig_.summary = {.done = 1, .time_s = 12.5, .force_error = 0.4, .stops = 1};
  wait(1);
  EXPECT_EQ(phase(), StudyPhase::kFeedback);
  EXPECT_EQ(page()["title"], "Task completed");
  EXPECT_EQ(page()["feedback"], "right");
  const std::vector<TrialRow> rows = store_->trials();
  ASSERT_THAT(rows, SizeIs(1));
  EXPECT_EQ(rows[0].level, "learning 2.6 s");
  EXPECT_EQ(rows[0].reference, "");
  EXPECT_EQ(rows[0].state, TrialState::kAnswered);
  ASSERT_TRUE(rows[0].answer && rows[0].answer->teleop);
  EXPECT_EQ(rows[0].answer->teleop->time_s, 12.5);
  EXPECT_EQ(rows[0].answer->teleop->force_error, 0.4);
  EXPECT_TRUE(std::isnan(rows[0].answer->teleop->cohesion_pa)) << "it is not known";
  EXPECT_THAT(rig_.prepared, ElementsAre("learning 2.6 s"));
  EXPECT_THAT(rig_.shown, ElementsAre("dig learning 2.6 s"));
  EXPECT_FALSE(counts(rows[0]));
}

TEST_F(TeleopStudy, ATrialEndsWhenItsTimeIsOver) {
  comeToWork();
  rig_.summary = {.done = 0, .time_s = 60};
  wait(59);
  EXPECT_EQ(phase(), StudyPhase::kInterval);
  wait(1.1);
  EXPECT_EQ(phase(), StudyPhase::kFeedback);
  EXPECT_EQ(page()["title"], "Time is over");
  EXPECT_EQ(store_->trials()[0].answer->teleop->done, 0);
}

TEST_F(TeleopStudy, ARobotThatIsLostPausesTheStudyAndTheTrialIsDoneAgain) {
  comeToWork();
  rig_.robot_is_lost = true;
  wait(1);
  EXPECT_TRUE(conductor_->state().paused);
  EXPECT_THAT(conductor_->state().problem, HasSubstr("fallen silent"));
  rig_.robot_is_lost = false;
  conductor_->resume();
  wait(0.1);
  EXPECT_EQ(phase(), StudyPhase::kInterval);
  const std::vector<TrialRow> rows = store_->trials();
  ASSERT_THAT(rows, SizeIs(2));
  EXPECT_EQ(rows[0].state, TrialState::kLost);
  EXPECT_EQ(rows[1].attempt, 1);
}

TEST_F(TeleopStudy, ASimulatedParticipantTrustsWhatIsTrue) {
  std::vector<double> trusted;
  for (const double error : {0.1, 0.9}) {
    make(kHead + kDig);
    rig_.summary = {.done = 1, .time_s = 12.5, .force_error = error};
    double sum = 0;
    constexpr int kPeople = 30;
    for (int person = 0; person < kPeople; ++person) {
      SimulatedParticipant participant({}, static_cast<std::uint64_t>(person));
      Conductor conductor(*store_, rig_, {.now_s = [&participant] { return participant.now(); }});
      conductor.begin("");
      participant.takePart(conductor);
    }
    for (const FormAnswerRow& answer : store_->formAnswers(false)) {
      sum += std::stod(answer.value);
    }
    trusted.push_back(sum / kPeople);
    EXPECT_THAT(store_->trials(), SizeIs(3 * kPeople));
  }
  // 100 (1 - error) with a standard deviation of 10, cut off at the scale's ends: by 0.8 of the mean here
  EXPECT_NEAR(trusted[0], 90 - 0.8, 5.5);
  EXPECT_NEAR(trusted[1], 10 + 0.8, 5.5);
}

TEST_F(TeleopStudy, TheTableHasWhatWasMeasured) {
  rig_.summary = {.done = 1, .time_s = 12.5, .reached = 0.041, .force_error = 0.4, .stops = 2};
  SimulatedParticipant participant({}, 1);
  Conductor conductor(*store_, rig_, {.now_s = [&participant] { return participant.now(); }});
  conductor.begin("");
  participant.takePart(conductor);
  exportCsv(*store_, folder_ / "a.csv", {});
  std::ifstream file(folder_ / "a.csv");
  std::vector<std::map<std::string, std::string>> rows;
  std::vector<std::string> heads;
  for (std::string line; std::getline(file, line);) {
    std::vector<std::string> fields;
    std::istringstream parts(line);
    for (std::string field; std::getline(parts, field, ',');) {
      fields.push_back(field);
    }
    if (heads.empty()) {
      heads = fields;
      continue;
    }
    for (std::size_t i = 0; i < fields.size(); ++i) {
      rows.resize(std::max(rows.size(), std::size_t{1}));
      rows.back()[heads[i]] = fields[i];
    }
    rows.emplace_back();
  }
  ASSERT_THAT(rows, SizeIs(4));
  EXPECT_EQ(rows[1]["teleop_done"], "1");
  EXPECT_EQ(rows[1]["teleop_time_s"], "12.5");
  EXPECT_EQ(rows[1]["teleop_force_error"], "0.4");
  EXPECT_EQ(rows[1]["teleop_reached"], "0.041");
  EXPECT_EQ(rows[1]["teleop_stops"], "2");
  EXPECT_EQ(rows[1]["teleop_cohesion_pa"], "");
  EXPECT_EQ(rows[1]["response"], "") << "nothing was asked";
  EXPECT_EQ(rows[1]["level"], "learning 2.6 s");
  EXPECT_NE(rows[1]["dig_trust"], "");
  EXPECT_THAT(
      json::parse(experimenterMessage(conductor, historyJson(conductor), 0, 0))["answers"].back()["work"].dump(),
      HasSubstr("\"time_s\":12.5"));
}

TEST_F(TeleopStudy, ThePreregistrationSaysWhatIsMeasured) {
  const std::string text = preregistrationText(load(kHead + kDig), {.protocol_text = kHead + kDig, .version = "1"});
  EXPECT_THAT(text, HasSubstr("task time"));
  EXPECT_THAT(text, HasSubstr("The round-trip delay is 2.6 s"));
  EXPECT_THAT(text, testing::Not(HasSubstr("psychometric")));
}

/// A participant's main trials in two blocks.
void takePart(StudyStore& store, const std::map<std::string, std::vector<double>>& times_s, const std::string& trust) {
  const std::int64_t person = store.addParticipant("").id;
  std::size_t block = 0;
  for (const auto& [name, times] : times_s) {
    for (std::size_t i = 0; i < times.size(); ++i) {
      TrialBegun begun{.participant = person, .block = block, .position = block, .index = static_cast<int>(i)};
      begun.block_name = name;
      const std::int64_t trial = store.beginTrial(begun);
      store.answerTrial(trial, {.teleop = TeleopSummary{.done = 1, .time_s = times[i]}});
    }
    store.setAnswers(person, name, store.protocol().blocks[block].questionnaire, {{"trust", trust}});
    ++block;
  }
}

const TeleopMeasure& measure(const TeleopBlockResult& result, const std::string& name) {
  return *std::ranges::find(result.measures, name, &TeleopMeasure::name);
}

TEST_F(TeleopStudy, PeopleAreComparedBetweenBlocks) {
  make(kHead + kDig + replaced(kDig, "name = \"dig\"", "name = \"far\""));
  takePart(*store_, {{"dig", {10, 20}}, {"far", {30, 40}}}, "80");
  takePart(*store_, {{"dig", {14, 14}}, {"far", {36, 38}}}, "60");
  takePart(*store_, {{"dig", {99, 99}}, {"far", {99, 99}}}, "0");
  store_->setExcluded(store_->participants().back().id, true, "slept");
  const std::vector<TeleopBlockResult> results = teleopResults(*store_, false);
  ASSERT_THAT(results, SizeIs(2));
  const PeopleMean first = meanOf(measure(results[0], "task time"));
  EXPECT_EQ(first.people, 2U);
  EXPECT_EQ(first.mean, 14.5) << "of 15 and 14";
  const PeopleMean more = meanDifference(measure(results[1], "task time"), measure(results[0], "task time"));
  EXPECT_EQ(more.mean, 21.5) << "of 20 and 23";
  EXPECT_NEAR(more.interval.high - more.mean, 12.7062 * std::sqrt(4.5) / std::sqrt(2), 1e-3) << "t of one degree";
  EXPECT_EQ(meanOf(measure(results[0], "trust")).mean, 70);
  EXPECT_EQ(meanOf(measure(results[0], "error of force")).people, 0U) << "it was never known";
}

TEST(PeopleMean, ItsIntervalHoldsTheTruthAsOftenAsItSays) {
  constexpr int kStudies = 4000;
  std::mt19937_64 random(3);
  for (const double confidence : {0.8, 0.95}) {
    int holds = 0;
    for (int study = 0; study < kStudies; ++study) {
      std::vector<double> values(6);
      for (double& value : values) {
        value = 5 + 3 * normal(random);
      }
      const Interval interval = meanOverPeople(values, confidence).interval;
      holds += interval.low <= 5 && 5 <= interval.high ? 1 : 0;
    }
    const double scatter = std::sqrt(confidence * (1 - confidence) / kStudies);
    EXPECT_NEAR(static_cast<double>(holds) / kStudies, confidence, 4 * scatter);
  }
  EXPECT_TRUE(std::isnan(meanOverPeople(std::vector<double>{4}).interval.low)) << "of one person";
}

}  // namespace
}  // namespace haptolith
