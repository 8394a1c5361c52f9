// A mock of Force Dimension's SDK: its functions, without a device, for tests. They do what a test orders. Like
// the SDK's they may be called from several threads at once, and therefore lock.

#include "force_dimension_stand_in.h"

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <limits>
#include <mutex>
#include <thread>
#include <utility>

namespace {

haptolith::StandIn stand_in;
std::mutex in_use;

/// Writes the call down; whether it works.
bool called(const char* name) {
  const int number = stand_in.called++;
  if (number < static_cast<int>(stand_in.calls.size())) {
    stand_in.calls[static_cast<std::size_t>(number)] = name;
  }
  if (stand_in.failing == nullptr || std::strcmp(stand_in.failing, name) != 0) {
    return true;
  }
  const int seen = stand_in.failing_seen++;
  const bool fails = seen >= stand_in.failing_after && seen - stand_in.failing_after < stand_in.failing_times;
  if (fails) {
    stand_in.last_error = stand_in.error;
  }
  return !fails;
}

int result(const char* name) {
  return called(name) ? 0 : -1;
}

/// Half of the duration of a call to the device: its effect happens halfway.
void talk() {
  if (stand_in.call_us > 0) {
    std::this_thread::sleep_for(std::chrono::microseconds(stand_in.call_us) / 2);
  }
}

haptolith::StandInDevice& device(char id) {
  return stand_in.device.at(static_cast<std::size_t>(id));
}

int open(const char* name, int index) {
  if (!called(name)) {
    return -1;
  }
  if (index >= stand_in.devices || device(static_cast<char>(index)).in_use) {
    stand_in.last_error = index >= stand_in.devices ? 5 : 20;
    return -1;
  }
  stand_in.open = true;
  return index;
}

}  // namespace

extern "C" {

haptolith::StandIn* standIn() {
  return &stand_in;
}

int dhdErrorGetLast() {
  return stand_in.last_error;
}
const char* dhdErrorGetStr(int error) {
  return error == 2 ? "communication error" : error == 20 ? "device in use" : error == 5 ? "no device" : "other error";
}
const char* dhdErrorGetLastStr() {
  return dhdErrorGetStr(stand_in.last_error);
}

int dhdGetDeviceCount() {
  return stand_in.devices;
}
int dhdOpenID(char index) {
  return open("dhdOpenID", index);
}
int dhdClose(char) {
  stand_in.open = false;
  return result("dhdClose");
}
int drdOpen() {
  int index = 0;
  while (index < stand_in.devices && device(static_cast<char>(index)).in_use) {
    ++index;
  }
  return open("drdOpen", index);
}
int drdOpenID(char index) {
  return open("drdOpenID", index);
}
int drdClose(char) {
  stand_in.open = false;
  return result("drdClose");
}
bool drdIsInitialized(char) {
  return stand_in.initialized;
}
int drdAutoInit(char) {
  stand_in.initialized = true;
  return result("drdAutoInit");
}
int drdStop(bool force_on, char) {
  return result(force_on ? "drdStop(true)" : "drdStop(false)");
}

const char* dhdGetSystemName(char id) {
  return device(id).name;
}
int dhdGetSystemType(char id) {
  return device(id).type;
}
int dhdGetSerialNumber(unsigned short* serial, char id) {
  *serial = device(id).serial;
  return 0;
}
bool dhdIsLeftHanded(char id) {
  return device(id).left_handed;
}
bool dhdHasWrist(char id) {
  return device(id).wrist;
}
bool dhdHasActiveWrist(char id) {
  return device(id).active_wrist;
}
bool dhdHasGripper(char id) {
  return device(id).gripper;
}
bool dhdHasActiveGripper(char id) {
  return device(id).active_gripper;
}

int dhdGetPositionAndOrientationFrame(double* x, double* y, double* z, double r[3][3], char) {
  const std::lock_guard lock(in_use);
  talk();
  talk();
  if (!called("dhdGetPositionAndOrientationFrame")) {
    return -1;
  }
  stand_in.poses += stand_in.frozen ? 0 : 1;
  *x = stand_in.position_m[0] + 1e-9 * stand_in.poses;
  *y = stand_in.position_m[1];
  *z = stand_in.not_a_number ? std::numeric_limits<double>::quiet_NaN() : stand_in.position_m[2];
  const double c = std::cos(stand_in.turned_rad), s = std::sin(stand_in.turned_rad);
  const double turned[3][3] = {{c, -s, 0}, {s, c, 0}, {0, 0, stand_in.no_rotation ? -1.0 : 1.0}};
  std::memcpy(r, turned, sizeof turned);
  return stand_in.reading_result;
}
int dhdGetLinearVelocity(double* x, double* y, double* z, char) {
  const std::lock_guard lock(in_use);
  talk();
  talk();
  *x = stand_in.velocity_m_s[0];
  *y = stand_in.velocity_m_s[1];
  *z = stand_in.velocity_m_s[2];
  return called("dhdGetLinearVelocity") ? stand_in.reading_result : -1;
}
int dhdGetAngularVelocityRad(double* x, double* y, double* z, char) {
  const std::lock_guard lock(in_use);
  talk();
  talk();
  *x = 1;
  *y = 2;
  *z = 3;
  return called("dhdGetAngularVelocityRad") ? stand_in.reading_result : -1;
}
int dhdGetGripperAngleRad(double* angle, char id) {
  const std::lock_guard lock(in_use);
  talk();
  talk();
  *angle = device(id).left_handed ? -stand_in.gripper_rad : stand_in.gripper_rad;
  return called("dhdGetGripperAngleRad") ? stand_in.reading_result : -1;
}
unsigned int dhdGetButtonMask(char) {
  return stand_in.buttons;
}
int dhdGetStatus(int* status, char) {
  const std::lock_guard lock(in_use);
  if (!called("dhdGetStatus")) {
    return -1;
  }
  std::memset(status, 0, 17 * sizeof(int));
  status[5] = stand_in.forces_on ? 1 : 0;
  status[14] = stand_in.forces_off_cause;
  return 0;
}

int dhdSetForceAndTorqueAndGripperForce(double fx, double fy, double fz, double tx, double ty, double tz, double fg,
                                        char) {
  const std::lock_guard lock(in_use);
  stand_in.in_call = true;
  if (const int signal = std::exchange(stand_in.raises, 0); signal != 0) {
    (void)std::raise(signal);
  }
  while (stand_in.hangs) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  talk();
  const bool works = called("dhdSetForceAndTorqueAndGripperForce");
  if (works && stand_in.motors != nullptr) {
    stand_in.motors->force_n = std::sqrt(fx * fx + fy * fy + fz * fz);
  }
  talk();
  stand_in.wrench = {fx, fy, fz, tx, ty, tz, fg};
  if (--stand_in.homed_by_forces == 0) {
    stand_in.initialized = true;
  }
  stand_in.in_call = false;
  return works ? stand_in.setting_result : -1;
}
int dhdEnableForce(unsigned char on, char) {
  const std::lock_guard lock(in_use);
  const int worked = result(on != 0 ? "dhdEnableForce(on)" : "dhdEnableForce(off)");
  stand_in.forces_on = worked >= 0 && on != 0;
  return worked;
}
int dhdSetBrakes(int on, char) {
  const std::lock_guard lock(in_use);
  stand_in.brakes = on != 0;
  return result(on != 0 ? "dhdSetBrakes(on)" : "dhdSetBrakes(off)");
}
int dhdStop(char) {
  const std::lock_guard lock(in_use);
  talk();
  stand_in.forces_on = false;
  stand_in.brakes = true;
  if (stand_in.motors != nullptr) {
    stand_in.motors->force_n = 0;
    ++stand_in.motors->stops;
  }
  talk();
  return result("dhdStop");
}
int dhdSetGravityCompensation(int on, char) {
  stand_in.gravity = on != 0;
  return result("dhdSetGravityCompensation");
}
int dhdSetMaxForce(double newton, char) {
  stand_in.max_force = newton;
  return result("dhdSetMaxForce");
}
int dhdSetMaxTorque(double newton_metre, char) {
  stand_in.max_torque = newton_metre;
  return result("dhdSetMaxTorque");
}
int dhdSetMaxGripperForce(double newton, char) {
  stand_in.max_gripper = newton;
  return result("dhdSetMaxGripperForce");
}
int dhdEnableExpertMode() {
  stand_in.expert = true;
  return result("dhdEnableExpertMode");
}
int dhdDisableExpertMode() {
  stand_in.expert = false;
  return result("dhdDisableExpertMode");
}
#ifndef STAND_IN_WITHOUT_WATCHDOG
int dhdSetWatchdog(unsigned char duration, char) {
  if (!stand_in.expert) {
    stand_in.last_error = 9;
    return -1;
  }
  stand_in.watchdog = duration;
  return result("dhdSetWatchdog");
}
#endif

}  // extern "C"
