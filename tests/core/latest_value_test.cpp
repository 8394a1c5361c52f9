#include "haptolith/core/process/latest_value.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

namespace haptolith {
namespace {

TEST(LatestValue, IsTheInitialOneUntilSomethingIsPublished) {
  LatestValue<int> value(7);
  EXPECT_FALSE(value.update());
  EXPECT_EQ(value.latest(), 7);
}

TEST(LatestValue, MovesToTheNewestAndPassesOverTheRest) {
  LatestValue<int> value(0);
  for (int i = 1; i <= 5; ++i) {
    value.draft() = i;
    value.publish();
  }
  EXPECT_EQ(value.latest(), 0);  // not before the reader asks
  EXPECT_TRUE(value.update());
  EXPECT_EQ(value.latest(), 5);
  EXPECT_FALSE(value.update());
  EXPECT_EQ(value.latest(), 5);
}

TEST(LatestValue, ADraftIsNoValueYet) {
  LatestValue<int> value(1);
  value.draft() = 2;
  EXPECT_FALSE(value.update());
  EXPECT_EQ(value.latest(), 1);
}

TEST(LatestValue, NeverShowsHalfAValueToAnotherThread) {
  using Large = std::array<std::uint64_t, 64>;
  LatestValue<Large> value(Large{});
  constexpr std::uint64_t kLast = 200'000;
  std::atomic<bool> go{false};
  std::thread writer([&] {
    while (!go) {
    }
    for (std::uint64_t i = 1; i <= kLast; ++i) {
      value.draft().fill(i);
      value.publish();
    }
  });
  go = true;
  std::uint64_t before = 0, torn = 0, backward = 0, seen = 0;
  while (before < kLast) {
    if (!value.update()) {
      std::this_thread::yield();
      continue;
    }
    ++seen;
    const Large& now = value.latest();
    for (const std::uint64_t number : now) {
      torn += number != now.front() ? 1 : 0;
    }
    backward += now.front() <= before ? 1 : 0;
    before = now.front();
  }
  writer.join();
  EXPECT_EQ(torn, 0U);
  EXPECT_EQ(backward, 0U);
  EXPECT_GE(seen, 1U);
  EXPECT_EQ(value.latest().front(), kLast);  // the last one always arrives
}

TEST(LatestValue, BuffersKeepTheirSizeForever) {
  LatestValue<std::vector<int>> value(std::vector<int>(100));
  for (int i = 0; i < 10; ++i) {
    ASSERT_EQ(value.draft().size(), 100U);
    value.draft()[0] = i;
    value.publish();
    if (i % 3 == 0) {
      value.update();
    }
    ASSERT_EQ(value.latest().size(), 100U);
  }
}

}  // namespace
}  // namespace haptolith
