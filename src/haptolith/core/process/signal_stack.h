#pragma once

#include <array>
#include <csignal>
#include <cstddef>

namespace haptolith {

/// A separate stack for the handlers of signals (SA_ONSTACK) that interrupt the calling thread, as long as it lives:
/// when the thread's own stack has overflowed, a handler could not run on that. May itself lie on that stack, whose end
/// is far below.
class SignalStack {
 public:
  SignalStack() noexcept {
    stack_t own{};
    own.ss_sp = memory_.data();
    own.ss_size = memory_.size();
    sigaltstack(&own, &before_);
  }
  ~SignalStack() { sigaltstack(&before_, nullptr); }
  SignalStack(const SignalStack&) = delete;
  SignalStack& operator=(const SignalStack&) = delete;

 private:
  /// A handler calls a device's library, which calls the system. The kernel wants 11 KiB of it for AVX-512.
  alignas(64) std::array<std::byte, 64UL * 1024> memory_{};
  stack_t before_{};
};

}  // namespace haptolith
