#pragma once

#include <atomic>

namespace haptolith {

/// Whether the work should end, after Ctrl-C for example; long work polls it.
[[nodiscard]] std::atomic<bool>& stopAsked() noexcept;

/// @throws Failure "interrupted" when stopAsked().
void throwIfStopped();

}  // namespace haptolith
