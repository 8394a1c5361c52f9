#pragma once

#include <SDL.h>

#include "haptolith/core/platform/shared_library.h"

namespace haptolith {

/// The functions of SDL 2 that drivers call. Linked, SDL and the fifty libraries that come with it would cost every
/// start of the program 10 ms; so it is loaded when a gamepad or a mouse is wanted, and then kept, because some of
/// its libraries do not like to be unloaded. Not for the tick.
struct Sdl {
  /// @throws Failure with the command that installs SDL.
  static const Sdl& get();

  SharedLibrary library{"libSDL2-2.0.so.0"};

  decltype(&SDL_InitSubSystem) init_sub_system = library.symbol("SDL_InitSubSystem");
  decltype(&SDL_QuitSubSystem) quit_sub_system = library.symbol("SDL_QuitSubSystem");
  decltype(&SDL_SetHint) set_hint = library.symbol("SDL_SetHint");
  decltype(&SDL_GetError) get_error = library.symbol("SDL_GetError");
  decltype(&SDL_TLSCleanup) tls_cleanup = library.symbol("SDL_TLSCleanup");

  decltype(&SDL_NumJoysticks) num_joysticks = library.symbol("SDL_NumJoysticks");
  decltype(&SDL_JoystickNameForIndex) joystick_name_for_index = library.symbol("SDL_JoystickNameForIndex");
  decltype(&SDL_JoystickGetDeviceGUID) joystick_get_device_guid = library.symbol("SDL_JoystickGetDeviceGUID");
  decltype(&SDL_IsGameController) is_game_controller = library.symbol("SDL_IsGameController");
  decltype(&SDL_GameControllerOpen) game_controller_open = library.symbol("SDL_GameControllerOpen");
  decltype(&SDL_GameControllerClose) game_controller_close = library.symbol("SDL_GameControllerClose");
  decltype(&SDL_GameControllerUpdate) game_controller_update = library.symbol("SDL_GameControllerUpdate");
  decltype(&SDL_GameControllerGetAttached) game_controller_get_attached =
      library.symbol("SDL_GameControllerGetAttached");
  decltype(&SDL_GameControllerGetAxis) game_controller_get_axis = library.symbol("SDL_GameControllerGetAxis");
  decltype(&SDL_GameControllerGetButton) game_controller_get_button = library.symbol("SDL_GameControllerGetButton");
  decltype(&SDL_GameControllerRumble) game_controller_rumble = library.symbol("SDL_GameControllerRumble");
  decltype(&SDL_FlushEvents) flush_events = library.symbol("SDL_FlushEvents");

  decltype(&SDL_CreateWindow) create_window = library.symbol("SDL_CreateWindow");
  decltype(&SDL_DestroyWindow) destroy_window = library.symbol("SDL_DestroyWindow");
  decltype(&SDL_SetWindowTitle) set_window_title = library.symbol("SDL_SetWindowTitle");
  decltype(&SDL_GetWindowSurface) get_window_surface = library.symbol("SDL_GetWindowSurface");
  decltype(&SDL_FillRect) fill_rect = library.symbol("SDL_FillRect");
  decltype(&SDL_UpdateWindowSurface) update_window_surface = library.symbol("SDL_UpdateWindowSurface");
  decltype(&SDL_SetRelativeMouseMode) set_relative_mouse_mode = library.symbol("SDL_SetRelativeMouseMode");
  decltype(&SDL_WaitEventTimeout) wait_event_timeout = library.symbol("SDL_WaitEventTimeout");
};

/// A part of SDL, for as long as this lives. SDL counts its users and cleans up after the last. To be
/// destroyed by the thread that has used it.
class SdlPart {
 public:
  /// @param part  SDL_INIT_VIDEO or SDL_INIT_GAMECONTROLLER. @throws Failure with SDL's reason, or as Sdl::get().
  explicit SdlPart(Uint32 part);
  ~SdlPart();
  SdlPart(const SdlPart&) = delete;
  SdlPart& operator=(const SdlPart&) = delete;

 private:
  const Sdl& sdl_;
  Uint32 part_;
};

}  // namespace haptolith
