#pragma once

#include <filesystem>

#include "haptolith/core/platform/locks.h"

namespace haptolith {

/// Lock that allows one process at a time to run a study: a lock on FILE-lock. The system frees it at any end of the
/// process.
class RunnerLock {
 public:
  /// @throws Failure if another process holds the lock, or if the file cannot be made.
  explicit RunnerLock(const std::filesystem::path& study);

 private:
  FileLock lock_;
};

}  // namespace haptolith
