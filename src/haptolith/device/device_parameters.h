#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "haptolith/core/error.h"
#include "haptolith/device/haptic_device.h"

namespace haptolith {

enum class DeviceKind { kVirtualHand, kForceDimension, kInverse3, kSpaceMouse, kGamepad, kMouse, kNetwork };

/// Which device to open, and how.
struct DeviceParameters {
  DeviceKind kind = DeviceKind::kVirtualHand;
  std::string id;  ///< which of several: its number, serial or name as `haptolith devices` prints it; empty: the first
  std::string library;  ///< kForceDimension: the SDK's folder or library; empty: looked for. Never from a file
  /// kNetwork, from the command line only, because scenes may be foreign: 64 hexadecimal digits shared by both
  /// ends.
  std::string key{};
  bool insecure = false;  ///< kNetwork: whether it may listen beyond this machine without a key
  std::string address;    ///< kInverse3: of the service, kNetwork: to listen on; empty: the driver's usual one

  /// Values measured by the owner, instead of the driver's assumptions: see DeviceLimits.
  std::optional<double> delay_s, resolution_m;

  [[nodiscard]] bool operator==(const DeviceParameters&) const = default;
};

/// Valid ranges of the owner's measurements.
struct DeviceRanges {
  static constexpr Range delay_s{0, 0.03};
  static constexpr Range resolution_m{0, 0.005, Ends::kOpenBelow};
};

/// @throws InvalidParameter with the key, the value and the valid range.
void validate(const DeviceParameters& device);

/// Returns the limits with the owner's measurements.
[[nodiscard]] DeviceLimits measured(DeviceLimits limits, const DeviceParameters& parameters) noexcept;

/// One device that a driver has found, or why it found none.
struct DeviceReport {
  DeviceKind kind = DeviceKind::kVirtualHand;
  std::string name;  ///< "sigma.7"
  std::string id;    ///< value for DeviceParameters::id
  bool usable = false;
  std::string why_not;  ///< when it is not: what was tried
  std::string remedy;   ///< and what to do about it
};

}  // namespace haptolith
