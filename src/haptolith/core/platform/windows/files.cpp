#include "haptolith/core/platform/files.h"

#include <bcrypt.h>
#include <direct.h>
#include <fcntl.h>
#include <io.h>
#include <sys/stat.h>
#include <windows.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <cwchar>

namespace haptolith {

namespace {

namespace fs = std::filesystem;

/// Translates the reason of a failure for errno. Returns false.
bool fail(DWORD error) noexcept {
  switch (error) {
    case ERROR_FILE_NOT_FOUND:
    case ERROR_PATH_NOT_FOUND: errno = ENOENT; break;
    case ERROR_ACCESS_DENIED:
    case ERROR_SHARING_VIOLATION: errno = EACCES; break;
    case ERROR_FILE_EXISTS:
    case ERROR_ALREADY_EXISTS: errno = EEXIST; break;
    case ERROR_DISK_FULL: errno = ENOSPC; break;
    case ERROR_FILENAME_EXCED_RANGE: errno = ENAMETOOLONG; break;
    default: errno = EIO;
  }
  return false;
}

fs::path folderIn(const wchar_t* variable) {
  const wchar_t* value = _wgetenv(variable);
  const fs::path folder = value == nullptr ? L"" : value;
  return folder.is_absolute() ? folder : fs::path();
}

}  // namespace

bool fillWithRandom(std::span<std::byte> bytes) noexcept {
  return BCryptGenRandom(nullptr, reinterpret_cast<PUCHAR>(bytes.data()), static_cast<ULONG>(bytes.size()),
                         BCRYPT_USE_SYSTEM_PREFERRED_RNG) == 0;
}

int createNewFile(const fs::path& path, bool /*owner_only*/) noexcept {
  return _wopen(path.c_str(), _O_WRONLY | _O_CREAT | _O_EXCL | _O_BINARY | _O_NOINHERIT, _S_IREAD | _S_IWRITE);
}

std::FILE* streamOf(int descriptor) noexcept {
  return descriptor < 0 ? nullptr : _fdopen(descriptor, "wb");
}

bool createFolder(const fs::path& path, bool /*owner_only*/) noexcept {
  return _wmkdir(path.c_str()) == 0;
}

bool writeBytes(int descriptor, std::string_view bytes) noexcept {
  constexpr std::size_t kMostAtOnce = 1 << 30;
  while (!bytes.empty()) {
    const int written = _write(descriptor, bytes.data(), static_cast<unsigned>(std::min(bytes.size(), kMostAtOnce)));
    if (written <= 0) {
      return false;
    }
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

bool flushToDisk(int descriptor) noexcept {
  return _commit(descriptor) == 0;
}

bool flushToDisk(std::FILE* file) noexcept {
  return std::fflush(file) == 0 && flushToDisk(_fileno(file));
}

bool closeFile(int descriptor) noexcept {
  return _close(descriptor) == 0;
}

int copyOf(int descriptor) noexcept {
  const int copy = _dup(descriptor);
  if (copy >= 0) {
    SetHandleInformation(reinterpret_cast<HANDLE>(_get_osfhandle(copy)), HANDLE_FLAG_INHERIT, 0);
  }
  return copy;
}

int openForReading(const fs::path& path) noexcept {
  return _wopen(path.c_str(), _O_RDONLY | _O_BINARY | _O_NOINHERIT);
}

std::int64_t readAt(int descriptor, std::uint64_t offset, std::span<std::byte> into) noexcept {
  return _lseeki64(descriptor, static_cast<std::int64_t>(offset), SEEK_SET) < 0
             ? -1
             : _read(descriptor, into.data(), static_cast<unsigned>(into.size()));
}

std::optional<std::uint64_t> sizeOf(int descriptor) noexcept {
  const std::int64_t size = _filelengthi64(descriptor);
  return size >= 0 ? std::optional(static_cast<std::uint64_t>(size)) : std::nullopt;
}

bool wasRemoved(int /*descriptor*/) noexcept {
  return false;
}

void discardWrites(int descriptor) noexcept {
  if (const int nowhere = _wopen(L"NUL", _O_RDWR | _O_BINARY | _O_NOINHERIT); nowhere >= 0) {
    _dup2(nowhere, descriptor);
    _close(nowhere);
  }
}

void flushFolderToDisk(const fs::path& /*folder*/) noexcept {}  // renameFile() waits instead

bool renameFile(const fs::path& made, const fs::path& name, bool replaces) noexcept {
  const DWORD flags = MOVEFILE_WRITE_THROUGH | (replaces ? MOVEFILE_REPLACE_EXISTING : 0U);
  return MoveFileExW(made.c_str(), name.c_str(), flags) != 0 || fail(GetLastError());
}

std::optional<FileIdentity> identityOf(const fs::path& path) noexcept {
  const HANDLE file = CreateFileW(path.c_str(), 0, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE, nullptr,
                                  OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS, nullptr);
  if (file == INVALID_HANDLE_VALUE) {
    return std::nullopt;
  }
  BY_HANDLE_FILE_INFORMATION info{};
  const bool known = GetFileInformationByHandle(file, &info) != 0;
  CloseHandle(file);
  const std::uint64_t number = std::uint64_t{info.nFileIndexHigh} << 32U | info.nFileIndexLow;
  return known ? std::optional(FileIdentity{info.dwVolumeSerialNumber, number}) : std::nullopt;
}

void makeNewFilesPrivate() noexcept {}

fs::path cacheHome() {
  return folderIn(L"LOCALAPPDATA");
}

fs::path stateHome() {
  return folderIn(L"LOCALAPPDATA");
}

}  // namespace haptolith

/// The runtime library's own function takes bytes for letters of an old alphabet, and std::filesystem::path uses it for
/// names: the linker puts this one in its place, which reads UTF-8. A letter that takes two wide characters is passed
/// on in two calls, as 3 bytes and 1.
extern "C" std::size_t __wrap_mbrtowc(wchar_t* to, const char* from, std::size_t size, mbstate_t* state) {
  constexpr auto kMalformed = static_cast<std::size_t>(-1);
  constexpr auto kIncomplete = static_cast<std::size_t>(-2);
  static mbstate_t own{};
  mbstate_t& second_half = state != nullptr ? *state : own;
  wchar_t unused = 0;
  wchar_t& letter = to != nullptr ? *to : unused;
  if (from == nullptr) {
    second_half = 0;
    return 0;
  }
  if (size == 0) {
    return kIncomplete;
  }
  if (second_half != 0) {
    letter = static_cast<wchar_t>(second_half);
    second_half = 0;
    return 1;
  }
  const auto byte = [from](std::size_t i) { return static_cast<unsigned char>(from[i]); };
  struct Length {
    unsigned least;  ///< first byte
    std::size_t bytes;
  };
  static constexpr std::array<Length, 6> kLengths{{{0xF5, 0}, {0xF0, 4}, {0xE0, 3}, {0xC2, 2}, {0x80, 0}, {0, 1}}};
  const std::size_t bytes =
      std::ranges::find_if(kLengths, [&](const Length& length) { return byte(0) >= length.least; })->bytes;
  if (bytes > size) {
    return kIncomplete;
  }
  constexpr std::array<unsigned, 5> kLeastCodes{0, 0, 0x80, 0x800, 0x10000};
  unsigned code = bytes > 1 ? byte(0) & (0x7FU >> bytes) : byte(0);
  bool well_formed = bytes > 0;
  for (std::size_t i = 1; i < bytes; ++i) {
    well_formed = well_formed && (byte(i) & 0xC0U) == 0x80U;
    code = code << 6U | (byte(i) & 0x3FU);
  }
  if (!well_formed || code < kLeastCodes[bytes] || code > 0x10FFFF) {
    errno = EILSEQ;
    return kMalformed;
  }
  if (bytes < 4) {
    letter = static_cast<wchar_t>(code);
    return code == 0 ? 0 : bytes;
  }
  code -= 0x10000;
  letter = static_cast<wchar_t>(0xD800U + (code >> 10U));
  second_half = static_cast<mbstate_t>(0xDC00U + (code & 0x3FFU));
  return 3;
}
