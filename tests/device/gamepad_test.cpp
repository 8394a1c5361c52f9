// Gamepads that SDL plays to us: no hardware, no display.
#include "haptolith/device/drivers/gamepad.h"

#include <SDL.h>
#include <gmock/gmock.h>

#include <atomic>
#include <optional>

#include "haptolith/core/error.h"

#include "allocations.h"
#include "eventually.h"

namespace haptolith {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

constexpr double kTick_s = 1e-3;
constexpr double kFast = 0.15;  // m/s, at full deflection
constexpr double kTurn = 1.5;   // rad/s

Vec3 moves(const PadSticks& sticks) {
  return speedOf(sticks).linear_m_s;
}
Vec3 turns(const PadSticks& sticks) {
  return speedOf(sticks).angular_rad_s;
}

TEST(SpeedOf, TheLeftStickMovesToTheRightAndAwayFromTheUser) {
  EXPECT_TRUE(moves({.left_right = 1}).isApprox(Vec3(kFast, 0, 0)));
  EXPECT_TRUE(moves({.left_towards = 1}).isApprox(Vec3(0, -kFast, 0)));
}

TEST(SpeedOf, TheLeftTriggerLowersAndWithItsShoulderButtonRaises) {
  EXPECT_TRUE(moves({.left_trigger = 1}).isApprox(Vec3(0, 0, -kFast)));
  EXPECT_TRUE(moves({.left_trigger = 1, .raise = true}).isApprox(Vec3(0, 0, kFast)));
}

TEST(SpeedOf, TheRightStickTurnsTheTopOfTheToolWhereItIsPushed) {
  const auto top = [](const PadSticks& sticks) { return turns(sticks).cross(Vec3::UnitZ()); };
  EXPECT_TRUE(top({.right_towards = 1}).isApprox(Vec3(0, -kTurn, 0)));
  EXPECT_TRUE(top({.right_right = 1, .roll = true}).isApprox(Vec3(kTurn, 0, 0)));
  // To the right without the button: the far side swings to the right.
  EXPECT_TRUE(turns({.right_right = 1}).cross(Vec3::UnitY()).isApprox(Vec3(kTurn, 0, 0)));
}

TEST(SpeedOf, AStickThatRestsBesideTheMiddleMovesNothingWhenATriggerIsPulled) {
  EXPECT_TRUE(moves({.left_right = 0.1, .left_towards = 0.1, .left_trigger = 1}).isApprox(Vec3(0, 0, -kFast)));
}

/// Commands sent to a pad's motors.
struct Motors {
  std::atomic<int> strength{0};
  std::atomic<int> calls{0};
};

int rumble(void* motors, Uint16 low, Uint16 high) {
  EXPECT_EQ(low, high);
  static_cast<Motors*>(motors)->strength = low;
  ++static_cast<Motors*>(motors)->calls;
  return 0;
}

/// A pad with six axes and fifteen buttons that is plugged in and out.
class PlayedPad {
 public:
  explicit PlayedPad(Motors& motors) {
    SDL_VirtualJoystickDesc pad{};
    pad.version = SDL_VIRTUAL_JOYSTICK_DESC_VERSION;
    pad.type = SDL_JOYSTICK_TYPE_GAMECONTROLLER;
    pad.naxes = SDL_CONTROLLER_AXIS_MAX;
    pad.nbuttons = 15;
    pad.name = "played pad";
    pad.userdata = &motors;
    pad.Rumble = rumble;
    const int index = SDL_JoystickAttachVirtualEx(&pad);
    joystick_ = index < 0 ? nullptr : SDL_JoystickOpen(index);
    if (joystick_ == nullptr) {
      throw std::runtime_error(SDL_GetError());
    }
    push(SDL_CONTROLLER_AXIS_TRIGGERLEFT, -1);
    push(SDL_CONTROLLER_AXIS_TRIGGERRIGHT, -1);
  }
  ~PlayedPad() {
    unplug();
    SDL_JoystickClose(joystick_);
  }
  PlayedPad(const PlayedPad&) = delete;
  PlayedPad& operator=(const PlayedPad&) = delete;

  void push(SDL_GameControllerAxis axis, double share) {
    EXPECT_EQ(SDL_JoystickSetVirtualAxis(joystick_, axis, static_cast<Sint16>(32767 * share - (share < 0 ? 1 : 0))), 0);
  }
  void press(SDL_GameControllerButton button, bool down) {
    EXPECT_EQ(SDL_JoystickSetVirtualButton(joystick_, button, down ? 1 : 0), 0);
  }
  void unplug() {
    const SDL_JoystickID id = SDL_JoystickInstanceID(joystick_);
    for (int i = 0; i < SDL_NumJoysticks(); ++i) {
      if (SDL_JoystickGetDeviceInstanceID(i) == id) {
        EXPECT_EQ(SDL_JoystickDetachVirtual(i), 0);
        return;
      }
    }
  }

 private:
  SDL_Joystick* joystick_ = nullptr;
};

class GamepadTest : public testing::Test {
 protected:
  GamepadTest() {
    if (SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER) != 0) {
      throw std::runtime_error(SDL_GetError());
    }
    played_.emplace(motors_);
  }
  ~GamepadTest() override {
    played_.reset();
    SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER);
  }

  [[nodiscard]] static Gamepad open(const std::string& id = "played pad") {
    DeviceParameters parameters;
    parameters.id = id;
    return {parameters, kTick_s};
  }

  Motors motors_;
  std::optional<PlayedPad> played_;
};

TEST_F(GamepadTest, RestsUntilAStickIsPushedAndAgainWhenItIsLetGo) {
  Gamepad pad = open();
  EXPECT_EQ(pad.name(), "played pad");
  DeviceInput input = pad.read();
  EXPECT_EQ(input.state, DeviceState::kLive);
  EXPECT_EQ(input.pose.position_m, Vec3::Zero());

  played_->push(SDL_CONTROLLER_AXIS_LEFTX, 1);
  EXPECT_TRUE(eventually([&] { return pad.read().twist.linear_m_s.x() > 0.1; }));
  played_->push(SDL_CONTROLLER_AXIS_LEFTX, 0);
  EXPECT_TRUE(eventually([&] { return pad.read().twist.linear_m_s.norm() == 0; }));
  input = pad.read();
  EXPECT_GT(input.pose.position_m.x(), 0);
  EXPECT_LE(input.pose.position_m.x(), pad.limits().workspace_radius_m);
  EXPECT_EQ(input.pose.position_m.y(), 0);
}

TEST_F(GamepadTest, EveryStickAndTriggerMovesTheRightWay) {
  Gamepad pad = open();
  const auto asked = [&](SDL_GameControllerAxis axis, double rest, const Vec3& way, bool turn) {
    played_->push(axis, 1);
    EXPECT_TRUE(eventually([&] {
      const Twist twist = pad.read().twist;
      return (turn ? twist.angular_rad_s : twist.linear_m_s).normalized().isApprox(way, 1e-6);
    })) << "axis "
        << axis;
    played_->push(axis, rest);
    EXPECT_TRUE(
        eventually([&] { return pad.read().twist.linear_m_s.norm() + pad.read().twist.angular_rad_s.norm() == 0; }));
  };
  asked(SDL_CONTROLLER_AXIS_LEFTX, 0, Vec3::UnitX(), false);
  asked(SDL_CONTROLLER_AXIS_LEFTY, 0, -Vec3::UnitY(), false);
  asked(SDL_CONTROLLER_AXIS_TRIGGERLEFT, -1, -Vec3::UnitZ(), false);
  asked(SDL_CONTROLLER_AXIS_RIGHTX, 0, -Vec3::UnitZ(), true);
  asked(SDL_CONTROLLER_AXIS_RIGHTY, 0, Vec3::UnitX(), true);
}

TEST_F(GamepadTest, TheRightTriggerClosesTheGripper) {
  Gamepad pad = open();
  EXPECT_TRUE(eventually([&] { return pad.read().gripper_open == 1; }));
  played_->push(SDL_CONTROLLER_AXIS_TRIGGERRIGHT, 1);
  EXPECT_TRUE(eventually([&] { return pad.read().gripper_open == 0; }));
  EXPECT_EQ(pad.read().twist.linear_m_s, Vec3::Zero());
}

TEST_F(GamepadTest, PassesButtonsOnByTheirNumbers) {
  Gamepad pad = open();
  played_->press(SDL_CONTROLLER_BUTTON_A, true);
  played_->press(SDL_CONTROLLER_BUTTON_START, true);
  EXPECT_TRUE(eventually([&] { return pad.read().buttons == ((1U << 0) | (1U << 6)); }));
  played_->press(SDL_CONTROLLER_BUTTON_A, false);
  EXPECT_TRUE(eventually([&] { return pad.read().buttons == 1U << 6; }));
}

/// As the loop does, until something comes true.
template <class Condition>
bool eventuallyFeeling(Gamepad& pad, const Vec3& force_n, Condition condition) {
  DeviceOutput output;
  output.wrench.force_n = force_n;
  return eventually([&] {
    pad.write(output);
    return condition();
  });
}

TEST_F(GamepadTest, RumblesAsStronglyAsTheForce) {
  Gamepad pad = open();
  const auto isAbout = [&](int strength) {
    return [this, strength] { return std::abs(motors_.strength - strength) < 1100; };
  };
  EXPECT_TRUE(eventuallyFeeling(pad, {0, -Gamepad::kFullRumble_n / 2, 0}, isAbout(0xFFFF / 2)));
  EXPECT_TRUE(eventuallyFeeling(pad, {0, 0, 100 * Gamepad::kFullRumble_n}, isAbout(0xFFFF)));
  EXPECT_TRUE(eventuallyFeeling(pad, Vec3::Zero(), isAbout(0)));
}

TEST_F(GamepadTest, StopsTheRumbleWhenItIsLetGoWhateverItIsTold) {
  Gamepad pad = open();
  const Vec3 force_n(Gamepad::kFullRumble_n, 0, 0);
  ASSERT_TRUE(eventuallyFeeling(pad, force_n, [&] { return motors_.strength == 0xFFFF; }));
  pad.releaseForce();
  ASSERT_TRUE(eventuallyFeeling(pad, force_n, [&] { return motors_.strength == 0; }));
  const int calls = motors_.calls;
  EXPECT_FALSE([&] {
    for (int i = 0; i < 100; ++i) {
      (void)eventuallyFeeling(pad, force_n, [] { return true; });
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return motors_.calls > calls && motors_.strength > 0;
  }());
  pad.resumeForce();
  EXPECT_TRUE(eventuallyFeeling(pad, force_n, [&] { return motors_.strength == 0xFFFF; }));
}

TEST_F(GamepadTest, StopsTheRumbleWhenTheLoopHangs) {
  Gamepad pad = open();
  ASSERT_TRUE(eventuallyFeeling(pad, {50, 0, 0}, [&] { return motors_.strength == 0xFFFF; }));
  EXPECT_TRUE(eventually([&] { return motors_.strength == 0; }));
}

TEST_F(GamepadTest, StopsTheRumbleAtTheEnd) {
  {
    Gamepad pad = open();
    ASSERT_TRUE(eventuallyFeeling(pad, {50, 0, 0}, [&] { return motors_.strength == 0xFFFF; }));
  }
  EXPECT_EQ(motors_.strength, 0);
}

TEST_F(GamepadTest, ForceThatIsNoNumberDoesNotRumble) {
  Gamepad pad = open();
  ASSERT_TRUE(eventuallyFeeling(pad, {50, 0, 0}, [&] { return motors_.strength == 0xFFFF; }));
  EXPECT_TRUE(eventuallyFeeling(pad, {std::nan(""), 0, 0}, [&] { return motors_.strength == 0; }));
}

TEST_F(GamepadTest, IsLostWhenItIsUnpluggedStandsStillAndComesBack) {
  Gamepad pad = open();
  EXPECT_EQ(pad.problem(), "");
  played_->push(SDL_CONTROLLER_AXIS_LEFTX, 1);
  played_->press(SDL_CONTROLLER_BUTTON_A, true);
  ASSERT_TRUE(eventually([&] { return pad.read().buttons == 1; }));
  played_->unplug();
  ASSERT_TRUE(eventually([&] { return pad.read().state == DeviceState::kStale; }));
  EXPECT_THAT(std::string(pad.problem()), HasSubstr("played pad is disconnected: connect it"));
  EXPECT_TRUE(eventually([&] { return pad.read().twist.linear_m_s.norm() == 0; }));
  EXPECT_EQ(pad.read().buttons, 0U);

  played_.emplace(motors_);
  EXPECT_TRUE(eventually([&] { return pad.read().state == DeviceState::kLive; }));
  EXPECT_EQ(pad.problem(), "");
}

TEST_F(GamepadTest, AllocatesNothingInTheTick) {
  const long before_all = allocationsOfThisThread();
  Gamepad pad = open();
  ASSERT_GT(allocationsOfThisThread(), before_all) << "the counter does not count";
  played_->push(SDL_CONTROLLER_AXIS_LEFTX, 1);
  ASSERT_TRUE(eventually([&] { return pad.read().twist.linear_m_s.x() > 0; }));
  const long before = allocationsOfThisThread();
  for (int i = 0; i < 2000; ++i) {
    (void)pad.read();
    pad.write({});
  }
  pad.releaseForce();
  pad.resumeForce();
  EXPECT_EQ(allocationsOfThisThread(), before);
}

TEST_F(GamepadTest, IsFoundByNumberAndName) {
  const std::vector<DeviceReport> found = findGamepads({});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].kind, DeviceKind::kGamepad);
  EXPECT_TRUE(found[0].usable);
  EXPECT_EQ(found[0].name, "played pad");
  EXPECT_EQ(open(found[0].id).name(), "played pad");
  EXPECT_EQ(open("").name(), "played pad");
  EXPECT_THAT(
      [] { (void)open("7"); },
      ThrowsMessage<Failure>(HasSubstr("no gamepad '7': available are 0 (played pad); use a number or a name")));
}

TEST_F(GamepadTest, DeclaresARumbleAndNoMore) {
  const DeviceLimits limits = open().limits();
  EXPECT_EQ(limits.max_force_n, Gamepad::kFullRumble_n);
  EXPECT_EQ(limits.max_torque_nm, 0);
  EXPECT_EQ(limits.max_gripper_force_n, 0);
}

TEST(Gamepad, SaysWhatToDoWhenThereIsNone) {
  if (SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER) == 0) {
    const int there = SDL_NumJoysticks();
    SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER);
    if (there > 0) {
      GTEST_SKIP() << "this machine has a gamepad";
    }
  }
  EXPECT_THAT([] { Gamepad({}, kTick_s); }, ThrowsMessage<Failure>(HasSubstr("SDL 2 finds none; plug one in")));
  const std::vector<DeviceReport> found = findGamepads({});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_FALSE(found[0].usable);
  EXPECT_EQ(found[0].why_not, "SDL 2 finds no gamepad");
  EXPECT_THAT(found[0].remedy, HasSubstr("plug one in"));
  EXPECT_EQ(SDL_WasInit(0), 0U) << "SDL has been left running";
}

}  // namespace
}  // namespace haptolith
