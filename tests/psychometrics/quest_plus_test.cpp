#include "haptolith/psychometrics/adaptive/quest_plus.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/math/random.h"
#include "haptolith/psychometrics/fit.h"

namespace haptolith {
namespace {

// Watson's examples work in decibels: psi = guess + (1 - guess - lapse)(1 - exp(-10^(slope (x - t)/20))), so his
// threshold is where the sigmoid is 1 - 1/e.
Hypothesis watsons(double threshold_db, double slope, double lapse) {
  const double per_db = std::numbers::ln10 * slope / 20;
  const double width = (std::log(-std::log(0.05)) - std::log(-std::log(0.95))) / per_db;
  return {{.sigmoid = Sigmoid::kGumbel,
           .threshold = threshold_db + std::log(std::numbers::ln2) / per_db,
           .width = width,
           .guess = 0.5,
           .lapse = lapse}};
}

QuestPlus watsonsQuest(const std::vector<double>& slopes, const std::vector<double>& lapses, int trials) {
  std::vector<double> contrasts_db;
  std::vector<Hypothesis> hypotheses;
  for (int contrast = -40; contrast <= 0; ++contrast) {
    contrasts_db.push_back(contrast);
    for (const double slope : slopes) {
      for (const double lapse : lapses) {
        hypotheses.push_back(watsons(contrast, slope, lapse));
      }
    }
  }
  for (Hypothesis& hypothesis : hypotheses) {
    hypothesis.probability = 1.0 / double(hypotheses.size());
  }
  return {contrasts_db, hypotheses, trials};
}

/// Number of consecutive stimuli that match the published ones, for responses C correct, I incorrect.
std::size_t publishedInARow(QuestPlus& quest, const std::vector<int>& contrasts_db, std::string_view answers) {
  for (std::size_t i = 0; i < contrasts_db.size(); ++i) {
    const std::optional<double> next = quest.next();
    if (!next || *next != contrasts_db[i]) {
      return i;
    }
    quest.answer(*next, answers[i] == 'C');
  }
  return contrasts_db.size();
}

/// The threshold of the most probable hypothesis, in Watson's decibels.
double mostProbableDb(const QuestPlus& quest, double slope) {
  const auto best = std::ranges::max_element(quest.hypotheses(), {}, &Hypothesis::probability);
  return best->function.threshold - std::log(std::numbers::ln2) / (std::numbers::ln10 * slope / 20);
}

TEST(QuestPlus, ChoosesWatsonsStimuliForAThreshold) {  // Watson 2017, example 1
  QuestPlus quest = watsonsQuest({3.5}, {0.02}, 32);
  const std::vector<int> contrasts_db{-18, -22, -25, -28, -30, -22, -13, -15, -16, -18, -19, -20, -21, -22, -23, -19,
                                      -20, -20, -18, -18, -19, -17, -17, -18, -18, -18, -19, -19, -19, -19, -19, -19};
  EXPECT_EQ(publishedInARow(quest, contrasts_db, "CCCCIICCCCCCCCICCICCICCCCCCCCCCC"), contrasts_db.size());
  EXPECT_NEAR(mostProbableDb(quest, 3.5), -20, 1e-9);
  double mean_db = 0;
  for (const Hypothesis& hypothesis : quest.hypotheses()) {
    mean_db += hypothesis.probability * hypothesis.function.threshold;
  }
  mean_db -= std::log(std::numbers::ln2) / (std::numbers::ln10 * 3.5 / 20);
  EXPECT_NEAR(mean_db, -20.39360311638961, 1e-9);
  EXPECT_EQ(quest.next(), std::nullopt);
}

TEST(QuestPlus, ChoosesWatsonsStimuliForThresholdAndSlope) {  // Watson 2017, "Implementation"
  QuestPlus quest = watsonsQuest({2, 3, 4, 5}, {0.02}, 64);
  const std::vector<int> contrasts_db{-18, -22, -12, -13, -15, -16, -17, -18, -19, -21, -24, -25, -26, -27, -21, -22,
                                      -23, -20, -20, -20, -21, -19, -19, -20, -20, -20, -19, -19, -19, -19, -19, -20,
                                      -20, -20, -20, -20, -21, -21, -20, -20, -20, -19, -18, -18, -19, -19, -19, -18,
                                      -18, -17, -18, -18, -18, -17, -17, -17, -17, -17, -17, -17, -18, -18, -18, -18};
  EXPECT_EQ(publishedInARow(quest, contrasts_db, "CICCCCCCCCCCCICCICCCICCCCICCCCCCCCCCCICCIICCCCICICCCICCCCCCCCCCC"),
            contrasts_db.size());
  EXPECT_NEAR(mostProbableDb(quest, 3), -20, 1e-9);
}

TEST(QuestPlus, ChoosesWatsonsStimuliForThresholdSlopeAndLapse) {  // Watson 2017, example 2
  QuestPlus quest = watsonsQuest({2, 3, 4, 5}, {0, 0.01, 0.02, 0.03, 0.04}, 128);
  const std::vector<int> contrasts_db{
      -18, -22, -25, -28, -30, -21, -12, -14, -15, -16, -18, -19, -20, -22, -23, -18, -19, -16, -17, -17, -18, -18,
      -18, -19, -19, -17, -17, -18, -18, -18, -18, -19, -19, -20, -18, -18, -18, -18, -18, -19, -19, -19, -19, -20,
      -18, -18, -18, -18, -18, -18, -18, -18, -18, -19, -19, -19, -20, -18, -18, -18, -18, -19, -19, -19, -18, -18,
      -18, -18, -19, -19, -19, -19, -19, -19, -19, -19, -20, -21, -19, -19, -19, -19, -19, -19, -19, -18, -19, -19,
      -16, -16, -16, -16, -16, -16, 0,   0,   -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19,
      -21, -21, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19};
  const std::string_view answers =
      "CCCCIICCCCCCCCICICCCCCCCICCCCCCCCICCCCCCCCCICCCICCCCCCCCICCCCCCI"
      "CCCCCCCCCCCCCICICCCCICCICCCCCCCICCCCCCCCCCCCCCCICCCICIICCCCICCCC";
  EXPECT_EQ(publishedInARow(quest, contrasts_db, answers), contrasts_db.size());
  EXPECT_NEAR(mostProbableDb(quest, 5), -20, 1e-9);
}

/// Whether a participant with this function responds "more".
bool answerOf(const PsychometricFunction& truth, double x, std::mt19937_64& random) {
  return (uniformSigned(random) + 1) / 2 < probability(truth, x);
}

constexpr double kReference = 0.835;
constexpr double kW = 0.29;

std::vector<double> fineLevels() {
  std::vector<double> levels;
  for (int i = -12; i <= 12; ++i) {
    if (i != 0) {
      levels.push_back(kReference * std::exp(0.05 * i));
    }
  }
  return levels;
}

/// The levels of one simulated person after `trials` of QUEST+.
std::vector<Level> simulated(QuestPlus& quest, const PsychometricFunction& truth, std::mt19937_64& random) {
  std::vector<Level> levels;
  while (const std::optional<double> x = quest.next()) {
    const bool positive = answerOf(truth, *x, random);
    quest.answer(*x, positive);
    levels.push_back({*x, positive ? 1.0 : 0.0, 1});
  }
  return levels;
}

TEST(QuestPlus, FindsTheWeberFractionOfSimulatedPeople) {
  std::mt19937_64 random(1);
  PsychometricFunction truth = weberFunction(1.05 * kReference, kW);
  truth.lapse = truth.guess = 0.02;
  double sum = 0;
  double sum_threshold = 0;
  constexpr int kPeople = 20;
  for (int i = 0; i < kPeople; ++i) {
    const auto quest = makeQuestPlus({.trials = 60}, fineLevels(), kReference);
    (void)simulated(*quest, truth, random);
    sum += std::log(quest->estimate()->jnd / quest->estimate()->threshold);
    sum_threshold += quest->estimate()->threshold;
  }
  EXPECT_NEAR(std::exp(sum / kPeople), kW, 0.15 * kW);
  EXPECT_NEAR(sum_threshold / kPeople, 1.05 * kReference, 0.03 * kReference);
}

// People differ. Levels that were chosen beforehand suit few of them; QUEST+ finds the most informative levels for
// each.
TEST(QuestPlus, NeedsFewerTrialsThanConstantStimuli) {
  std::mt19937_64 random(2);
  FitOptions options = weberOptions(kReference);
  options.simulations = 0;
  constexpr int kPeople = 80;
  const auto squaredError = [&](const std::vector<Level>& levels, double w) {
    const double error = std::log(fitPsychometric(levels, options).w->value / w);
    return error * error / kPeople;
  };
  double adaptive = 0;
  double constant = 0;
  for (int i = 0; i < kPeople; ++i) {
    const double w = 0.08 * std::pow(0.6 / 0.08, (i + 0.5) / kPeople);
    const PsychometricFunction truth = weberFunction(kReference, w);
    const auto quest =
        makeQuestPlus({.thresholds = {kReference}, .lapses = {0}, .trials = 40}, fineLevels(), kReference);
    adaptive += squaredError(simulated(*quest, truth, random), w);
    std::vector<Level> levels;
    for (const double x : {0.600, 0.648, 0.735, 1.00, 1.21}) {
      for (int trial = 0; trial < 12; ++trial) {
        levels.push_back({x, answerOf(truth, x, random) ? 1.0 : 0.0, 1});
      }
    }
    constant += squaredError(levels, w);
  }
  EXPECT_LT(std::sqrt(adaptive), 0.9 * std::sqrt(constant)) << "40 trials against 60";
}

TEST(QuestPlus, GoesOnWhereItWasWhenToldTheAnswersAgain) {
  std::mt19937_64 random(3);
  const auto quest = makeQuestPlus({}, fineLevels(), kReference);
  std::vector<std::pair<double, bool>> told;
  for (int i = 0; i < 12; ++i) {
    const double x = *quest->next();
    told.emplace_back(x, answerOf(weberFunction(kReference, kW), x, random));
    quest->answer(told.back().first, told.back().second);
  }
  const auto again = makeQuestPlus({}, fineLevels(), kReference);
  for (const auto& [x, positive] : told) {
    again->answer(x, positive);
  }
  EXPECT_EQ(again->next(), quest->next());
  EXPECT_EQ(again->estimate()->jnd, quest->estimate()->jnd);
}

TEST(QuestPlus, UsesBothSidesOfTheReference) {
  std::mt19937_64 random(4);
  const auto quest = makeQuestPlus({.trials = 30}, fineLevels(), kReference);
  const std::vector<Level> levels = pooled(simulated(*quest, weberFunction(kReference, kW), random));
  EXPECT_LT(levels.front().x, kReference);
  EXPECT_GT(levels.back().x, kReference);
}

TEST(QuestPlus, EndsWhenItIsSureEnough) {
  std::mt19937_64 random(5);
  const auto quest = makeQuestPlus({.trials = 500, .enough_spread = 0.3}, fineLevels(), kReference);
  const std::vector<Level> levels = simulated(*quest, weberFunction(kReference, kW), random);
  EXPECT_LT(levels.size(), 300u);
  EXPECT_LT(quest->logWidthSpread(), 0.3);
}

TEST(QuestPlus, TellsMediansAndIntervalsOfItsMarginals) {
  // Thresholds 1, 2 and 3 with 1/4, 1/2 and 1/4: the mass at 2 lies evenly from 1.5 to 2.5, half of it below 2.
  std::vector<Hypothesis> hypotheses;
  for (const auto& [threshold, probability] : {std::pair(1.0, 0.25), {2.0, 0.5}, {3.0, 0.25}}) {
    hypotheses.push_back({{.threshold = threshold, .width = 2}, probability});
  }
  const QuestPlus quest({1, 2, 3}, hypotheses, 10);
  const Estimate threshold = quest.threshold(0.5);
  EXPECT_DOUBLE_EQ(threshold.value, 2);
  EXPECT_DOUBLE_EQ(threshold.interval.low, 1.5);
  EXPECT_DOUBLE_EQ(threshold.interval.high, 2.5);
  EXPECT_DOUBLE_EQ(quest.threshold(0.9).interval.low, 0.7) << "a fifth of the mass at 1, which begins at 0.5";
  EXPECT_DOUBLE_EQ(quest.width().value, 2) << "there is no other";
  EXPECT_DOUBLE_EQ(quest.width().interval.high, 2);
  EXPECT_THROW((void)quest.width(1), InvalidParameter);
}

TEST(QuestPlus, HasTheLowerAsymptoteOfItsDesign) {
  const auto guesses = [](const QuestPlusOptions& options) {
    std::set<double> rates;
    const auto quest = makeQuestPlus(options, {1, 2}, 1.5);
    for (const Hypothesis& hypothesis : quest->hypotheses()) {
      rates.insert(hypothesis.function.guess);
    }
    return rates;
  };
  EXPECT_EQ(guesses({.lapses = {0.01, 0.03}}), (std::set<double>{0.01, 0.03}));
  EXPECT_EQ(guesses({.design = Design::kForcedChoice}), (std::set<double>{0.5}));
  EXPECT_EQ(guesses({.design = Design::kForcedChoice, .alternatives = 4}), (std::set<double>{0.25}));
  EXPECT_EQ(guesses({.design = Design::kYesNo, .guesses = {0.1, 0.2}}), (std::set<double>{0.1, 0.2}));
}

TEST(QuestPlus, NonsenseIsRefused) {
  EXPECT_THROW((void)makeQuestPlus({}, {1}, 1), InvalidParameter);
  EXPECT_THROW((void)makeQuestPlus({}, {2, 1}, 1), InvalidParameter);
  EXPECT_THROW((void)makeQuestPlus({}, {-1, 1}, 1), InvalidParameter);
  EXPECT_THROW((void)makeQuestPlus({}, {1, 2}, 0), InvalidParameter);
  EXPECT_THROW((void)makeQuestPlus({.lapses = {}}, {1, 2}, 1), InvalidParameter);
  EXPECT_THROW((void)makeQuestPlus({.lapses = {0.7}}, {1, 2}, 1), InvalidParameter);
  EXPECT_THROW((void)makeQuestPlus({.design = Design::kYesNo, .guesses = {}}, {1, 2}, 1), InvalidParameter);
  EXPECT_THROW((void)makeQuestPlus({.alternatives = 1}, {1, 2}, 1), InvalidParameter);
  EXPECT_THROW((void)makeQuestPlus({.trials = 0}, {1, 2}, 1), InvalidParameter);
  const auto quest = makeQuestPlus({}, {1, 2}, 1.5);
  EXPECT_THROW(quest->answer(1.7, true), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
