#pragma once

#include <string>

namespace haptolith {

/// What the system granted to the calling thread.
struct RealTime {
  std::string scheduler = "SCHED_OTHER";  ///< "SCHED_FIFO" when granted
  bool memory_locked = false;
  std::string advice;  ///< empty when all was granted; else one line that says what is missing and how to get it
};

/// Asks for SCHED_FIFO and locked memory for the calling thread and tells what came of it. Call before the first tick.
[[nodiscard]] RealTime requestRealTime();

}  // namespace haptolith
