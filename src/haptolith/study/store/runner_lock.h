#pragma once

#include <filesystem>

namespace haptolith {

/// Lock that allows one process at a time to run a study: an open-file-description lock on FILE-lock. The system frees
/// it at any end of the process. The file remains and contains the process's number.
class RunnerLock {
 public:
  /// @throws Failure if another process holds the lock, or if the file cannot be made.
  explicit RunnerLock(const std::filesystem::path& study);
  ~RunnerLock();
  RunnerLock(const RunnerLock&) = delete;
  RunnerLock& operator=(const RunnerLock&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace haptolith
