#include "haptolith/core/platform/signal_stack.h"

#include <csignal>

namespace haptolith {

SignalStack::SignalStack() noexcept {
  stack_t own{};
  own.ss_sp = memory_.data();
  own.ss_size = memory_.size();
  stack_t before{};
  sigaltstack(&own, &before);
  before_ = {before.ss_sp, before.ss_size, before.ss_flags};
}

SignalStack::~SignalStack() {
  stack_t before{};
  before.ss_sp = before_.start;
  before.ss_size = before_.bytes;
  before.ss_flags = before_.flags;
  sigaltstack(&before, nullptr);
}

}  // namespace haptolith
