#pragma once

#include <thread>

#include "haptolith/core/platform/force_source.h"
#include "haptolith/core/platform/signal_stack.h"

namespace haptolith {

/// While it exists, every signal that would end or halt the program (SIGSEGV, SIGABRT with std::terminate(),
/// SIGHUP, SIGTSTP of Ctrl-Z, SIGUSR1, SIGALRM, ...) first sets the force to zero. Then the default action follows: it
/// ends the program, with a core dump if enabled, or halts it. Ignored signals stay ignored, and existing handlers of
/// such a signal stay, except for crashes.
///
/// The handler waits up to 50 ms for a device that cannot be released immediately, because a thread is inside its
/// library. If that is the thread that the signal has interrupted, it is sent back, and a helper, a thread of this
/// object, finishes when the call has come out. Only a thread that crashed inside the library never comes out: then the
/// helper tries to send zero past it, for 50 ms, because the library may hold a lock. After that, the device's own
/// watchdog must do it; also after SIGKILL, SIGSTOP and power cuts, which cannot be handled.
///
/// Threads that may run out of stack need a SignalStack. One LastResort at a time; a second one takes over from the
/// first until it goes. Made and destroyed by the same thread, which is given a SignalStack.
class LastResort {
 public:
  /// @throws Failure when there is no thread for the helper.
  explicit LastResort(ForceSource& device);
  ~LastResort();
  LastResort(const LastResort&) = delete;
  LastResort& operator=(const LastResort&) = delete;

  /// Whether, since the last call, a signal has released the device's force and the program runs on. May be called in
  /// the tick.
  [[nodiscard]] static bool releasedForceMeanwhile() noexcept;

 private:
  SignalStack stack_;
  ForceSource* before_;
  std::thread helper_;
};

}  // namespace haptolith
