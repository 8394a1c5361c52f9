#pragma once

namespace haptolith {

/// Number of calls of operator new by this thread. Every call in this program counts.
[[nodiscard]] long allocationsOfThisThread() noexcept;

}  // namespace haptolith
