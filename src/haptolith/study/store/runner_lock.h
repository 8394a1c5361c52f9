#pragma once

#include <filesystem>

namespace haptolith {

/// Sees to it that one process at a time runs a study: an open-file-description lock on FILE-lock, which the system
/// frees when the process ends, however that comes. The file stays; it holds the process's number.
class RunnerLock {
 public:
  /// @throws Failure when another one holds it, or when the file cannot be made.
  explicit RunnerLock(const std::filesystem::path& study);
  ~RunnerLock();
  RunnerLock(const RunnerLock&) = delete;
  RunnerLock& operator=(const RunnerLock&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace haptolith
