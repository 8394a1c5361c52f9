#pragma once

#include <cstdint>
#include <optional>

#include "haptolith/device/haptic_device.h"
#include "haptolith/device/mapping.h"
#include "haptolith/haptics/coupling.h"
#include "haptolith/haptics/loop/handling_parameters.h"
#include "haptolith/haptics/loop/tool_fade.h"
#include "haptolith/haptics/loop_parameters.h"
#include "haptolith/haptics/safety/safety_layer.h"
#include "haptolith/haptics/safety/watchdog.h"
#include "haptolith/haptics/tick_record.h"
#include "haptolith/scene/scene.h"

namespace haptolith {

/// The device that moves one of a scene's tools, and its handling.
struct ToolHandling {
  HapticDevice* device = nullptr;
  HandlingParameters handling = {};
};

/// A hand in the loop, from its device to its tool and back: mapping, coupling, safety layer, watchdog and fade of its
/// own. What goes wrong with one hand concerns no other. Functions may be called in the tick, in this order:
/// beginTick(), then standStill(), or resumeAfterStandstill(), read(), fade(), target(), and after the scene's tick
/// feel() and send(), and fill().
class ToolHand {
 public:
  /// @param tool  its number in the scene.
  /// @throws InvalidParameter as validate() of the parameters; Failure when there is no thread for the watchdog of a
  /// person's device.
  ToolHand(const Scene& scene, std::size_t tool, const ToolHandling& handling, const LoopParameters& parameters);

  /// Whether a watchdog watches over it.
  [[nodiscard]] bool watched() const noexcept { return watchdog_.has_value(); }
  void startWatching() noexcept;
  void stopWatching() noexcept;

  /// First of all: sends nothing when the loop was silent, because what the hand feels is as old as the silence is
  /// long. @param released  whether a signal has released the force.
  void beginTick(bool released) noexcept;
  /// Time is paused: the device gets no force.
  void standStill() noexcept;
  /// A simulated hand must not be affected by a pause; a person's has moved meanwhile.
  void resumeAfterStandstill() noexcept;

  /// Reads the hand. An implausible reading leaves the tool in place, and it fades out of the soil.
  /// @param overridden  health of the loop in a recorded tick, instead of `late` and the watchdog's.
  void read(const BedParameters& bed, bool late, const std::optional<LoopHealth>& overridden) noexcept;
  /// Whether the device is gone.
  [[nodiscard]] bool lost() const noexcept { return safety_.trip() == SafetyTrip::kLost; }
  /// Whether a simulated hand has left: a person's comes back.
  [[nodiscard]] bool left() const noexcept;
  /// Whether the device has nothing more to give.
  [[nodiscard]] bool finished() const noexcept { return input_.state == DeviceState::kFinished; }

  /// Fades the tool, and returns its present share.
  double fade(double speed) noexcept;
  /// Returns the state of the hand that its tool takes.
  [[nodiscard]] const HandState& target(Scene& scene) noexcept;

  /// The hand feels the soil, as far as is safe.
  void feel(const Scene& scene) noexcept;
  /// No force, because the run ends.
  void sendNothing() noexcept;

  /// Fills the record of this tick, except for times and flags of the loop.
  void fill(TickRecord& record, const Scene& scene, bool failed) noexcept;

  /// The tool leaves the soil because something is to be replaced; then it gone(), until it is restart()ed.
  void leave() noexcept { fade_.leave(); }
  [[nodiscard]] bool gone() const noexcept { return fade_.gone(); }
  /// Begins outside the soil.
  void restart() noexcept;
  void touch(bool on) noexcept { fade_.touch(on); }
  [[nodiscard]] double stiffnessShare() const noexcept { return fade_.stiffnessShare(); }

  [[nodiscard]] HapticDevice& device() const noexcept { return *device_; }
  [[nodiscard]] SafetyLayer& safety() noexcept { return safety_; }
  [[nodiscard]] const SafetyLayer& safety() const noexcept { return safety_; }
  [[nodiscard]] double opening() const noexcept { return hand_.opening; }
  /// Device wrench of the last tick, about the handle's origin, device frame.
  [[nodiscard]] const Wrench& sent() const noexcept { return output_.wrench; }
  /// Device wrench of the last tick in scene axes, with the device's magnitude.
  [[nodiscard]] Wrench sentInScene() const noexcept { return mapping_.turnedIntoScene(output_.wrench); }

 private:
  void follow(const BedParameters& bed) noexcept;
  [[nodiscard]] Wrench weight(const Scene& scene) const noexcept;

  HapticDevice* device_;
  std::size_t tool_;
  Mapping mapping_;
  Coupling coupling_;
  SafetyLayer safety_;
  std::optional<Watchdog> watchdog_;  ///< for a person's device, paced by the clock
  ToolFade fade_;
  HandState hand_;         ///< the last plausible one, in the scene
  DeviceInput input_;      ///< reading of this tick
  DeviceOutput rendered_;  ///< output of this tick before the safety layer, device frame
  DeviceOutput output_;    ///< output of the last tick, device frame
  bool silent_ = false;
  bool released_ = false;    ///< the device gets no force, because time is paused
  std::uint32_t flags_ = 0;  ///< TickFlag of events before the current tick
};

}  // namespace haptolith
