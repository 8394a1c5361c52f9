#pragma once

namespace haptolith {

/// How often this thread has called operator new. Every call in this program counts.
[[nodiscard]] long allocationsOfThisThread() noexcept;

}  // namespace haptolith
