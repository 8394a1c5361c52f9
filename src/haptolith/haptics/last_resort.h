#pragma once

#include "haptolith/device/haptic_device.h"

namespace haptolith {

/// As long as it lives, a crash of the program (a signal that ends it: SIGSEGV, SIGABRT with std::terminate(), SIGFPE,
/// SIGHUP, ...) lets go of the hand before the program dies. Only SIGKILL and power cuts pass it by: there the
/// device's own watchdog has to do it. One at a time; a second one takes over from the first until it goes.
class LastResort {
 public:
  explicit LastResort(HapticDevice& device) noexcept;
  ~LastResort();
  LastResort(const LastResort&) = delete;
  LastResort& operator=(const LastResort&) = delete;

 private:
  HapticDevice* before_;
};

}  // namespace haptolith
