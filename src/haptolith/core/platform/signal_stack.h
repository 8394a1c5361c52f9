#pragma once

#include <array>
#include <cstddef>

namespace haptolith {

/// A separate stack for the handlers of signals that interrupt the calling thread, as long as it lives: when the
/// thread's own stack has overflowed, a handler could not run on that. May itself lie on that stack, whose end is far
/// below.
class SignalStack {
 public:
  SignalStack() noexcept;
  ~SignalStack();
  SignalStack(const SignalStack&) = delete;
  SignalStack& operator=(const SignalStack&) = delete;

 private:
  /// A handler calls a device's library, which calls the system. The kernel wants 11 KiB of it for AVX-512.
  alignas(64) std::array<std::byte, 64UL * 1024> memory_{};
  struct Before {
    void* start = nullptr;
    std::size_t bytes = 0;
    int flags = 0;
  };
  Before before_;
};

}  // namespace haptolith
