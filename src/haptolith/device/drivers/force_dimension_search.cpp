#include "haptolith/device/drivers/force_dimension_search.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>

#include "haptolith/core/error.h"
#include "haptolith/device/drivers/force_dimension.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;

std::string firstLine(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return line;
}

/// "sigma.x haptic device (USB 1451:0402)" for each of these devices that is plugged in, no matter which user may open
/// it.
std::vector<std::string> pluggedIn(const fs::path& usb_devices) {
  std::vector<std::string> found;
  std::error_code ignored;  // a system without USB has no devices
  for (const fs::directory_entry& entry : fs::directory_iterator(usb_devices, ignored)) {
    const std::string vendor = firstLine(entry.path() / "idVendor");
    const std::string product = firstLine(entry.path() / "idProduct");
    const bool is_falcon = vendor == "0403" && product == "cb48";
    if (vendor == "1451" || is_falcon) {
      const std::string said = firstLine(entry.path() / "product");
      const char* const otherwise = is_falcon ? "Novint Falcon" : "haptic device";
      found.push_back(fmt::format("{} (USB {}:{})", said.empty() ? otherwise : said, vendor, product));
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::string permissionRemedy() {
  return fmt::format(
      "write these lines into /etc/udev/rules.d/70-force-dimension.rules, then run `sudo udevadm control --reload`, "
      "and "
      "unplug the device and plug it in again:\n{}",
      forceDimensionUdevRule());
}

/// A device in the SDK's list.
struct Listed {
  int index = 0;
  std::string name;
  std::string serial;  ///< empty: it has none
  bool opens = false;
  std::string error;  ///< when it does not
  bool in_use = false;

  [[nodiscard]] std::string id() const { return serial.empty() ? fmt::format("{}", index) : serial; }
};

std::vector<Listed> list(const ForceDimensionSdk& sdk) {
  std::vector<Listed> all;
  const int count = sdk.get_device_count();
  for (int index = 0; index < count; ++index) {
    Listed one;
    one.index = index;
    const int opened = sdk.open_id(static_cast<char>(index));
    one.opens = opened >= 0;
    if (one.opens) {
      const char id = static_cast<char>(opened);
      one.name = sdk.systemName(id);
      unsigned short serial = 0;
      if (sdk.get_serial_number(&serial, id) >= 0 && serial != 0) {
        one.serial = fmt::format("{}", serial);
      }
      sdk.close(id);
    } else {
      one.error = sdk.lastError();
      one.in_use = sdk.error_get_last() == ForceDimensionSdk::kErrorDeviceInUse;
    }
    all.push_back(one);
  }
  return all;
}

DeviceReport unusable() {
  DeviceReport report;
  report.kind = DeviceKind::kForceDimension;
  report.name = "Force Dimension";
  return report;
}

}  // namespace

DeviceReport whyNoForceDimension(const ForceDimensionPlaces& places, const std::string& what_failed) {
  DeviceReport report = unusable();
  const std::vector<std::string> plugged_in = pluggedIn(places.usb_devices);
  if (plugged_in.empty()) {
    report.why_not = fmt::format("{}; no USB device with vendor 1451 (Force Dimension) or 0403:cb48 (Falcon) in {}",
                                 what_failed, places.usb_devices.string());
    report.remedy = "plug the device in and switch it on";
  } else {
    report.why_not = fmt::format("{}, but it is plugged in: {}", what_failed, fmt::join(plugged_in, ", "));
    report.remedy = "end other programs that use it; if no program uses it, " + permissionRemedy();
  }
  return report;
}

void failWith(const DeviceReport& report) {
  throw Failure(fmt::format("{}: {}. What to do: {}", report.name, report.why_not, report.remedy));
}

int forceDimensionIndex(const std::string& id, const ForceDimensionSdk& sdk, const ForceDimensionPlaces& places) {
  const std::vector<Listed> all = list(sdk);
  const auto find = [&](const auto& key) -> std::optional<int> {
    const auto found = std::find_if(all.begin(), all.end(), [&](const Listed& one) { return key(one) == id; });
    return found != all.end() ? std::optional(found->index) : std::nullopt;
  };
  for (const std::optional<int> found : {find([](const Listed& one) { return one.serial; }),
                                         find([](const Listed& one) { return fmt::format("{}", one.index); }),
                                         find([](const Listed& one) { return one.name; })}) {
    if (found) {
      return *found;
    }
  }
  if (all.empty()) {
    failWith(whyNoForceDimension(places, "the SDK sees no device"));
  }
  std::vector<std::string> names(all.size());
  std::transform(all.begin(), all.end(), names.begin(),
                 [](const Listed& one) { return fmt::format("{} ({})", one.id(), one.opens ? one.name : one.error); });
  throw Failure(fmt::format("Force Dimension: there is no device {}. Available: {}", id, fmt::join(names, ", ")));
}

std::string forceDimensionUdevRule() {
  return "# Haptic devices of Force Dimension, and the Novint Falcon: for the user who is logged in at the machine.\n"
         "SUBSYSTEM==\"usb\", ATTR{idVendor}==\"1451\", MODE=\"0660\", GROUP=\"plugdev\", TAG+=\"uaccess\"\n"
         "SUBSYSTEM==\"usb\", ATTR{idVendor}==\"0403\", ATTR{idProduct}==\"cb48\", MODE=\"0660\", GROUP=\"plugdev\", "
         "TAG+=\"uaccess\"\n";
}

std::vector<DeviceReport> findForceDimension(const DeviceParameters& parameters, const ForceDimensionPlaces& places) {
  std::optional<ForceDimensionSdk> sdk;
  try {
    sdk.emplace(parameters.library, places);
  } catch (const Failure& failure) {
    DeviceReport report = unusable();
    report.why_not = failure.what();
    report.remedy = kForceDimensionSdkRemedy;
    if (const std::vector<std::string> plugged_in = pluggedIn(places.usb_devices); !plugged_in.empty()) {
      report.why_not += fmt::format("\nPlugged in: {}", fmt::join(plugged_in, ", "));
    }
    return {report};
  }
  std::vector<DeviceReport> reports;
  for (const Listed& one : list(*sdk)) {
    DeviceReport report = unusable();
    if (one.opens) {
      report.name = one.name;
      report.usable = true;
    } else {
      report = whyNoForceDimension(places, fmt::format("dhdOpenID({}) failed: {}", one.index, one.error));
      if (one.in_use) {
        report.remedy = "end the other program that uses it";
      }
    }
    report.id = one.id();
    reports.push_back(report);
  }
  if (reports.empty()) {
    reports.push_back(whyNoForceDimension(places, fmt::format("{} sees no device", sdk->library.path().string())));
  }
  return reports;
}

}  // namespace haptolith
