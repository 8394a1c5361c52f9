#pragma once

#include <fmt/format.h>

#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/platform/signal_stack.h"

namespace haptolith {

/// A thread that runs `work`, with a SignalStack. @throws Failure that says for what there is no thread when the system
/// grants none.
template <class Work>
[[nodiscard]] std::thread startThread(std::string_view what_for, Work&& work) {
  try {
    return std::thread([work = std::forward<Work>(work)]() mutable {
      const SignalStack stack;
      work();
    });
  } catch (const std::system_error& error) {
    throw Failure(
        fmt::format("cannot start a thread for {}: {}; end other programs, or allow this user more "
                    "processes (ulimit -u) and more locked memory (ulimit -l)",
                    what_for, error.code().message()));
  }
}

}  // namespace haptolith
