#pragma once

#include <chrono>
#include <cstdint>
#include <future>
#include <utility>

namespace haptolith {

/// Place of a computation that takes longer than its caller may wait.
enum class Work : std::uint8_t {
  kAtOnce,  ///< in the calling thread: the same steps on every run
  kBeside,  ///< on a separate thread
};

/// Whether there are threads: a browser has one only, and work for a separate thread is done there when its result is
/// fetched.
#if defined(__EMSCRIPTEN__) && !defined(__EMSCRIPTEN_PTHREADS__)
inline constexpr bool kHasThreads = false;
#else
inline constexpr bool kHasThreads = true;
#endif

/// Sets out; isThere() when it may be fetched. Not for the tick. @throws std::system_error when there is no thread.
template <class Task>
[[nodiscard]] auto setOut(Work work, Task task) {
  return std::async(work == Work::kBeside && kHasThreads ? std::launch::async : std::launch::deferred, std::move(task));
}

/// Whether the result can be fetched without waiting for a thread.
template <class Result>
[[nodiscard]] bool isThere(const std::future<Result>& coming) {
  return coming.valid() && coming.wait_for(std::chrono::seconds(0)) != std::future_status::timeout;
}

}  // namespace haptolith
