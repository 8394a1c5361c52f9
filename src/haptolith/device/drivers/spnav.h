#pragma once

#include <spnav.h>

#include "haptolith/core/platform/shared_library.h"

namespace haptolith {

/// The functions of libspnav that the SpaceMouse's driver calls. It is loaded by the search for a SpaceMouse, and
/// then kept: linked, it would bring X11 to every program that holds haptolith. Not for the tick.
struct Spnav {
  /// @throws Failure with the command that installs libspnav.
  static const Spnav& get();

  SharedLibrary library{"libspnav.so.0"};

  decltype(&spnav_open) open = library.symbol("spnav_open");
  decltype(&spnav_close) close = library.symbol("spnav_close");
  decltype(&spnav_fd) fd = library.symbol("spnav_fd");
  decltype(&spnav_poll_event) poll_event = library.symbol("spnav_poll_event");
  decltype(&spnav_protocol) protocol = library.symbol("spnav_protocol");
  decltype(&spnav_dev_type) dev_type = library.symbol("spnav_dev_type");
};

}  // namespace haptolith
