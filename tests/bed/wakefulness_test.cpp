#include "haptolith/bed/wakefulness.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/bed/measure/bed_check.h"

namespace haptolith {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::uint32_t kTurn = Wakefulness::kTurn;
constexpr RestRule kRule{.sleep = true, .speed_m_s = 1e-3F, .distance_m = 1e-4F, .steps = 100};

/// Three groups of 16 in a row: the last of each touches the first of the next. Group 3 is ghosts.
class ThreeGroups : public testing::Test {
 protected:
  static constexpr std::size_t kParticles = 48, kGroups = 4;

  ThreeGroups() : wakefulness_(kGroups, kRule) {
    const std::size_t padded = paddedCount(kParticles);
    state_.position.resize(padded, Float4{});
    state_.velocity.resize(padded, Float4{});
    state_.rested_at = state_.position;
    state_.rested.resize(kGroups);
    state_.particle_count = kParticles;
    state_.contacts = ContactLists(kParticles, true);
    touch(15, 16);
    touch(31, 32);
  }

  void touch(std::size_t i, std::size_t j) {
    ASSERT_TRUE(state_.contacts.add(i, static_cast<std::int32_t>(j)));
    ASSERT_TRUE(state_.contacts.add(j, static_cast<std::int32_t>(i)));
  }

  /// Steps while the `moving` groups move further than they may, and the `trembling` ones where they are, and puts
  /// groups to sleep. Returns those that were disturbed.
  std::vector<std::uint32_t> step(int steps, const std::vector<std::size_t>& moving = {},
                                  const std::vector<std::size_t>& trembling = {}) {
    std::vector<std::uint32_t> disturbed;
    for (int k = 0; k < steps; ++k) {
      ++state_.step;
      std::fill_n(wakefulness_.moving(), kGroups, std::uint8_t{0});
      for (const std::size_t group : moving) {
        wakefulness_.moving()[group] = 1;
        state_.position[group * kGroup].x += 2 * kRule.distance_m;
      }
      for (const std::size_t group : trembling) {
        wakefulness_.moving()[group] = 1;
      }
      const Wakefulness::Transitions found =
          wakefulness_.updateRest(0, wakefulness_.awake().size(), state_.position, state_);
      disturbed.insert(disturbed.end(), found.disturbed, found.disturbed + found.disturbed_count);
      ready_.assign(found.ready_to_sleep, found.ready_to_sleep + found.ready_to_sleep_count);
      wakefulness_.wakeBeside({found.disturbed, found.disturbed_count}, state_);
      wakefulness_.putToSleep({found.ready_to_sleep, found.ready_to_sleep_count}, keep_awake_,
                              {state_, next_position_, next_velocity_});
      wakefulness_.listAwake();
    }
    return disturbed;
  }
  void sleepAll() {
    step(kRule.steps + 3 * static_cast<int>(kTurn));
    ASSERT_THAT(wakefulness_.awake(), IsEmpty());
  }

  BedState state_;
  Wakefulness wakefulness_;
  std::vector<std::uint64_t> keep_awake_{0};
  std::vector<Float4> next_position_{paddedCount(kParticles)}, next_velocity_{paddedCount(kParticles)};
  std::vector<std::uint32_t> ready_;
};

TEST_F(ThreeGroups, SleepAfterATurnMoreThanRestTakesAndNotBefore) {
  step(kRule.steps + static_cast<int>(kTurn));
  EXPECT_THAT(wakefulness_.awake(), ElementsAre(0, 1, 2, 3));
  step(static_cast<int>(kTurn));
  EXPECT_THAT(wakefulness_.awake(), IsEmpty());
  EXPECT_EQ(wakefulness_.awake().data()[0], kGroups) << "the number behind the last";
  for (std::size_t group = 0; group < 3; ++group) {
    EXPECT_TRUE(state_.asleep(group));
  }
}

TEST_F(ThreeGroups, AMovingGroupKeepsOnlyItsNeighbourAwake) {
  step(kRule.steps + 3 * static_cast<int>(kTurn), {0});
  EXPECT_THAT(wakefulness_.awake(), ElementsAre(0, 1));
  EXPECT_EQ(state_.rested[0], 0);
}

TEST_F(ThreeGroups, OnlyWhatRestedIsDisturbed) {
  step(kRule.steps - 1);
  EXPECT_THAT(step(1, {1}), IsEmpty()) << "had not rested long enough";
  step(kRule.steps);
  EXPECT_THAT(step(1, {1}), ElementsAre(1));
  EXPECT_EQ(state_.rested[1], 0);
  EXPECT_THAT(step(1, {1}), IsEmpty()) << "is disturbed already";
}

// A sound wave moves soil fast, but not from its place.
TEST_F(ThreeGroups, ATremblingGroupAtRestDisturbsNobodyAndStaysAwake) {
  step(kRule.steps + static_cast<int>(kTurn));
  EXPECT_THAT(step(3 * static_cast<int>(kTurn), {}, {0}), IsEmpty());
  EXPECT_THAT(wakefulness_.awake(), ElementsAre(0)) << "its neighbour sleeps";
  EXPECT_EQ(state_.rested[0], kRule.steps);
  step(2 * static_cast<int>(kTurn));
  EXPECT_THAT(wakefulness_.awake(), IsEmpty());
}

TEST_F(ThreeGroups, AGroupThatTremblesBeforeItHasRestedIsNotAtRest) {
  step(kRule.steps + 3 * static_cast<int>(kTurn), {}, {0});
  EXPECT_EQ(state_.rested[0], 0);
  EXPECT_THAT(wakefulness_.awake(), ElementsAre(0, 1));
}

TEST_F(ThreeGroups, ADisturbedOneWakesWhatItTouches) {
  step(kRule.steps + 3 * static_cast<int>(kTurn), {0});
  ASSERT_THAT(wakefulness_.awake(), ElementsAre(0, 1));
  step(1, {0, 1});
  EXPECT_THAT(wakefulness_.awake(), ElementsAre(0, 1, 2));
  EXPECT_EQ(state_.rested[2], kRule.steps) << "at rest, with a turn's time to begin to move";
}

TEST_F(ThreeGroups, CreepingFurtherThanItMayIsMoving) {
  step(kRule.steps + static_cast<int>(kTurn));
  state_.position[20].x = 0.9e-4F;
  EXPECT_THAT(step(static_cast<int>(kTurn) - 1), IsEmpty());
  wakefulness_.wakeAll(state_);
  wakefulness_.listAwake();
  state_.position[20].x = 0.8e-4F;
  state_.position[20].y = 0.8e-4F;
  EXPECT_THAT(step(static_cast<int>(kTurn)), ElementsAre(1));
  EXPECT_EQ(state_.rested_at[20].x, state_.position[20].x) << "is measured from here now";
  EXPECT_EQ(state_.rested_at[20].y, state_.position[20].y);
}

TEST_F(ThreeGroups, SleepStopsParticlesAndStandsInBothRecords) {
  state_.velocity[5] = {1e-5F, -1e-5F, 0, 0};
  state_.position[5] = {1, 2, 3, 0};
  state_.rested_at = state_.position;
  sleepAll();
  for (const std::vector<Float4>* velocity : {&state_.velocity, &next_velocity_}) {
    EXPECT_EQ((*velocity)[5].x, 0);
    EXPECT_EQ((*velocity)[5].y, 0);
  }
  EXPECT_EQ(next_position_[5].z, 3);
}

TEST_F(ThreeGroups, KeptOrDrivenGroupsDoNotSleep) {
  keep_awake_[0] = 1U << 2;
  state_.velocity[3] = {0, 0, 1e-9F, BedState::kDriven};
  step(kRule.steps + 3 * static_cast<int>(kTurn));
  EXPECT_THAT(wakefulness_.awake(), ElementsAre(0, 2));
  state_.velocity[3].z = 0;  // driven to stand still
  step(static_cast<int>(kTurn));
  EXPECT_THAT(wakefulness_.awake(), ElementsAre(2));
}

TEST_F(ThreeGroups, TheSideThatWakesTakesOverWhatTheOtherRemembers) {
  step(kRule.steps + 3 * static_cast<int>(kTurn), {0});
  ASSERT_THAT(wakefulness_.awake(), ElementsAre(0, 1));
  state_.contacts.setSlip(31, 0, {9, 9, 9});  // the second contact of group 1
  const std::uint32_t back = state_.contacts.find(31, 32);
  state_.contacts.setSlip(31, back, {1, -2, 3});
  wakefulness_.wakeAround(31, state_);
  const Slip slip = state_.contacts.slip(32, state_.contacts.find(32, 31));
  EXPECT_EQ(slip.x, -1);
  EXPECT_EQ(slip.y, 2);
  EXPECT_EQ(slip.z, -3);
}

TEST_F(ThreeGroups, TheLastThatFallsAsleepLeavesWhatItRemembersToTheOther) {
  keep_awake_[0] = 1U << 1;
  step(kRule.steps + 3 * static_cast<int>(kTurn));
  ASSERT_THAT(wakefulness_.awake(), ElementsAre(1));
  state_.contacts.setSlip(31, state_.contacts.find(31, 32), {1, -2, 3});
  keep_awake_[0] = 0;
  step(static_cast<int>(kTurn));
  ASSERT_THAT(wakefulness_.awake(), IsEmpty());
  EXPECT_EQ(state_.contacts.slip(32, 0).y, 2);
}

TEST_F(ThreeGroups, HeldSoilIsWokenByNothing) {
  sleepAll();
  state_.rested[1] = BedState::kAsleepForEver;
  wakefulness_.wakeAll(state_);
  wakefulness_.listAwake();
  EXPECT_THAT(wakefulness_.awake(), ElementsAre(0, 2, 3));
}

TEST_F(ThreeGroups, AreWorkedOnInTheOrderThatIsGiven) {
  wakefulness_.setOrder({2, 0, 3, 1});
  wakefulness_.takeOver(state_);
  wakefulness_.listAwake();
  EXPECT_THAT(wakefulness_.awake(), ElementsAre(2, 0, 3, 1));
  sleepAll();
  wakefulness_.wake(1, state_);
  wakefulness_.wake(2, state_);
  wakefulness_.listAwake();
  EXPECT_THAT(wakefulness_.awake(), ElementsAre(2, 1));
}

TEST_F(ThreeGroups, AGroupOfGhostsAloneKeepsItsPlace) {  // the bed orders its particles' groups only
  wakefulness_.setOrder({2, 0, 1});
  wakefulness_.takeOver(state_);
  wakefulness_.listAwake();
  EXPECT_THAT(wakefulness_.awake(), ElementsAre(2, 0, 1, 3));
}

TEST_F(ThreeGroups, PartsTogetherFindTheSameInOrder) {
  step(kRule.steps);
  wakefulness_.setOrder({3, 2, 1, 0});
  wakefulness_.takeOver(state_);
  wakefulness_.listAwake();
  std::fill_n(wakefulness_.moving(), kGroups, std::uint8_t{1});
  std::ranges::for_each(state_.position, [](Float4& position) { position.x += 2 * kRule.distance_m; });
  const std::vector<Wakefulness::Transitions> parts{wakefulness_.updateRest(0, 1, state_.position, state_),
                                                    wakefulness_.updateRest(1, 2, state_.position, state_),
                                                    wakefulness_.updateRest(2, 4, state_.position, state_)};
  const Wakefulness::Transitions all = wakefulness_.mergeTransitions(parts);
  EXPECT_THAT(std::vector<std::uint32_t>(all.disturbed, all.disturbed + all.disturbed_count), ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(all.ready_to_sleep_count, 0U);
}

TEST_F(ThreeGroups, NoGroupSleepsBesideUnrestInARestoredState) {
  sleepAll();
  state_.rested[0] = 5;  // as of another bed
  wakefulness_.takeOver(state_);
  wakefulness_.listAwake();
  EXPECT_THAT(wakefulness_.awake(), ElementsAre(0, 1));
  EXPECT_TRUE(state_.asleep(2));
}

TEST_F(ThreeGroups, NothingSleepsWhereTheRuleForbidsIt) {
  wakefulness_.setRule({.sleep = false});
  step(1000);
  EXPECT_EQ(wakefulness_.awake().size(), kGroups);
}

// A bed that is pushed here and there, its soil moved and woken, in random order.
TEST(BedCheck, AStirredBedKeepsWhatTheStepReliesOn) {
  for (const bool contact : {true, false}) {
    BedParameters parameters;
    if (contact) {
      parameters.soil.friction = FrictionModel::kContact;
      parameters.soil.stiffness_n_m = 1000;
    }
    parameters.sleep_speed_m_s = 0.01;
    Bed bed(parameters);
    std::mt19937 random(7);
    const auto any = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
    std::size_t least_awake = bed.particles();
    for (int round = 0; round < 30; ++round) {
      std::ranges::fill(bed.externalForces(), Float4{});
      if (round % 3 != 2) {
        const std::size_t pushed = any(bed.particles());
        bed.wake(pushed);
        bed.externalForces()[pushed] = {0.3F, -0.2F, 0.5F, 0};
      }
      for (int k = 0; k < (round % 3 == 2 ? 1200 : 100); ++k) {
        ASSERT_EQ(bed.step(2.5e-4), StepStatus::kOk);
      }
      ASSERT_EQ(inconsistency(bed.state()), "") << "round " << round << (contact ? ", contact" : ", icra2021");
      least_awake = std::min(least_awake, bed.awake());
    }
    EXPECT_LT(least_awake, bed.particles()) << "some of it slept";
  }
}

TEST(BedCheck, SaysWhatIsWrong) {
  BedParameters parameters;
  parameters.soil.friction = FrictionModel::kContact;
  parameters.soil.stiffness_n_m = 1000;
  Bed bed(parameters);
  for (int k = 0; k < 400; ++k) {
    ASSERT_EQ(bed.step(2.5e-4), StepStatus::kOk);
  }
  ASSERT_EQ(inconsistency(bed.state()), "");
  std::size_t i = 0;
  while (bed.state().contacts.count(i) == 0) {
    ++i;
  }
  const auto wrong = [&bed](auto change) {
    BedState state = bed.state();
    change(state);
    return inconsistency(state);
  };
  using testing::HasSubstr;
  EXPECT_THAT(wrong([i](BedState& s) { s.contacts.remove(i, 0); }), HasSubstr("which does not list it"));
  EXPECT_THAT(wrong([i](BedState& s) { s.contacts.setSlip(i, 0, {1, 0, 0}); }), HasSubstr("different slips"));
  EXPECT_THAT(wrong([i](BedState& s) { s.contacts.set(i, 0, static_cast<std::int32_t>(i)); }), HasSubstr("lists"));
  EXPECT_THAT(wrong([](BedState& s) { s.velocity[3].y = std::nanf(""); }), HasSubstr("particle 3 is not finite"));
  EXPECT_THAT(wrong([](BedState& s) {
                s.velocity[3] = {1, 0, 0, 0}, s.rested[0] = BedState::kAsleep;
              }),
              HasSubstr("which sleeps"));
}

}  // namespace
}  // namespace haptolith
