#include "haptolith/core/platform/child_process.h"

#include <fmt/format.h>

#include <algorithm>

#include "haptolith/core/error.h"
#include "haptolith/core/stop_asked.h"

namespace haptolith {

using namespace std::chrono_literals;

bool ChildProcess::wait(std::chrono::milliseconds timeout) {
  constexpr std::chrono::milliseconds kAfterStop = 30s;
  const bool stopped_before = stopAsked();
  const auto until = std::chrono::steady_clock::now() + (stopped_before ? std::min(timeout, kAfterStop) : timeout);
  while (!endsWithin(100ms)) {
    if (stopAsked() && !stopped_before) {
      throw Failure("interrupted");
    }
    if (std::chrono::steady_clock::now() > until) {
      throw Failure(fmt::format("{} did not end in time and was stopped", name_));
    }
  }
  return succeeded_;
}

}  // namespace haptolith
