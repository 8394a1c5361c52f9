#include "haptolith/haptics/loop/deadline_miss.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

namespace haptolith {
namespace {

constexpr double kUsual_us = 500;

/// Cause of the miss of a tick that ran all the time.
Miss causeOf(double late_us, double wall_us, double usual_us = kUsual_us) {
  return causeOfMiss({.late_us = late_us, .wall_us = wall_us, .cpu_us = wall_us}, usual_us, Miss::kNone);
}

TEST(DeadlineMiss, WorkOverItsShareIsTooLong) {
  EXPECT_EQ(causeOf(0, 1001), Miss::kTooLong);
  EXPECT_EQ(causeOf(60, 950), Miss::kTooLong) << "waking up took what it may";
  EXPECT_EQ(causeOf(300, 1200), Miss::kTooLong) << "100 us over one share, 400 over the other";
  EXPECT_EQ(causeOf(0, 5000, 4000), Miss::kTooLong) << "as always";
}

TEST(DeadlineMiss, AThreadThatWakesLateIsWokenLate) {
  EXPECT_EQ(causeOf(600, 500), Miss::kWokenLate);
  EXPECT_EQ(causeOf(4000, 500), Miss::kWokenLate);
  EXPECT_EQ(causeOf(4000, 900), Miss::kWokenLate) << "though its work was over its share, too";
}

TEST(DeadlineMiss, TimeInWhichTheThreadDidNotRunIsPreemption) {
  // As measured under SCHED_FIFO on a virtual machine, whose kernel knew: no context switch, and 17 ms gone.
  EXPECT_EQ(causeOfMiss({.wall_us = 17'012, .cpu_us = 277}, 270, Miss::kNone), Miss::kPreempted);
  EXPECT_EQ(causeOfMiss({.wall_us = 1050, .cpu_us = 650}, 650, Miss::kNone), Miss::kPreempted);
  EXPECT_EQ(causeOfMiss({.late_us = 300, .wall_us = 1100, .cpu_us = 500}, 500, Miss::kNone), Miss::kPreempted);
  EXPECT_EQ(causeOfMiss({.late_us = 1500, .wall_us = 1100, .cpu_us = 500}, 500, Miss::kNone), Miss::kWokenLate)
      << "woken 1300 us later than it may be, interrupted for 600";
}

TEST(DeadlineMiss, ManyTimesTheUsualIsPreemptionThoughTheClocksDoNotShowIt) {
  EXPECT_EQ(causeOf(0, 3000), Miss::kPreempted);
  EXPECT_EQ(causeOf(0, 1400), Miss::kTooLong) << "soil may take up to three times the usual";
}

TEST(DeadlineMiss, ADeviceThatAlwaysBlocksIsPartOfTheWork) {
  EXPECT_EQ(causeOfMiss({.wall_us = 1200, .cpu_us = 50}, 1200, Miss::kNone), Miss::kTooLong);
}

TEST(DeadlineMiss, ATickInheritsTheCauseOfTheOneThatKeptItWaiting) {
  const TickTiming kept_waiting{.late_us = 1010, .busy_us = 1000, .wall_us = 300, .cpu_us = 300};
  for (const Miss before : {Miss::kTooLong, Miss::kWokenLate, Miss::kPreempted}) {
    EXPECT_EQ(causeOfMiss(kept_waiting, 300, before), before);
  }
  EXPECT_EQ(causeOfMiss(kept_waiting, 300, Miss::kNone), Miss::kWokenLate) << "a pause or a request was in the way";
}

TEST(DeadlineMiss, SoilThatLeavesNoRoomToCatchUpIsTheCauseItself) {
  EXPECT_EQ(causeOfMiss({.late_us = 500, .busy_us = 500, .wall_us = 850, .cpu_us = 850}, 850, Miss::kPreempted),
            Miss::kTooLong);
  EXPECT_EQ(causeOfMiss({.late_us = 500, .busy_us = 500, .wall_us = 1100, .cpu_us = 1100}, 850, Miss::kPreempted),
            Miss::kTooLong);
}

TEST(DeadlineMiss, EveryMissHasACause) {
  std::mt19937 draw(1);
  std::exponential_distribution<double> some_us(1.0 / 500);
  for (int i = 0; i < 100'000; ++i) {
    TickTiming tick{.late_us = some_us(draw), .wall_us = some_us(draw)};
    tick.busy_us = std::min(some_us(draw), tick.late_us);
    tick.cpu_us = std::min(some_us(draw), tick.wall_us);
    if (tick.late_us + tick.wall_us > tick.period_us) {
      ASSERT_NE(causeOfMiss(tick, some_us(draw), Miss::kNone), Miss::kNone);
    }
  }
}

/// Disturbance of one tick.
struct Fate {
  double woken_us = 5;  ///< so late
  double work_us = 300;
  double taken_us = 0;       ///< in the tick, so long
  bool hidden = false;       ///< from the thread's processor time
  std::size_t awake = 1000;  ///< particles
};

/// The loop's pacing in virtual time: LoopClock without a clock.
class PacedLoop {
 public:
  explicit PacedLoop(double speed = 1) : period_us_(kTick_us / speed) {}

  Miss tick(const Fate& fate) {
    const double free_us = now_us_;
    now_us_ = std::max(now_us_, due_us_) + fate.woken_us;
    TickTiming timing{.period_us = kTick_us,
                      .late_us = now_us_ - due_us_,
                      .busy_us = std::max(0.0, free_us - due_us_),
                      .wall_us = fate.work_us + fate.taken_us};
    timing.cpu_us = fate.hidden ? timing.wall_us : fate.work_us;
    now_us_ += timing.wall_us;
    const Miss cause = classifier_.classify(timing, now_us_ > due_us_ + kTick_us, static_cast<double>(fate.awake));
    ++counted_[static_cast<std::size_t>(cause)];
    due_us_ = std::max(due_us_ + period_us_, now_us_ - kTick_us);
    return cause;
  }
  void ticks(int count, const Fate& fate = {}) {
    for (int i = 0; i < count; ++i) {
      tick(fate);
    }
  }
  /// Pauses time while the loop cycles `turns` times without a tick; the last cycle has the given duration.
  void pause(int turns, double last_us) {
    now_us_ = std::max(now_us_, due_us_ + turns * kTick_us) + last_us;
    due_us_ = std::max(due_us_ + (turns + 1) * kTick_us, now_us_ - kTick_us);
  }
  [[nodiscard]] std::array<int, 3> misses() const { return {counted_[1], counted_[2], counted_[3]}; }

 private:
  static constexpr double kTick_us = 1000;

  double period_us_, now_us_ = 0, due_us_ = 0;
  MissClassifier classifier_;
  std::array<int, kMissCauses> counted_{};
};

using Misses = std::array<int, 3>;  // too long, woken late, preempted

TEST(MissClassifier, CountsNothingWhileAllIsInTime) {
  PacedLoop loop;
  loop.ticks(1000);
  EXPECT_EQ(loop.misses(), (Misses{0, 0, 0}));
}

TEST(MissClassifier, SoilTooFineIsTooLongHoweverLongItLasts) {
  PacedLoop loop;
  loop.ticks(1000, {.work_us = 500});
  loop.ticks(1000, {.work_us = 1100});
  EXPECT_EQ(loop.misses(), (Misses{1000, 0, 0}));
}

TEST(MissClassifier, ALateWakeUpAndWhatFollowsAreOneCause) {
  PacedLoop loop;
  loop.ticks(100);
  EXPECT_EQ(loop.tick({.woken_us = 5000}), Miss::kWokenLate);
  loop.ticks(100);
  EXPECT_EQ(loop.misses(), (Misses{0, 2, 0})) << "the tick after it begins when it is over already";
}

TEST(MissClassifier, AnInterruptionAndWhatFollowsAreOneCauseHiddenOrNot) {
  for (const bool hidden : {false, true}) {
    PacedLoop loop;
    loop.ticks(100);
    loop.tick({.taken_us = 20'000, .hidden = hidden});
    loop.ticks(100, {.work_us = 700});
    EXPECT_EQ(loop.misses(), (Misses{0, 0, 4})) << "each tick catches up 0.3 ms";
  }
}

TEST(MissClassifier, AChainEndsWithTheFirstTickInTime) {
  PacedLoop loop;
  loop.ticks(100);
  loop.tick({.taken_us = 3000});
  loop.ticks(100);
  loop.tick({.woken_us = 3000});
  loop.ticks(100);
  loop.tick({.work_us = 1500, .awake = 10'000});
  loop.ticks(100);
  const auto [too_long, woken_late, preempted] = loop.misses();
  EXPECT_EQ(preempted, 2);
  EXPECT_EQ(woken_late, 2);
  EXPECT_GE(too_long, 1);
}

TEST(MissClassifier, SoilThatWakesUpIsNotAnInterruption) {
  PacedLoop loop;
  loop.ticks(1000, {.work_us = 20, .awake = 0});
  loop.ticks(20, {.work_us = 1100, .awake = 2000});
  EXPECT_EQ(loop.misses(), (Misses{20, 0, 0})) << "55 times as long, and 2000 particles instead of none";
}

TEST(MissClassifier, InterruptionsOfSoilAtRestAreSeen) {
  PacedLoop loop;
  loop.ticks(1000, {.work_us = 20, .awake = 0});
  EXPECT_EQ(loop.tick({.work_us = 20, .taken_us = 4000, .hidden = true, .awake = 0}), Miss::kPreempted);
}

TEST(MissClassifier, FollowsAMachineThatBecomesSlower) {
  PacedLoop loop;
  loop.ticks(500, {.work_us = 250});
  loop.ticks(500, {.work_us = 1050});
  const auto [too_long, woken_late, preempted] = loop.misses();
  EXPECT_LT(preempted, 20) << "more than three times the usual, until that is what is usual";
  EXPECT_EQ(too_long + preempted, 500);
  EXPECT_EQ(woken_late, 0);
}

TEST(MissClassifier, ManyInterruptionsDoNotBecomeUsual) {
  PacedLoop loop;
  loop.ticks(100);
  for (int i = 0; i < 1000; ++i) {
    loop.tick({.taken_us = i % 5 == 0 ? 1500.0 : 0.0, .hidden = true});
  }
  const auto [too_long, woken_late, preempted] = loop.misses();
  EXPECT_EQ(too_long, 0);
  EXPECT_GE(preempted, 200);
}

TEST(MissClassifier, APauseIsNoMissAndLeavesNone) {
  PacedLoop loop;
  loop.ticks(100);
  loop.pause(500, 100);
  loop.ticks(100);
  EXPECT_EQ(loop.misses(), (Misses{0, 0, 0}));
  loop.pause(500, 3000);  // interrupted while nothing was computed
  loop.ticks(100);
  EXPECT_EQ(loop.misses(), (Misses{0, 1, 0}));
}

TEST(MissClassifier, SlowMotionLeavesRoomBetweenTicks) {
  PacedLoop loop(0.5);
  loop.ticks(100, {.work_us = 500});
  EXPECT_EQ(loop.tick({.taken_us = 1000}), Miss::kPreempted);
  EXPECT_EQ(loop.tick({}), Miss::kNone) << "the next one was due later than this one ended";
  loop.ticks(100, {.work_us = 1200});
  EXPECT_EQ(loop.misses(), (Misses{100, 0, 1}));
}

TEST(MissClassifier, TheFirstTickHasNothingToBeComparedWith) {
  PacedLoop loop;
  EXPECT_EQ(loop.tick({.work_us = 5000}), Miss::kTooLong);
}

}  // namespace
}  // namespace haptolith
