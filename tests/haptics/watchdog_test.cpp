#include "haptolith/haptics/safety/watchdog.h"

#include <gmock/gmock.h>
#include <pthread.h>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>

#include "haptolith/core/error.h"
#include "haptolith/core/platform/clock.h"

namespace haptolith {
namespace {

using namespace std::chrono_literals;

constexpr double kPatience_s = 0.05;  // longer than a busy machine takes to come round

class Hand final : public HapticDevice {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "hand"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return {}; }
  [[nodiscard]] DeviceInput read() noexcept override { return {}; }
  void write(const DeviceOutput&) noexcept override {}
  void releaseForce() noexcept override {
    let_go_ns = monotonicNs();
    ++let_goes;
  }
  void resumeForce() noexcept override { ++take_ups; }

  std::atomic<std::int64_t> let_go_ns{0};
  std::atomic<int> let_goes{0}, take_ups{0};
};

void waitFor(const Watchdog& watchdog) {
  for (int i = 0; i < 2000 && !watchdog.fired(); ++i) {
    std::this_thread::sleep_for(5ms);
  }
}

TEST(Watchdog, LetsGoOfTheHandWhenTheLoopFallsSilent) {
  Hand hand;
  Watchdog watchdog(hand, kPatience_s);
  watchdog.start();
  (void)watchdog.beat();
  const std::int64_t last_beat_ns = monotonicNs();
  waitFor(watchdog);
  ASSERT_TRUE(watchdog.fired());
  EXPECT_EQ(hand.let_goes, 1);
  EXPECT_GE(hand.let_go_ns - last_beat_ns, 49'000'000) << "not before";
  EXPECT_LT(hand.let_go_ns - last_beat_ns, 5'000'000'000);
}

TEST(Watchdog, IsQuietWhileTheLoopLives) {
  Hand hand;
  Watchdog watchdog(hand, 1);
  watchdog.start();
  for (int i = 0; i < 30; ++i) {
    (void)watchdog.beat();
    std::this_thread::sleep_for(5ms);
  }
  EXPECT_FALSE(watchdog.fired());
  watchdog.stop();
  EXPECT_EQ(hand.let_goes, 0);
}

TEST(Watchdog, LetsGoOnceForASilenceAndAgainForTheNext) {
  Hand hand;
  Watchdog watchdog(hand, kPatience_s);
  watchdog.start();
  for (int silence = 1; silence <= 2; ++silence) {
    waitFor(watchdog);
    std::this_thread::sleep_for(3 * std::chrono::milliseconds(50));
    EXPECT_EQ(hand.let_goes, silence);
    (void)watchdog.beat();
    watchdog.resumeForce();
    EXPECT_EQ(hand.take_ups, silence);
    EXPECT_FALSE(watchdog.fired());
  }
}

TEST(Watchdog, OnceItHasBarkedTheHandHasBeenLetGo) {  // otherwise it could be resumed before it is released
  for (int i = 0; i < 20; ++i) {
    Hand hand;
    Watchdog watchdog(hand, 0.002);
    watchdog.start();
    while (!watchdog.fired()) {
    }
    ASSERT_EQ(hand.let_goes, 1);
  }
}

TEST(Watchdog, TheLoopHearsOfItsSilenceAndOfNoneWhenNobodyWatches) {
  Hand hand;
  Watchdog watchdog(hand, 0.002);
  std::this_thread::sleep_for(10ms);
  EXPECT_FALSE(watchdog.beat());
  watchdog.start();
  std::this_thread::sleep_for(10ms);
  EXPECT_TRUE(watchdog.tooLate());
  EXPECT_TRUE(watchdog.beat());
}

TEST(Watchdog, WithoutAThreadForItThereIsAFailureBeforeTheFirstTick) {
  pthread_attr_t usual;
  ASSERT_EQ(pthread_getattr_default_np(&usual), 0);
  pthread_attr_t impossible;
  ASSERT_EQ(pthread_getattr_default_np(&impossible), 0);
  ASSERT_EQ(pthread_attr_setstacksize(&impossible, std::size_t{1} << 47U), 0);
  ASSERT_EQ(pthread_setattr_default_np(&impossible), 0);
  Hand hand;
  std::string words;
  try {
    const Watchdog watchdog(hand, kPatience_s);
  } catch (const Failure& failure) {
    words = failure.what();
  }
  ASSERT_EQ(pthread_setattr_default_np(&usual), 0);
  EXPECT_THAT(words, testing::HasSubstr("watchdog"));
}

TEST(Watchdog, WatchesOnlyBetweenStartAndStop) {
  Hand hand;
  Watchdog watchdog(hand, 0.01);
  std::this_thread::sleep_for(50ms);
  watchdog.start();
  watchdog.stop();
  const int before = hand.let_goes;  // a busy machine may have been slow
  std::this_thread::sleep_for(50ms);
  EXPECT_EQ(hand.let_goes, before);
  watchdog.stop();  // a second time does no harm
  watchdog.start();
  watchdog.start();
  waitFor(watchdog);
  EXPECT_TRUE(watchdog.fired());
}

}  // namespace
}  // namespace haptolith
