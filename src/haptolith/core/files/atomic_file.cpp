#include "haptolith/core/files/atomic_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <mutex>
#include <span>
#include <string>
#include <system_error>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/files/input_file.h"
#include "haptolith/core/platform/files.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void failAt(const char* what, const fs::path& path) {
  throw Failure(fmt::format("cannot {} {}: {}", what, path.string(), std::strerror(errno)));
}

struct Outputs {
  std::mutex mutex;
  std::vector<fs::path> paths;
};

Outputs& outputs() {
  static Outputs all;
  return all;
}

/// giveName(); false, with errno, when it did not.
bool tryName(const fs::path& made, const fs::path& name, IfThere if_there) {
  if (!renameFile(made, name, if_there == IfThere::kReplace)) {
    return false;
  }
  rememberOutput(name);
  return true;
}

}  // namespace

std::string_view irreplaceable(const fs::path& path) {
  constexpr std::string_view kHdf5 = "\x89HDF\r\n\x1a\n";
  constexpr std::string_view kSqlite = "SQLite format 3";
  std::array<char, kSqlite.size()> bytes{};
  std::ifstream(path, std::ios::binary).read(bytes.data(), bytes.size());
  const std::string_view beginning(bytes.data(), bytes.size());
  return beginning.starts_with(kHdf5) ? "a recording" : beginning == kSqlite ? "a study" : "";
}

void requireFree(const OutputFile& file) {
  const fs::path& path = file.path;
  std::error_code ignored;  // a path without access cannot be replaced either, and the rename reports why
  if (!fs::exists(fs::symlink_status(path, ignored))) {
    return;
  }
  const fs::file_status status = fs::status(path, ignored);
  if (fs::is_directory(status)) {
    errno = EISDIR;
    failAt("open", path);
  }
  if (fs::exists(status) && !fs::is_regular_file(status)) {  // the rename would put a file in the place of /dev/null
    throw Failure(fmt::format("cannot replace {}: not a regular file", path.string()));
  }
  if (constexpr auto kWriters = fs::perms::owner_write | fs::perms::group_write | fs::perms::others_write;
      fs::exists(status) && (status.permissions() & kWriters) == fs::perms::none) {  // also for root, who may do all
    throw Failure(fmt::format("cannot replace {}: it is write-protected; choose another name", path.string()));
  }
  if (const std::string_view kind = irreplaceable(path); !kind.empty()) {
    throw Failure(fmt::format("cannot replace {}: it is {}; choose another name", path.string(), kind));
  }
  if (isInput(path)) {
    throw Failure(fmt::format("cannot replace {}: this command reads it; choose another name", path.string()));
  }
  if (file.if_there == IfThere::kRefuse) {
    throw Failure(fmt::format("{} already exists: choose another name, or add --overwrite", path.string()));
  }
}

fs::path temporaryBeside(const fs::path& path, std::string_view what, std::size_t longest_bytes) {
  std::uint64_t random = 0;
  if (!fillWithRandom(std::as_writable_bytes(std::span(&random, 1)))) {
    failAt("find a free name next to", path);
  }
  // The extension stays last, so that a program that chooses the format by it can write here. A long name loses its end
  // instead, between two characters of UTF-8.
  std::string stem = path.stem().string();
  const std::string end = fmt::format(".{}-{:016x}{}", what, random, path.extension().string());
  while (stem.size() + end.size() + 1 > longest_bytes && !stem.empty()) {
    do {
      stem.pop_back();
    } while (!stem.empty() && (static_cast<unsigned char>(stem.back()) & 0x80U) != 0);
  }
  fs::path beside = path;
  return beside.replace_filename("." + stem + end);
}

int makeNewFile(const fs::path& path, Readers readers) {
  return createNewFile(path, readers == Readers::kOwner);
}

void rememberOutput(const fs::path& path) {
  const std::scoped_lock lock(outputs().mutex);
  if (std::ranges::find(outputs().paths, path) == outputs().paths.end()) {
    outputs().paths.push_back(path);
  }
}

std::vector<fs::path> filesWritten() {
  const std::scoped_lock lock(outputs().mutex);
  std::vector<fs::path> there;
  std::error_code ignored;
  std::ranges::copy_if(outputs().paths, std::back_inserter(there),
                       [&](const fs::path& path) { return fs::exists(path, ignored); });
  return there;
}

void giveName(const fs::path& made, const fs::path& name, IfThere if_there) {
  if (!tryName(made, name, if_there)) {
    failAt("save", name);
  }
}

AtomicFile::AtomicFile(OutputFile file) : target_(std::move(file)) {
  requireFree(target_);
  std::error_code ignored;
  if (fs::exists(target_.path, ignored) && fs::is_symlink(target_.path, ignored)) {  // its target is replaced
    target_.path = fs::canonical(target_.path);
  }
  temporary_ = temporaryBeside(target_.path, "part");
  file_ = streamOf(makeNewFile(temporary_, target_.readers));
  if (file_ == nullptr) {
    fail("create");
  }
}

AtomicFile::~AtomicFile() {
  if (file_ != nullptr) {
    std::fclose(file_);
  }
  std::error_code ignored;
  fs::remove(temporary_, ignored);
}

void AtomicFile::write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) {
    fail("write");
  }
}

void AtomicFile::commit() {
  if (!flushToDisk(file_)) {
    fail("write");
  }
  if (std::fclose(std::exchange(file_, nullptr)) != 0) {
    fail("save");
  }
  if (tryName(temporary_, target_.path, target_.if_there)) {
    return;
  }
  if (errno != EEXIST || target_.if_there == IfThere::kReplace) {
    fail("save");
  }
  for (int number = 2; number < 100; ++number) {
    fs::path other = target_.path;
    other.replace_filename(
        fmt::format("{}-{}{}", target_.path.stem().string(), number, target_.path.extension().string()));
    if (tryName(temporary_, other, IfThere::kRefuse)) {
      throw Failure(
          fmt::format("{} was created by another program: saved as {}", target_.path.string(), other.string()));
    }
  }
  errno = EEXIST;
  fail("save");
}

void AtomicFile::fail(const char* what) const {
  failAt(what, target_.path);
}

}  // namespace haptolith
