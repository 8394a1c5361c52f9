#include "haptolith/study/run/session_rig.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

using namespace std::chrono_literals;

/// A rig on a session that runs as fast as it can.
class SessionRigTest : public testing::Test {
 protected:
  void SetUp() override {
    SceneFile scene_file;
    scene_file.hand.motion = HandMotion::kStill;
    scene_file.loop.real_time = false;
    session_ = std::make_unique<Session>(scene_file, true);
    rig_ = std::make_unique<SessionRig>(*session_, SessionRig::Recorder{});
    session_->start(stop_);
  }
  void TearDown() override {
    stop_ = true;
    session_->join();
  }

  testing::AssertionResult soon(const std::function<bool()>& is_so) {
    for (int i = 0; i < 10'000; ++i) {
      session_->poll();
      session_->update();
      std::vector<TickRecord> ticks;
      session_->loop().takeRecords(ticks);
      rig_->follow(ticks);
      if (is_so()) {
        return testing::AssertionSuccess();
      }
      std::this_thread::sleep_for(1ms);
    }
    return testing::AssertionFailure() << "not within ten seconds";
  }
  [[nodiscard]] static StudyBlock block() {
    StudyBlock block;
    block.scene.preset = "P4";
    return block;
  }

  std::atomic<bool> stop_{false};
  std::unique_ptr<Session> session_;
  std::unique_ptr<SessionRig> rig_;
};

TEST_F(SessionRigTest, AStimulusIsThereButNotFeltBeforeItsInterval) {
  rig_->show(block(), {.name = "Mars", .change = {.body = "Mars"}});
  ASSERT_TRUE(soon([&] { return rig_->ready(); }));
  EXPECT_EQ(session_->shown().preset, "P4");
  EXPECT_EQ(session_->shown().body, "Mars");
  session_->hold(Pose{Vec3(0.01, 0, 0.02)});
  ASSERT_TRUE(soon([&] { return session_->snapshot().scene_T_tool.position_m.z() < 0.025; }))
      << "nothing keeps the tool out of soil that it does not touch";
  EXPECT_LT(rig_->force(), 1e-3);
  rig_->feel();
  ASSERT_TRUE(soon([&] { return rig_->force() > 0.5; }));
  const TrialSummary summary = rig_->rest();
  EXPECT_GT(summary.peak_force_n, 0.5);
  EXPECT_GT(summary.duration_s, 0);
  ASSERT_TRUE(soon([&] { return rig_->force() < 1e-3; }));
}

TEST_F(SessionRigTest, EveryIntervalIsSummedUpByItself) {
  rig_->show(block(), {.name = "Moon"});
  ASSERT_TRUE(soon([&] { return rig_->ready(); }));
  // An interval lasts no longer than the ticks from its beginning to its end, however late a busy machine looks; their
  // number is reported a few ticks late.
  const auto ticks_s = [&](std::uint64_t since) {
    return 0.5 + 1e-3 * static_cast<double>(session_->loopTicks() - since);
  };
  const std::uint64_t first = session_->loopTicks();
  rig_->feel();
  ASSERT_TRUE(soon([&] { return session_->loopTicks() > first + 2000; }));
  const double long_s = rig_->rest().duration_s;
  EXPECT_GT(long_s, 1);
  EXPECT_LE(long_s, ticks_s(first));
  const std::uint64_t second = session_->loopTicks();
  rig_->feel();
  ASSERT_TRUE(soon([&] { return session_->loopTicks() > second + 100; }));
  const double short_s = rig_->rest().duration_s;
  EXPECT_LE(short_s, ticks_s(second));
  EXPECT_TRUE(rig_->pageMayHold());
  EXPECT_EQ(rig_->deviceName(), "virtual hand");
}

TEST_F(SessionRigTest, AStimulusThatCannotBeIsRefused) {
  EXPECT_THROW(rig_->show(block(), {.name = "Venus", .change = {.body = "Venus"}}), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
