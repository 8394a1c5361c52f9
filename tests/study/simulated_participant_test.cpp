#include "haptolith/study/run/simulated_participant.h"

#include <boost/math/distributions/non_central_t.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "haptolith/core/error.h"
#include "haptolith/study/results/answers.h"
#include "haptolith/study/run/study_plan.h"

namespace haptolith {
namespace {

/// Share of "more" among many answers to one pair.
double shareOfMore(const ObserverParameters& parameters, double test, double reference) {
  constexpr int kAnswers = 20'000;
  SimulatedObserver observer(parameters, 5);
  int more = 0;
  for (int i = 0; i < kAnswers; ++i) {
    more += observer.saysMore(test, reference) ? 1 : 0;
  }
  return static_cast<double>(more) / kAnswers;
}

double phi(double z) {
  return 0.5 * std::erfc(-z / std::sqrt(2.0));
}

constexpr double kScatter = 0.012;  // 3.4 standard deviations of a share among 20 000

TEST(SimulatedObserver, AnswersAsThePapersPsychometricFunctionSays) {
  for (const double w : {0.29, 3.31}) {
    for (const double ratio : {0.5, 0.9, 1.0, 1.0 + w, 6.0}) {
      EXPECT_NEAR(shareOfMore({.weber_fraction = w}, 1.625 * ratio, 1.625), phi(std::log(ratio) / std::log1p(w)),
                  kScatter)
          << w << " " << ratio;
    }
  }
}

TEST(SimulatedObserver, BiasMovesTheCurveAndLapsesFlattenIt) {
  EXPECT_NEAR(shareOfMore({.bias = 0.25}, 0.8, 1), 0.5, kScatter);
  EXPECT_NEAR(shareOfMore({.lapse = 0.05}, 1000, 1), 0.95, kScatter);
  EXPECT_NEAR(shareOfMore({.lapse = 0.5}, 1000, 1), 0.5, kScatter);
}

TEST(SimulatedObserver, LearningMakesTheFirstAnswersWorse) {
  int right_at_first = 0, right_later = 0;
  for (std::uint64_t person = 0; person < 400; ++person) {
    SimulatedObserver observer({.weber_fraction = 0.2, .learning = 4, .learning_trials = 10}, person);
    for (int trial = 0; trial < 60; ++trial) {
      const bool right = observer.saysMore(1.2, 1);
      right_at_first += trial < 10 && right ? 1 : 0;
      right_later += trial >= 50 && right ? 1 : 0;
    }
  }
  EXPECT_NEAR(right_later / 4000.0, phi(1), 0.03);
  EXPECT_LT(right_at_first, 0.85 * right_later);
}

TEST(SimulatedObserver, WhatMakesNoSenseIsRefused) {
  EXPECT_THROW(SimulatedObserver({.weber_fraction = 0}, 1), InvalidParameter);
  EXPECT_THROW(SimulatedObserver({.lapse = 0.6}, 1), InvalidParameter);
  EXPECT_THROW(SimulatedObserver({.bias = -1}, 1), InvalidParameter);
  SimulatedObserver observer({}, 1);
  EXPECT_THROW((void)observer.saysMore(0, 1), InvalidParameter);
}

TEST(SimulatedParticipant, CannotJudgeValuesWithoutRatios) {
  const ProtocolText text = findProtocol("icra2021");
  StudyProtocol protocol = loadProtocolText(text.text, text.name);
  EXPECT_NO_THROW(requireRatios(protocol, JudgedBy::kValue));
  protocol.blocks.front().reference.value = 0;
  EXPECT_THROW(requireRatios(protocol, JudgedBy::kValue), InvalidParameter);
  EXPECT_NO_THROW(requireRatios(protocol, JudgedBy::kMeanForce));
}

TEST(SimulatedParticipant, TakesPartInAWholeStudy) {
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / ("simulated_" + std::to_string(getpid()) + ".study");
  std::filesystem::remove(file);
  const ProtocolText protocol = findProtocol("icra2021");
  StudyStore::create(file, loadProtocolText(protocol.text, protocol.name), protocol.text, 3);
  StudyStore store(file, StudyStore::Access::kRun);
  RigWithoutBed rig;
  for (int person = 0; person < 4; ++person) {
    SimulatedParticipant participant({.weber_fraction = 0.01}, static_cast<std::uint64_t>(person));
    Conductor conductor(store, rig, {.now_s = [&participant] { return participant.now(); }});
    conductor.begin("");
    participant.takePart(conductor);
    EXPECT_EQ(conductor.state().phase, StudyPhase::kFinished);
  }
  const std::vector<TrialRow> rows = store.trials();
  for (std::size_t block = 0; block < store.protocol().blocks.size(); ++block) {
    const std::vector<Level> levels = levelsOf(rows, block);
    ASSERT_EQ(levels.size(), 5U);
    double answers = 0;
    for (const Level& level : levels) {
      answers += level.n;
      EXPECT_EQ(level.k, level.x > store.protocol().blocks[block].reference.value ? level.n : 0) << level.x;
    }
    EXPECT_EQ(answers, 4 * 5 * 3);
  }
  std::filesystem::remove(file);
}

StudyBlock frictionBlock() {
  const ProtocolText protocol = findProtocol("icra2021-friction");
  return loadProtocolText(protocol.text, protocol.name).blocks.front();
}

TEST(StudyPlan, MoreAnswersMakeNarrowerIntervalsAndMorePower) {
  const std::vector<PlanOutcome> outcomes =
      planStudy(frictionBlock(), {{4, 3}, {8, 6}, {12, 12}}, {.alternative = 0.4, .studies = 30});
  ASSERT_EQ(outcomes.size(), 3U);
  EXPECT_EQ(outcomes[0].answers, 4 * 3 * 5);
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    EXPECT_NEAR(outcomes[i].median, 0.29, i == 0 ? 0.1 : 0.04);
    EXPECT_GT(outcomes[i].covered.value, 0.85);
    EXPECT_LT(outcomes[i].covered.interval.low, outcomes[i].covered.value);
    if (i > 0) {
      EXPECT_LT(outcomes[i].interval_width, outcomes[i - 1].interval_width);
      EXPECT_GT(outcomes[i].power->value, outcomes[i - 1].power->value);
    }
  }
  EXPECT_GT(outcomes[2].power->value, 0.75);
}

// If participants differ, a Weber fraction is not distinguished from itself more often than the interval is wrong.
TEST(StudyPlan, DoesNotTellAWeberFractionFromItself) {
  const PlanOutcome same =
      planStudy(frictionBlock(), {{8, 6}}, {.between_sd = 0.6, .alternative = 0.29, .studies = 60}).front();
  EXPECT_LE(same.power->value, 0.15) << "5 % of 60 studies are 3, give or take 1.7";
}

// With so many responses that each participant's Weber fraction is known, the t test over ln w has exact power.
TEST(StudyPlan, HasThePowerOfATTestWhereEachPersonIsKnownWell) {
  constexpr int kPeople = 8;
  constexpr double kBetweenSd = 0.6, kAlternative = 0.5;
  const ObserverParameters median_person;
  const double deviations = std::log(kAlternative / median_person.weber_fraction) / kBetweenSd;
  const double critical = boost::math::quantile(boost::math::students_t(kPeople - 1), 0.975);
  const double power = boost::math::cdf(
      boost::math::complement(boost::math::non_central_t(kPeople - 1, deviations * std::sqrt(kPeople)), critical));
  const PlanOutcome known_well = planStudy(frictionBlock(), {{kPeople, 200}},
                                           {.between_sd = kBetweenSd, .alternative = kAlternative, .studies = 100})
                                     .front();
  EXPECT_NEAR(known_well.power->value, power, 3 * std::sqrt(power * (1 - power) / 100)) << "exactly " << power;
}

TEST(StudyPlan, SearchesTheLeastNumberOfPeople) {
  const std::vector<PlanOutcome> tried = leastParticipants(frictionBlock(), 12, {.width = 1, .studies = 10}, 0.8);
  ASSERT_GE(tried.size(), 2U);
  const auto enough =
      std::ranges::find_if(tried, [](const PlanOutcome& outcome) { return outcome.narrow->value >= 0.8; });
  ASSERT_NE(enough, tried.end());
  EXPECT_LT(enough->size.participants, 40);
  EXPECT_THROW((void)leastParticipants(frictionBlock(), 3, {.studies = 10}, 0.8), InvalidParameter);
}

TEST(StudyPlan, WhatMakesNoSenseIsRefused) {
  StudyBlock block = frictionBlock();
  EXPECT_THROW((void)planStudy(block, {{0, 3}}, {}), InvalidParameter);
  EXPECT_THROW((void)planStudy(block, {{4, 3}}, {.alternative = -1}), InvalidParameter);
  EXPECT_THROW((void)planStudy(block, {{4, 3}}, {}, [] { return false; }), Failure);
  block.procedure = ProcedureKind::kStaircase;
  EXPECT_THROW((void)planStudy(block, {{4, 3}}, {}), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
