// Stubs for features that a browser lacks: devices, other processors, other instruction sets.

#include <hwy/highway.h>

#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <string_view>

#include "haptolith/bed/kernel/simd_target.h"
#include "haptolith/bed/start/ready_tile.h"
#include "haptolith/core/error.h"
#include "haptolith/core/math/arithmetic-inl.h"
#include "haptolith/device/drivers/open_device.h"

namespace haptolith {

/// Returns the content of a file that the page has fetched from its folder.
std::string_view readyTileFile(std::string_view name) {
  static std::map<std::string, std::string, std::less<>> files;
  if (const auto known = files.find(name); known != files.end()) {
    return known->second;
  }
  std::ifstream file("/tiles/" + std::string(name), std::ios::binary);
  if (!file) {
    return {};
  }
  return files.emplace(name, std::string(std::istreambuf_iterator<char>(file), {})).first->second;
}

void validate(const DeviceParameters& /*parameters*/) {}  // no device is opened

std::unique_ptr<HapticDevice> openDevice(const DeviceParameters& /*parameters*/, double /*tick_s*/) {
  throw Failure("a browser opens no haptic device: install haptolith, and dig with yours there");
}

std::vector<DeviceReport> findDevices(const DeviceParameters& /*parameters*/) {
  return {};
}

const char* simdTarget() noexcept {
  return hwy::TargetName(HWY_TARGET);
}

const char* arithmetic() noexcept {
  return HWY_NAMESPACE::kFused ? "fused" : "unfused";
}

}  // namespace haptolith
