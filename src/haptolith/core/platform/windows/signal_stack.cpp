#include "haptolith/core/platform/signal_stack.h"

#include <windows.h>

namespace haptolith {

// Handlers of exceptions run on the thread's own stack, of which so much is kept for them.
SignalStack::SignalStack() noexcept {
  auto bytes = static_cast<ULONG>(memory_.size());
  SetThreadStackGuarantee(&bytes);
}

SignalStack::~SignalStack() = default;

}  // namespace haptolith
