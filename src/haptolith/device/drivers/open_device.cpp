#include "haptolith/device/drivers/open_device.h"

#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/device/drivers/force_dimension.h"
#include "haptolith/device/drivers/gamepad.h"
#include "haptolith/device/drivers/inverse3.h"
#include "haptolith/device/drivers/mouse.h"
#include "haptolith/device/drivers/network_device.h"
#ifndef _WIN32
#include "haptolith/device/drivers/space_mouse.h"
#endif

namespace haptolith {

namespace {

std::vector<DeviceReport> findAnyForceDimension(const DeviceParameters& parameters) {
  return findForceDimension(parameters);
}

#ifdef _WIN32
/// Its daemon, spacenavd, runs on Linux only.
constexpr const char* kNoSpaceMouse = "a SpaceMouse works on Linux only";

std::vector<DeviceReport> findSpaceMouse(const DeviceParameters& /*parameters*/) {
  return {{.kind = DeviceKind::kSpaceMouse,
           .name = "SpaceMouse",
           .id = {},
           .usable = false,
           .why_not = kNoSpaceMouse,
           .remedy = {}}};
}

std::unique_ptr<HapticDevice> openSpaceMouse(const DeviceParameters& /*parameters*/, double /*tick_s*/) {
  throw Failure(kNoSpaceMouse);
}
#else
std::unique_ptr<HapticDevice> openSpaceMouse(const DeviceParameters& parameters, double tick_s) {
  return std::make_unique<SpaceMouse>(parameters, tick_s);
}
#endif

DeviceReport alwaysThere(DeviceKind kind, const char* name) {
  DeviceReport report;
  report.kind = kind;
  report.name = name;
  report.usable = true;
  return report;
}

}  // namespace

void validate(const DeviceParameters& device) {
  if (device.delay_s) {
    requireInRange("delay_s", *device.delay_s, DeviceRanges::delay_s);
  }
  if (device.resolution_m) {
    requireInRange("resolution_m", *device.resolution_m, DeviceRanges::resolution_m);
  }
}

DeviceLimits measured(DeviceLimits limits, const DeviceParameters& parameters) noexcept {
  limits.delay_s = parameters.delay_s.value_or(limits.delay_s);
  limits.delay_known = limits.delay_known || parameters.delay_s.has_value();
  limits.resolution_m = parameters.resolution_m.value_or(limits.resolution_m);
  return limits;
}

std::unique_ptr<HapticDevice> openDevice(const DeviceParameters& parameters, double tick_s) {
  switch (parameters.kind) {
    case DeviceKind::kVirtualHand: break;
    case DeviceKind::kForceDimension: return std::make_unique<ForceDimension>(parameters);
    case DeviceKind::kInverse3: return std::make_unique<Inverse3>(parameters);
    case DeviceKind::kSpaceMouse: return openSpaceMouse(parameters, tick_s);
    case DeviceKind::kGamepad: return std::make_unique<Gamepad>(parameters, tick_s);
    case DeviceKind::kMouse: return std::make_unique<Mouse>(parameters, tick_s);
    case DeviceKind::kNetwork: return std::make_unique<NetworkDevice>(parameters);
  }
  throw InvalidParameter("kind", "virtual-hand", "a device with hardware");
}

std::vector<DeviceReport> findDevices(const DeviceParameters& parameters) {
  std::vector<DeviceReport> all{alwaysThere(DeviceKind::kVirtualHand, "virtual hand")};
  for (const auto find : {findAnyForceDimension, findInverse3, findSpaceMouse, findGamepads, findMouse}) {
    for (DeviceReport& report : find(parameters)) {
      all.push_back(std::move(report));
    }
  }
  all.push_back(alwaysThere(DeviceKind::kNetwork, "network device"));
  return all;
}

}  // namespace haptolith
