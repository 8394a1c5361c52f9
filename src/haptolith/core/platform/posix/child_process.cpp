#include "haptolith/core/platform/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
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
void waitFor(const Descriptor& descriptor, short event, const Deadline& deadline) {
  constexpr int kLook_ms = 100;
  pollfd asked{descriptor.number(), event, 0};
  while (poll(&asked, 1, kLook_ms) <= 0) {  // a signal interrupts it
    if (deadline.stopped && deadline.stopped()) {
      throw Failure("interrupted");
    }
    if (std::chrono::steady_clock::now() > deadline.until) {
      throw Failure("no response in time");
    }
  }
}

}  // namespace

Pipe::Pipe() {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw Failure(fmt::format("cannot make a pipe: {}", std::strerror(errno)));
  }
  to_read = kept(ends[0]);
  to_write = kept(ends[1]);
}

bool writeAll(const Descriptor& to, std::string_view bytes, const Deadline& deadline) {
  // A ready pipe always accepts this many bytes: a larger piece could wait for a reader that has hung up or hangs.
  constexpr std::size_t kPiece = 4096;
  while (!bytes.empty()) {
    waitFor(to, POLLOUT, deadline);
    const ssize_t written = ::write(to.number(), bytes.data(), std::min(bytes.size(), kPiece));
    if (written < 0 && errno != EINTR) {
      return false;
    }
    bytes.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(written, 0)));
  }
  return true;
}

bool readSome(const Descriptor& from, std::string& bytes, const Deadline& deadline) {
  std::array<char, 65536> piece;
  ssize_t size = -1;
  do {
    waitFor(from, POLLIN, deadline);
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

namespace {

/// A list of texts as execvpe() takes it.
std::vector<char*> pointersTo(const std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  pointers.reserve(texts.size() + 1);
  for (const std::string& text : texts) {
    pointers.push_back(const_cast<char*>(text.c_str()));
  }
  pointers.push_back(nullptr);
  return pointers;
}

/// All that the child needs, made beforehand: between fork and exec nothing may be allocated.
struct Start {
  std::vector<char*> arguments, environment;
  const std::vector<ChildProcess::Given>& given;
  pid_t parent;
  rlim_t most_cpu_s;
  int error_to;  ///< descriptor for the reason of a failed start
};

/// Becomes the program. Only calls that are safe after a fork of a program with threads.
[[noreturn]] void become(const Start& start) noexcept {
  // A separate process group: it can be killed with its children, and the terminal's Ctrl-C does not reach it.
  setpgid(0, 0);
  // It ends with the thread that has started it, however that ends; who has gone already sends no signal any more.
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != start.parent) {
    _exit(EXIT_FAILURE);
  }
  // Processes that escape all that, children of the child for example, do not spin for ever.
  const rlimit cpu{start.most_cpu_s, start.most_cpu_s};
  setrlimit(RLIMIT_CPU, &cpu);
  // Signals as a program expects them at its start.
  struct sigaction usual {};
  usual.sa_handler = SIG_DFL;
  for (const int signal : {SIGPIPE, SIGINT, SIGTERM}) {
    sigaction(signal, &usual, nullptr);
  }
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  for (const ChildProcess::Given& one : start.given) {
    dup2(one.ours.number(), one.number);
  }
  // Every other descriptor is closed by the exec.
  close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);
  for (const ChildProcess::Given& one : start.given) {
    if (one.number > STDERR_FILENO) {
      fcntl(one.number, F_SETFD, 0);
    }
  }
  execvpe(start.arguments[0], start.arguments.data(), start.environment.data());
  const int error = errno;
  [[maybe_unused]] const ssize_t told = ::write(start.error_to, &error, sizeof(error));
  _exit(EXIT_FAILURE);
}

}  // namespace

ChildProcess::ChildProcess(const Command& command, const std::vector<Given>& given) {
  Start start{.arguments = pointersTo(command.arguments),
              .environment = pointersTo(command.environment),
              .given = given,
              .parent = getpid(),
              .most_cpu_s = static_cast<rlim_t>(command.most_cpu.count()),
              .error_to = -1};
  start.environment.pop_back();
  for (char** variable = environ; *variable != nullptr; ++variable) {
    // A name that appears twice means the first to some programs and the last to others, such as shells.
    const std::string_view ours(*variable);
    const std::string_view name = ours.substr(0, ours.find('=') + 1);
    const auto has_name = [name](const std::string& variable_set) { return variable_set.starts_with(name); };
    if (std::ranges::none_of(command.environment, has_name)) {
      start.environment.push_back(*variable);
    }
  }
  start.environment.push_back(nullptr);
  Pipe failed;
  start.error_to = failed.to_write.number();
  const pid_t process = fork();
  if (process == 0) {
    become(start);
  }
  int error = process < 0 ? errno : 0;
  failed.to_write.close();
  // Says nothing when the program has begun, for then the other end is closed.
  if (process > 0 && TEMP_FAILURE_RETRY(::read(failed.to_read.number(), &error, sizeof(error))) > 0) {
    waitpid(process, nullptr, 0);
  }
  if (error == ENOENT) {
    throw Failure(fmt::format("{} is not installed: apt install {}", command.arguments[0], command.package));
  }
  if (error != 0) {
    throw Failure(fmt::format("cannot start {}: {}", command.arguments[0], std::strerror(error)));
  }
  process_ = process;
  name_ = command.arguments[0];
}

ChildProcess::~ChildProcess() {
  const auto process = static_cast<pid_t>(process_);
  ::kill(-process, SIGKILL);
  while (waitpid(process, nullptr, 0) < 0 && errno == EINTR) {
  }
}

// Keeps its number reserved (WNOWAIT): until the destructor no other process group can have that number, and processes
// that the program left running can still be killed by it.
bool ChildProcess::endsWithin(std::chrono::milliseconds timeout) {
  const auto until = std::chrono::steady_clock::now() + timeout;
  while (running_) {
    siginfo_t ended{};
    if (waitid(P_PID, static_cast<id_t>(process_), &ended, WEXITED | WNOWAIT | WNOHANG) == 0 && ended.si_pid != 0) {
      running_ = false;
      succeeded_ = ended.si_code == CLD_EXITED && ended.si_status == 0;
    } else if (std::chrono::steady_clock::now() < until) {
      std::this_thread::sleep_for(10ms);
    } else {
      break;
    }
  }
  return !running_;
}

}  // namespace haptolith
