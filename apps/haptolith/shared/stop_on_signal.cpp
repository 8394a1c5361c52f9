#include "shared/stop_on_signal.h"

#include <csignal>

namespace haptolith {

StopOnSignal::StopOnSignal() {
  stopAsked() = false;  // made before a signal can come, as well
  struct sigaction action {};
  action.sa_handler = [](int) { stopAsked() = true; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

}  // namespace haptolith
