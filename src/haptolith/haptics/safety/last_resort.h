#pragma once

#include <thread>

#include "haptolith/core/process/signal_stack.h"
#include "haptolith/device/haptic_device.h"

namespace haptolith {

/// As long as it lives, every signal that would end or halt the program (SIGSEGV, SIGABRT with std::terminate(),
/// SIGHUP, SIGTSTP of Ctrl-Z, SIGUSR1, SIGALRM, ...) first lets go of the hand. Then it does what it does without: it
/// ends the program, with a core dump where there is one, or halts it. What is ignored stays so, and who handles such a
/// signal keeps it, crashes excepted.
///
/// The handler waits up to 50 ms for a device that cannot be let go at once, because a thread is inside its library. Is
/// that the very thread that the signal has interrupted, it is sent back, and a helper, a thread of this object,
/// finishes when the call has come out. Only a thread that crashed inside the library never comes out: then the helper
/// tries to send zero past it, for 50 ms, for the library may hold a lock. After that, the device's own watchdog has to
/// do it; so it has after SIGKILL, SIGSTOP and power cuts, which nobody can handle.
///
/// Threads that may run out of stack need a SignalStack. One LastResort at a time; a second one takes over from the
/// first until it goes. Made and destroyed by the same thread, which is given a SignalStack.
class LastResort {
 public:
  /// @throws Failure when there is no thread for the helper.
  explicit LastResort(HapticDevice& device);
  ~LastResort();
  LastResort(const LastResort&) = delete;
  LastResort& operator=(const LastResort&) = delete;

  /// Whether, since the last call, a signal has released the device's force and the program runs on. May be called in
  /// the tick.
  [[nodiscard]] static bool releasedForceMeanwhile() noexcept;

 private:
  SignalStack stack_;
  HapticDevice* before_;
  std::thread helper_;
};

}  // namespace haptolith
