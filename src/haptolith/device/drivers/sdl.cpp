#include "haptolith/device/drivers/sdl.h"

#include <fmt/format.h>

#include <mutex>
#include <string>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

/// SDL's counting of who wants what is not made for threads.
std::mutex counting;

}  // namespace

const Sdl& Sdl::get() {
  try {
    static const Sdl& sdl = *new Sdl;  // for ever
    return sdl;
  } catch (const Failure& failure) {
    throw Failure(fmt::format("{}; install SDL 2: sudo apt-get install libsdl2-2.0-0", failure.what()));
  }
}

SdlPart::SdlPart(Uint32 part) : sdl_(Sdl::get()), part_(part) {
  const std::lock_guard lock(counting);
  sdl_.set_hint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");                // Ctrl-C is ours
  sdl_.set_hint(SDL_HINT_JOYSTICK_ALLOW_BACKGROUND_EVENTS, "1");  // there may be no window, or the browser's in front
  sdl_.set_hint(SDL_HINT_MOUSE_FOCUS_CLICKTHROUGH, "1");  // the click that brings the window to the front counts
  if (sdl_.init_sub_system(part) != 0) {
    const std::string reason = sdl_.get_error();
    sdl_.tls_cleanup();
    throw Failure(reason);
  }
}

SdlPart::~SdlPart() {
  const std::lock_guard lock(counting);
  sdl_.quit_sub_system(part_);
  sdl_.tls_cleanup();  // the last error of this thread, which SDL does not know to end
}

}  // namespace haptolith
