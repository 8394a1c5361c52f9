#pragma once

#include <limits>
#include <string_view>

#include "haptolith/core/vec.h"

namespace haptolith {

/// What a device tells about the hand, in the scene's frame.
struct DeviceInput {
  Pose scene_T_tool;
  Twist twist;
  bool finished = false;  ///< nothing more will come, for example at the end of a pose file
};

/// What a device can show without harm.
struct DeviceLimits {
  double max_force_n = std::numeric_limits<double>::infinity();
  double max_torque_nm = std::numeric_limits<double>::infinity();
};

/// Something that moves the tool and feels the wrench on it. read() and write() are called once a tick, in that order,
/// from the loop's thread.
class HapticDevice {
 public:
  virtual ~HapticDevice() = default;

  [[nodiscard]] virtual std::string_view name() const noexcept = 0;
  [[nodiscard]] virtual DeviceLimits limits() const noexcept = 0;

  /// Pose and velocity of the tool now. Must not allocate, lock or throw.
  [[nodiscard]] virtual DeviceInput read() noexcept = 0;

  /// Makes the hand feel `wrench` (scene frame, about the tool's origin). Must not allocate, lock or throw.
  virtual void write(const Wrench& wrench) noexcept = 0;
};

}  // namespace haptolith
