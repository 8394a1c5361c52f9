#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

#include "haptolith/core/movement.h"

namespace haptolith {

/// The operator's tool at one tick.
struct Keyframe {
  std::uint64_t index = 0;  ///< the operator's tick: what both sides count by, whatever their clocks say
  HandState hand;           ///< site frame: its origin in the middle of the soil's first surface, z up
};

/// An operator's movement as far as it has arrived: keyframes, and between them a course that has their velocities,
/// too.
///
///     x(s) = h00 x0 + h10 T v0 + h01 x1 + h11 T v1        Hermite's cubic, T: time between two keyframes
///
/// It is wrong by T^4 / 384 times the fourth derivative at most: a hand that oscillates by 35 mm in 2 s is reproduced
/// within 1.5 nm from keyframes 20 ms apart, and within 0.23 mm when all packets of 0.4 s were lost. Rotations follow
/// the same scheme, as a rotation vector from the key before. Not for the tick.
class CommandTrack {
 public:
  static constexpr std::size_t kMostKeyframes = 65536;  ///< the oldest go

  explicit CommandTrack(double tick_s) : tick_s_(tick_s) {}

  /// Enters a key in its place; one that is there already is passed over, and what is as old as what has been
  /// forgotten.
  void add(const Keyframe& key);
  /// Drops unused keys: all but the last at or before `index`.
  void forgetBefore(double index);
  void clear() noexcept { keys_.clear(); }

  [[nodiscard]] bool empty() const noexcept { return keys_.empty(); }
  [[nodiscard]] std::uint64_t oldest() const noexcept { return keys_.front().index; }
  [[nodiscard]] std::uint64_t newest() const noexcept { return keys_.back().index; }
  /// Pose and twist of the hand at a tick or between two; before the first and after the last key: at rest there. Not
  /// when it is empty.
  [[nodiscard]] HandState at(double index) const noexcept;

  /// Two keyframes next to each other.
  struct Stretch {
    Keyframe from, to;
  };
  /// Those around `index`, which is before the newest and not before the oldest.
  [[nodiscard]] Stretch around(double index) const noexcept;

 private:
  [[nodiscard]] std::size_t after(double index) const noexcept;  ///< the first key later than that

  double tick_s_;
  std::deque<Keyframe> keys_;
};

}  // namespace haptolith
