#include "shared/stop_on_signal.h"

#include "haptolith/core/platform/this_program.h"

namespace haptolith {

StopOnSignal::StopOnSignal() {
  stopAsked() = false;  // also creates the flag before a signal can arrive
  onEndAsked([] { stopAsked() = true; });
}

}  // namespace haptolith
