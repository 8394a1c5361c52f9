#pragma once

#include <filesystem>
#include <string_view>

#include "haptolith/core/files/atomic_file.h"

namespace haptolith {

/// A folder that appears with all its files or not at all: made next to its name, renamed on commit(), removed
/// otherwise. Not for the tick.
class AtomicFolder {
 public:
  /// @param if_there  whether commit() may take the place of a folder that is there.
  /// @throws Failure when there is something of that name that may not be replaced, or when it cannot be made.
  explicit AtomicFolder(const std::filesystem::path& path, IfThere if_there = IfThere::kRefuse,
                        Readers readers = Readers::kAsUsual);
  ~AtomicFolder();
  AtomicFolder(const AtomicFolder&) = delete;
  AtomicFolder& operator=(const AtomicFolder&) = delete;

  /// Writes a file and creates its parent folders.
  /// @throws Failure with the path and the system's reason; for a name that leads out of the folder, or is taken.
  void write(const std::filesystem::path& name, std::string_view bytes) const;

  /// Path of the folder until commit(); a library that needs a path may write there.
  [[nodiscard]] const std::filesystem::path& makingPath() const noexcept { return making_; }
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

  /// Nothing may be written afterwards. @throws Failure as write().
  void commit() const;

 private:
  std::filesystem::path path_, making_;
  IfThere if_there_;
  Readers readers_;
};

}  // namespace haptolith
