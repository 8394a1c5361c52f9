#pragma once

#include <pthread.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/device/device_parameters.h"
#include "haptolith/device/drivers/force_dimension_sdk.h"
#include "haptolith/device/haptic_device.h"

namespace haptolith {

/// A sigma.7, omega, delta or lambda of Force Dimension, or a Novint Falcon, through Force Dimension's SDK, which is
/// loaded when the program runs (ForceDimensionSdk). Capabilities are queried from the device: whether its
/// handle turns, is turned, grips, is gripped, and for which hand it is.
///
/// It is kLive while every call works. It is kStale, and the loop shows no force,
///   - when a call fails, a value is not finite or the handle's orientation is not a rotation; the pose is the last
///   good one;
///   - when the pose stays bit-identical for 50 reads (50 ms) while a force is rendered: the encoders of a
///   handle
///     in a person's hand always count. Without a force it may rest, as when it has been put down;
///   - when the device has its forces off: its button was pressed, or it moved too fast, or its watchdog had no
///     force for too long. The first two are for a person to switch on again, the third is taken back by read().
/// After 10 failures in a row it is kLost for good, stopped, and problem() says why.
///
/// The device has a watchdog, which this driver sets to 10 ms: it brakes the handle when the program hangs. A Falcon
/// has none. Its limit on velocity is left as it is.
class ForceDimension final : public HapticDevice {
 public:
  /// Opens the device, homes it (the handle moves; a Falcon is homed by hand) and switches its
  /// forces on, at zero.
  /// @param parameters  id: the serial number, the number in the SDK's list or the name ("sigma.7"), the first of these
  /// that fits; empty: the first device that is not in use. library: see ForceDimensionSdk.
  /// @throws Failure that names the call that failed, the SDK's reason and what to do. The device is closed again.
  explicit ForceDimension(const DeviceParameters& parameters, const ForceDimensionPlaces& places = {});

  [[nodiscard]] std::string_view name() const noexcept override { return name_; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return limits_; }
  [[nodiscard]] DeviceInput read() noexcept override;
  void write(const DeviceOutput& output) noexcept override;
  /// Sends a zero wrench and stops the device, which brakes its handle: from here, or, while the loop's thread is in
  /// the SDK, which may hold a lock then, by that thread as soon as it is out. Should it never come out, the watchdog
  /// stops the device.
  void releaseForce() noexcept override;
  [[nodiscard]] ForceRelease forceRelease() const noexcept override;
  void releaseForceRegardless() noexcept override;
  void resumeForce() noexcept override;
  /// For one thread at a time.
  [[nodiscard]] std::string_view problem() const noexcept override;

 private:
  /// Cause of a failed read.
  enum class Trouble : std::uint8_t { kNone, kPose, kVelocity, kTurning, kGripper, kForce, kNotFinite, kNoRotation };

  /// Closed with a zero wrench and brakes.
  struct OpenDevice {
    OpenDevice(const ForceDimensionSdk& opened_by, int number) : sdk(opened_by), id(static_cast<char>(number)) {}
    ~OpenDevice();
    OpenDevice(const OpenDevice&) = delete;
    OpenDevice& operator=(const OpenDevice&) = delete;

    const ForceDimensionSdk& sdk;
    char id;
  };

  /// Values that distinguish one reading from the next.
  struct Reading {
    std::array<double, 3> position_m{};
    std::array<std::array<double, 3>, 3> rotation{};
    double gripper_rad = 0;
  };

  /// Marks that the loop's thread is in the SDK.
  class InSdk;

  void findZero(const ForceDimensionPlaces& places);
  void homeByHand(double timeout_s);
  void switchOn();
  void check(int result, const char* call, const char* remedy) const;
  [[nodiscard]] Trouble measure(DeviceInput& now) noexcept;
  [[nodiscard]] bool holdsStill(const Reading& reading) noexcept;
  void watchForces() noexcept;
  [[nodiscard]] int enableForces() noexcept;
  [[nodiscard]] int send(const DeviceOutput& output) noexcept;
  void stop() noexcept;

  ForceDimensionSdk sdk_;
  OpenDevice device_;
  std::string name_;
  int type_;
  double hand_;  ///< 1 for right hands; -1 for left ones, whose gripper counts the other way round
  bool wrist_, active_wrist_, gripper_, active_gripper_;
  DeviceLimits limits_;

  DeviceInput last_;  ///< the last good one
  Reading reading_;
  int failures_ = 0;    ///< in a row
  int same_reads_ = 0;  ///< reads with the same pose while a force was rendered, since it last changed
  std::uint64_t reads_ = 0;
  bool shows_force_ = false;
  bool forces_seen_ = false;  ///< whether the device has ever said that its forces are on
  bool forces_off_ = false;
  int write_error_ = 0;  ///< error of the last write(); 0: none

  static constexpr pthread_t kNobody = 0;
  static_assert(std::atomic<pthread_t>::is_always_lock_free);   // a signal's handler may release the device
  std::atomic<pthread_t> in_sdk_{kNobody}, stopping_{kNobody};  ///< the thread inside
  std::atomic<bool> released_{false}, stopped_{false};
  std::atomic<Trouble> lost_by_{Trouble::kNone};
  std::atomic<int> lost_error_{0};
  mutable std::array<char, 512> problem_{};
};

/// All devices that the SDK sees, or one report of the reason when there is no device. Not for the tick.
[[nodiscard]] std::vector<DeviceReport> findForceDimension(const DeviceParameters& parameters,
                                                           const ForceDimensionPlaces& places = {});

/// Rule that lets the user at the desk open these devices, for a file /etc/udev/rules.d/70-force-dimension.rules.
[[nodiscard]] std::string forceDimensionUdevRule();

}  // namespace haptolith
