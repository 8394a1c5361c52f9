#include "haptolith/core/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <memory>
#include <thread>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

using namespace std::chrono_literals;

/// Above the numbers under which children find what they are given, so that giving one never overwrites another.
constexpr int kLowestNumber = 16;

Descriptor kept(int number) {
  const Descriptor low(number);
  const int moved = fcntl(number, F_DUPFD_CLOEXEC, kLowestNumber);
  if (moved < 0) {
    throw Failure(fmt::format("cannot keep a file open: {}", std::strerror(errno)));
  }
  return Descriptor(moved);
}

/// Waits until `descriptor` is ready for `event`.
void waitFor(const Descriptor& descriptor, short event, const Patience& patience) {
  constexpr int kLook_ms = 100;
  pollfd asked{descriptor.number(), event, 0};
  while (poll(&asked, 1, kLook_ms) <= 0) {  // a signal interrupts it
    if (patience.stopped && patience.stopped()) {
      throw Failure("interrupted");
    }
    if (std::chrono::steady_clock::now() > patience.until) {
      throw Failure("no answer in time");
    }
  }
}

}  // namespace

void Descriptor::close() noexcept {
  if (number_ >= 0) {
    ::close(std::exchange(number_, -1));
  }
}

Pipe::Pipe() {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw Failure(fmt::format("cannot make a pipe: {}", std::strerror(errno)));
  }
  to_read = kept(ends[0]);
  to_write = kept(ends[1]);
}

bool writeAll(const Descriptor& to, std::string_view bytes, const Patience& patience) {
  // What a pipe that is ready always takes: a larger piece could wait for a reader that has hung up or hangs.
  constexpr std::size_t kPiece = 4096;
  while (!bytes.empty()) {
    waitFor(to, POLLOUT, patience);
    const ssize_t written = ::write(to.number(), bytes.data(), std::min(bytes.size(), kPiece));
    if (written < 0 && errno != EINTR) {
      return false;
    }
    bytes.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(written, 0)));
  }
  return true;
}

bool readSome(const Descriptor& from, std::string& bytes, const Patience& patience) {
  std::array<char, 65536> piece;
  ssize_t size = -1;
  do {
    waitFor(from, POLLIN, patience);
    size = ::read(from.number(), piece.data(), piece.size());
  } while (size < 0 && errno == EINTR);
  bytes.append(piece.data(), static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
  return size > 0;
}

Descriptor temporaryFile(std::string_view content) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::tmpfile(), &std::fclose);
  if (file == nullptr) {
    throw Failure(fmt::format("cannot create a temporary file: {}", std::strerror(errno)));
  }
  const bool written = content.empty() || std::fwrite(content.data(), 1, content.size(), file.get()) == content.size();
  if (!written || std::fflush(file.get()) != 0) {
    throw Failure(fmt::format("cannot write a temporary file: {}", std::strerror(errno)));
  }
  std::rewind(file.get());
  return kept(dup(fileno(file.get())));
}

std::string contentOf(const Descriptor& file) {
  std::string content;
  std::array<char, 4096> piece;
  for (ssize_t size = 0;
       (size = pread(file.number(), piece.data(), piece.size(), static_cast<off_t>(content.size()))) > 0;) {
    content.append(piece.data(), static_cast<std::size_t>(size));
  }
  return content;
}

ChildProcess::ChildProcess(const Command& command, const std::vector<Given>& given) {
  std::vector<char*> arguments, environment;
  for (const std::string& argument : command.arguments) {
    arguments.push_back(const_cast<char*>(argument.c_str()));
  }
  arguments.push_back(nullptr);
  for (const std::string& variable : command.environment) {  // the first of a name counts
    environment.push_back(const_cast<char*>(variable.c_str()));
  }
  for (char** variable = environ; *variable != nullptr; ++variable) {
    environment.push_back(*variable);
  }
  environment.push_back(nullptr);

  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  int highest = STDERR_FILENO;
  for (const Given& one : given) {
    posix_spawn_file_actions_adddup2(&files, one.ours.number(), one.number);
    highest = std::max(highest, one.number);
  }
  posix_spawn_file_actions_addclosefrom_np(&files, highest + 1);

  // A group of its own, so that it can be killed with its own children and the terminal's Ctrl-C passes it by; signals
  // as a program expects them at its start.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
  sigset_t usual;
  sigemptyset(&usual);
  for (const int signal : {SIGPIPE, SIGINT, SIGTERM}) {
    sigaddset(&usual, signal);
  }
  posix_spawnattr_setsigdefault(&attributes, &usual);

  const int error = posix_spawnp(&process_, arguments[0], &files, &attributes, arguments.data(), environment.data());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  if (error == ENOENT) {
    throw Failure(fmt::format("{} is not installed: apt install {}", command.arguments[0], command.package));
  }
  if (error != 0) {
    throw Failure(fmt::format("cannot start {}: {}", command.arguments[0], std::strerror(error)));
  }
}

ChildProcess::~ChildProcess() {
  ::kill(-process_, SIGKILL);
  while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

bool ChildProcess::wait() {
  while (running_) {
    look(0);
  }
  return succeeded_;
}

bool ChildProcess::endsWithin(std::chrono::milliseconds patience) {
  const auto until = std::chrono::steady_clock::now() + patience;
  for (look(WNOHANG); running_ && std::chrono::steady_clock::now() < until; look(WNOHANG)) {
    std::this_thread::sleep_for(10ms);
  }
  return !running_;
}

/// Sees whether it has ended, without letting go of its number (WNOWAIT): until the destructor no other group of
/// processes can have that, and what the program has left running can still be killed by it.
void ChildProcess::look(int options) {
  siginfo_t ended{};
  if (waitid(P_PID, static_cast<id_t>(process_), &ended, WEXITED | WNOWAIT | options) == 0 && ended.si_pid != 0) {
    running_ = false;
    succeeded_ = ended.si_code == CLD_EXITED && ended.si_status == 0;
  }
}

}  // namespace haptolith
