#include "haptolith/study/run/study_messages.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "haptolith/core/error.h"
#include "haptolith/study/run/study_pages.h"

#include "a_study.h"
#include "fake_rig.h"

namespace haptolith {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

class StudyMessages : public testing::Test {
 protected:
  void SetUp() override {
    file_ = std::filesystem::path(testing::TempDir()) / ("messages_" + std::to_string(getpid()) + ".study");
    std::filesystem::remove(file_);
    StudyStore::create(file_, loadProtocolText(kTwoBlocks, "test"), kTwoBlocks, 7);
    store_ = std::make_unique<StudyStore>(file_, StudyStore::Access::kRun);
    conductor_ = std::make_unique<Conductor>(*store_, rig_, ConductorOptions{.now_s = [this] { return now_s_; }});
  }
  void TearDown() override {
    conductor_.reset();
    store_.reset();
    std::filesystem::remove(file_);
  }

  void says(const json& message, StudyRole role = StudyRole::kParticipant) {
    (void)handleStudyMessage(*conductor_, message.dump(), role, true);
  }
  [[nodiscard]] json participant() const { return json::parse(participantMessage(*conductor_)); }
  [[nodiscard]] json experimenter() const {
    return json::parse(experimenterMessage(*conductor_, historyJson(*conductor_), 1.5, 3));
  }
  /// To the question of the first trial.
  void comeToAQuestion() {
    conductor_->begin("");
    says({{"act", "fill"}, {"values", {{"age", "30"}, {"name", "Ada"}}}});
    for (int interval = 1; interval <= 2; ++interval) {
      now_s_ += 1;
      conductor_->poll();
      now_s_ += 1;
      says({{"act", "go"}});
    }
  }

  std::filesystem::path file_;
  double now_s_ = 0;
  FakeRig rig_;
  std::unique_ptr<StudyStore> store_;
  std::unique_ptr<Conductor> conductor_;
};

TEST_F(StudyMessages, TellsThePageHowLateThePictureIs) {
  const std::string late = kTwoBlocks + "visual_delay_s = 0.5\n";  // in the last block
  TearDown();
  StudyStore::create(file_, loadProtocolText(late, "test"), late, 7);
  store_ = std::make_unique<StudyStore>(file_, StudyStore::Access::kRun);
  conductor_ = std::make_unique<Conductor>(*store_, rig_, ConductorOptions{.now_s = [this] { return now_s_; }});
  conductor_->begin("");
  says({{"act", "fill"}, {"values", {{"age", "30"}, {"name", "Ada"}}}});
  EXPECT_EQ(participant().at("visual_delay_s"), 0);
  std::map<std::string, double> told_s;
  for (int i = 0; i < 400 && participant().at("phase") != "finished"; ++i) {
    now_s_ += 1;
    conductor_->poll();
    const json now = participant();
    if (now.at("phase") == "interval") {
      told_s[experimenter().at("now").at("block")] = now.at("visual_delay_s");
      says({{"act", "go"}});
    } else if (now.at("phase") == "question") {
      EXPECT_EQ(now.at("visual_delay_s"), 0);
      says({{"act", "answer"}, {"choice", 1}});
    }
  }
  EXPECT_EQ(told_s, (std::map<std::string, double>{{"friction", 0}, {"gravity", 0.5}}));
}

TEST_F(StudyMessages, AnEmptyStudyWaits) {
  EXPECT_EQ(participant()["phase"], "waiting");
  EXPECT_EQ(experimenter()["participant"], nullptr);
  EXPECT_EQ(experimenter()["blocks"].size(), 2U);
}

TEST_F(StudyMessages, AnAnswerIsZeroOrOneAndNoNumberThatBecomesOneOfThem) {
  comeToAQuestion();
  for (const json& choice : {json(4294967296), json(4294967297), json(-1), json(2), json(0.5), json("1")}) {
    EXPECT_THROW(says({{"act", "answer"}, {"choice", choice}}), InvalidParameter) << choice;
  }
  EXPECT_EQ(participant()["phase"], "question");
  EXPECT_NO_THROW(says({{"act", "answer"}, {"choice", 1}}));
}

TEST_F(StudyMessages, OnlyTheParticipantHoldsTheToolAndOnlyWhileThereIsSomethingToFeel) {
  using Wish = StudyPages::Wish;
  StudyPages pages(*conductor_);
  pages.join(1, StudyRole::kParticipant);
  pages.join(2, StudyRole::kExperimenter);
  pages.handleMessages(1, R"({"act": "join", "as": "participant"})");
  pages.handleMessages(2, R"({"act": "join", "as": "experimenter"})");
  EXPECT_EQ(pages.refusal(1, Wish::kLook), "");
  EXPECT_THAT(pages.refusal(1, Wish::kHoldTool), HasSubstr("no stimulus"));
  conductor_->begin("");
  says({{"act", "fill"}, {"values", {{"age", "30"}, {"name", "Ada"}}}});
  now_s_ += 1;
  conductor_->poll();
  ASSERT_EQ(conductor_->state().phase, StudyPhase::kInterval);
  EXPECT_EQ(pages.refusal(1, Wish::kHoldTool), "");
  EXPECT_THAT(pages.refusal(2, Wish::kHoldTool), HasSubstr("the scene cannot be changed"));
  EXPECT_THAT(pages.refusal(1, Wish::kChangeScene), HasSubstr("the scene cannot be changed"));
  EXPECT_FALSE(pages.news(1.0).lets_go);
  now_s_ += 1;
  says({{"act", "go"}});
  const StudyPages::News news = pages.news(1.0);
  EXPECT_TRUE(news.lets_go) << "the interval is over";
  EXPECT_EQ(news.messages.size(), 2U);
  pages.leave(1);
  pages.leave(2);
  EXPECT_THAT(pages.news(0).messages, testing::IsEmpty());
}

TEST_F(StudyMessages, AFormIsFilledInByMessage) {
  conductor_->begin("");
  const json form = participant();
  EXPECT_EQ(form["phase"], "form");
  ASSERT_EQ(form["fields"].size(), 2U);
  EXPECT_EQ(form["fields"][1]["kind"], "number");
  EXPECT_EQ(form["fields"][1]["low"], 18);
  EXPECT_EQ(form["fields"][1]["required"], true);
  EXPECT_THROW(says({{"act", "fill"}, {"values", {{"age", "3"}}}}), InvalidParameter);
  EXPECT_THROW(says({{"act", "fill"}, {"values", {{"age", 30}}}}), InvalidParameter);
  EXPECT_THROW(says({{"act", "fill"}}), InvalidParameter);
  EXPECT_EQ(participant()["phase"], "form");
}

TEST_F(StudyMessages, TheParticipantIsToldNothingThatTellsTheStimulus) {
  comeToAQuestion();
  EXPECT_EQ(participant()["phase"], "question");
  EXPECT_EQ(participant()["choices"].size(), 2U);
  const std::string test = conductor_->state().now->test->name;
  for (const std::string& word : {test, std::string("P3"), std::string("Moon"), std::string("force")}) {
    EXPECT_THAT(participantMessage(*conductor_), Not(HasSubstr("\"" + word))) << word;
  }
  EXPECT_EQ(experimenter()["now"]["test"], test);
  EXPECT_EQ(experimenter()["force_n"], 1.5);
}

TEST_F(StudyMessages, AnAnswerReachesTheStoreAndTheExperimenter) {
  comeToAQuestion();
  says({{"act", "answer"}, {"choice", 1}});
  EXPECT_TRUE(store_->trials().front().answer->positive);
  EXPECT_EQ(experimenter()["answers"][0]["positive"], true);
  EXPECT_EQ(experimenter()["answers"][0]["state"], "answered");
  EXPECT_EQ(experimenter()["blocks"][store_->trials().front().block]["levels"][0]["n"], 1);
  EXPECT_THROW(says({{"act", "answer"}, {"choice", 1}}), InvalidParameter) << "there is no question open";
}

TEST_F(StudyMessages, ACurveIsDrawnThroughSomeAnswersNotThroughTwo) {
  comeToAQuestion();
  for (int answers = 1; answers <= 12; ++answers) {
    says({{"act", "answer"}, {"choice", answers % 2}});
    const std::size_t block = store_->trials().front().block;
    EXPECT_EQ(experimenter()["blocks"][block]["curve"].is_array(), answers >= 10) << answers;
    for (int interval = 1; interval <= 2; ++interval) {
      now_s_ += 1;
      conductor_->poll();
      now_s_ += 1;
      says({{"act", "go"}});
    }
  }
}

TEST_F(StudyMessages, TheEndForTodayIsSaidToBothPages) {
  comeToAQuestion();
  says({{"act", "answer"}, {"choice", 1}});
  EXPECT_EQ(participant()["ended"], false);
  EXPECT_EQ(experimenter()["ended"], nullptr);
  says({{"act", "end"}}, StudyRole::kExperimenter);
  EXPECT_EQ(participant()["phase"], "stopped");
  EXPECT_EQ(participant()["ended"], true);
  EXPECT_EQ(participant()["text"], "") << "the page has words of its own";
  EXPECT_EQ(experimenter()["participant"], "S01");
  EXPECT_THAT(experimenter()["ended"],
              AllOf(HasSubstr("S01 stopped after 1 of "), HasSubstr("haptolith study resume " + file_.string())));
}

TEST_F(StudyMessages, EachRoleMayAskForItsOwnOnly) {
  comeToAQuestion();
  EXPECT_THROW(says({{"act", "pause"}}), InvalidParameter);
  EXPECT_THROW(says({{"act", "answer"}, {"choice", 1}}, StudyRole::kExperimenter), InvalidParameter);
  says({{"act", "pause"}}, StudyRole::kExperimenter);
  EXPECT_EQ(participant()["phase"], "paused");
  EXPECT_EQ(experimenter()["paused"], true);
  says({{"act", "note"}, {"text", "sneezed"}}, StudyRole::kExperimenter);
  EXPECT_EQ(experimenter()["notes"].back()["text"], "sneezed");
  says({{"act", "resume"}}, StudyRole::kExperimenter);
  says({{"act", "quit"}});
  EXPECT_EQ(participant()["phase"], "withdrawn");
}

TEST_F(StudyMessages, WhoHasNotJoinedOrTalksNonsenseIsRefused) {
  const auto refused = [this](const std::string& text) {
    EXPECT_THROW((void)handleStudyMessage(*conductor_, text, StudyRole::kParticipant, true), InvalidParameter) << text;
  };
  refused("");
  refused("[1, 2]");
  refused("{}");
  refused(R"({"act": 3})");
  refused(R"({"act": "dance"})");
  refused(R"({"act": "join", "as": "director"})");
  refused(R"({"act": "answer", "choice": "1"})");
  EXPECT_THROW((void)handleStudyMessage(*conductor_, R"({"act": "go"})", StudyRole::kParticipant, false),
               InvalidParameter);
}

TEST_F(StudyMessages, NobodyJoinsInAnotherRoleThanTheirAddressGives) {
  const std::string as_experimenter = R"({"act": "join", "as": "experimenter"})";
  const std::string as_participant = R"({"act": "join", "as": "participant"})";
  for (const bool joined : {false, true}) {
    EXPECT_THROW((void)handleStudyMessage(*conductor_, as_experimenter, StudyRole::kParticipant, joined),
                 InvalidParameter);
    EXPECT_THROW((void)handleStudyMessage(*conductor_, as_participant, StudyRole::kExperimenter, joined),
                 InvalidParameter);
    EXPECT_TRUE(handleStudyMessage(*conductor_, as_experimenter, StudyRole::kExperimenter, joined));
    EXPECT_TRUE(handleStudyMessage(*conductor_, as_participant, StudyRole::kParticipant, joined));
  }
}

}  // namespace
}  // namespace haptolith
