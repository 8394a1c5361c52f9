#pragma once

#include "haptolith/core/process/stop_asked.h"

namespace haptolith {

/// From here on Ctrl-C, SIGTERM and SIGHUP (a closed terminal, unless nohup has started the program) end the work in
/// good order, however often they come: they set stopAsked().
class StopOnSignal {
 public:
  StopOnSignal();
};

}  // namespace haptolith
