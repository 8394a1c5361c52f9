#pragma once

#include <atomic>
#include <cstdint>
#include <future>
#include <string_view>
#include <thread>
#include <vector>

#include "haptolith/core/process/latest_value.h"
#include "haptolith/device/device_parameters.h"
#include "haptolith/device/drivers/rate_control.h"
#include "haptolith/device/haptic_device.h"

namespace haptolith {

/// An ordinary mouse, through a small window of SDL 2: a click into the window takes the pointer, Esc gives it back.
/// Pushing the mouse moves the tool over the bed; the wheel, or pushing with the right button held, lowers and raises
/// it. Device's frame: x to the right, y away from the user, z up. A mouse is silent while it lies still, so that
/// silence is rest and the state is never kStale.
class Mouse final : public HapticDevice {
 public:
  static constexpr double kPerCount_m = 1e-4;  ///< movement of the tool for one count of the mouse: 0.1 mm
  static constexpr double kPerNotch_m = 2e-3;  ///< and for one notch of its wheel

  /// Opens the window.
  /// @throws Failure when there is no display or no SDL, with what to do; InvalidParameter as SteeredHandle and for an
  /// `id` other than "0": a system has one pointer.
  Mouse(const DeviceParameters& parameters, double tick_s);

  [[nodiscard]] std::string_view name() const noexcept override { return "mouse"; }
  /// It shows no force and knows no turn; its workspace is SteeredHandle's.
  [[nodiscard]] DeviceLimits limits() const noexcept override;
  /// Buttons: bit 0 left, 1 middle, 3 and 4 the thumb's; while the pointer is taken.
  [[nodiscard]] DeviceInput read() noexcept override;
  void write(const DeviceOutput&) noexcept override {}
  void releaseForce() noexcept override {}
  void resumeForce() noexcept override {}
  [[nodiscard]] std::string_view problem() const noexcept override;

 private:
  class Window;  // SDL's side

  struct Told {
    Vec3 pushed_m = Vec3::Zero();  ///< since the beginning, so that nothing is lost when a value is passed over
    std::uint32_t buttons = 0;
    bool closed = false;
  };

  void serve(const std::stop_token& stop, std::promise<void>& opened);

  SteeredHandle handle_;
  LatestValue<Told> told_;
  Vec3 seen_m_ = Vec3::Zero();
  std::atomic<bool> closed_{false};
  std::jthread thread_;
};

/// The mouse, or why its window cannot be opened. Not for the tick.
[[nodiscard]] std::vector<DeviceReport> findMouse(const DeviceParameters& parameters);

}  // namespace haptolith
