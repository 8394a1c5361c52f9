#include "haptolith/study/results/adaptive_results.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/psychometrics/psychometric_function.h"
#include "haptolith/study/protocol/sequence.h"
#include "haptolith/study/run/simulated_participant.h"

#include "a_study.h"

namespace haptolith {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::uint64_t kSeed = 3;

/// A block over coefficients of friction, with further lines of its tables.
StudyBlock aBlock(const std::string& rest) {
  return loadProtocolText(R"(title = "Friction"
[[block]]
name = "friction"
question = "Which of the two was more resistant?"
answers = ["the first", "the second"]
task = "two-interval"
varies = "friction_coefficient"
reference = 0.835
levels = [0.56, 0.62, 0.67, 0.72, 0.76, 0.79, 0.81, 0.86, 0.885, 0.92, 0.97, 1.04, 1.13, 1.25]
)" + rest,
                          "test")
      .blocks.front();
}

StudyBlock aStaircase(const std::string& rest = "") {
  return aBlock("procedure = \"staircase\"\n[block.staircase]\nreversals = 12\n" + rest);
}

/// Responses of a participant with this Weber fraction, to the procedure's end.
std::vector<Level> answersOf(const StudyBlock& block, double w, std::uint64_t seed, double bias = 0) {
  SimulatedObserver observer({.weber_fraction = w, .bias = bias}, seed);
  const std::unique_ptr<AdaptiveProcedure> procedure = procedureOf(block, seed);
  std::vector<Level> answers;
  while (const std::optional<double> x = procedure->next()) {
    const bool positive = observer.saysMore(*x, block.reference.value);
    procedure->answer(*x, positive);
    answers.push_back({.x = *x, .k = positive ? 1.0 : 0.0, .n = 1});
  }
  return answers;
}

TEST(AdaptiveResults, AreNoneBeforeTheFirstAnswerAndUnfinishedAtFirst) {
  const StudyBlock block = aStaircase();
  EXPECT_FALSE(adaptiveResult(block, kSeed, {}));
  std::vector<Level> answers = answersOf(block, 0.2, kSeed);
  const AdaptiveResult whole = adaptiveResult(block, kSeed, answers).value();
  EXPECT_TRUE(whole.finished);
  EXPECT_EQ(whole.trials, static_cast<int>(answers.size()));
  ASSERT_TRUE(whole.reversals);
  answers.resize(5);
  const AdaptiveResult begun = adaptiveResult(block, kSeed, answers).value();
  EXPECT_FALSE(begun.finished);
  EXPECT_FALSE(begun.reversals);
  EXPECT_LT(begun.weber_fraction->interval.low, begun.weber_fraction->value);
  EXPECT_THROW((void)procedureOf(aBlock(""), kSeed), InvalidParameter) << "constant stimuli have no procedure";
}

/// docs/reports/psychometric-coverage.md has 400 people of each kind: haptolith_adaptive_coverage.
TEST(AdaptiveResults, OfStaircasesHaveLittleBiasWhereTheirReversalsHaveMuch) {
  constexpr int kPeople = 60;
  const StudyBlock block = aStaircase();
  for (const double w : {0.08, 0.2}) {
    double log_w = 0, log_threshold = 0;
    int covered = 0;
    for (int person = 0; person < kPeople; ++person) {
      const auto seed = static_cast<std::uint64_t>(person);
      const AdaptiveResult result = adaptiveResult(block, seed, answersOf(block, w, seed, 0.05)).value();
      log_w += std::log(result.weber_fraction->value / w) / kPeople;
      log_threshold += std::log(result.threshold.value * 1.05 / 0.835) / kPeople;
      covered += result.weber_fraction->interval.low <= w && w <= result.weber_fraction->interval.high ? 1 : 0;
    }
    EXPECT_NEAR(log_w, 0, 0.15) << w;  // three standard errors
    EXPECT_NEAR(log_threshold, 0, 0.02) << w;
    EXPECT_GE(covered, 52) << w;  // 57 are expected
  }
}

TEST(AdaptiveResults, SayThatTheLevelsEndWhereTheyDo) {
  const auto remark = [](double w) {
    const StudyBlock block = aStaircase();
    return adaptiveResult(block, kSeed, answersOf(block, w, kSeed)).value().remark;
  };
  EXPECT_THAT(remark(0.15), IsEmpty());
  EXPECT_THAT(remark(3.0), HasSubstr("the Weber fraction can be larger"));
  EXPECT_THAT(remark(0.001),
              HasSubstr("no level is closer to the reference than 0.81: the Weber fraction can be smaller"));
}

// 200 people of w = 0.05: the coarse grid with which stimuli are chosen held 81 % of the points of equality.
TEST(AdaptiveResults, IntervalsOfQuestPlusAreNoCoarserThanItsAnswers) {
  const StudyBlock block = aBlock("procedure = \"quest+\"\n[block.quest_plus]\ntrials = 40\nlapses = [0]\n");
  const AdaptiveResult result = adaptiveResult(block, kSeed, answersOf(block, 0.04, kSeed, 0.1)).value();
  EXPECT_NEAR(result.threshold.value, 0.835 / 1.1, 0.02);
  EXPECT_LT(result.threshold.interval.low, 0.835 / 1.1);
  EXPECT_GT(result.threshold.interval.high, 0.835 / 1.1);
}

TEST(AdaptiveResults, OfStaircasesSayThatEqualityLiesTooFarFromTheReference) {
  const StudyBlock block = aStaircase();
  const AdaptiveResult result = adaptiveResult(block, kSeed, answersOf(block, 0.06, kSeed, 0.15)).value();
  EXPECT_THAT(result.remark, HasSubstr("JNDs from the reference, which the staircases do not cross"));
}

TEST(AdaptiveResults, OfAStaircaseForEqualityAreAThresholdAlone) {
  const StudyBlock block = aBlock(
      "procedure = \"staircase\"\n[block.staircase]\ntarget = \"equality\"\nstaircases = 2\ndown = 1\nreversals = "
      "16\n");
  const AdaptiveResult result = adaptiveResult(block, kSeed, answersOf(block, 0.1, kSeed, -0.15)).value();
  EXPECT_FALSE(result.width);
  EXPECT_FALSE(result.weber_fraction);
  EXPECT_NEAR(result.threshold.value, 0.835 / 0.85, 0.05);
  EXPECT_LT(result.threshold.interval.low, 0.835 / 0.85);
  EXPECT_GT(result.threshold.interval.high, 0.835 / 0.85);
}

// Watson 2017, example 1: contrasts of -40 to 0 dB, a threshold, two alternatives. 40 soils stand for the contrasts.
TEST(AdaptiveResults, AProtocolCanAskForWatsonsFirstExample) {
  constexpr double kPerDb = std::numbers::ln10 * 3.5 / 20;
  std::vector<int> contrasts_db;
  std::vector<double> angles_deg, thresholds_db;
  for (int contrast = -40; contrast <= 0; ++contrast) {
    contrasts_db.push_back(contrast);
    angles_deg.push_back(50 + contrast);
    thresholds_db.push_back(contrast + std::log(std::numbers::ln2) / kPerDb);
  }
  const double width_db = (std::log(-std::log(0.05)) - std::log(-std::log(0.95))) / kPerDb;
  const StudyBlock block = loadProtocolText(fmt::format(R"toml(title = "Watson 2017"
[[block]]
name = "contrast"
question = "In which of the two was something?"
answers = ["the first", "the second"]
task = "two-interval"
varies = "friction_angle_deg"
reference = 5
reference_value = -60
levels = [{}]
values = [{}]
axis_label = "contrast (dB)"
procedure = "quest+"
[block.quest_plus]
sigmoid = "gumbel"
design = "2afc"
thresholds = [{}]
widths = [{}]
lapses = [0.02]
trials = 32
)toml",
                                                        fmt::join(angles_deg, ", "), fmt::join(contrasts_db, ", "),
                                                        fmt::join(thresholds_db, ", "), width_db),
                                            "test")
                               .blocks.front();
  const std::unique_ptr<AdaptiveProcedure> procedure = procedureOf(block, kSeed);
  const std::vector<int> published_db{-18, -22, -25, -28, -30, -22, -13, -15, -16, -18, -19, -20, -21, -22, -23, -19,
                                      -20, -20, -18, -18, -19, -17, -17, -18, -18, -18, -19, -19, -19, -19, -19, -19};
  constexpr std::string_view kAnswers = "CCCCIICCCCCCCCICCICCICCCCCCCCCCC";
  std::vector<Level> answers;
  for (std::size_t i = 0; i < published_db.size(); ++i) {
    ASSERT_EQ(procedure->next(), published_db[i]) << i;
    answers.push_back({.x = double(published_db[i]), .k = kAnswers[i] == 'C' ? 1.0 : 0.0, .n = 1});
    procedure->answer(answers.back().x, answers.back().k > 0);
  }
  EXPECT_EQ(procedure->next(), std::nullopt);
  const AdaptiveResult result = adaptiveResult(block, kSeed, answers).value();
  EXPECT_NEAR(result.threshold.value - std::log(std::numbers::ln2) / kPerDb, -20.39, 0.2);  // the mean he published
  EXPECT_EQ(result.width->value, result.width->interval.high) << "it was given";
  EXPECT_THAT(result.remark, IsEmpty());
}

class AdaptiveResultsOfAStudy : public AStudy {};

TEST_F(AdaptiveResultsOfAStudy, AreThoseOfEachParticipantInEachAdaptiveBlock) {
  std::filesystem::remove(file_);
  const std::string text = R"(title = "A study"
[[block]]
name = "list"
question = "Was the second more resistant?"
answers = ["less", "more"]
varies = "preset"
reference = "P3"
levels = ["P1", "P6"]
[[block]]
name = "quest"
question = "Was the second more resistant?"
answers = ["less", "more"]
varies = "preset"
reference = "P3"
levels = ["P1", "P2", "P4", "P5", "P6"]
procedure = "quest+"
)";
  StudyStore::create(file_, loadProtocolText(text, "test"), text, 42);
  StudyStore study(file_, StudyStore::Access::kRun);
  for (int person = 0; person < 2; ++person) {
    SimulatedParticipant participant({}, 5);
    RigWithoutBed rig;
    Conductor conductor(study, rig, {.now_s = [&participant] { return participant.now(); }});
    conductor.begin("");
    participant.takePart(conductor);
  }
  const std::vector<AdaptiveResultOf> results = adaptiveResults(study, study.trials());
  ASSERT_EQ(results.size(), 2U);
  EXPECT_EQ(results[0].participant, 1);
  EXPECT_EQ(results[1].participant, 2);
  for (const AdaptiveResultOf& of : results) {
    EXPECT_EQ(of.block, 1U);
    EXPECT_EQ(of.result.trials, 30);
    EXPECT_TRUE(of.result.finished);
  }
}

}  // namespace
}  // namespace haptolith
