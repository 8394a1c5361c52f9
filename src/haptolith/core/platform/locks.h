#pragma once

#include <filesystem>
#include <string>

#include "haptolith/core/platform/descriptor.h"

namespace haptolith {

/// A folder that one process at a time may hold, until this object or the process ends. Not for the tick.
class FolderLock {
 public:
  FolderLock() = default;
  /// @throws Failure when the folder cannot be opened.
  explicit FolderLock(const std::filesystem::path& folder);

  /// Whether no other process holds it.
  [[nodiscard]] bool held() const noexcept { return held_; }

 private:
  Descriptor file_;
  bool held_ = false;
};

/// A file that one process at a time may hold, until this object or the process ends; made if it is missing. It remains
/// and has the number of the process that holds it, or held it last. Not for the tick.
class FileLock {
 public:
  /// @throws Failure when the file cannot be opened or locked.
  explicit FileLock(const std::filesystem::path& file);

  /// Whether no other process holds it.
  [[nodiscard]] bool held() const noexcept { return held_; }

  /// Number of the other process that holds it; empty if it is unknown.
  [[nodiscard]] const std::string& holder() const noexcept { return holder_; }

 private:
  Descriptor file_;
  bool held_ = false;
  std::string holder_;
};

}  // namespace haptolith
