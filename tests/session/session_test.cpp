#include "haptolith/session/session.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <thread>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

using namespace std::chrono_literals;

/// A session that runs as fast as it can, under a hand that keeps still above the soil.
class SessionTest : public testing::Test {
 protected:
  static Scenario quiet() {
    Scenario scenario;
    scenario.hand.manoeuvre = Manoeuvre::kStill;
    scenario.loop.paced = false;
    return scenario;
  }

  void start(const Scenario& scenario = quiet()) {
    session_ = std::make_unique<Session>(scenario, false);
    session_->start(stop_);
  }
  void TearDown() override {
    stop_ = true;
    if (session_) {
      session_->join();
    }
  }

  /// Waits until something is so; it takes milliseconds unless something is wrong.
  testing::AssertionResult soon(const std::function<bool()>& is_so) {
    for (int i = 0; i < 10'000; ++i) {
      session_->poll();
      session_->update();
      if (is_so()) {
        return testing::AssertionSuccess();
      }
      std::this_thread::sleep_for(1ms);
    }
    return testing::AssertionFailure() << "not within ten seconds";
  }
  void pauseAndWait() {
    session_->pause();
    ASSERT_TRUE(soon([&] { return session_->snapshot().paused; }));
  }

  std::atomic<bool> stop_{false};
  std::unique_ptr<Session> session_;
};

TEST_F(SessionTest, AnotherWorldIsFeltByTheBedThatIsThere) {
  start();
  session_->change({.body = "Earth"});
  EXPECT_EQ(session_->scenario().body, "Earth");
  ASSERT_TRUE(soon([&] { return session_->snapshot().ticks > 100; }));
  EXPECT_EQ(session_->scenes(), 1U);
  stop_ = true;
  session_->join();
  EXPECT_EQ(session_->scene().bed().parameters().gravity_m_s2, Vec3(0, 0, -9.807));
}

TEST_F(SessionTest, AnotherSoilIsAnotherBedAndCanBeUndoneAndDoneAgain) {
  start();
  const std::size_t before = session_->scene().bed().particles();
  session_->change({.preset = "P6"});
  EXPECT_EQ(session_->scenario().preset, "P6");
  ASSERT_TRUE(soon([&] { return session_->scenes() == 2; }));
  EXPECT_EQ(session_->undoable(), "soil");
  EXPECT_EQ(session_->scene().bed().parameters().soil.mu_hat, session_->scenario().bed.soil.mu_hat);

  session_->undo();
  ASSERT_TRUE(soon([&] { return session_->scenes() == 3; }));
  EXPECT_EQ(session_->scenario().preset, "P3");
  EXPECT_EQ(session_->scene().bed().particles(), before);
  session_->undo();
  ASSERT_TRUE(soon([&] { return session_->scenes() == 4; }));
  EXPECT_EQ(session_->scenario().preset, "P6");
}

TEST_F(SessionTest, ASliderChangesTheSoilThatLiesThere) {
  start();
  session_->change({.sliders = {{"friction_angle_deg", 20}}});
  ASSERT_TRUE(soon([&] { return session_->snapshot().ticks > 100; }));
  EXPECT_EQ(session_->scenes(), 1U);
  EXPECT_TRUE(session_->undoable().empty());
  const double wanted = session_->scenario().bed.soil.mu_hat;
  stop_ = true;
  session_->join();
  EXPECT_EQ(session_->scene().bed().parameters().soil.mu_hat, wanted);
}

TEST_F(SessionTest, ASliderThatTheListsAreNotGoodForTakesTheSoilAsItLies) {
  Scenario cohesionless = quiet();
  cohesionless.bed.soil.friction = FrictionModel::kPairwise;
  start(cohesionless);
  session_->change({.sliders = {{"contact_cohesion_mn", 2}}});  // reaches further than the lists
  ASSERT_TRUE(soon([&] { return session_->scenes() == 2; }));
  EXPECT_NEAR(session_->scene().bed().parameters().soil.contact_cohesion_n, 0.002, 1e-12);
}

TEST_F(SessionTest, ResetTakesBackEverythingAndLevelOnlyWhatWasDug) {
  Scenario stirred = quiet();
  stirred.hand.manoeuvre = Manoeuvre::kStir;
  start(stirred);
  session_->change({.body = "Mars"});
  ASSERT_TRUE(soon([&] { return session_->snapshot().ticks > 3000; }));
  session_->level();
  ASSERT_TRUE(soon([&] { return session_->scenes() == 2; }));
  EXPECT_EQ(session_->scenario().body, "Mars");
  EXPECT_EQ(session_->undoable(), "level");
  session_->reset();
  ASSERT_TRUE(soon([&] { return session_->scenes() == 3; }));
  EXPECT_EQ(session_->scenario().body, "Moon");
  EXPECT_EQ(session_->undoable(), "reset");
}

TEST_F(SessionTest, ARefusedChangeChangesNothing) {
  start();
  EXPECT_THROW(session_->change({.preset = "P9"}), InvalidParameter);
  EXPECT_THROW(session_->change({.body = "Mars", .sliders = {{"nonsense", 1}}}), InvalidParameter);
  EXPECT_THROW(session_->undo(), InvalidParameter);
  EXPECT_THROW(session_->setSpeed(0), InvalidParameter);
  EXPECT_THROW(session_->hold(Pose{Vec3(0, 0, 5)}), InvalidParameter);
  EXPECT_THROW(session_->hold(Pose{Vec3(0, 0, 0.1), Quat(0, 0, 0, 0)}), InvalidParameter);
  EXPECT_EQ(session_->scenario().preset, "P3");
  EXPECT_EQ(session_->scenario().body, "Moon");
}

TEST_F(SessionTest, WhoeverHoldsTheToolDigsAndItStaysWhereItIsLeft) {
  start();
  session_->hold(Pose{Vec3(0.01, 0, 0.02)});
  ASSERT_TRUE(soon([&] { return session_->snapshot().felt.force_n.norm() > 0.1; }));
  session_->release();
  const auto ticks = session_->snapshot().ticks;
  ASSERT_TRUE(soon([&] { return session_->snapshot().ticks > ticks + 2000; }));
  const double left_at = session_->snapshot().scene_T_tool.position_m.z();
  EXPECT_LT(left_at, 0.05);
  session_->play(Manoeuvre::kStill);
  ASSERT_TRUE(soon([&] { return session_->snapshot().scene_T_tool.position_m.z() > 0.1; }));
}

TEST_F(SessionTest, APausedSessionGoesOnTickByTick) {
  start();
  pauseAndWait();
  const auto ticks = session_->snapshot().ticks;
  session_->advance(10);
  ASSERT_TRUE(soon([&] { return session_->snapshot().ticks == ticks + 10; }));
  session_->resume();
  ASSERT_TRUE(soon([&] { return session_->snapshot().ticks > ticks + 1000; }));
}

TEST_F(SessionTest, ManyChangesAtOnceEndWithTheLast) {
  start();
  for (const char* preset : {"P1", "P2", "P4", "P5", "P6", "P1", "P2"}) {
    session_->change({.preset = preset});
    session_->poll();
  }
  session_->change({.body = "Ceres"});
  ASSERT_TRUE(soon([&] { return session_->busy().empty(); }));
  EXPECT_EQ(session_->scenario().preset, "P2");
  stop_ = true;
  session_->join();
  EXPECT_EQ(session_->scene().bed().parameters().soil.mu_hat, session_->scenario().bed.soil.mu_hat);
  EXPECT_EQ(session_->scene().bed().parameters().gravity_m_s2.z(), -0.27);
}

TEST_F(SessionTest, ASessionMayEndWhileABedIsBeingMade) {
  start();
  session_->change({.soil = "dry-sand"});  // rain, which settles for a while
  EXPECT_FALSE(session_->busy().empty());
}

}  // namespace
}  // namespace haptolith
