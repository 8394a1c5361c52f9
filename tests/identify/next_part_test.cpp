#include <gmock/gmock.h>

#include <algorithm>

#include "haptolith/identify/check/parts_check.h"
#include "haptolith/identify/next_measurement.h"
#include "haptolith/identify/training/training_file.h"

#include "made_up_training.h"

namespace haptolith {
namespace {

using testing::ElementsAre;

constexpr std::size_t kBlock = 4, kAir = 4;  ///< windows of one place, and between two

/// Forces of a synthetic soil with a path through the air after each place.
WindowForces withAir(const WindowForces& forces) {
  WindowForces all;
  for (std::size_t i = 0; i < forces.size(); i += kBlock) {
    all.insert(all.end(), forces.begin() + static_cast<std::ptrdiff_t>(i),
               forces.begin() + static_cast<std::ptrdiff_t>(i + kBlock));
    all.insert(all.end(), kAir, Vec3::Zero());
  }
  return all;
}

Training withAir(const Training& training) {
  Training made{ToolMovement({{0, {}}, {0.25 * 2 * MadeUpSoil::kWindows + 0.01, {{0.1, 0, -0.02}, Quat::Identity()}}}),
                training.tool, training.gravity_m_s2, training.runs, training.temper};
  for (TrainingRun& run : made.runs) {
    run.forces = withAir(run.forces);
  }
  return made;
}

MeasuredForces only(const WindowForces& forces, const MovementPart& part) {
  MeasuredForces measured(forces.size());
  for (std::size_t window = part.first_window; window < part.first_window + part.windows; ++window) {
    measured[window] = forces[window];
  }
  return measured;
}

class Parts : public testing::Test {
 protected:
  static constexpr double kGravity = 1.625;
  const MadeUpSoil soils_{0.1};
  const Training training_ = withAir(soils_.training(150));
  const ForceEmulator emulator_{training_};
  const double temper_ = *training_.temper;
  const std::vector<MovementPart> parts_ = partsOf(training_.movement, emulator_);
};

TEST_F(Parts, ArePartedInTheAir) {
  ASSERT_EQ(parts_.size(), MadeUpSoil::kWindows / kBlock);
  EXPECT_EQ(parts_[1].first_window, kBlock + kAir / 2) << "in the middle of it";
  EXPECT_EQ(parts_[1].windows, kBlock + kAir);
  EXPECT_EQ(parts_.back().first_window + parts_.back().windows, 2 * MadeUpSoil::kWindows);
  EXPECT_THAT(parts_[1].name, testing::HasSubstr("part 2, at "));
  std::size_t numbers = 0;
  for (const MovementPart& part : parts_) {
    numbers += numbersOf(part, emulator_).size();
  }
  EXPECT_EQ(numbers, emulator_.size());
}

TEST_F(Parts, AreGainedFromOnce) {
  const WindowForces forces = withAir(soils_.forces({42, 500, 0.36}, kGravity, 1));
  const MeasuredForces measured = only(forces, parts_[4]);
  const std::vector<PartGain> gains = expectedGains(parts_, emulator_, temper_, measured, kGravity);
  EXPECT_EQ(gains.size(), parts_.size() - 1);
  EXPECT_TRUE(std::ranges::none_of(gains, [](const PartGain& gain) { return gain.part == 4; }));
  EXPECT_TRUE(std::ranges::is_sorted(gains, std::ranges::greater{}, &PartGain::bits_s));
  const std::vector<PartGain> before =
      expectedGains(parts_, emulator_, temper_, MeasuredForces(forces.size()), kGravity);
  const auto bits_of = [](const std::vector<PartGain>& all, std::size_t part) {
    return std::ranges::find(all, part, &PartGain::part)->bits;
  };
  EXPECT_LT(bits_of(gains, 6), 0.75 * bits_of(before, 6)) << "a cut as deep and as upright has told most of it";
}

TEST_F(Parts, HalfAPartIsOne) {
  MeasuredForces measured = only(withAir(soils_.forces({42, 500, 0.36}, kGravity, 1)), parts_[4]);
  EXPECT_TRUE(isMeasured(parts_[4], emulator_, measured));
  const std::size_t first = emulator_.windowOf(numbersOf(parts_[4], emulator_).front());
  measured[first].reset();
  EXPECT_TRUE(isMeasured(parts_[4], emulator_, measured));
  measured[first + 2].reset();
  EXPECT_FALSE(isMeasured(parts_[4], emulator_, measured));
}

TEST(NextPart, IsWhatHelpsWhereSomethingIsTooWide) {
  const std::vector<PartGain> gains{{3, 1, 0.4, {20, 990, 20}}, {1, 1, 0.3, {12, 800, 20}}};
  const SoilWidths now{20, 1000, 20};
  EXPECT_EQ(nextPart(gains, now, {20, 1000, 20}), std::nullopt) << "nothing is too wide";
  EXPECT_EQ(nextPart(gains, now, {15, 1000, 20})->part, 1U) << "the other one does not tell the angle";
  EXPECT_EQ(nextPart(gains, now, {20, 1000, 15}), std::nullopt) << "nothing would help";
  EXPECT_EQ(nextPart({{3, 1, 0.4, {20, 900, 20}}, gains[1]}, now, {15, 500, 20})->part, 3U) << "the most a second";
}

TEST(ProbeParts, HaveNamesAndMeetInTheAir) {
  const Training& training = probeTraining();
  const std::vector<MovementPart> parts = partsOf(training.movement, ForceEmulator(training));
  std::vector<std::string> names;
  for (const MovementPart& part : parts) {
    names.push_back(part.name);
    EXPECT_GT(part.movement.at(0).position_m.z(), 0.04);
    EXPECT_GT(part.movement.at(part.movement.duration()).position_m.z(), 0.04);
    const double from_s = static_cast<double>(part.first_window) * kForceWindow_s;
    EXPECT_LT((part.movement.at(1.3).position_m - training.movement.at(from_s + 1.3).position_m).norm(), 1e-9);
  }
  EXPECT_THAT(names, ElementsAre("press 8 mm", "press 14 mm", "cut 20 mm, upright", "cut 35 mm, upright",
                                 "cut 20 mm, leaning", "cut 35 mm, leaning"));
}

TEST(PartsCheck, MeasuresEachPartOnce) {
  constexpr std::size_t kEvery = 25;
  const PartsCheck check(probeTraining(), kEvery);
  const std::vector<PartsCourse> courses = check.courses(PartOrder::kByGain);
  ASSERT_GE(courses.size(), 2U);
  for (const PartsCourse& course : courses) {
    std::vector<std::size_t> parts;
    for (const PartsStep& step : course.steps) {
      parts.push_back(step.part);
    }
    EXPECT_THAT(parts, testing::UnorderedElementsAre(0, 1, 2, 3, 4, 5));
    EXPECT_NEAR(course.steps.back().time_s, check.duration(), 1e-9);
    EXPECT_LT(course.steps.back().belief.friction_angle_deg.width(), 0.9 * course.before.friction_angle_deg);
  }
}

// docs/reports/identification.md has the same of all the soils: `haptolith identify next --evaluate`.
TEST(PartsCheck, GainTellsSoonerAndIntervalsComeAsExpected) {
  constexpr std::size_t kEvery = 3;
  const PartsCheck check(probeTraining(), kEvery);
  const std::vector<PartsCourse> by_gain = check.courses(PartOrder::kByGain);
  const std::vector<PartsCourse> as_learned = check.courses(PartOrder::kAsLearned);
  ASSERT_GE(by_gain.size(), 15U);
  const SoilWidths wanted{16, 600, 20};
  EXPECT_LT(timeUntil(by_gain, wanted, check.duration()).mean_s,
            timeUntil(as_learned, wanted, check.duration()).mean_s - 1.5);
  double held = 0;
  for (const PartsRow& row : partsRows(by_gain)) {
    held += row.held_share / 6;
    for (double SoilWidths::*width : kWidths) {
      EXPECT_NEAR(row.over_expected.*width, 1, 0.25) << row.parts << " parts";
    }
    EXPECT_GE(row.within_quarter, 0.6) << row.parts << " parts";
  }
  EXPECT_NEAR(held, 0.92, 0.06);
}

}  // namespace
}  // namespace haptolith
