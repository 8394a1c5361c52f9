#include "haptolith/machine/finest_grain.h"

#include <gmock/gmock.h>
#include <sys/mman.h>

#include <cmath>
#include <limits>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

/// On a machine on which grains of `just_mm` take all that a tick may, and R^-4 of it others.
FinestGrain chosenWhere(double just_mm, int* trials = nullptr) {
  return finestOf(kGrainRadii_m, [&](double radius_m) {
    if (trials != nullptr) {
      ++*trials;
    }
    return GrainTrial{.radius_m = radius_m, .tick_us_p99 = kFinestTick_us * std::pow(just_mm / (1e3 * radius_m), 4)};
  });
}

TEST(FinestGrain, IsTheFinestThatStaysWithinItsTime) {
  for (std::size_t i = 0; i < kGrainRadii_m.size(); ++i) {
    int trials = 0;
    const FinestGrain found = chosenWhere(0.999e3 * kGrainRadii_m[i], &trials);
    EXPECT_EQ(found.chosen.radius_m, kGrainRadii_m[i]);
    EXPECT_TRUE(found.holds());
    EXPECT_EQ(found.too_slow.has_value(), i + 1 < kGrainRadii_m.size());
    if (found.too_slow) {
      EXPECT_EQ(found.too_slow->radius_m, kGrainRadii_m[i + 1]);
    }
    EXPECT_LE(trials, 5) << "each takes up to a third of a second";
  }
}

TEST(FinestGrain, StepsOfTheLadderAreTenPercentAtMost) {
  for (std::size_t i = 1; i < kGrainRadii_m.size(); ++i) {
    EXPECT_LT(kGrainRadii_m[i], kGrainRadii_m[i - 1]);
    EXPECT_GE(kGrainRadii_m[i], 0.9 * kGrainRadii_m[i - 1]);
    EXPECT_EQ(coarserRadius(kGrainRadii_m[i]), kGrainRadii_m[i - 1]);
  }
  EXPECT_EQ(coarserRadius(kGrainRadii_m.front()), std::nullopt);
  EXPECT_EQ(coarserRadius(4.5e-3), 4.8e-3);
}

TEST(FinestGrain, IsTheCoarsestWhereNoneStaysWithinItsTime) {
  const FinestGrain found = chosenWhere(20);
  EXPECT_EQ(found.chosen.radius_m, kGrainRadii_m.front());
  EXPECT_FALSE(found.holds());
}

constexpr int kOneThread[]{1};

class FinestGrainHere : public testing::Test {
 protected:
  FinestGrainHere() {
    bed_.soil = findPreset("P3").soil;
    bed_.soil.friction = FrictionModel::kContact;
    bed_.start = BedStart::kSettled;
  }
  ~FinestGrainHere() override { munlockall(); }

  BedParameters bed_;
  std::atomic<bool> stop_{false};
};

TEST_F(FinestGrainHere, IsMeasuredInTheBoxOfTheBed) {
  const FinestGrain found = finestGrain(bed_, {}, {.real_time = false}, kOneThread, stop_);
  EXPECT_GT(found.chosen.tick_us_p99, 0);
  EXPECT_THAT(kGrainRadii_m, testing::Contains(found.chosen.radius_m));
  // With R = 7 mm it would be 256, as in icra2021.
  EXPECT_NEAR(static_cast<double>(found.chosen.grains) * std::pow(found.chosen.radius_m / 7e-3, 3), 256, 80);
}

TEST_F(FinestGrainHere, IsCoarserInALargerBox) {
  const double small_m = finestGrain(bed_, {}, {.real_time = false}, kOneThread, stop_).chosen.radius_m;
  bed_.width_m = bed_.length_m = 1;
  bed_.depth_m = 0.1;  // 47 000 of 7 mm, and no machine steps those of 1.75 mm
  const FinestGrain large = finestGrain(bed_, {}, {.real_time = false}, kOneThread, stop_);
  EXPECT_GE(large.chosen.radius_m, small_m);
  ASSERT_TRUE(large.too_slow);
}

TEST_F(FinestGrainHere, IsOnOneOfTheNumbersOfThreads) {
  constexpr int kThreads[]{1, 2};
  const FinestGrain found = finestGrain(bed_, {}, {.real_time = false}, kThreads, stop_);
  EXPECT_THAT(kThreads, testing::Contains(found.chosen.threads));
}

TEST_F(FinestGrainHere, CanBeStopped) {
  stop_ = true;
  EXPECT_THROW((void)finestGrain(bed_, {}, {}, kOneThread, stop_), Failure);
}

TEST_F(FinestGrainHere, RefusesABedForWhichAllAreTooLarge) {
  bed_.width_m = 1e-3;
  EXPECT_THROW((void)finestGrain(bed_, {}, {}, kOneThread, stop_), Failure);
}

}  // namespace
}  // namespace haptolith
