#pragma once

#include <filesystem>

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

}  // namespace haptolith
