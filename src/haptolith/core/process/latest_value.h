#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace haptolith {

/// Hands the newest value from one writer to one reader without locks: neither ever waits for the other, and the reader
/// may miss values but never sees half of one. Neither side allocates as long as T's buffers keep their size.
template <class T>
class LatestValue {
 public:
  LatestValue() = default;
  explicit LatestValue(const T& initial) : slots_{initial, initial, initial} {}

  /// Writer: the slot to fill before publish(). It holds an old value. May be called in the tick.
  [[nodiscard]] T& draft() noexcept { return slots_[writing_]; }

  /// Writer: makes the draft the newest value. May be called in the tick.
  void publish() noexcept {
    const std::uint8_t handed = shared_.exchange(writing_ | kNew, std::memory_order_acq_rel);
    writing_ = handed & kSlot;
  }

  /// Reader: whether something newer than latest() has been published; if so latest() moves on to it.
  bool update() noexcept {
    if ((shared_.load(std::memory_order_relaxed) & kNew) == 0) {
      return false;
    }
    reading_ = shared_.exchange(reading_, std::memory_order_acq_rel) & kSlot;
    return true;
  }

  /// Reader: the newest value as of the last update().
  [[nodiscard]] const T& latest() const noexcept { return slots_[reading_]; }

 private:
  static constexpr std::uint8_t kNew = 4;
  static constexpr std::uint8_t kSlot = 3;

  std::array<T, 3> slots_{};
  std::uint8_t writing_ = 0;
  std::uint8_t reading_ = 1;
  std::atomic<std::uint8_t> shared_{2};
};

}  // namespace haptolith
