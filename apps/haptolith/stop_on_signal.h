#pragma once

#include <atomic>

namespace haptolith {

/// Whether somebody wants the work to end; long work looks at it now and then.
[[nodiscard]] std::atomic<bool>& stopAsked() noexcept;

/// From here on Ctrl-C and SIGTERM end the work in good order, however often they come: they set stopAsked().
class StopOnSignal {
 public:
  StopOnSignal();
};

}  // namespace haptolith
