#include "haptolith/session/session.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <thread>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

using namespace std::chrono_literals;

/// A session that runs as fast as it can, under a hand that keeps still above the soil.
class SessionTest : public testing::Test {
 protected:
  static SceneFile quiet() {
    SceneFile scene_file;
    scene_file.hand.motion = HandMotion::kStill;
    scene_file.loop.real_time = false;
    return scene_file;
  }

  void start(const SceneFile& scene_file = quiet()) {
    session_ = std::make_unique<Session>(scene_file, false);
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
  /// The largest distance between a particle here and there, in m.
  static double farthest(const std::vector<Float4>& a, const std::vector<Float4>& b) {
    double farthest = 0;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
      farthest = std::max(farthest, static_cast<double>(std::hypot(a[i].x - b[i].x, a[i].y - b[i].y, a[i].z - b[i].z)));
    }
    return a.size() == b.size() ? farthest : 1;
  }
  void waitTicks(std::uint64_t count) {
    session_->update();
    const std::uint64_t ticks = session_->snapshot().ticks;
    ASSERT_TRUE(soon([&] { return session_->snapshot().ticks > ticks + count; }));
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
  EXPECT_EQ(session_->sceneFile().body, "Earth");
  waitTicks(500);
  EXPECT_EQ(session_->scenes(), 1U);
  stop_ = true;
  session_->join();
  EXPECT_EQ(session_->scene().bed().parameters().gravity_m_s2, Vec3(0, 0, -9.807));
}

TEST_F(SessionTest, AnotherSoilIsAnotherBedAndCanBeUndoneAndDoneAgain) {
  start();
  const std::size_t before = session_->scene().bed().particles();
  session_->change({.preset = "P6"});
  EXPECT_EQ(session_->sceneFile().preset, "P6");
  ASSERT_TRUE(soon([&] { return session_->scenes() == 2; }));
  EXPECT_EQ(session_->undoable(), "soil");
  EXPECT_FALSE(session_->undoRedoes());
  EXPECT_EQ(session_->scene().bed().parameters().soil.mu_hat, session_->sceneFile().bed.soil.mu_hat);

  session_->undo();
  ASSERT_TRUE(soon([&] { return session_->scenes() == 3; }));
  EXPECT_EQ(session_->sceneFile().preset, "P3");
  EXPECT_EQ(session_->scene().bed().particles(), before);
  session_->undo();
  ASSERT_TRUE(soon([&] { return session_->scenes() == 4; }));
  EXPECT_EQ(session_->sceneFile().preset, "P6");
}

TEST_F(SessionTest, ASliderChangesTheSoilThatLiesThere) {
  start();
  session_->change({.sliders = {{"friction_angle_deg", 20}}});
  waitTicks(500);
  EXPECT_EQ(session_->scenes(), 1U);
  EXPECT_TRUE(session_->undoable().empty());
  const double wanted = session_->sceneFile().bed.soil.mu_hat;
  stop_ = true;
  session_->join();
  EXPECT_EQ(session_->scene().bed().parameters().soil.mu_hat, wanted);
}

TEST_F(SessionTest, ASliderThatTheListsAreNotGoodForTakesTheSoilAsItLies) {
  SceneFile cohesionless = quiet();
  cohesionless.bed.soil.friction = FrictionModel::kContact;
  cohesionless.hand.motion = HandMotion::kStir;
  start(cohesionless);
  ASSERT_TRUE(soon([&] { return session_->snapshot().ticks > 3000; }));
  pauseAndWait();
  const std::vector<Float4> dug = session_->snapshot().position;
  session_->change({.sliders = {{"contact_cohesion_mn", 2}}});  // reaches further than the lists
  session_->change({.sliders = {{"contact_friction", 0.7}}});   // while that bed is on its way
  ASSERT_TRUE(soon([&] { return session_->scenes() == 2 && session_->busy().empty(); }));
  EXPECT_LT(farthest(dug, session_->snapshot().position), 1e-6);
  EXPECT_NEAR(session_->shown().bed.soil.contact_cohesion_n, 0.002, 1e-12);
  EXPECT_EQ(session_->shown().bed.soil.contact_friction, 0.7);

  session_->level();
  ASSERT_TRUE(soon([&] { return session_->scenes() == 3; }));
  EXPECT_GT(farthest(dug, session_->snapshot().position), 5e-3) << "level, although made of what was dug";
}

TEST_F(SessionTest, SoilIsAdjustedWhereItLiesUnlessSomebodyWantsAnother) {
  SceneFile cohesive = quiet();
  cohesive.bed.soil.friction = FrictionModel::kContact;
  cohesive.bed.soil.contact_cohesion_n = 0.01;
  start(cohesive);
  EXPECT_TRUE(session_->adjust({.contact_friction = 0.31, .contact_cohesion_n = 0.02, .tool_friction = 0.27}));
  waitTicks(100);
  EXPECT_EQ(session_->scenes(), 1U);
  EXPECT_EQ(session_->shown().bed.soil.contact_friction, 0.31);
  EXPECT_EQ(session_->sceneFile().tool.friction, 0.27);
  EXPECT_TRUE(session_->settled()) << "and no other bed is made for it";
  EXPECT_THROW((void)session_->adjust({.contact_friction = -1, .contact_cohesion_n = 0, .tool_friction = 0}),
               InvalidParameter);
  session_->change({.preset = "P6"});
  EXPECT_FALSE(session_->adjust({.contact_friction = 0.5, .contact_cohesion_n = 0.02, .tool_friction = 0.27}));
  ASSERT_TRUE(soon([&] { return session_->scenes() == 2; }));
  EXPECT_EQ(session_->shown().preset, "P6");
  stop_ = true;
  session_->join();
}

TEST_F(SessionTest, AdjustsNothingThatTheListsAreNotGoodFor) {
  SceneFile cohesionless = quiet();
  cohesionless.bed.soil.friction = FrictionModel::kContact;
  start(cohesionless);
  EXPECT_FALSE(session_->adjust({.contact_friction = 0.3, .contact_cohesion_n = 0.02, .tool_friction = 0.3}));
  EXPECT_EQ(session_->shown().bed.soil, cohesionless.bed.soil);
}

TEST_F(SessionTest, NoGrainIsMovedWhileTimeStandsStillSoThatItGoesOnAgain) {
  start();
  const GrainMove nowhere{0, Vec3::Zero(), Vec3::Zero()};  // the bed refuses it
  EXPECT_TRUE(session_->moveGrain(nowhere));
  session_->pause();
  EXPECT_FALSE(session_->moveGrain(nowhere));
  EXPECT_FALSE(session_->moveGrain(nowhere));
  session_->resume();
  waitTicks(100);
  EXPECT_TRUE(session_->moveGrain(nowhere));
}

TEST_F(SessionTest, WhatIsAskedForWhileABedComesIsDoneToThatBed) {
  start();
  session_->setSpeed(0.1);
  session_->level();
  session_->change({.body = "Mars", .tool_shape = ToolShape::kSphere});
  ASSERT_TRUE(soon([&] { return session_->scenes() == 2 && session_->busy().empty(); }));
  EXPECT_EQ(session_->shown().body, "Mars");
  session_->undo();
  ASSERT_TRUE(soon([&] { return session_->scenes() == 3; }));
  EXPECT_EQ(session_->sceneFile().body, "Moon");
  EXPECT_EQ(session_->sceneFile().tool.shape, ToolShape::kBox);
  stop_ = true;
  session_->join();
  EXPECT_EQ(session_->scene().bed().parameters().gravity_m_s2.z(), -1.625);
  EXPECT_EQ(session_->scene().tool().shape, ToolShape::kBox);
}

TEST_F(SessionTest, LettingGoRightAfterAnotherBedHasComeLeavesTheToolWhereItIs) {
  start();
  session_->hold(Pose{Vec3(0.03, 0.02, 0.12)});
  ASSERT_TRUE(soon([&] { return session_->snapshot().scene_T_tool.position_m.x() > 0.029; }));
  session_->level();
  ASSERT_TRUE(soon([&] { return session_->scenes() == 2; }));
  session_->release();
  EXPECT_LT((session_->held()->position_m - Vec3(0.03, 0.02, 0.12)).norm(), 0.005);
}

TEST_F(SessionTest, ResetTakesBackEverythingAndLevelOnlyWhatWasDug) {
  SceneFile stirred = quiet();
  stirred.hand.motion = HandMotion::kStir;
  start(stirred);
  session_->change({.body = "Mars"});
  ASSERT_TRUE(soon([&] { return session_->snapshot().ticks > 3000; }));
  session_->level();
  ASSERT_TRUE(soon([&] { return session_->scenes() == 2; }));
  EXPECT_EQ(session_->sceneFile().body, "Mars");
  EXPECT_EQ(session_->undoable(), "level");
  session_->reset();
  ASSERT_TRUE(soon([&] { return session_->scenes() == 3; }));
  EXPECT_EQ(session_->sceneFile().body, "Moon");
  EXPECT_EQ(session_->undoable(), "reset");
}

TEST_F(SessionTest, BecomesCoarserAndStaysSo) {
  SceneFile fine = findSceneFile("auto");
  fine.hand.motion = HandMotion::kStill;
  fine.loop.real_time = false;
  start(fine);
  session_->coarsen();
  session_->coarsen();  // while the first is being made
  ASSERT_TRUE(soon([&] { return session_->settled() && session_->shown().bed.soil.radius_m > 5.2e-3; }));
  EXPECT_DOUBLE_EQ(session_->shown().bed.soil.radius_m, 5.3e-3);
  EXPECT_EQ(session_->undoable(), "coarser");
  const std::uint32_t scenes = session_->scenes();
  session_->reset();
  ASSERT_TRUE(soon([&] { return session_->scenes() == scenes + 1; }));
  EXPECT_DOUBLE_EQ(session_->shown().bed.soil.radius_m, 5.3e-3);
}

TEST_F(SessionTest, DoesNotBecomeCoarserWhereParticlesAreCounted) {
  start();
  EXPECT_THROW(session_->coarsen(), InvalidParameter);
  EXPECT_TRUE(session_->settled());
}

TEST_F(SessionTest, ARefusedChangeChangesNothing) {
  start();
  EXPECT_THROW(session_->change({.preset = "P9"}), InvalidParameter);
  EXPECT_THROW(session_->change({.body = "Mars", .sliders = {{"nonsense", 1}}}), InvalidParameter);
  EXPECT_THROW(session_->undo(), InvalidParameter);
  EXPECT_THROW(session_->setSpeed(0), InvalidParameter);
  EXPECT_THROW(session_->hold(Pose{Vec3(0, 0, 5)}), InvalidParameter);
  EXPECT_THROW(session_->hold(Pose{Vec3(0, 0, 0.1), Quat(0, 0, 0, 0)}), InvalidParameter);
  EXPECT_EQ(session_->sceneFile().preset, "P3");
  EXPECT_EQ(session_->sceneFile().body, "Moon");
}

TEST_F(SessionTest, WhoeverHoldsTheToolDigsAndItStaysWhereItIsLeft) {
  start();
  session_->hold(Pose{Vec3(0.01, 0, 0.02)});
  ASSERT_TRUE(soon([&] { return session_->snapshot().device_wrench.force_n.norm() > 0.1; }));
  session_->release();
  const auto ticks = session_->snapshot().ticks;
  ASSERT_TRUE(soon([&] { return session_->snapshot().ticks > ticks + 2000; }));
  const double left_at = session_->snapshot().scene_T_tool.position_m.z();
  EXPECT_LT(left_at, 0.05);
  session_->play(HandMotion::kStill);
  ASSERT_TRUE(soon([&] { return session_->snapshot().scene_T_tool.position_m.z() > 0.1; }));
}

TEST_F(SessionTest, TheTitleFollowsTheMotion) {
  start();
  const std::string own = session_->sceneFile().title;
  session_->play(session_->motion());
  EXPECT_EQ(session_->sceneFile().title, own);
  session_->play(HandMotion::kStir);
  EXPECT_EQ(session_->sceneFile().title, "P3 soil, Moon, R = 7 mm, shovel, stir");
  EXPECT_EQ(session_->shown().title, session_->sceneFile().title);
  session_->reset();
  EXPECT_EQ(session_->sceneFile().title, "P3 soil, Moon, R = 7 mm, shovel, stir") << "the hand still stirs";
}

TEST_F(SessionTest, APausedSessionGoesOnTickByTick) {
  start();
  EXPECT_THROW(session_->advance(1), InvalidParameter);
  pauseAndWait();
  const auto ticks = session_->snapshot().ticks;
  for (int i = 0; i < 10; ++i) {
    session_->advance(1);  // none is lost
  }
  ASSERT_TRUE(soon([&] { return session_->snapshot().ticks == ticks + 10; }));
  session_->resume();
  ASSERT_TRUE(soon([&] { return session_->snapshot().ticks > ticks + 1000; }));
}

TEST_F(SessionTest, LevelSoilLiesAsItDidAtFirstHoweverItWasMade) {
  SceneFile settled = findSceneFile("soil-surface");  // repeated from a tile, its sides held
  settled.bed.width_m = settled.bed.length_m = 0.08;
  settled.bed.depth_m = 0.02;
  settled.loop.real_time = false;
  settled.hand.motion = HandMotion::kStill;
  start(settled);
  const std::vector<Float4> first = session_->snapshot().position;
  const std::size_t held = session_->scene().bed().heldParticles();
  ASSERT_GT(held, 0U);
  session_->level();
  ASSERT_TRUE(soon([&] { return session_->scenes() == 2; }));
  waitTicks(500);
  EXPECT_EQ(session_->scene().bed().heldParticles(), held);
  const std::vector<Float4> level = session_->snapshot().position;
  EXPECT_LT(farthest(level, first), 1e-4);
  for (std::size_t i = 0; i < level.size(); ++i) {
    ASSERT_EQ(level[i].w, first[i].w) << i;
  }
}

TEST_F(SessionTest, ShowsOneStimulusAfterAnotherEachOnALevelBed) {
  start();
  const SceneChange block{.preset = "P4"}, mars{.body = "Mars"}, ceres{.body = "Ceres"};
  session_->show(std::array{block, mars});
  EXPECT_FALSE(session_->settled());
  ASSERT_TRUE(soon([&] { return session_->settled(); }));
  EXPECT_EQ(session_->shown().preset, "P4");
  EXPECT_EQ(session_->shown().body, "Mars");
  constexpr std::uint64_t kToRest = 3000;  // under another gravity the bed sinks by millimetres
  waitTicks(kToRest);
  const std::vector<Float4> level = session_->snapshot().position;
  session_->play(HandMotion::kStir);
  waitTicks(3000);
  EXPECT_GT(farthest(session_->snapshot().position, level), 0.005);
  session_->play(HandMotion::kStill);
  waitTicks(3000);                    // until the tool is out of the soil, where the next bed would meet it
  session_->show(std::array{ceres});  // not of what is shown: of the scene as it was started
  ASSERT_TRUE(soon([&] { return session_->settled(); }));
  EXPECT_EQ(session_->shown().preset, "P3");
  EXPECT_EQ(session_->shown().body, "Ceres");
  session_->show(std::array{block, mars});
  ASSERT_TRUE(soon([&] { return session_->settled(); }));
  waitTicks(kToRest);
  EXPECT_LT(farthest(session_->snapshot().position, level), 1e-3);
  EXPECT_THROW(session_->show(std::array{SceneChange{.body = "Venus"}}), InvalidParameter);
  EXPECT_EQ(session_->sceneFile().body, "Mars");
}

TEST_F(SessionTest, ShowsStonesWhereEachStimulusHasThem) {
  SceneFile scene = findSceneFile("buried-stone");
  scene.bed.start = BedStart::kPacked;  // soon at rest
  scene.loop.real_time = false;
  scene.hand.motion = HandMotion::kStill;
  start(scene);
  const auto stone_m = [&] { return session_->scene().bed().stones().poses().front().position_m.z(); };
  const double first_m = stone_m();
  SceneChange deeper, no_change;
  deeper.stone_depth_m = scene.bed.stones.placed.front().depth_m + 0.01;
  for (int round = 0; round < 2; ++round) {
    session_->show(std::array{deeper});
    ASSERT_TRUE(soon([&] { return session_->settled(); }));
    EXPECT_NEAR(stone_m(), first_m - 0.01, 0.002) << "round " << round;
    session_->show(std::array{no_change});
    ASSERT_TRUE(soon([&] { return session_->settled(); }));
    EXPECT_NEAR(stone_m(), first_m, 1e-6) << "round " << round;
  }
}

TEST_F(SessionTest, AToolThatTouchesNothingFadesOutOfTheSoilAndBackWithoutAJump) {
  start();
  session_->hold(Pose{Vec3(0.01, 0, 0.02)});
  const auto force_n = [&] { return session_->snapshot().device_wrench.force_n.norm(); };
  ASSERT_TRUE(soon([&] { return force_n() > 1; }));
  session_->touch(false);
  ASSERT_TRUE(soon([&] { return force_n() < 1e-3; }));
  waitTicks(500);
  EXPECT_LT(force_n(), 1e-3);
  session_->level();  // another bed is not touched either
  ASSERT_TRUE(soon([&] { return session_->scenes() == 2; }));
  waitTicks(500);
  EXPECT_LT(force_n(), 1e-3);
  session_->touch(true);
  ASSERT_TRUE(soon([&] { return force_n() > 1; }));
}

TEST_F(SessionTest, ManyChangesAtOnceEndWithTheLast) {
  start();
  for (const char* preset : {"P1", "P2", "P4", "P5", "P6", "P1", "P2"}) {
    session_->change({.preset = preset});
    session_->poll();
  }
  session_->change({.body = "Ceres"});
  ASSERT_TRUE(soon([&] { return session_->busy().empty(); }));
  EXPECT_EQ(session_->sceneFile().preset, "P2");
  stop_ = true;
  session_->join();
  EXPECT_EQ(session_->scene().bed().parameters().soil.mu_hat, session_->sceneFile().bed.soil.mu_hat);
  EXPECT_EQ(session_->scene().bed().parameters().gravity_m_s2.z(), -0.27);
}

TEST_F(SessionTest, ASessionMayEndWhileABedIsBeingMade) {
  start();
  session_->change({.soil = "dry-sand"});  // rain, which settles for a while
  EXPECT_FALSE(session_->busy().empty());
}

}  // namespace
}  // namespace haptolith
