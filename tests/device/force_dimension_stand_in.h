#pragma once

#include <array>
#include <atomic>
#include <climits>

namespace haptolith {

/// The simulated device of the mock SDK.
struct StandInDevice {
  const char* name = "sigma.7";
  int type = 104;
  unsigned short serial = 4711;
  bool left_handed = false, wrist = true, active_wrist = true, gripper = true, active_gripper = true;
  bool in_use = false;
};

/// State of the simulated device's motors, in memory that may be shared with another process.
struct StandInMotors {
  std::atomic<double> force_n{0};
  std::atomic<int> stops{0};
};

/// Orders of a test to the mock, and calls that the mock received. A test gets it from `standIn` in the library.
struct StandIn {
  // Orders.
  int devices = 1;
  std::array<StandInDevice, 3> device{};
  const char* failing = nullptr;  ///< the call that fails
  int failing_after = 0;          ///< number of successful calls before
  int failing_times = INT_MAX;    ///< and of failing ones
  int error = 2;                  ///< with this error
  bool initialized = false;
  int homed_by_forces = INT_MAX;  ///< number of them after which a Falcon is homed
  bool frozen = false;            ///< the pose stays as it is
  bool not_a_number = false, no_rotation = false;
  std::array<double, 3> position_m{0.01, 0.02, 0.03}, velocity_m_s{0.1, 0.2, 0.3};
  double turned_rad = 0;  ///< about z
  double gripper_rad = 0;
  unsigned int buttons = 0;
  int reading_result = 0, setting_result = 0;
  bool forces_on = false;
  int forces_off_cause = 0;
  std::atomic<bool> hangs{false};  ///< a call that sets forces does not return
  int call_us = 0;                 ///< that a call which talks to the device takes
  int raises = 0;                  ///< a signal, once, in the midst of a call that sets forces

  // Received calls.
  StandInMotors* motors = nullptr;  ///< second target of the force, for tests that outlive the program
  std::array<double, 7> wrench{};
  double max_force = -1, max_torque = -1, max_gripper = -1;
  int watchdog = -1;
  bool expert = false, brakes = true, open = false, gravity = false;
  std::atomic<bool> in_call{false};  ///< a call is setting forces
  std::array<const char*, 1 << 16> calls{};
  std::atomic<int> called{0};

  // Its own.
  int last_error = 0;
  int failing_seen = 0;
  int poses = 0;
};

}  // namespace haptolith
