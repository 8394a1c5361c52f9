#include "haptolith/device/drivers/mouse.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <optional>

#include "haptolith/core/error.h"
#include "haptolith/device/drivers/sdl.h"

namespace haptolith {

namespace {

constexpr const char* kFreeTitle = "haptolith mouse";
constexpr const char* kTakenTitle = "haptolith mouse: Esc gives the pointer back";

/// Limit of one wheel movement; larger sums would lose precision.
constexpr float kMaxNotches = 100;

/// Time for which the window's thread waits for an event before it checks whether it should end.
constexpr int kMouseWait_ms = 20;

constexpr std::string_view kMouseRemedy = "start haptolith in a desktop session, or over `ssh -X`";

/// SDL without a display, left to itself, may take the whole console for its window.
void requireDisplay() {
  const auto is_set = [](const char* name) {
    const char* const value = std::getenv(name);
    return value != nullptr && *value != '\0';
  };
  if (!is_set("DISPLAY") && !is_set("WAYLAND_DISPLAY") && !is_set("SDL_VIDEODRIVER")) {
    throw Failure("no display for the mouse's window: none of DISPLAY, WAYLAND_DISPLAY and SDL_VIDEODRIVER is set");
  }
}

constexpr std::uint32_t bitOf(Uint8 button) noexcept {
  return button >= 1 && button <= 32 ? 1U << (button - 1) : 0;
}

}  // namespace

/// The window as SDL knows it. Video wants to be made, asked and ended by one thread.
class Mouse::Window {
 public:
  Window() {
    constexpr int kWidth = 320;
    constexpr int kHeight = 240;
    window_ = sdl_.create_window(kFreeTitle, SDL_WINDOWPOS_UNDEFINED, SDL_WINDOWPOS_UNDEFINED, kWidth, kHeight, 0);
    if (window_ == nullptr) {
      throw Failure(sdl_.get_error());
    }
    paint();
  }
  ~Window() {
    sdl_.set_relative_mouse_mode(SDL_FALSE);
    sdl_.destroy_window(window_);
  }
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Waits a little for an event; whether there was one.
  [[nodiscard]] bool wait(SDL_Event& event) { return sdl_.wait_event_timeout(&event, kMouseWait_ms) != 0; }

  void take(const SDL_Event& event, Told& told) {
    switch (event.type) {
      case SDL_MOUSEMOTION:
        if (taken_) {
          push(event.motion.xrel, event.motion.yrel, told);
        }
        break;
      case SDL_MOUSEWHEEL:
        if (taken_ && std::isfinite(event.wheel.preciseY)) {
          const double away = event.wheel.direction == SDL_MOUSEWHEEL_FLIPPED ? -1 : 1;
          told.pushed_m.z() += kPerNotch_m * away * std::clamp(event.wheel.preciseY, -kMaxNotches, kMaxNotches);
        }
        break;
      case SDL_MOUSEBUTTONDOWN: press(event.button.button, told); break;
      case SDL_MOUSEBUTTONUP:
        told.buttons &= ~bitOf(event.button.button);
        lifts_ = lifts_ && event.button.button != SDL_BUTTON_RIGHT;
        break;
      case SDL_KEYDOWN:
        if (event.key.keysym.sym == SDLK_ESCAPE) {
          hold(false, told);
        }
        break;
      case SDL_WINDOWEVENT:
        if (event.window.event == SDL_WINDOWEVENT_FOCUS_LOST) {
          hold(false, told);
        } else if (event.window.event == SDL_WINDOWEVENT_EXPOSED) {
          paint();
        } else if (event.window.event == SDL_WINDOWEVENT_CLOSE) {
          close(told);
        }
        break;
      case SDL_QUIT: close(told); break;
      default: break;
    }
  }

 private:
  /// SDL counts to the right and towards the user.
  void push(Sint32 right, Sint32 towards, Told& told) const {
    told.pushed_m += kPerCount_m * (lifts_ ? Vec3(0, 0, -towards) : Vec3(right, -1.0 * towards, 0));
  }

  void press(Uint8 button, Told& told) {
    if (!taken_) {
      hold(true, told);  // the click that takes the pointer is no other click
    } else if (button == SDL_BUTTON_RIGHT) {
      lifts_ = true;
    } else {
      told.buttons |= bitOf(button);
    }
  }

  void hold(bool taken, Told& told) {
    taken_ = taken;
    lifts_ = false;
    told.buttons = 0;
    sdl_.set_relative_mouse_mode(taken ? SDL_TRUE : SDL_FALSE);
    sdl_.set_window_title(window_, taken ? kTakenTitle : kFreeTitle);
  }

  void close(Told& told) {
    hold(false, told);
    told.closed = true;
  }

  /// A window without a picture is not shown by Wayland.
  void paint() {
    if (SDL_Surface* const surface = sdl_.get_window_surface(window_)) {
      constexpr Uint32 kDarkGrey = 0x303030;
      sdl_.fill_rect(surface, nullptr, kDarkGrey);
      sdl_.update_window_surface(window_);
    }
  }

  const Sdl& sdl_ = Sdl::get();
  SdlPart part_{SDL_INIT_VIDEO};
  SDL_Window* window_ = nullptr;
  bool taken_ = false, lifts_ = false;
};

Mouse::Mouse(const DeviceParameters& parameters, double tick_s) : handle_(tick_s) {
  if (!parameters.id.empty() && parameters.id != "0") {
    throw InvalidParameter("id", fmt::format("'{}'", parameters.id), "empty or 0: a system has one pointer");
  }
  requireDisplay();
  std::promise<void> opened;
  thread_ = std::jthread([this, &opened](const std::stop_token& stop) { serve(stop, opened); });
  opened.get_future().get();
}

DeviceLimits Mouse::limits() const noexcept {
  DeviceLimits limits = SteeredHandle::limits();
  limits.turns = false;
  return limits;
}

DeviceInput Mouse::read() noexcept {
  told_.update();
  const Told& told = told_.latest();
  const Movement& handle = handle_.displace(told.pushed_m - seen_m_);
  seen_m_ = told.pushed_m;
  return {.pose = handle.pose,
          .twist = handle.twist,
          .buttons = told.buttons,
          .state = told.closed ? DeviceState::kLost : DeviceState::kLive};
}

std::string_view Mouse::problem() const noexcept {
  return closed_.load(std::memory_order_relaxed) ? "the window of the mouse was closed: start haptolith again"
                                                 : std::string_view{};
}

void Mouse::serve(const std::stop_token& stop, std::promise<void>& opened) {
  std::optional<Window> window;
  try {
    window.emplace();
  } catch (const Failure& failure) {
    opened.set_exception(std::make_exception_ptr(
        Failure(fmt::format("cannot open the mouse's window: {}; {}", failure.what(), kMouseRemedy))));
    return;
  }
  opened.set_value();  // the promise is gone from here on

  Told told;
  SDL_Event event;
  while (!stop.stop_requested() && !told.closed) {
    if (window->wait(event)) {
      window->take(event, told);
      closed_.store(told.closed, std::memory_order_relaxed);
      told_.draft() = told;
      told_.publish();
    }
  }
}

std::vector<DeviceReport> findMouse(const DeviceParameters&) {
  DeviceReport report{
      .kind = DeviceKind::kMouse, .name = "mouse", .id = "0", .usable = true, .why_not = {}, .remedy = {}};
  try {
    requireDisplay();
    const SdlPart part(SDL_INIT_VIDEO);
  } catch (const Failure& failure) {
    report.usable = false;
    report.why_not = failure.what();
    report.remedy = kMouseRemedy;
  }
  return {report};
}

}  // namespace haptolith
