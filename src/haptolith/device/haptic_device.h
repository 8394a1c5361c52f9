#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/platform/force_source.h"
#include "haptolith/core/vec.h"

namespace haptolith {

/// Whether what a device reports is valid.
enum class DeviceState : std::uint8_t {
  kLive,
  kStale,     ///< nothing new for longer than the driver waits: the pose is the last one known
  kLost,      ///< gone; the driver's problem() says why
  kFinished,  ///< nothing more will come, for example at the end of a pose file
};

/// State of the handle from a device, device frame: right-handed, m and rad.
struct DeviceInput {
  Pose pose;                  ///< handle; identity orientation from a device without rotation
  Twist twist;                ///< handle
  double gripper_open = 0;    ///< 0 closed to 1 wide open
  std::uint32_t buttons = 0;  ///< bit n: button n is down
  DeviceState state = DeviceState::kLive;
};

/// Output sent to a device, device frame.
struct DeviceOutput {
  Wrench wrench;               ///< device wrench, about the handle's origin, device frame
  double gripper_force_n = 0;  ///< > 0 opens the fingers
};

/// Properties that a device declares. Infinity means no limit; 0 N means no force feedback.
struct DeviceLimits {
  static constexpr double kNone = std::numeric_limits<double>::infinity();

  double max_force_n = kNone;
  double max_torque_nm = kNone;
  double max_gripper_force_n = kNone;
  double max_force_rate_n_s = kNone;  ///< largest rate of force, except to zero
  double max_torque_rate_nm_s = kNone;
  double max_gripper_rate_n_s = kNone;
  double max_stiffness_n_m = kNone;  ///< that it shows without shaking, at `rate_hz`
  double max_stiffness_nm_rad = kNone;
  double damping_n_s_m = 0;  ///< its own, as a hand that holds it loosely finds it
  Vec3 turn_rad =
      Vec3::Zero();  ///< turns its frame into that of a person before it: x right, y away, z up; as in Mapping
  Vec3 workspace_centre_m = Vec3::Zero();
  double workspace_radius_m = kNone;
  double rate_hz = 1000;    ///< update rate of readings and forces
  double delay_s = 0;       ///< from write() to its effect on read(), beyond a tick
  bool delay_known = true;  ///< else the delay is anything up to delay_s
  double resolution_m = 0;  ///< positions come in steps, or with noise to either side, of at most this; 0: exact
  bool turns = true;        ///< whether the handle's turn is known
  bool shows_force = true;  ///< as a force, not as a rumble
  bool grips = false;       ///< whether it has a gripper
};

/// Something that moves the tool and feels the wrench on it. read() and write() are called once a tick, in that order,
/// from the loop's thread; neither may allocate, lock, throw or wait.
class HapticDevice : public ForceSource {
 public:
  virtual ~HapticDevice() = default;

  [[nodiscard]] virtual std::string_view name() const noexcept = 0;
  [[nodiscard]] virtual DeviceLimits limits() const noexcept = 0;

  /// Whether no person's hand is at it: time may then run slower, and forces need no soft start.
  [[nodiscard]] virtual bool simulated() const noexcept { return false; }

  /// The handle now. Never NaN in a live input; a driver that cannot read reports it in `state`.
  [[nodiscard]] virtual DeviceInput read() noexcept = 0;

  /// Makes the hand feel something. What fails shows in the state of the next read().
  virtual void write(const DeviceOutput& output) noexcept = 0;

  /// Takes a releaseForce() back. From the loop's thread.
  virtual void resumeForce() noexcept = 0;

  /// Why it is lost, and what to do; empty when it is not. Not for the tick.
  [[nodiscard]] virtual std::string_view problem() const noexcept { return {}; }

  /// Returns one warning for each kind of unusable input, in order of first occurrence. From any thread; not for the
  /// tick.
  [[nodiscard]] virtual std::vector<std::string> inputWarnings() const { return {}; }

  /// Returns counts of received input for the end of a run; empty for a device that counts nothing. Not while the loop
  /// runs.
  [[nodiscard]] virtual std::string inputSummary() const { return {}; }
};

}  // namespace haptolith
