#include "haptolith/core/files/input_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <mutex>
#include <optional>
#include <set>
#include <system_error>

#include "haptolith/core/error.h"
#include "haptolith/core/files/moved_file.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/core/platform/files.h"
#include "haptolith/core/stop_asked.h"

namespace haptolith {

namespace fs = std::filesystem;

namespace {

/// "64 MiB", or bytes where that would be a fraction.
std::string sizeText(std::uintmax_t bytes) {
  constexpr std::uintmax_t kMiB = 1 << 20;
  return bytes % kMiB == 0 ? fmt::format("{} MiB", bytes / kMiB) : fmt::format("{} bytes", bytes);
}

std::string_view kindOf(const fs::file_status& status) {
  switch (status.type()) {
    case fs::file_type::not_found: return "there is no such file";
    case fs::file_type::directory: return "it is a folder";
    case fs::file_type::fifo: return "it is a pipe";
    default: return "it is a device";
  }
}

struct Inputs {
  std::mutex mutex;
  std::set<FileIdentity> files;
};

Inputs& inputs() {
  static Inputs all;
  return all;
}

}  // namespace

std::ifstream openInput(const fs::path& path, std::uintmax_t most_bytes) {
  const fs::path current = currentPath(path);
  std::error_code error;
  const fs::file_status status = fs::status(current, error);
  if (status.type() == fs::file_type::none) {
    throw Failure(fmt::format("cannot read {}: {}", path.string(), error.message()));
  }
  if (!fs::is_regular_file(status)) {
    throw InvalidParameter("file", fmt::format("'{}'", path.string()), fmt::format("a file; {}", kindOf(status)));
  }
  const std::uintmax_t size = fs::file_size(current, error);
  if (!error && size > most_bytes) {
    throw InvalidParameter(path.string(), fmt::format("{} bytes", size), "at most " + sizeText(most_bytes));
  }
  std::ifstream file(current, std::ios::binary);
  if (!file) {
    throw Failure(fmt::format("cannot read {}: {}", path.string(), std::strerror(errno)));
  }
  rememberInput(current);
  return file;
}

void rememberInput(const fs::path& path) {
  if (const std::optional<FileIdentity> identity = identityOf(path)) {
    const std::scoped_lock lock(inputs().mutex);
    inputs().files.insert(*identity);
  }
}

bool isInput(const fs::path& path) {
  const std::optional<FileIdentity> identity = identityOf(path);
  const std::scoped_lock lock(inputs().mutex);
  return identity && inputs().files.contains(*identity);
}

LineReader::LineReader(std::istream& text, std::string_view name, const TextLimits& limits)
    : text_(*text.rdbuf()), name_(name), limits_(limits) {}

bool LineReader::next(std::string& line) {
  throwIfStopped();
  using Traits = std::streambuf::traits_type;
  line.clear();
  ended_ = false;
  Traits::int_type letter = text_.sbumpc();
  if (Traits::eq_int_type(letter, Traits::eof())) {
    return false;
  }
  ++number_;
  for (; !Traits::eq_int_type(letter, Traits::eof()); letter = text_.sbumpc()) {
    if (++bytes_ > limits_.bytes) {  // a file that grows, or one whose size the system does not report
      throw InvalidParameter(name_, fmt::format("more than {}", sizeText(limits_.bytes)),
                             "at most " + sizeText(limits_.bytes));
    }
    const char given = Traits::to_char_type(letter);
    if (given == '\n' || given == '\r') {
      if (given == '\r' && Traits::eq_int_type(text_.sgetc(), Traits::to_int_type('\n'))) {
        text_.sbumpc();
        ++bytes_;
      }
      ended_ = true;
      return true;
    }
    if (line.size() == limits_.line_bytes) {
      throw InvalidParameter(fmt::format("{}:{}: line", name_, number_), inQuotes(line),
                             fmt::format("at most {} bytes long", limits_.line_bytes));
    }
    line += given;
  }
  return true;
}

}  // namespace haptolith
