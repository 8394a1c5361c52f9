#include "haptolith/core/platform/sleep_while.h"

#include <windows.h>

namespace haptolith {

void sleepWhileEqual(const void* address, const void* old, std::size_t bytes) noexcept {
  WaitOnAddress(const_cast<void*>(address), const_cast<void*>(old), bytes, INFINITE);
}

void wakeThoseAt(const void* address) noexcept {
  WakeByAddressAll(const_cast<void*>(address));
}

}  // namespace haptolith
