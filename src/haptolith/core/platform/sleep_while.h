#pragma once

#include <atomic>
#include <cstddef>

namespace haptolith {

#ifdef _WIN32
/// Sleeps while the bytes at `address` equal those at `old`; may return early.
void sleepWhileEqual(const void* address, const void* old, std::size_t bytes) noexcept;
void wakeThoseAt(const void* address) noexcept;
#endif

/// Sleeps until `value` is no longer `old`, like std::atomic::wait(); the thread that changes it calls wakeAll(). On
/// Windows, std::atomic::wait() of g++ 12 misses a wake-up between its last test of the value and its sleep, and never
/// returns.
template <class T>
void sleepWhile(const std::atomic<T>& value, T old) noexcept {
#ifdef _WIN32
  static_assert(sizeof(std::atomic<T>) == sizeof(T) && std::atomic<T>::is_always_lock_free);
  while (value.load(std::memory_order_acquire) == old) {
    sleepWhileEqual(&value, &old, sizeof(T));
  }
#else
  value.wait(old, std::memory_order_acquire);
#endif
}

/// Wakes the threads in sleepWhile(). May be called in the tick.
template <class T>
void wakeAll(std::atomic<T>& value) noexcept {
#ifdef _WIN32
  wakeThoseAt(&value);
#else
  value.notify_all();
#endif
}

}  // namespace haptolith
