#pragma once

#include "haptolith/core/ramp.h"

namespace haptolith {

/// Fades the tool out of the soil when it should not be felt, after a safety trip, and before another tool or
/// bed replaces it; and fades it in again: the force has no jump, and soil inside the tool is moved
/// out of its way. Functions may be called in the tick.
class ToolFade {
 public:
  /// @param faded_in  else it begins outside the soil.
  ToolFade(double tick_s, bool faded_in) noexcept : tick_s_(tick_s), ramp_(faded_in ? 1 : 0) {}

  /// The tool is out of the soil, and has to be placed where the hand is.
  void begin() noexcept;
  /// Whether the tool is to be felt at all.
  void touch(bool on) noexcept { touches_ = on; }
  /// The tool leaves the soil, because it or the bed is to be replaced, and stays out until begin().
  void leave() noexcept { leaves_ = true; }
  /// Whether it has left.
  [[nodiscard]] bool gone() const noexcept { return leaves_ && ramp_.share() == 0; }

  /// One tick. @param speed  of time.
  void step(bool hand_feels, double speed) noexcept;

  /// Present fraction of the tool's stiffness, for Scene::setToolFade().
  [[nodiscard]] double stiffnessShare() const noexcept { return ramp_.share() * ramp_.share(); }
  /// Whether the tool has to be placed where the hand is, instead of moved there through the soil: true once after
  /// begin(), and at first.
  [[nodiscard]] bool takePlacing() noexcept;

 private:
  double tick_s_;
  Ramp ramp_;
  bool touches_ = true;
  bool placed_ = false;
  bool leaves_ = false;
};

}  // namespace haptolith
