#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "haptolith/core/process/latest_value.h"
#include "haptolith/device/device_parameters.h"
#include "haptolith/device/drivers/rate_control.h"
#include "haptolith/device/haptic_device.h"

namespace haptolith {

/// State of a gamepad's sticks and triggers, in SDL's convention: sticks -1 to 1, to the right and *towards* the user;
/// triggers 0 to 1.
struct PadSticks {
  double left_right = 0, left_towards = 0;    ///< left stick
  double right_right = 0, right_towards = 0;  ///< right stick
  double left_trigger = 0;
  bool raise = false;  ///< left shoulder button
  bool roll = false;   ///< right shoulder button
};

/// The speed they ask for, in the device's frame (x to the right, y away from the user, z up): the left stick moves the
/// tool over the bed; the left trigger lowers it or, with the left shoulder button, raises it; the right stick tips it
/// away from the user and back and swings it about the vertical or, with the right shoulder button, rolls it to the
/// sides. As rateOf(), for each stick and trigger separately, so that a stick that does not centre exactly moves
/// nothing when a trigger is pulled.
[[nodiscard]] Twist speedOf(const PadSticks& sticks) noexcept;

/// A gamepad, through SDL 2: moves the tool by speeds (RateParameters), closes the gripper with the right trigger, and
/// rumbles as strongly as the tool feels force. A pad is silent as long as nothing changes, so that silence is rest and
/// the state is never kStale.
class Gamepad final : public HapticDevice {
 public:
  /// The force that makes it rumble with all its might; half of it with half. A rumble has no direction and closes no
  /// loop of forces.
  static constexpr double kFullRumble_n = 10;

  /// Opens the first gamepad, or the one that `id` names: its number or name as findGamepads() has it.
  /// @throws Failure when it does not exist, with the available ones and a remedy; InvalidParameter as SteeredHandle.
  Gamepad(const DeviceParameters& parameters, double tick_s);
  ~Gamepad() override;
  Gamepad(const Gamepad&) = delete;
  Gamepad& operator=(const Gamepad&) = delete;

  [[nodiscard]] std::string_view name() const noexcept override { return name_; }
  /// Its force is kFullRumble_n, its workspace SteeredHandle's.
  [[nodiscard]] DeviceLimits limits() const noexcept override;
  [[nodiscard]] DeviceInput read() noexcept override;
  void write(const DeviceOutput& output) noexcept override;
  void releaseForce() noexcept override { released_.store(true, std::memory_order_relaxed); }
  void resumeForce() noexcept override { released_.store(false, std::memory_order_relaxed); }
  [[nodiscard]] std::string_view problem() const noexcept override;

 private:
  class Pad;  // SDL's side

  struct Told {
    Twist speed;  ///< device frame
    double gripper_open = 1;
    std::uint32_t buttons = 0;
    bool connected = true;
  };

  void serve(const std::stop_token& stop, Pad& pad);
  [[nodiscard]] double rumbleShare(std::int64_t now_ns) noexcept;

  SteeredHandle handle_;
  std::string name_, problem_;
  LatestValue<Told> told_;
  std::atomic<bool> connected_{true}, released_{false};
  std::atomic<double> force_n_{0};
  std::atomic<std::uint64_t> writes_{0};
  std::uint64_t writes_seen_ = 0;  ///< by the pad's thread, and when
  std::int64_t last_write_ns_ = 0;
  std::jthread thread_;
};

/// Gamepads that SDL reports, or the reason when there is no gamepad. Takes about 0.05 s; not for the tick.
[[nodiscard]] std::vector<DeviceReport> findGamepads(const DeviceParameters& parameters);

}  // namespace haptolith
