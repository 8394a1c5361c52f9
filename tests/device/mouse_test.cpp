// A mouse whose events are pushed into SDL's queue, and a hidden window.
#include "haptolith/device/drivers/mouse.h"

#include <SDL.h>
#include <gmock/gmock.h>

#include <cstdlib>
#include <limits>

#include "haptolith/core/error.h"

#include "allocations.h"
#include "eventually.h"

namespace haptolith {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kTick_s = 1e-3;
constexpr Sint32 kLargest = std::numeric_limits<Sint32>::max();

class MouseTest : public testing::Test {
 protected:
  MouseTest() { setenv("SDL_VIDEODRIVER", "dummy", 1); }
  ~MouseTest() override {
    unsetenv("SDL_VIDEODRIVER");
    EXPECT_EQ(SDL_WasInit(0), 0U) << "SDL has been left running";
  }

  static void push(const SDL_Event& event) {
    SDL_Event copy = event;
    ASSERT_EQ(SDL_PushEvent(&copy), 1) << SDL_GetError();
  }
  static void move(Sint32 right, Sint32 towards) {
    SDL_Event event{};
    event.type = SDL_MOUSEMOTION;
    event.motion.xrel = right;
    event.motion.yrel = towards;
    push(event);
  }
  static void press(Uint8 button, bool down = true) {
    SDL_Event event{};
    event.type = down ? SDL_MOUSEBUTTONDOWN : SDL_MOUSEBUTTONUP;
    event.button.button = button;
    push(event);
  }
  static void click(Uint8 button) {
    press(button);
    press(button, false);
  }
  static void wheel(float away, Uint32 direction = SDL_MOUSEWHEEL_NORMAL) {
    SDL_Event event{};
    event.type = SDL_MOUSEWHEEL;
    event.wheel.preciseY = away;
    event.wheel.direction = direction;
    push(event);
  }
  static void key(SDL_Keycode code) {
    SDL_Event event{};
    event.type = SDL_KEYDOWN;
    event.key.keysym.sym = code;
    push(event);
  }
  static void window(SDL_WindowEventID what) {
    SDL_Event event{};
    event.type = SDL_WINDOWEVENT;
    event.window.event = static_cast<Uint8>(what);
    push(event);
  }

  /// Events are taken in order: when a button arrives, all before it have.
  static void settle(Mouse& mouse) {
    press(SDL_BUTTON_X2);
    ASSERT_TRUE(eventually([&] { return (mouse.read().buttons & (1U << 4)) != 0; }));
    press(SDL_BUTTON_X2, false);
    ASSERT_TRUE(eventually([&] { return (mouse.read().buttons & (1U << 4)) == 0; }));
    for (int i = 0; i < 2000; ++i) {
      (void)mouse.read();
    }
  }
  /// SDL drops the movements that wait in its queue when the pointer is taken.
  static void takePointer(Mouse& mouse) {
    click(SDL_BUTTON_LEFT);
    settle(mouse);
  }
  static void expectAt(Mouse& mouse, const Vec3& position_m) {
    settle(mouse);
    const DeviceInput input = mouse.read();
    EXPECT_NEAR((input.pose.position_m - position_m).norm(), 0, 1e-9) << input.pose.position_m.transpose();
    EXPECT_EQ(input.twist.linear_m_s, Vec3::Zero());
    EXPECT_EQ(input.state, DeviceState::kLive);
  }
};

TEST_F(MouseTest, MovesTheToolToTheRightAndAwayAsFarAsItIsPushed) {
  Mouse mouse({}, kTick_s);
  EXPECT_EQ(mouse.read().pose.position_m, Vec3::Zero());
  takePointer(mouse);
  for (int i = 0; i < 10; ++i) {
    move(30, -20);  // SDL counts towards the user
  }
  expectAt(mouse, {0.03, 0.02, 0});
}

TEST_F(MouseTest, TheWheelAndTheRightButtonRaise) {
  Mouse mouse({}, kTick_s);
  takePointer(mouse);
  wheel(3);
  expectAt(mouse, {0, 0, 3 * Mouse::kPerNotch_m});
  wheel(1, SDL_MOUSEWHEEL_FLIPPED);
  expectAt(mouse, {0, 0, 2 * Mouse::kPerNotch_m});
  press(SDL_BUTTON_RIGHT);
  move(50, 100);
  expectAt(mouse, {0, 0, 2 * Mouse::kPerNotch_m - 100 * Mouse::kPerCount_m});
  EXPECT_EQ(mouse.read().buttons, 0U) << "the right button has its meaning already";
  press(SDL_BUTTON_RIGHT, false);
  move(10, 0);
  expectAt(mouse, {10 * Mouse::kPerCount_m, 0, 2 * Mouse::kPerNotch_m - 100 * Mouse::kPerCount_m});
}

TEST_F(MouseTest, ThePointerIsFreeUntilAClickAndAfterEsc) {
  Mouse mouse({}, kTick_s);
  move(100, 0);
  wheel(1);
  takePointer(mouse);
  move(0, -100);
  expectAt(mouse, {0, 0.01, 0});
  key(SDLK_a);
  move(0, -100);
  expectAt(mouse, {0, 0.02, 0});
  press(SDL_BUTTON_LEFT);
  ASSERT_TRUE(eventually([&] { return mouse.read().buttons == 1; }));
  key(SDLK_ESCAPE);
  EXPECT_TRUE(eventually([&] { return mouse.read().buttons == 0; }));
  move(500, 500);
  click(SDL_BUTTON_MIDDLE);  // takes the pointer again
  expectAt(mouse, {0, 0.02, 0});
}

TEST_F(MouseTest, LosesThePointerToAnotherWindow) {
  Mouse mouse({}, kTick_s);
  takePointer(mouse);
  press(SDL_BUTTON_MIDDLE);
  ASSERT_TRUE(eventually([&] { return mouse.read().buttons == 1U << 1; }));
  window(SDL_WINDOWEVENT_FOCUS_LOST);
  EXPECT_TRUE(eventually([&] { return mouse.read().buttons == 0; }));
  move(500, 500);
  click(SDL_BUTTON_LEFT);
  expectAt(mouse, Vec3::Zero());
}

TEST_F(MouseTest, TheClickThatTakesThePointerIsNoOther) {
  Mouse mouse({}, kTick_s);
  press(SDL_BUTTON_LEFT);
  press(SDL_BUTTON_MIDDLE);
  EXPECT_TRUE(eventually([&] { return mouse.read().buttons == 1U << 1; }));
}

TEST_F(MouseTest, IsLostWhenItsWindowIsClosedAndStandsStill) {
  Mouse mouse({}, kTick_s);
  takePointer(mouse);
  move(100, 0);
  settle(mouse);
  EXPECT_EQ(mouse.problem(), "");
  window(SDL_WINDOWEVENT_CLOSE);
  ASSERT_TRUE(eventually([&] { return mouse.read().state == DeviceState::kLost; }));
  EXPECT_THAT(std::string(mouse.problem()), HasSubstr("window of the mouse was closed: start haptolith again"));
  EXPECT_NEAR(mouse.read().pose.position_m.x(), 0.01, 1e-9);
  EXPECT_EQ(mouse.read().twist.linear_m_s, Vec3::Zero());
}

TEST_F(MouseTest, RubbishKeepsTheToolInItsWorkspaceAndTheMouseAlive) {
  Mouse mouse({}, kTick_s);
  takePointer(mouse);
  for (int i = 0; i < 100; ++i) {
    move(kLargest, -kLargest);
    wheel(std::numeric_limits<float>::quiet_NaN());
    wheel(std::numeric_limits<float>::max());
    press(0);
    press(255);
    SDL_Event event{};
    event.type = SDL_USEREVENT + static_cast<Uint32>(i);
    push(event);
  }
  settle(mouse);
  Vec3 at = mouse.read().pose.position_m;
  EXPECT_TRUE(at.allFinite());
  EXPECT_NEAR(at.norm(), mouse.limits().workspace_radius_m, 1e-9);
  move(0, 100);
  settle(mouse);
  EXPECT_NEAR(mouse.read().pose.position_m.y(), at.y() - 0.01, 1e-8);
}

TEST_F(MouseTest, CanBeOpenedAgainAndAgain) {
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(Mouse({}, kTick_s).read().state, DeviceState::kLive);
  }
}

TEST_F(MouseTest, AllocatesNothingInTheTick) {
  const long before_all = allocationsOfThisThread();
  Mouse mouse({}, kTick_s);
  ASSERT_GT(allocationsOfThisThread(), before_all) << "the counter does not count";
  takePointer(mouse);
  move(100, 100);
  const long before = allocationsOfThisThread();
  for (int i = 0; i < 2000; ++i) {
    (void)mouse.read();
    mouse.write({});
  }
  mouse.releaseForce();
  mouse.resumeForce();
  EXPECT_EQ(allocationsOfThisThread(), before);
}

TEST_F(MouseTest, IsFoundWithADisplay) {
  const std::vector<DeviceReport> found = findMouse({});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].kind, DeviceKind::kMouse);
  EXPECT_TRUE(found[0].usable) << found[0].why_not;
}

TEST_F(MouseTest, SaysWhyItsWindowCannotBeOpened) {
  setenv("SDL_VIDEODRIVER", "no-such-driver", 1);
  EXPECT_THAT([] { Mouse({}, kTick_s); },
              ThrowsMessage<Failure>(testing::AllOf(HasSubstr("cannot open the mouse's window: "),
                                                    HasSubstr("start haptolith in a desktop session"))));
  EXPECT_FALSE(findMouse({})[0].usable);
}

TEST_F(MouseTest, SaysThatThereIsNoDisplay) {
  unsetenv("SDL_VIDEODRIVER");
  if (std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY") != nullptr) {
    GTEST_SKIP() << "this machine has a display";
  }
  EXPECT_THAT([] { Mouse({}, kTick_s); }, ThrowsMessage<Failure>(HasSubstr("no display for the mouse's window")));
  const std::vector<DeviceReport> found = findMouse({});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_FALSE(found[0].usable);
  EXPECT_THAT(found[0].why_not, HasSubstr("none of DISPLAY"));
  EXPECT_THAT(found[0].remedy, HasSubstr("desktop session"));
}

TEST_F(MouseTest, RefusesAnotherId) {
  DeviceParameters parameters;
  parameters.id = "1";
  EXPECT_THROW(Mouse(parameters, kTick_s), InvalidParameter);
}

TEST_F(MouseTest, ShowsNoForceAndKnowsNoTurn) {
  const DeviceLimits limits = Mouse({}, kTick_s).limits();
  EXPECT_EQ(limits.max_force_n, 0);
  EXPECT_EQ(limits.max_torque_nm, 0);
  EXPECT_EQ(limits.max_gripper_force_n, 0);
  EXPECT_FALSE(limits.turns);
}

}  // namespace
}  // namespace haptolith
