// Each wrench of the library has one frame: checked by pressing along one axis of devices that are turned.

#include <dlfcn.h>
#include <gmock/gmock.h>
#include <haptolith/haptolith.hpp>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "../device/force_dimension_stand_in.h"
#include "sweep.h"
#include "use.h"

namespace haptolith::library {
namespace {

namespace fs = std::filesystem;

constexpr double kQuarter_rad = std::numbers::pi / 2;

std::string turned(int degrees) {
  return "mapping.turn_deg=[0, 0, " + std::to_string(degrees) + "]";
}

std::vector<hapto_tick> ticksOf(hapto_loop* loop) {
  std::vector<hapto_tick> ticks(8000);
  std::uint64_t count = 0;
  expectOk(hapto_loop_take_ticks(loop, ticks.data(), ticks.size(), &count, nullptr));
  ticks.resize(count);
  return ticks;
}

TEST(Frames, EachWrenchOfALoopHasItsOwnWhicheverWayTheDeviceIsTurned) {
  for (const int mapping_deg : {0, 90, 180}) {
    for (const double device_rad : {0.0, -kQuarter_rad}) {
      SCOPED_TRACE(testing::Message() << mapping_deg << " degrees, the device's own " << device_rad);
      const ScenePtr scene = sceneOf(kIcra2021, {kZeroInSoil, turned(mapping_deg).c_str()});
      SweepingDevice hand{.sweep = {.turn_rad = mapping_deg * std::numbers::pi / 180 + device_rad},
                          .device_turn_rad = device_rad};
      const hapto_device device = hand.handle();
      hapto_loop* made = nullptr;
      expectOk(hapto_loop_create(scene.get(), &device, HAPTO_LOOP_TICKED_BY_CALLER | HAPTO_LOOP_KEEPS_TICKS, &made));
      const LoopPtr loop(made);
      for (int tick = 0; tick < 480; ++tick) {  // 30 snapshots
        ASSERT_EQ(hapto_loop_tick(loop.get(), 0), HAPTO_OK);
      }
      const std::vector<hapto_tick> ticks = ticksOf(loop.get());
      ASSERT_EQ(ticks.size(), 480U);
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(ticks.back().felt.force_n[axis], hand.last.wrench.force_n[axis]) << "what the device was sent";
      }
      expectPushedBack(ticks, hand.sweep);
      auto now = sized<hapto_snapshot>();
      expectOk(hapto_loop_snapshot(loop.get(), &now));
      expectWrenchesOfATick(now, ticks, hand.sweep);
    }
  }
}

/// A Sweep through the C++ interface.
class SweepingHand final : public hapto::Device {
 public:
  explicit SweepingHand(double turn_rad) : sweep_{.turn_rad = turn_rad} {}
  void declare(hapto_device_limits& limits) const noexcept override { limits.simulated = 1; }
  void read(hapto_device_input& told) noexcept override {
    std::ranges::copy(sweep_.position(1e-3 * reads_), told.pose.position_m);
    std::ranges::copy(sweep_.velocity(1e-3 * reads_++), told.twist.linear_m_s);
  }
  void write(const hapto_device_output& force) noexcept override { last_ = force; }

  Sweep sweep_;
  int reads_ = 0;
  hapto_device_output last_{};
};

TEST(Frames, AreTheSameInCpp) {
  hapto::Scene scene = hapto::Scene::fromToml(kIcra2021, {kZeroInSoil, turned(90)});
  SweepingHand hand(kQuarter_rad);
  hapto::Loop loop(scene, hand, hapto::Loop::Ticked::kByCaller, hapto::Loop::Ticks::kKept);
  while (hand.reads_ < 480) {
    ASSERT_TRUE(loop.tick());
  }
  const std::vector<hapto_tick> ticks = loop.takeTicks(1000);
  ASSERT_EQ(ticks.size(), 480U);
  expectPushedBack(ticks, hand.sweep_);
  expectWrenchesOfATick(loop.snapshot(), ticks, hand.sweep_);
}

TEST(Frames, OfAForceDimensionDeviceAreAQuarterTurnApart) {
  const fs::path sdk = fs::path(testing::TempDir()) / ("haptolith-frames-" + std::to_string(getpid()));
  fs::create_directories(sdk);
  fs::create_symlink(HAPTOLITH_STAND_IN, sdk / "libdrd.so.3");
  setenv("FORCEDIM_SDK", sdk.c_str(), 1);
  void* const library = dlopen((sdk / "libdrd.so.3").c_str(), RTLD_NOW);
  ASSERT_NE(library, nullptr) << dlerror();
  StandIn& stand_in = *reinterpret_cast<StandIn* (*)()>(dlsym(library, "standIn"))();
  for (const int mapping_deg : {0, 90, 180}) {
    SCOPED_TRACE(mapping_deg);
    const Sweep sweep{.turn_rad = mapping_deg * std::numbers::pi / 180 - kQuarter_rad,
                      .rests_s = 4.5};  // with soft start and all, as a person's hand has it
    const ScenePtr scene =
        sceneOf(kIcra2021, {kZeroInSoil, turned(mapping_deg).c_str(), "device.kind=force-dimension"});
    stand_in.position_m = sweep.position(0);
    stand_in.velocity_m_s = {};
    hapto_loop* made = nullptr;
    expectOk(hapto_loop_create(scene.get(), nullptr, HAPTO_LOOP_TICKED_BY_CALLER | HAPTO_LOOP_KEEPS_TICKS, &made));
    const LoopPtr loop(made);
    for (int tick = 0; tick < 4784; ++tick) {
      stand_in.position_m = sweep.position(1e-3 * tick);
      stand_in.velocity_m_s = sweep.velocity(1e-3 * tick);
      ASSERT_EQ(hapto_loop_tick(loop.get(), 0), HAPTO_OK);
    }
    const std::vector<hapto_tick> ticks = ticksOf(loop.get());
    ASSERT_EQ(ticks.size(), 4784U);
    EXPECT_EQ(ticks.back().trip, static_cast<std::uint32_t>(HAPTO_TRIP_NONE));
    EXPECT_EQ(ticks.back().felt.force_n[0], stand_in.wrench[0]);
    EXPECT_EQ(ticks.back().felt.force_n[1], stand_in.wrench[1]);
    expectPushedBack(ticks, sweep);
    auto now = sized<hapto_snapshot>();
    expectOk(hapto_loop_snapshot(loop.get(), &now));
    expectWrenchesOfATick(now, ticks, sweep);
  }
  unsetenv("FORCEDIM_SDK");
  dlclose(library);
  fs::remove_all(sdk);
}

}  // namespace
}  // namespace haptolith::library
