#pragma once

#include <cstdio>
#include <filesystem>
#include <string_view>

namespace haptolith {

/// A file that appears whole or not at all: written beside its name, renamed on commit(), removed otherwise.
/// Not for the tick.
class AtomicFile {
 public:
  /// @throws Failure when the folder does not exist or cannot be written.
  explicit AtomicFile(std::filesystem::path path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// @throws Failure with the path and the system's reason, for example a full disk.
  void write(std::string_view text);

  /// Flushes to the disk and renames. Nothing may be written afterwards. @throws Failure as write().
  void commit();

  /// Where the bytes are until commit(); other programs (gnuplot) may write there.
  [[nodiscard]] const std::filesystem::path& temporaryPath() const noexcept { return temporary_; }

 private:
  [[noreturn]] void fail(const char* what) const;

  std::filesystem::path path_, temporary_;
  std::FILE* file_ = nullptr;
};

}  // namespace haptolith
