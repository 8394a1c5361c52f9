#pragma once

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <string_view>
#include <type_traits>
#include <vector>

namespace haptolith {

/// Policy for a file that already has the name. Replacing one needs the user's consent: the option --overwrite.
enum class IfThere { kRefuse, kReplace };

/// Readers of the written file: all that the umask allows, or the owner alone.
enum class Readers { kAsUsual, kOwner };

/// The name of a file to be written, and how.
struct OutputFile {
  template <class Path>
  requires std::is_convertible_v<Path, std::filesystem::path>
  // NOLINTNEXTLINE(google-explicit-constructor): a bare path means: do not overwrite
  OutputFile(const Path& where, IfThere if_it_is_there = IfThere::kRefuse, Readers who = Readers::kAsUsual)
      : path(where), if_there(if_it_is_there), readers(who) {}

  std::filesystem::path path;
  IfThere if_there;
  Readers readers;
};

/// "a recording" (HDF5) or "a study" (SQLite) when a file begins like one: both cannot be made again. Empty
/// for any other.
[[nodiscard]] std::string_view irreplaceable(const std::filesystem::path& path);

/// @throws Failure when `file` may not be written: it is there and may not be replaced; it is a recording or a study,
/// which no other kind of file ever replaces; this program has read it (input_file.h); it is write-protected; it is not
/// a regular file.
void requireFree(const OutputFile& file);

/// The most that file systems take for a name, without its folder.
inline constexpr std::size_t kLongestName_bytes = 255;

/// "x-3f2a...9c" next to `path`, hidden, with its extension: an unguessable name.
/// @param longest_bytes  limit of the name's length, where another program adds an ending to it.
[[nodiscard]] std::filesystem::path temporaryBeside(const std::filesystem::path& path, std::string_view what,
                                                    std::size_t longest_bytes = kLongestName_bytes);

/// Makes an empty file that was not there, and that no link leads to. @return its descriptor. @throws Failure.
[[nodiscard]] int makeNewFile(const std::filesystem::path& path, Readers readers);

/// Gives a file or a folder that is whole its name, and the name to the disk; with kRefuse only when nothing has the
/// name by then. @throws Failure.
void giveName(const std::filesystem::path& made, const std::filesystem::path& name, IfThere if_there);

/// Remembers that this program has written a file or a folder, to list them for the user at the end (giveName() does
/// so).
void rememberOutput(const std::filesystem::path& path);

/// Files that this program has written and that still exist: in that order, each once.
[[nodiscard]] std::vector<std::filesystem::path> filesWritten();

/// A file that appears completely or not at all: written next to its name, renamed on commit(), removed otherwise. The
/// target of a symbolic link is replaced. Not for the tick.
class AtomicFile {
 public:
  /// @throws Failure when the folder does not exist or cannot be written, and as requireFree().
  explicit AtomicFile(OutputFile file);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// @throws Failure with the path and the system's reason, for example a full disk.
  void write(std::string_view text);

  /// Flushes to the disk and renames. Nothing may be written afterwards.
  /// @throws Failure as write(); and when another file has come to have the name that may not be replaced: then this
  /// one is kept next to it, and the message names it.
  void commit();

  /// Path of the bytes until commit(); other programs (ffmpeg) may write there.
  [[nodiscard]] const std::filesystem::path& temporaryPath() const noexcept { return temporary_; }

 private:
  [[noreturn]] void fail(const char* what) const;

  OutputFile target_;
  std::filesystem::path temporary_;
  std::FILE* file_ = nullptr;
};

}  // namespace haptolith
