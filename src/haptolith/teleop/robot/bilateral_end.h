#pragma once

#include <algorithm>

#include "haptolith/core/movement.h"

namespace haptolith {

/// One end of a channel with delay, kept from giving more energy than went in at the other: time-domain passivity for a
/// network of two ports (Ryu, Artigas and Preusche 2010, Mechatronics 20:812).
///
///     out here (t) <= in there (t - delay)
///
/// Each end sends with every packet its total input energy. Excess output is dissipated: at the
/// hand by damping its force; at the robot by slowing it down. May be called in the tick.
class BilateralEnd {
 public:
  /// @param lever_m  lever that converts rotations to movements.
  BilateralEnd(double tick_s, double lever_m) noexcept : tick_s_(tick_s), lever_m_(lever_m) {}

  /// Receives the other end's total input.
  void hear(double in_there_j) noexcept { in_there_j_ = std::max(in_there_j_, in_there_j); }
  /// Total input at this end, to be sent.
  [[nodiscard]] double in() const noexcept { return in_j_; }
  /// Energy that is still owed to this end.
  [[nodiscard]] double margin() const noexcept { return in_there_j_ - out_j_; }
  /// Taken back so far.
  [[nodiscard]] double dissipated() const noexcept { return dissipated_j_; }

  /// Part of the displayed wrench that the channel's energy pays for while this end moves so. All wrenches and twists
  /// are in the site frame, about the tool's origin.
  [[nodiscard]] Wrench damp(const Wrench& shown, const Twist& twist) noexcept;
  /// Part of a commanded movement against a load that the channel's energy pays for. @param load  against the movement.
  [[nodiscard]] Twist brake(const Twist& moved, const Wrench& load) noexcept;

 private:
  /// Excess of a tick's energy out of the channel; books the rest.
  [[nodiscard]] double excess(double out_j) noexcept;

  double tick_s_, lever_m_;
  double in_j_ = 0, out_j_ = 0, in_there_j_ = 0, dissipated_j_ = 0;
};

}  // namespace haptolith
