#pragma once

#include <atomic>

namespace haptolith {

/// Whether somebody wants the work to end, by Ctrl-C for example; long work looks at it now and then.
[[nodiscard]] std::atomic<bool>& stopAsked() noexcept;

/// @throws Failure "interrupted" when stopAsked().
void throwIfStopped();

}  // namespace haptolith
