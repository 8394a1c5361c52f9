// A session whose tool is in a person's hand.

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/session/session.h"

namespace haptolith {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kMost_n = 10;
constexpr double kRate_n_s = 100;

/// Data shared by a test and the device in a session.
struct Handle {
  std::atomic<double> z_m{0};        ///< target of the person: above the centre of the device's workspace
  std::atomic<double> step_m{2e-4};  ///< largest movement per tick
  std::atomic<bool> letting_go{false}, gone{false};
  std::atomic<double> last_force_n{0};
};

class PersonsDevice final : public HapticDevice {
 public:
  explicit PersonsDevice(std::shared_ptr<Handle> handle) : handle_(std::move(handle)) {}
  ~PersonsDevice() override { handle_->gone = true; }
  PersonsDevice(const PersonsDevice&) = delete;
  PersonsDevice& operator=(const PersonsDevice&) = delete;

  [[nodiscard]] std::string_view name() const noexcept override { return "a person's"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override {
    DeviceLimits limits;
    limits.max_force_n = kMost_n;
    limits.max_force_rate_n_s = kRate_n_s;
    limits.workspace_centre_m = Vec3(0.3, 0.2, 0.1);
    return limits;
  }
  [[nodiscard]] DeviceInput read() noexcept override {
    at_m_ += std::clamp(handle_->z_m - at_m_, -handle_->step_m, +handle_->step_m);
    DeviceInput input;
    input.pose.position_m = limits().workspace_centre_m + Vec3(0, 0, at_m_);
    return input;
  }
  void write(const DeviceOutput& output) noexcept override { handle_->last_force_n = output.wrench.force_n.norm(); }
  void releaseForce() noexcept override { handle_->letting_go = true; }
  void resumeForce() noexcept override {}

 private:
  std::shared_ptr<Handle> handle_;
  double at_m_ = 0;
};

/// A session that runs as fast as it can, with all its records.
class PersonsSession : public testing::Test {
 protected:
  PersonsSession() {
    SceneFile scene_file;
    scene_file.loop.real_time = false;
    scene_file.device.kind = DeviceKind::kNetwork;  // any but the virtual hand
    scene_file.handling.safety.soft_start_s = 0.5;
    session_ = std::make_unique<Session>(scene_file, true, SettleProgress{}, std::make_unique<PersonsDevice>(handle_));
    session_->start(stop_);
  }
  ~PersonsSession() override {
    stop_ = true;
    session_.reset();
  }

  /// Waits until something is so; it takes milliseconds unless something is wrong.
  testing::AssertionResult soon(const std::function<bool()>& is_so) {
    for (int i = 0; i < 20'000; ++i) {
      session_->poll();
      session_->update();
      session_->loop().takeRecords(records_);
      if (is_so()) {
        return testing::AssertionSuccess();
      }
      std::this_thread::sleep_for(500us);
    }
    return testing::AssertionFailure() << "not within ten seconds";
  }
  [[nodiscard]] double toolHeight() const { return session_->snapshot().scene_T_tool.position_m.z(); }
  /// Moves the hand into the soil, until it has felt that for a while.
  void dig() {
    handle_->z_m = below(0.02);
    ASSERT_TRUE(soon([&] { return toolHeight() < session_->surface() - 0.0199; }));
    waitTicks(300);
    ASSERT_TRUE(soon([&] { return session_->snapshot().device_wrench.force_n.norm() > 0.05; }));
  }
  void waitTicks(std::uint64_t count) {
    const std::uint64_t ticks = session_->snapshot().ticks;
    ASSERT_TRUE(soon([&] { return session_->snapshot().ticks > ticks + count; }));
  }
  /// Distance below the centre of the workspace at which the tool's centre has a given depth in the soil.
  [[nodiscard]] static double below(double depth_m) { return -HandParameters().home_m.z() - depth_m; }

  /// Largest change of the force at the hand in a tick, from record number `first` on.
  [[nodiscard]] double largestChange(std::size_t first) const {
    double largest_n = 0;
    for (std::size_t i = std::max<std::size_t>(first, 1); i < records_.size(); ++i) {
      largest_n = std::max(largest_n, (records_[i].sent.wrench.force_n - records_[i - 1].sent.wrench.force_n).norm());
    }
    return largest_n;
  }
  void stopAndTakeAll() {
    stop_ = true;
    session_->join();
    session_->loop().takeRecords(records_);
  }

  std::atomic<bool> stop_{false};
  std::shared_ptr<Handle> handle_ = std::make_shared<Handle>();
  std::vector<TickRecord> records_;
  std::unique_ptr<Session> session_;
};

TEST_F(PersonsSession, WhatOnlyASimulatedHandCanDoIsRefusedAndSaysWho) {
  const auto refused = [](const char* what) {
    return ThrowsMessage<InvalidParameter>(AllOf(HasSubstr(what), HasSubstr("a haptic device moves")));
  };
  EXPECT_THAT([this] { session_->hold(Pose{Vec3(0, 0, 0.1)}); }, refused("cannot move the tool"));
  EXPECT_THAT([this] { session_->play(HandMotion::kStir); }, refused("cannot move the tool"));
  EXPECT_THAT([this] { session_->setSpeed(0.5); }, refused("cannot change the speed"));
  EXPECT_FALSE(session_->held());
  EXPECT_EQ(session_->speed(), 1);
  session_->release();  // without a held tool: no effect
  waitTicks(100);
}

TEST_F(PersonsSession, TheMiddleOfTheWorkspaceLiesAboveTheSurface) {
  waitTicks(50);
  const Vec3 wanted_m = Vec3(0, 0, session_->surface()) + HandParameters().home_m;
  EXPECT_LT((session_->snapshot().scene_T_tool.position_m - wanted_m).norm(), 1e-12);
  EXPECT_EQ(session_->snapshot().device_wrench.force_n, Vec3::Zero());
}

TEST_F(PersonsSession, APauseLetsGoAndForceComesBackSoftlyWhereTheHandIsThen) {
  waitTicks(1000);  // the soft start is over
  dig();
  session_->pause();
  ASSERT_TRUE(soon([&] { return session_->snapshot().paused; }));
  EXPECT_EQ(handle_->last_force_n, 0);
  const double before_m = toolHeight();
  const std::size_t ticks = records_.size();

  handle_->step_m = 1;  // time is paused, and the hand moves
  handle_->z_m = below(0.01);
  session_->resume();
  ASSERT_TRUE(soon([&] { return records_.size() > ticks + 900; }));
  stopAndTakeAll();
  const TickRecord& first = records_[ticks];
  ASSERT_NE(first.flags & kTickResumed, 0U);
  EXPECT_NE(first.flags & kTickSoftStart, 0U);
  EXPECT_NEAR(first.scene_T_tool.position_m.z(), before_m + 0.01, 1e-9) << "where the hand is, not on its way there";
  EXPECT_LT(first.soil.force_n.norm(), 0.01) << "the tool comes back into the soil gently";
  for (std::size_t i = ticks; i < ticks + 900; ++i) {
    ASSERT_NEAR(records_[i].scene_T_tool.position_m.z(), first.scene_T_tool.position_m.z(), 1e-12);
  }
  for (std::size_t i = ticks; i < ticks + 400; ++i) {  // part of the 500 of the soft start
    ASSERT_NE(records_[i].flags & kTickSoftStart, 0U);
    const double share = static_cast<double>(i + 1 - ticks) / 500;
    ASSERT_LE(records_[i].sent.wrench.force_n.norm(),
              1.001 * share * share * (3 - 2 * share) * records_[i].rendered.wrench.force_n.norm() + 1e-3);
  }
  EXPECT_EQ(records_[ticks + 600].flags & kTickSoftStart, 0U);
}

TEST_F(PersonsSession, AnotherBedUnderTheHandIsNoJolt) {
  waitTicks(1000);
  dig();
  const std::size_t ticks = records_.size();
  session_->level();
  ASSERT_TRUE(soon([&] { return session_->scenes() == 2; }));
  waitTicks(800);
  session_->change({.tool_shape = ToolShape::kSphere});
  waitTicks(800);
  EXPECT_TRUE(soon([&] { return session_->snapshot().device_wrench.force_n.norm() > 0.01; }))
      << "it is in the soil again";
  const std::size_t end = records_.size();
  stopAndTakeAll();
  records_.resize(end);
  const auto changes = std::count_if(records_.begin(), records_.end(),
                                     [](const TickRecord& tick) { return (tick.flags & kTickSceneChanged) != 0; });
  EXPECT_EQ(changes, 4) << "for each: the tool begins to fade, and then there is another bed or tool";
  EXPECT_LT(largestChange(ticks), 1.000001 * kRate_n_s * 1e-3);
  EXPECT_EQ(session_->snapshot().trips, 0U);
}

TEST_F(PersonsSession, TheLargestToolThatAPageMayAskForIsNoJoltAndNoCollapse) {
  waitTicks(1000);
  dig();
  const double largest_m = toolLengths(session_->shown().bed).highest;
  for (const ToolShape shape :
       {ToolShape::kBox, ToolShape::kSphere, ToolShape::kPlate, ToolShape::kCylinder, ToolShape::kJaws}) {
    const std::size_t ticks = records_.size();
    session_->change({.tool_shape = shape,
                      .tool_size_m = Vec3::Constant(largest_m),
                      .tool_diameter_m = largest_m,
                      .tool_thickness_m = largest_m,
                      .tool_opening_m = largest_m,
                      .tool_length_m = largest_m});
    waitTicks(1000);
    const std::uint32_t scenes = session_->scenes();
    session_->level();  // a bed whose soil finds the tool in its place
    ASSERT_TRUE(soon([&] { return session_->done() || session_->scenes() > scenes; }));
    handle_->z_m = below(0.035);  // and down, almost to the floor
    waitTicks(1000);
    handle_->z_m = below(0.02);
    waitTicks(500);
    ASSERT_FALSE(session_->done()) << "the bed has collapsed";
    EXPECT_LT(largestChange(ticks), 1.000001 * kRate_n_s * 1e-3);
    EXPECT_TRUE(std::all_of(records_.begin(), records_.end(), [](const TickRecord& tick) {
      return tick.sent.wrench.force_n.norm() < 1.000001 * kMost_n;
    }));
    EXPECT_EQ(session_->snapshot().trips, 0U);
  }
}

TEST_F(PersonsSession, ItsEndLetsGoOfTheHandSoftly) {
  waitTicks(1000);
  dig();
  const std::size_t ticks = records_.size();
  stopAndTakeAll();
  EXPECT_EQ(handle_->last_force_n, 0);
  EXPECT_LT(largestChange(ticks), 1.000001 * kRate_n_s * 1e-3);
  EXPECT_LT(records_.back().sent.wrench.force_n.norm(), 0.01);
  EXPECT_FALSE(handle_->gone);
  session_.reset();
  EXPECT_TRUE(handle_->gone);
}

TEST_F(PersonsSession, OneThatIsThrownAwayLetsGoToo) {
  waitTicks(1000);
  dig();
  session_.reset();
  EXPECT_EQ(handle_->last_force_n, 0);
  EXPECT_TRUE(handle_->gone);
}

}  // namespace
}  // namespace haptolith
