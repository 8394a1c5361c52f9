#pragma once

#include <filesystem>
#include <string>

#include "haptolith/core/platform/shared_library.h"

namespace haptolith {

/// Places of files of Force Dimension's SDK. Tests put their own places here.
struct ForceDimensionPlaces {
  std::filesystem::path usb_devices = "/sys/bus/usb/devices";  ///< the kernel's list
  std::filesystem::path local_libraries = "/usr/local/lib";    ///< looked through when nothing else has the SDK
  double homing_patience_s = 60;                               ///< time limit for homing a Falcon by hand
};

/// The functions of Force Dimension's SDK that the driver calls, loaded when the program runs: the SDK may not be
/// redistributed, and not every machine has it. libdrd alone carries the functions of DHD too. Names and types are
/// facts of the SDK's interface (versions 3.14 to 3.17). Lengths are in m, angles in rad, forces in N, torques in N m.
/// A device's number is what an opening function has returned. A result below 0 is an error; a reading function may
/// return 1 (its time guard: nothing newer yet), a setting one 2 (a motor is saturated). The SDK may be called from
/// several threads at once, which means that it locks.
struct ForceDimensionSdk {
  /// The SDK's numbers for some errors.
  static constexpr int kErrorNotAvailable = 6, kErrorTimeout = 7, kErrorNotImplemented = 10, kErrorDeviceInUse = 20;
  /// Entries of a device's status, and values of the last one.
  static constexpr int kStatusForce = 5, kStatusForceOffCause = 14, kForceOffByWatchdog = 3;
  static constexpr int kFalcon = 60;  ///< a system's type

  /// Loads `wanted`: the SDK's folder, a folder with libdrd.so* or the file itself. When it is empty looks in
  /// $FORCEDIM_SDK and $FDSDK, in the loader's own path and in places.local_libraries; of several versions in one
  /// folder the newest. Folders in the environment that are relative are passed over.
  /// @throws Failure with every path tried; or the function that a library lacks, and the library.
  explicit ForceDimensionSdk(const std::filesystem::path& wanted, const ForceDimensionPlaces& places = {});

  /// The last error of this thread, in the SDK's words.
  [[nodiscard]] std::string lastError() const;
  /// "sigma.7"
  [[nodiscard]] std::string systemName(char id) const;

  SharedLibrary library;

  int (*error_get_last)();
  const char* (*error_get_last_str)();
  const char* (*error_get_str)(int error);

  int (*get_device_count)();
  int (*open_id)(char index);
  int (*close)(char id);
  int (*drd_open)();
  int (*drd_open_id)(char index);
  int (*drd_close)(char id);
  bool (*drd_is_initialized)(char id);
  int (*drd_auto_init)(char id);
  int (*drd_stop)(bool force_on, char id);

  const char* (*get_system_name)(char id);
  int (*get_system_type)(char id);
  int (*get_serial_number)(unsigned short* serial, char id);
  bool (*is_left_handed)(char id);
  bool (*has_wrist)(char id);
  bool (*has_active_wrist)(char id);
  bool (*has_gripper)(char id);
  bool (*has_active_gripper)(char id);

  int (*get_position_and_orientation_frame)(double* x, double* y, double* z, double rotation[3][3], char id);
  int (*get_linear_velocity)(double* vx, double* vy, double* vz, char id);
  int (*get_angular_velocity_rad)(double* wx, double* wy, double* wz, char id);
  int (*get_gripper_angle_rad)(double* angle, char id);
  unsigned int (*get_button_mask)(char id);
  int (*get_status)(int* status, char id);

  int (*set_force_and_torque_and_gripper_force)(double fx, double fy, double fz, double tx, double ty, double tz,
                                                double gripper, char id);
  int (*enable_force)(unsigned char on, char id);
  int (*set_brakes)(int on, char id);
  int (*stop)(char id);
  int (*set_gravity_compensation)(int on, char id);
  int (*set_max_force)(double newton, char id);
  int (*set_max_torque)(double newton_metre, char id);
  int (*set_max_gripper_force)(double newton, char id);
  int (*enable_expert_mode)();
  int (*disable_expert_mode)();
  int (*set_watchdog)(unsigned char eighths_ms, char id);
};

}  // namespace haptolith
