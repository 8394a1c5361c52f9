#include "shared/stop_on_signal.h"

#include <csignal>

namespace haptolith {

StopOnSignal::StopOnSignal() {
  stopAsked() = false;  // also creates the flag before a signal can arrive
  struct sigaction action {};
  action.sa_handler = [](int) { stopAsked() = true; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  struct sigaction before {};
  if (sigaction(SIGHUP, nullptr, &before) == 0 && before.sa_handler != SIG_IGN) {  // nohup ignores it
    sigaction(SIGHUP, &action, nullptr);
  }
}

}  // namespace haptolith
