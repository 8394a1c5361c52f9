#include "haptolith/core/process/stop_asked.h"

namespace haptolith {

std::atomic<bool>& stopAsked() noexcept {
  static std::atomic<bool> asked{false};
  return asked;
}

}  // namespace haptolith
