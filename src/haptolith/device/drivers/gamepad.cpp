#include "haptolith/device/drivers/gamepad.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/platform/clock.h"
#include "haptolith/device/drivers/sdl.h"

namespace haptolith {

namespace {

using namespace std::chrono_literals;

/// Polling period of the pad. Pads update at 125 to 1000 Hz; SteeredHandle smooths the steps.
constexpr auto kGamepadPeriod = 4ms;

/// Rumble ends unless it is renewed, also when this program ends. It is renewed this often: a pad on Bluetooth
/// has no room for much more.
constexpr Uint32 kRumble_ms = 150;
constexpr std::int64_t kRumbleRenewal_ns = 50'000'000;

/// Time without a force from the loop after which it counts as hung, and the pad is released.
constexpr std::int64_t kLoopHangs_ns = 100'000'000;

/// Period of the search for a lost pad.
constexpr std::int64_t kLookAgain_ns = 500'000'000;

constexpr std::string_view kGamepadRemedy =
    "plug one in or switch it on (a wireless one: pair it with the system first); `haptolith devices` lists what is "
    "found";

struct Found {
  int index;  ///< SDL's, of joysticks
  std::string name;
};

std::string orUnnamed(const char* name, std::string_view otherwise) {
  return name != nullptr ? name : std::string(otherwise);
}

std::vector<Found> gamepads(const Sdl& sdl) {
  std::vector<Found> found;
  for (int i = 0; i < sdl.num_joysticks(); ++i) {
    if (sdl.is_game_controller(i) == SDL_TRUE) {
      found.push_back({i, orUnnamed(sdl.joystick_name_for_index(i), "gamepad")});
    }
  }
  return found;
}

Found choose(const std::vector<Found>& found, const std::string& id) {
  if (found.empty()) {
    throw Failure(fmt::format("no gamepad: SDL 2 finds none; {}", kGamepadRemedy));
  }
  std::string there;
  for (std::size_t number = 0; number < found.size(); ++number) {
    if (id.empty() || id == std::to_string(number) || id == found[number].name) {
      return found[number];
    }
    there += fmt::format("{}{} ({})", number == 0 ? "" : ", ", number, found[number].name);
  }
  throw Failure(fmt::format("no gamepad '{}': available are {}; use a number or a name", id, there));
}

}  // namespace

Twist speedOf(const PadSticks& sticks) noexcept {
  constexpr RateParameters kRate{.dead_zone = 0.15};  // worn sticks rest that far from the middle
  // Right-handed: about x the far side goes up, about y the right side goes down, about z from right to far.
  const Deflection stick{
      .linear = {sticks.left_right, -sticks.left_towards, 0},
      .angular = {sticks.right_towards, sticks.roll ? sticks.right_right : 0, sticks.roll ? 0 : -sticks.right_right}};
  const Deflection trigger{.linear = {0, 0, sticks.raise ? sticks.left_trigger : -sticks.left_trigger}};
  Twist speed = rateOf(stick, kRate);
  speed.linear_m_s += rateOf(trigger, kRate).linear_m_s;
  return speed;
}

/// The pad as SDL knows it. Made by the constructor, then used by the device's thread alone.
class Gamepad::Pad {
 public:
  explicit Pad(const std::string& id) {
    const Found found = choose(gamepads(sdl_), id);
    name_ = found.name;
    guid_ = sdl_.joystick_get_device_guid(found.index);
    pad_ = sdl_.game_controller_open(found.index);
    if (pad_ == nullptr) {
      throw Failure(fmt::format("cannot open the gamepad {}: {}; is the user allowed to read /dev/input?", name_,
                                sdl_.get_error()));
    }
  }
  ~Pad() { close(); }
  Pad(const Pad&) = delete;
  Pad& operator=(const Pad&) = delete;

  [[nodiscard]] const std::string& name() const noexcept { return name_; }

  [[nodiscard]] Told ask(std::int64_t now_ns) {
    sdl_.game_controller_update();
    sdl_.flush_events(SDL_JOYAXISMOTION, SDL_FINGERDOWN - 1);  // states are polled: these events are unused
    if (pad_ != nullptr && sdl_.game_controller_get_attached(pad_) == SDL_FALSE) {
      close();
    }
    if (pad_ == nullptr && now_ns >= next_look_ns_) {
      next_look_ns_ = now_ns + kLookAgain_ns;
      openAgain();
    }
    Told told;
    told.connected = pad_ != nullptr;
    if (told.connected) {
      told.speed = speedOf({.left_right = axis(SDL_CONTROLLER_AXIS_LEFTX),
                            .left_towards = axis(SDL_CONTROLLER_AXIS_LEFTY),
                            .right_right = axis(SDL_CONTROLLER_AXIS_RIGHTX),
                            .right_towards = axis(SDL_CONTROLLER_AXIS_RIGHTY),
                            .left_trigger = axis(SDL_CONTROLLER_AXIS_TRIGGERLEFT),
                            .raise = isDown(SDL_CONTROLLER_BUTTON_LEFTSHOULDER),
                            .roll = isDown(SDL_CONTROLLER_BUTTON_RIGHTSHOULDER)});
      told.gripper_open = std::clamp(1 - axis(SDL_CONTROLLER_AXIS_TRIGGERRIGHT), 0.0, 1.0);
      for (int button = 0; button < SDL_CONTROLLER_BUTTON_MAX; ++button) {
        told.buttons |= isDown(static_cast<SDL_GameControllerButton>(button)) ? 1U << button : 0U;
      }
    }
    return told;
  }

  /// Both motors: the small one is felt first, the large one is stronger.
  void rumble(double share, std::int64_t now_ns) {
    constexpr int kSteps = 64;  // more cannot be discriminated, and need not be sent
    const int step = static_cast<int>(std::lround(share * kSteps));
    const bool renew = step > 0 && now_ns >= rumbled_ns_ + kRumbleRenewal_ns;
    const bool differs = step != rumble_step_ && (step == 0 || now_ns >= rumbled_ns_ + kRumbleRenewal_ns / 5);
    if (pad_ == nullptr || (!renew && !differs)) {
      return;
    }
    const auto strength = static_cast<Uint16>(step * 0xFFFF / kSteps);
    sdl_.game_controller_rumble(pad_, strength, strength, step == 0 ? 0 : kRumble_ms);  // a pad without motors: -1
    rumble_step_ = step;
    rumbled_ns_ = now_ns;
  }

 private:
  [[nodiscard]] double axis(SDL_GameControllerAxis axis) const {
    return std::max(-1.0, sdl_.game_controller_get_axis(pad_, axis) / 32767.0);
  }
  [[nodiscard]] bool isDown(SDL_GameControllerButton button) const {
    return sdl_.game_controller_get_button(pad_, button) != 0;
  }

  /// Opens the same model again, on any port.
  void openAgain() {
    for (const Found& found : gamepads(sdl_)) {
      const SDL_JoystickGUID guid = sdl_.joystick_get_device_guid(found.index);
      if (std::equal(std::begin(guid.data), std::end(guid.data), std::begin(guid_.data))) {
        pad_ = sdl_.game_controller_open(found.index);
        rumble_step_ = 0;
        return;
      }
    }
  }

  void close() {
    if (pad_ != nullptr) {
      sdl_.game_controller_rumble(pad_, 0, 0, 0);
      sdl_.game_controller_close(std::exchange(pad_, nullptr));
    }
  }

  const Sdl& sdl_ = Sdl::get();
  SdlPart part_{SDL_INIT_GAMECONTROLLER};
  std::string name_;
  SDL_JoystickGUID guid_{};
  SDL_GameController* pad_ = nullptr;
  std::int64_t next_look_ns_ = 0, rumbled_ns_ = 0;
  int rumble_step_ = 0;
};

Gamepad::Gamepad(const DeviceParameters& parameters, double tick_s) : handle_(tick_s) {
  auto pad = std::make_unique<Pad>(parameters.id);
  name_ = pad->name();
  problem_ = fmt::format("the gamepad {} is disconnected: connect it or switch it on to continue", name_);
  thread_ = std::jthread([this, pad = std::move(pad)](const std::stop_token& stop) { serve(stop, *pad); });
}

Gamepad::~Gamepad() = default;

DeviceLimits Gamepad::limits() const noexcept {
  DeviceLimits limits = SteeredHandle::limits();
  limits.max_force_n = kFullRumble_n;
  limits.grips = true;
  limits.rate_hz = 1000.0 / kGamepadPeriod.count();
  return limits;
}

DeviceInput Gamepad::read() noexcept {
  told_.update();
  const Told& told = told_.latest();
  const Movement& handle = handle_.drive(told.speed);
  return {.pose = handle.pose,
          .twist = handle.twist,
          .gripper_open = told.gripper_open,
          .buttons = told.buttons,
          .state = told.connected ? DeviceState::kLive : DeviceState::kStale};
}

void Gamepad::write(const DeviceOutput& output) noexcept {
  force_n_.store(output.wrench.force_n.norm(), std::memory_order_relaxed);
  writes_.fetch_add(1, std::memory_order_relaxed);
}

std::string_view Gamepad::problem() const noexcept {
  return connected_.load(std::memory_order_relaxed) ? std::string_view{} : problem_;
}

double Gamepad::rumbleShare(std::int64_t now_ns) noexcept {
  if (const std::uint64_t writes = writes_.load(std::memory_order_relaxed); writes != writes_seen_) {
    writes_seen_ = writes;
    last_write_ns_ = now_ns;
  }
  const double share = force_n_.load(std::memory_order_relaxed) / kFullRumble_n;
  const bool quiet =
      released_.load(std::memory_order_relaxed) || now_ns > last_write_ns_ + kLoopHangs_ns || !std::isfinite(share);
  return quiet ? 0 : std::min(1.0, share);
}

void Gamepad::serve(const std::stop_token& stop, Pad& pad) {
  while (!stop.stop_requested()) {
    const std::int64_t now_ns = monotonicNs();
    told_.draft() = pad.ask(now_ns);
    connected_.store(told_.draft().connected, std::memory_order_relaxed);
    told_.publish();
    pad.rumble(rumbleShare(now_ns), now_ns);
    std::this_thread::sleep_for(kGamepadPeriod);
  }
}

std::vector<DeviceReport> findGamepads(const DeviceParameters&) {
  DeviceReport report;
  report.kind = DeviceKind::kGamepad;
  report.name = "gamepad";
  std::vector<DeviceReport> reports;
  try {
    const SdlPart part(SDL_INIT_GAMECONTROLLER);
    for (const Found& found : gamepads(Sdl::get())) {
      report.name = found.name;
      report.id = std::to_string(reports.size());
      report.usable = true;
      reports.push_back(report);
    }
    report.why_not = "SDL 2 finds no gamepad";
    report.remedy = kGamepadRemedy;
  } catch (const Failure& failure) {
    report.why_not = failure.what();
    report.remedy = "sudo apt-get install libsdl2-2.0-0";
  }
  if (reports.empty()) {
    reports.push_back(report);
  }
  return reports;
}

}  // namespace haptolith
