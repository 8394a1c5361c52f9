// Boxes so wide that single precision does not resolve slow particles.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/bed/bed_state.h"
#include "haptolith/core/error.h"

namespace haptolith {
namespace {

constexpr double kStep_s = 1e-3 / 3;

BedParameters box(double width_m, FrictionModel friction) {
  BedParameters bed;
  bed.soil.friction = friction;
  bed.width_m = width_m;
  bed.gravity_m_s2 = Vec3::Zero();
  bed.sleep = false;
  return bed;
}

double gone(double width_m, FrictionModel friction, double speed_m_s, int steps) {
  const Vec3 start_m(width_m / 2 - 0.1, 0, 0.1);
  Bed bed(box(width_m, friction), {start_m});
  const double from_m = bed.state().position[0].x;
  bed.drive(0, {speed_m_s, 0, 0});
  for (int i = 0; i < steps; ++i) {
    EXPECT_EQ(bed.step(kStep_s), StepStatus::kOk);
  }
  return static_cast<double>(bed.state().position[0].x) - from_m;
}

TEST(WideBed, WhatCreepsTwoMetresFromTheMiddleGetsOn) {
  for (const FrictionModel friction : {FrictionModel::kIcra2021, FrictionModel::kContact}) {
    for (const double speed_m_s : {3e-4, -3e-4, 1e-5, 1e-6}) {  // a position there is known to 2.4e-7 m
      EXPECT_NEAR(gone(4.2, friction, speed_m_s, 3000), speed_m_s, 2.4e-7) << speed_m_s;
    }
    EXPECT_NEAR(gone(1.1, friction, 1e-4, 3000), 1e-4, 3e-8);
  }
}

TEST(WideBed, NarrowBoxesKeepNoRemaindersAndAreSavedAsBefore) {
  const Bed narrow(box(0.99, FrictionModel::kContact), {Vec3(0, 0, 0.1)});
  EXPECT_TRUE(narrow.state().remainder.empty());
  EXPECT_TRUE(serialise(narrow.state()).starts_with("HAPBED06"));
  const Bed wide(box(1.01, FrictionModel::kContact), {Vec3(0, 0, 0.1)});
  EXPECT_FALSE(wide.state().remainder.empty());
  EXPECT_TRUE(serialise(wide.state()).starts_with("HAPBED07"));
}

Bed tumbling(int threads) {
  BedParameters parameters = box(1.6, FrictionModel::kContact);
  parameters.gravity_m_s2 = {2, 1, -1.6};
  parameters.threads = threads;
  std::vector<Vec3> centres_m;
  for (int i = 0; i < 3000; ++i) {
    centres_m.emplace_back(-0.7 + 0.0145 * (i % 95), 0.0145 * (i / 95 % 8) - 0.05, 0.0075 + 0.0145 * (i / 760));
  }
  return Bed(parameters, centres_m);
}

TEST(WideBed, GoesOnFromASavedStateAndWithAnyNumberOfThreadsBitForBit) {
  const auto hash_after = [](Bed& bed, int steps) {
    for (int i = 0; i < steps; ++i) {
      EXPECT_EQ(bed.step(kStep_s), StepStatus::kOk);
    }
    return bed.hash();
  };
  Bed bed = tumbling(1);
  const std::uint64_t halfway = hash_after(bed, 150);
  const std::string saved = serialise(bed.save());
  const std::uint64_t end = hash_after(bed, 150);
  EXPECT_NE(halfway, end);
  for (const int threads : {2, 3}) {
    Bed other = tumbling(threads);
    EXPECT_EQ(hash_after(other, 150), halfway);
    Bed again = tumbling(threads);
    again.restore(deserialiseSavedBed(saved));
    EXPECT_EQ(hash_after(again, 150), end);
  }
}

TEST(WideBed, RefusesStatesOfOtherBoxesAndDamagedOnes) {
  Bed wide = tumbling(1);
  SavedBed saved = wide.save();
  saved.state.remainder[7].y = std::nanf("");
  EXPECT_THROW(wide.restore(saved), InvalidParameter);
  saved = wide.save();
  saved.state.remainder.clear();
  EXPECT_THROW(wide.restore(saved), InvalidParameter);
  const std::string bytes = serialise(wide.state());
  EXPECT_THROW((void)deserialiseBedState(std::string_view(bytes).substr(0, bytes.size() - 16)), Failure);
  std::string as_narrow = bytes;
  as_narrow[7] = '4';
  EXPECT_THROW((void)deserialiseBedState(as_narrow), Failure);
}

}  // namespace
}  // namespace haptolith
