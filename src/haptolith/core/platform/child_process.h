#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/platform/descriptor.h"

namespace haptolith {

/// Both ends of a pipe. @throws Failure when the system has none left.
struct Pipe {
  Pipe();
  Descriptor to_read, to_write;
};

/// Time limit for the other end of a pipe.
struct Deadline {
  std::chrono::steady_clock::time_point until = std::chrono::steady_clock::time_point::max();
  const std::function<bool()>& stopped;  ///< whether the result is no longer needed; polled at 10 Hz
};

/// Writes all of `bytes`; false when the reader has closed the pipe, if SIGPIPE is ignored.
/// @throws Failure when the deadline has passed or the work is stopped.
[[nodiscard]] bool writeAll(const Descriptor& to, std::string_view bytes, const Deadline& deadline);

/// Waits for bytes and appends them to `bytes`; false at the end of what there is.
/// @throws Failure as writeAll().
[[nodiscard]] bool readSome(const Descriptor& from, std::string& bytes, const Deadline& deadline);

/// An unnamed file for what a child reads or says, to be read from its beginning. @throws Failure.
[[nodiscard]] Descriptor temporaryFile(std::string_view content = {});

/// All that is in a file, from its beginning.
[[nodiscard]] std::string contentOf(const Descriptor& file);

/// Another program that works for us. It is killed with this object, and with it all that it has started; it is killed
/// as well when the thread that started it ends, so also when this whole program is killed; and none of them takes more
/// time of a processor than `most_cpu`. Signals from the terminal do not reach it: who started it decides what Ctrl-C
/// means. Not for the tick, and not while it ticks: the fork makes every page that is written to fault once.
class ChildProcess {
 public:
  /// A descriptor of this process, and its number in the child.
  struct Given {
    const Descriptor& ours;
    int number;
  };

  struct Command {
    std::vector<std::string> arguments;    ///< the program first, looked for in PATH
    std::string package;                   ///< Debian's, that brings it
    std::vector<std::string> environment;  ///< "NAME=value", in addition to this process's environment
    std::chrono::seconds most_cpu{300};    ///< limit of CPU time, for it and each process that it starts
  };

  /// Starts the program; it sees no descriptor but the given ones.
  /// @throws Failure when it cannot be started, naming the package when it is not installed.
  ChildProcess(const Command& command, const std::vector<Given>& given);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Waits for its end. True when it succeeded (exit status 0). Work that was stopped before, such as the figure of a
  /// run that Ctrl-C has ended, is finished, in 30 s at most.
  /// @throws Failure when the deadline has passed, or when the work is stopped meanwhile.
  bool wait(std::chrono::milliseconds timeout = std::chrono::minutes(2));

  /// Waits for its end, but not for ever; false when it still runs.
  bool endsWithin(std::chrono::milliseconds timeout);

 private:
  std::string name_;
  std::intptr_t process_ = 0;  ///< number of the process, on Windows a handle of it
  std::intptr_t group_ = 0;    ///< on Windows, a handle of the job that it and its children belong to
  bool running_ = true, succeeded_ = false;
};

}  // namespace haptolith
