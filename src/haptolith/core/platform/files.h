#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

namespace haptolith {

// Operations on files that differ between systems. Those that may fail set errno. Not for the tick.

/// Whether the system has filled `bytes` with numbers that cannot be guessed.
[[nodiscard]] bool fillWithRandom(std::span<std::byte> bytes) noexcept;

/// Descriptor of a new file to write, which no child inherits; -1 on failure. Follows no link, opens no existing file.
/// @param owner_only  only the owner may read it; on Windows the folder's access list decides
[[nodiscard]] int createNewFile(const std::filesystem::path& path, bool owner_only) noexcept;

/// Stream of such a file, which it then owns; null on failure.
[[nodiscard]] std::FILE* streamOf(int descriptor) noexcept;

[[nodiscard]] bool createFolder(const std::filesystem::path& path, bool owner_only) noexcept;

/// Writes all of `bytes`, also after interruptions by signals.
[[nodiscard]] bool writeBytes(int descriptor, std::string_view bytes) noexcept;

/// Waits until the content of the file is on the disk.
[[nodiscard]] bool flushToDisk(int descriptor) noexcept;
[[nodiscard]] bool flushToDisk(std::FILE* file) noexcept;

bool closeFile(int descriptor) noexcept;

/// Another descriptor of the same open file, which no child inherits; -1 on failure.
[[nodiscard]] int copyOf(int descriptor) noexcept;

/// Descriptor of an existing file to read, which no child inherits; -1 on failure.
[[nodiscard]] int openForReading(const std::filesystem::path& path) noexcept;

/// Reads from a place in the file and returns the number of bytes, fewer at its end; -1 on failure.
[[nodiscard]] std::int64_t readAt(int descriptor, std::uint64_t offset, std::span<std::byte> into) noexcept;

/// Size in bytes of an open file.
[[nodiscard]] std::optional<std::uint64_t> sizeOf(int descriptor) noexcept;

/// Whether an open file has lost its last name; never on Windows, where an open file keeps its name.
[[nodiscard]] bool wasRemoved(int descriptor) noexcept;

/// Lets all later writes to the descriptor succeed and reach nothing.
void discardWrites(int descriptor) noexcept;

/// Whether a file may get another name while it is open.
#ifdef _WIN32
inline constexpr bool kOpenFilesCanBeRenamed = false;
#else
inline constexpr bool kOpenFilesCanBeRenamed = true;
#endif

/// Waits until the names in a folder are on the disk.
void flushFolderToDisk(const std::filesystem::path& folder) noexcept;

/// Gives `made` the name `name` in one step; waits until the folder's list is on the disk. An existing file is
/// replaced, or makes it fail with EEXIST.
[[nodiscard]] bool renameFile(const std::filesystem::path& made, const std::filesystem::path& name,
                              bool replaces) noexcept;

/// A file, whatever its name: the numbers of its volume and in it.
using FileIdentity = std::pair<std::uint64_t, std::uint64_t>;
[[nodiscard]] std::optional<FileIdentity> identityOf(const std::filesystem::path& path) noexcept;

/// Lets only this user read files that this program makes from now on; on Windows, folders decide.
void makeNewFilesPrivate() noexcept;

/// Folders of this user for files that programs can make again, and for files that last; empty if there is none.
[[nodiscard]] std::filesystem::path cacheHome();
[[nodiscard]] std::filesystem::path stateHome();

}  // namespace haptolith
