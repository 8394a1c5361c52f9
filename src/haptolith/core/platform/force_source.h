#pragma once

#include <cstdint>

namespace haptolith {

/// Progress of a releaseForce().
enum class ForceRelease : std::uint8_t {
  kDone,
  kUnderWay,  ///< another thread is inside the device's library and sends zero when it comes out
  kStuck,     ///< the thread that asks is itself inside the device's library
};

/// A device that pushes a hand, and has to stop when the program dies.
class ForceSource {
 public:
  /// Sets zero force immediately and permanently, whatever write() gets: the last resort of another thread or of a
  /// signal handler when the loop hangs. May be called from anywhere, also twice.
  virtual void releaseForce() noexcept = 0;

  /// Whether the last releaseForce() has reached the device. May be called from anywhere.
  [[nodiscard]] virtual ForceRelease forceRelease() const noexcept { return ForceRelease::kDone; }

  /// As releaseForce(), even if a call is inside the device's library that may hold a lock of it: it may never return.
  /// For a program that dies.
  virtual void releaseForceRegardless() noexcept { releaseForce(); }

 protected:
  ~ForceSource() = default;
};

}  // namespace haptolith
