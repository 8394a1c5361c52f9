#include "haptolith/device/drivers/force_dimension_sdk.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;

/// Names with one beginning and one end.
struct NamePattern {
  std::string_view begin, end;

  [[nodiscard]] bool fits(std::string_view name) const {
    return name.size() >= begin.size() + end.size() && name.starts_with(begin) && name.ends_with(end);
  }
  [[nodiscard]] std::string text() const { return fmt::format("{}*{}", begin, end); }
};

// Names of libraries in SDKs, the folder of each compiler's libraries, and names that the loader may know.
#ifdef _WIN32
constexpr NamePattern kLibraries{"drdms64", ".dll"};
constexpr std::string_view kCompilers = ".";
constexpr NamePattern kCompiler{"bin", ""};
constexpr std::array kLoadersNames{"drdms64.dll"};
#else
constexpr NamePattern kLibraries{"libdrd.so", ""};
constexpr std::string_view kCompilers = "lib/release";
constexpr NamePattern kCompiler{"lin-", "-gcc"};
constexpr std::array kLoadersNames{"libdrd.so.3", "libdrd.so"};
#endif

std::vector<fs::path> matching(const fs::path& folder, const NamePattern& pattern) {
  std::vector<fs::path> found;
  std::error_code ignored;  // a folder that cannot be read has nothing for us
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    if (pattern.fits(entry.path().filename().string())) {
      found.push_back(entry.path());
    }
  }
  return found;
}

/// The number that begins a text, which loses it.
unsigned long takeNumber(std::string_view& text) {
  unsigned long number = 0;
  while (!text.empty() && text.front() >= '0' && text.front() <= '9') {
    number = 10 * number + static_cast<unsigned long>(text.front() - '0');
    text.remove_prefix(1);
  }
  return number;
}

/// libdrd.so.3.17.10 comes before libdrd.so.3.17.6, and both before libdrd.so.
bool isNewer(const fs::path& a, const fs::path& b) {
  const std::string texts[] = {a.filename().string(), b.filename().string()};
  std::string_view left = texts[0];
  std::string_view right = texts[1];
  const auto digit = [](std::string_view text) { return text.front() >= '0' && text.front() <= '9'; };
  while (!left.empty() && !right.empty()) {
    if (digit(left) && digit(right)) {
      const unsigned long number = takeNumber(left);
      const unsigned long other = takeNumber(right);
      if (number != other) {
        return number > other;
      }
    } else if (left.front() != right.front()) {
      return left.front() > right.front();
    } else {
      left.remove_prefix(1);
      right.remove_prefix(1);
    }
  }
  return left.size() > right.size();
}

/// The libraries in a folder and where an SDK's folder keeps them (lib/release/lin-x86_64-gcc/), newest first; the
/// searched places when there is none.
std::vector<fs::path> librariesBelow(const fs::path& folder) {
  std::vector<fs::path> found = matching(folder, kLibraries);
  for (const fs::path& compiler : matching(folder / kCompilers, kCompiler)) {
    const std::vector<fs::path> here = matching(compiler, kLibraries);
    found.insert(found.end(), here.begin(), here.end());
  }
  std::sort(found.begin(), found.end(), isNewer);
  const std::string name = kLibraries.text();
  return found.empty() ? std::vector<fs::path>{folder / name, folder / kCompilers / kCompiler.text() / name} : found;
}

std::vector<fs::path> candidates(const fs::path& library, const ForceDimensionPlaces& places) {
  if (!library.empty()) {     // another SDK than the one that was asked for would be a surprise
    std::error_code ignored;  // what cannot be looked at cannot be loaded either, and the loader says why
    // A name without a slash would be looked for in the loader's folders, even if there is such a file here.
    const fs::path there = fs::exists(library, ignored) ? fs::absolute(library) : library;
    return fs::is_directory(there, ignored) ? librariesBelow(there) : std::vector{there};
  }
  std::vector<fs::path> all;
  const auto add = [&all](const std::vector<fs::path>& some) { all.insert(all.end(), some.begin(), some.end()); };
  for (const char* variable : {"FORCEDIM_SDK", "FDSDK"}) {
    if (const char* folder = std::getenv(variable); folder != nullptr && fs::path(folder).is_absolute()) {
      add(librariesBelow(folder));
    }
  }
  // An SDK brings no file with the plain name that the loader would look for.
  if (const char* folders = std::getenv("LD_LIBRARY_PATH"); folders != nullptr) {
    std::istringstream text(folders);
    for (std::string folder; std::getline(text, folder, ':');) {
      if (!folder.empty()) {
        std::vector<fs::path> here = matching(folder, kLibraries);
        std::sort(here.begin(), here.end(), isNewer);
        add(here);
      }
    }
  }
  add({kLoadersNames.begin(), kLoadersNames.end()});
  add(librariesBelow(places.local_libraries));
  return all;
}

SharedLibrary firstThatLoads(const fs::path& library, const ForceDimensionPlaces& places) {
  std::vector<std::string> tried;
  for (const fs::path& candidate : candidates(library, places)) {
    if (candidate.filename() == kLibraries.text()) {  // a folder where nothing is called like that
      tried.push_back(fmt::format("there is no {}", candidate.string()));
      continue;
    }
    try {
      return SharedLibrary(candidate);
    } catch (const Failure& failure) {
      tried.emplace_back(failure.what());
    }
  }
  throw Failure(fmt::format("its SDK (libdrd) was not found. Tried:\n  {}", fmt::join(tried, "\n  ")));
}

}  // namespace

ForceDimensionSdk::ForceDimensionSdk(const fs::path& wanted, const ForceDimensionPlaces& places)
    : library(firstThatLoads(wanted, places)) {
  try {
    error_get_last = library.symbol("dhdErrorGetLast");
    error_get_last_str = library.symbol("dhdErrorGetLastStr");
    error_get_str = library.symbol("dhdErrorGetStr");
    get_device_count = library.symbol("dhdGetDeviceCount");
    open_id = library.symbol("dhdOpenID");
    close = library.symbol("dhdClose");
    drd_open = library.symbol("drdOpen");
    drd_open_id = library.symbol("drdOpenID");
    drd_close = library.symbol("drdClose");
    drd_is_initialized = library.symbol("drdIsInitialized");
    drd_auto_init = library.symbol("drdAutoInit");
    drd_stop = library.symbol("drdStop");
    get_system_name = library.symbol("dhdGetSystemName");
    get_system_type = library.symbol("dhdGetSystemType");
    get_serial_number = library.symbol("dhdGetSerialNumber");
    is_left_handed = library.symbol("dhdIsLeftHanded");
    has_wrist = library.symbol("dhdHasWrist");
    has_active_wrist = library.symbol("dhdHasActiveWrist");
    has_gripper = library.symbol("dhdHasGripper");
    has_active_gripper = library.symbol("dhdHasActiveGripper");
    get_position_and_orientation_frame = library.symbol("dhdGetPositionAndOrientationFrame");
    get_linear_velocity = library.symbol("dhdGetLinearVelocity");
    get_angular_velocity_rad = library.symbol("dhdGetAngularVelocityRad");
    get_gripper_angle_rad = library.symbol("dhdGetGripperAngleRad");
    get_button_mask = library.symbol("dhdGetButtonMask");
    get_status = library.symbol("dhdGetStatus");
    set_force_and_torque_and_gripper_force = library.symbol("dhdSetForceAndTorqueAndGripperForce");
    enable_force = library.symbol("dhdEnableForce");
    set_brakes = library.symbol("dhdSetBrakes");
    stop = library.symbol("dhdStop");
    set_gravity_compensation = library.symbol("dhdSetGravityCompensation");
    set_max_force = library.symbol("dhdSetMaxForce");
    set_max_torque = library.symbol("dhdSetMaxTorque");
    set_max_gripper_force = library.symbol("dhdSetMaxGripperForce");
    enable_expert_mode = library.symbol("dhdEnableExpertMode");
    disable_expert_mode = library.symbol("dhdDisableExpertMode");
    set_watchdog = library.symbol("dhdSetWatchdog");
  } catch (const Failure& missing) {
    throw Failure(fmt::format("{}. It is not an SDK of Force Dimension, or it is too old", missing.what()));
  }
}

std::string ForceDimensionSdk::lastError() const {
  const char* const text = error_get_last_str();
  return text != nullptr ? text : "no reason given";
}

std::string ForceDimensionSdk::systemName(char id) const {
  const char* const name = get_system_name(id);
  return name != nullptr ? name : "Force Dimension";
}

}  // namespace haptolith
