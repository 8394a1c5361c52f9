#pragma once

#include "haptolith/core/stop_asked.h"

namespace haptolith {

/// Signal handler for a clean stop: from its construction Ctrl-C, SIGTERM and SIGHUP (a closed terminal, unless started
/// by nohup) set stopAsked(), also repeatedly.
class StopOnSignal {
 public:
  StopOnSignal();
};

}  // namespace haptolith
