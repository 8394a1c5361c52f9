#include "haptolith/core/stop_asked.h"

#include "haptolith/core/error.h"

namespace haptolith {

std::atomic<bool>& stopAsked() noexcept {
  static std::atomic<bool> asked{false};
  return asked;
}

void throwIfStopped() {
  if (stopAsked()) {
    throw Failure("interrupted");
  }
}

}  // namespace haptolith
