#pragma once

#include <chrono>
#include <thread>

namespace haptolith {

/// Whether something comes true in ten seconds, which a driver's thread needs only on a machine that is very busy.
template <class Condition>
bool eventually(Condition condition) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > until) {
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace haptolith
