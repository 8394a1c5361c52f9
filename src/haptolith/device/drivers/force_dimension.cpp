#include "haptolith/device/drivers/force_dimension.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <thread>

#include "haptolith/core/error.h"
#include "haptolith/device/drivers/force_dimension_search.h"

namespace haptolith {

namespace {

/// Consecutive failed reads, 10 ms of them, that are more than a hiccup of USB.
constexpr int kFailuresUntilLost = 10;

/// A hand trembles at about 10 Hz by more than the 0.01 mm that an encoder resolves: it never rests for half a period.
constexpr int kSameReadsUntilStale = 50;

/// Number of reads between two queries whether the device's forces are on.
constexpr std::uint64_t kReadsPerStatus = 50;

/// The device's watchdog, in units of 125 us: 10 ms. Ten ticks late is no loop any more, and a hand moves no further
/// than some millimetres meanwhile.
constexpr unsigned char kWatchdog = 80;

/// Full force in three ticks: felt as a knock, but the motors' amplifiers follow.
constexpr double kShortestRise_s = 0.003;

/// The SDK does not report the range of a gripper. CHAI3D 3.2 gives 30 degrees for sigma.7 and omega.7.
constexpr double kWidestGripper_rad = 30 * std::numbers::pi / 180;

/// Tolerance of R R^T against the identity.
constexpr double kRotationTolerance = 1e-3;

/// Limits of a device that avoid overheating and oscillation. Numbers of CHAI3D 3.2, src/devices/CDeltaDevices.cpp
/// (m_maxLinearForce, m_maxAngularTorque, m_maxGripperForce, m_maxLinearStiffness, m_maxAngularStiffness,
/// m_workspaceRadius, and -m_posWorkspaceOffset as the centre). 0 where a device has no such motor.
struct Model {
  int type;  ///< dhdGetSystemType()
  double force_n, torque_nm, gripper_n;
  double stiffness_n_m, stiffness_nm_rad;  ///< closed loop, at 1 kHz
  double radius_m, centre_x_m, centre_y_m;
  double resolution_m = 1e-5;  ///< as makers give it, rounded up; not measured
};
constexpr Model kModels[] = {
    {104, 12, 0.2, 8, 4000, 1, 0.075, 0.01, -0.02},  // sigma.7, right hand
    {105, 12, 0.2, 8, 4000, 1, 0.075, 0.01, 0.02},   // sigma.7, left hand
    {33, 12, 0, 0, 5000, 0, 0.075, 0, 0},            // omega.3
    {34, 12, 0, 0, 5000, 0, 0.075, 0, 0},            // omega.6, right hand
    {36, 12, 0, 0, 5000, 0, 0.075, 0, 0},            // omega.6, left hand
    {35, 12, 0, 8, 5000, 0, 0.075, 0, 0},            // omega.7, right hand
    {37, 12, 0, 8, 5000, 0, 0.075, 0, 0},            // omega.7, left hand
    {63, 20, 0, 0, 5000, 0, 0.15, 0, 0, 3e-5},       // delta.3
    {64, 20, 0.2, 0, 5000, 1, 0.15, 0, 0, 3e-5},     // delta.6
    {60, 8, 0, 0, 3000, 0, 0.04, 0, 0, 6.4e-5},      // Falcon, 400 dpi
};
/// lambda.3, lambda.7, sigma.3 and what is new: nothing published was found, so the smallest of the others.
constexpr Model kUnknownModel{0, 8, 0.2, 8, 3000, 1, 0.04, 0, 0, 1e-4};

const Model& modelOf(int type) {
  const auto* const found =
      std::find_if(std::begin(kModels), std::end(kModels), [type](const Model& model) { return model.type == type; });
  return found != std::end(kModels) ? *found : kUnknownModel;
}

DeviceLimits limitsOf(const Model& model, bool wrist, bool active_wrist, bool active_gripper) {
  DeviceLimits limits;
  limits.max_force_n = model.force_n;
  limits.max_torque_nm = active_wrist ? model.torque_nm : 0;
  limits.max_gripper_force_n = active_gripper ? model.gripper_n : 0;
  limits.max_force_rate_n_s = limits.max_force_n / kShortestRise_s;
  limits.max_torque_rate_nm_s = limits.max_torque_nm / kShortestRise_s;
  limits.max_gripper_rate_n_s = limits.max_gripper_force_n / kShortestRise_s;
  limits.max_stiffness_n_m = model.stiffness_n_m;
  if (limits.max_torque_nm > 0) {
    limits.max_stiffness_nm_rad = model.stiffness_nm_rad;
  }
  // A wall of stiffness K, sampled every T, is passive when the device's own damping b >= K T / 2 (Colgate and Schenkel
  // 1994, "Passivity of a class of sampled-data systems"): who shows K has at least that b.
  limits.damping_n_s_m = model.stiffness_n_m / (2 * limits.rate_hz);
  limits.workspace_centre_m = Vec3(model.centre_x_m, model.centre_y_m, 0);
  limits.workspace_radius_m = model.radius_m;
  limits.turns = wrist;
  limits.resolution_m = model.resolution_m;
  return limits;
}

ForceDimensionSdk loadSdk(const DeviceParameters& parameters, const ForceDimensionPlaces& places) {
  try {
    return ForceDimensionSdk(parameters.library, places);
  } catch (const Failure& failure) {
    throw Failure(fmt::format("Force Dimension: {}\nWhat to do: {}", failure.what(), kForceDimensionSdkRemedy));
  }
}

int openDevice(const DeviceParameters& parameters, const ForceDimensionSdk& sdk, const ForceDimensionPlaces& places) {
  const bool any = parameters.id.empty();
  const int id =
      any ? sdk.drd_open() : sdk.drd_open_id(static_cast<char>(forceDimensionIndex(parameters.id, sdk, places)));
  if (id < 0) {
    const std::string call = any ? "drdOpen" : fmt::format("drdOpenID for device {}", parameters.id);
    failWith(whyNoForceDimension(places, fmt::format("{} failed: {}", call, sdk.lastError())));
  }
  return id;
}

int sendZero(const ForceDimensionSdk& sdk, char id) noexcept {
  return sdk.set_force_and_torque_and_gripper_force(0, 0, 0, 0, 0, 0, 0, id);
}

bool isFinite(const DeviceOutput& output) noexcept {
  return output.wrench.force_n.allFinite() && output.wrench.torque_nm.allFinite() &&
         std::isfinite(output.gripper_force_n);
}

}  // namespace

// --- opening and closing

ForceDimension::ForceDimension(const DeviceParameters& parameters, const ForceDimensionPlaces& places)
    : sdk_(loadSdk(parameters, places)),
      device_(sdk_, openDevice(parameters, sdk_, places)),
      name_(sdk_.systemName(device_.id)),
      type_(sdk_.get_system_type(device_.id)),
      hand_(sdk_.is_left_handed(device_.id) ? -1 : 1),
      wrist_(sdk_.has_wrist(device_.id)),
      active_wrist_(sdk_.has_active_wrist(device_.id)),
      gripper_(sdk_.has_gripper(device_.id)),
      active_gripper_(sdk_.has_active_gripper(device_.id)),
      limits_(limitsOf(modelOf(type_), wrist_, active_wrist_, active_gripper_)) {
  limits_ = measured(limits_, parameters);
  limits_.grips = gripper_;
  limits_.turn_rad = {0, 0, -std::numbers::pi / 2};  // x is to the person, y to the right
  findZero(places);
  switchOn();
}

ForceDimension::OpenDevice::~OpenDevice() {
  sendZero(sdk, id);
  sdk.stop(id);
  sdk.drd_close(id);
}

void ForceDimension::check(int result, const char* call, const char* remedy) const {
  if (result < 0) {
    throw Failure(fmt::format("{}: {} failed: {}. What to do: {}", name_, call, sdk_.lastError(), remedy));
  }
}

/// A device that has kept its zero since it was switched on need not move again.
void ForceDimension::findZero(const ForceDimensionPlaces& places) {
  if (sdk_.drd_is_initialized(device_.id)) {
    return;
  }
  if (type_ == ForceDimensionSdk::kFalcon) {  // it has no motors for homing
    homeByHand(places.homing_patience_s);
    return;
  }
  check(sdk_.drd_auto_init(device_.id), "drdAutoInit",
        "move the handle to the centre of its workspace, remove the hand, and start again");
  constexpr bool kLeaveForcesOn = true;
  check(sdk_.drd_stop(kLeaveForcesOn, device_.id), "drdStop", "switch the device off and on, and start again");
}

/// A Falcon notices that it has been homed when it is sent forces.
void ForceDimension::homeByHand(double timeout_s) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
  while (!sdk_.drd_is_initialized(device_.id)) {
    if (std::chrono::steady_clock::now() > until) {
      throw Failure(fmt::format(
          "{}: not homed within {:g} s. What to do: start again, pull the handle out completely and push it in again",
          name_, timeout_s));
    }
    check(sendZero(sdk_, device_.id), "dhdSetForceAndTorqueAndGripperForce", "check the device's power and USB cable");
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

void ForceDimension::switchOn() {
  constexpr const char* kRemedy = "switch the device off and on, check its power and USB cable, and start again";
  const char id = device_.id;
  check(sdk_.set_max_force(limits_.max_force_n, id), "dhdSetMaxForce", kRemedy);
  if (active_wrist_) {
    check(sdk_.set_max_torque(limits_.max_torque_nm, id), "dhdSetMaxTorque", kRemedy);
  }
  if (active_gripper_) {
    check(sdk_.set_max_gripper_force(limits_.max_gripper_force_n, id), "dhdSetMaxGripperForce", kRemedy);
  }
  check(sdk_.set_brakes(0, id), "dhdSetBrakes", kRemedy);
  check(sdk_.enable_force(1, id), "dhdEnableForce", "press the device's force button, and start again");
  check(sdk_.set_gravity_compensation(1, id), "dhdSetGravityCompensation", kRemedy);
  check(sendZero(sdk_, id), "dhdSetForceAndTorqueAndGripperForce", kRemedy);

  // The watchdog belongs to the SDK's expert functions, which refuse to work until they are asked for.
  check(sdk_.enable_expert_mode(), "dhdEnableExpertMode", kRemedy);
  const int watched = sdk_.set_watchdog(kWatchdog, id);
  const int error = watched < 0 ? sdk_.error_get_last() : 0;
  if (error != ForceDimensionSdk::kErrorNotAvailable && error != ForceDimensionSdk::kErrorNotImplemented) {
    check(watched, "dhdSetWatchdog", kRemedy);
  }
  check(sdk_.disable_expert_mode(), "dhdDisableExpertMode", kRemedy);

  // Also the first of the two readings that the SDK needs for a velocity.
  const Trouble trouble = measure(last_);
  if (trouble == Trouble::kNotFinite || trouble == Trouble::kNoRotation) {
    throw Failure(fmt::format("{}: its first pose is not valid. What to do: {}", name_, kRemedy));
  }
  check(trouble == Trouble::kNone ? 0 : -1, "the first reading", kRemedy);
}

// --- the tick
// ---------------------------------------------------------------------------------------------------------

/// A device released while the loop's thread was in the SDK is stopped when the thread returns. Either releaseForce()
/// sees in_sdk_, or this thread sees released_: both are sequentially consistent.
class ForceDimension::InSdk {
 public:
  explicit InSdk(ForceDimension& device) noexcept : device_(device) { device_.in_sdk_ = pthread_self(); }
  ~InSdk() {
    device_.in_sdk_ = kNobody;
    if (device_.released_ && !device_.stopped_) {
      device_.stop();
    }
  }
  InSdk(const InSdk&) = delete;
  InSdk& operator=(const InSdk&) = delete;

 private:
  ForceDimension& device_;
};

DeviceInput ForceDimension::read() noexcept {
  if (lost_by_ != Trouble::kNone) {
    return last_;
  }
  const InSdk in_sdk(*this);
  DeviceInput now = last_;
  now.state = DeviceState::kLive;
  Trouble trouble = measure(now);
  int error = trouble == Trouble::kNone ? 0 : sdk_.error_get_last();
  if (trouble == Trouble::kNone && write_error_ != 0) {
    trouble = Trouble::kForce;
    error = write_error_;
  }
  write_error_ = 0;
  watchForces();

  if (trouble == Trouble::kNone) {
    failures_ = 0;
    const bool stale = forces_off_ || same_reads_ >= kSameReadsUntilStale;
    now.state = stale ? DeviceState::kStale : DeviceState::kLive;
    last_ = now;
    return now;
  }
  last_.twist = {};
  last_.state = DeviceState::kStale;
  if (++failures_ >= kFailuresUntilLost) {
    last_.state = DeviceState::kLost;
    lost_error_ = error;
    lost_by_ = trouble;
    stop();
  }
  return last_;
}

/// Reads the complete state. `now` is filled only when all of it is valid.
ForceDimension::Trouble ForceDimension::measure(DeviceInput& now) noexcept {
  const char id = device_.id;
  Reading reading;
  double rotation[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  auto& [x, y, z] = reading.position_m;
  if (sdk_.get_position_and_orientation_frame(&x, &y, &z, rotation, id) < 0) {
    return Trouble::kPose;
  }
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  for (std::size_t row = 0; wrist_ && row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      reading.rotation[row][column] = rotation[row][column];
      turn(static_cast<int>(row), static_cast<int>(column)) = rotation[row][column];
    }
  }
  // No velocity yet, or no more, because readings are more than 20 ms apart, is no failure.
  Twist twist;
  Vec3& v = twist.linear_m_s;
  if (sdk_.get_linear_velocity(&v.x(), &v.y(), &v.z(), id) < 0) {
    if (sdk_.error_get_last() != ForceDimensionSdk::kErrorTimeout) {
      return Trouble::kVelocity;
    }
    v.setZero();
  }
  Vec3& w = twist.angular_rad_s;
  if (wrist_ && sdk_.get_angular_velocity_rad(&w.x(), &w.y(), &w.z(), id) < 0) {
    if (sdk_.error_get_last() != ForceDimensionSdk::kErrorTimeout) {
      return Trouble::kTurning;
    }
    w.setZero();
  }
  if (gripper_ && sdk_.get_gripper_angle_rad(&reading.gripper_rad, id) < 0) {
    return Trouble::kGripper;
  }

  const Vec3 position_m(x, y, z);
  if (!position_m.allFinite() || !turn.allFinite() || !v.allFinite() || !w.allFinite() ||
      !std::isfinite(reading.gripper_rad)) {
    return Trouble::kNotFinite;
  }
  const double skew = (turn * turn.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (skew > kRotationTolerance || turn.determinant() < 0) {
    return Trouble::kNoRotation;
  }
  now.pose = {position_m, Quat(turn).normalized()};
  now.twist = twist;
  now.gripper_open = std::clamp(hand_ * reading.gripper_rad / kWidestGripper_rad, 0.0, 1.0);
  now.buttons = sdk_.get_button_mask(id);
  if (!holdsStill(reading)) {
    same_reads_ = 0;
  } else if (shows_force_) {
    ++same_reads_;
  }
  return Trouble::kNone;
}

/// Whether this reading is bit-identical to the one before.
bool ForceDimension::holdsStill(const Reading& reading) noexcept {
  const bool same = reading.position_m == reading_.position_m && reading.rotation == reading_.rotation &&
                    reading.gripper_rad == reading_.gripper_rad;
  reading_ = reading;
  return same;
}

/// Notices when the device has switched its forces off. After a trip of the watchdog, for example between the start
/// of the program and the first tick, they are switched on again, at zero: the state says kStale once, and the loop
/// begins softly.
void ForceDimension::watchForces() noexcept {
  if (released_ || (reads_++ % kReadsPerStatus != 0 && !forces_off_)) {
    return;
  }
  std::array<int, 32> status{};  // 17 entries in SDK 3.17
  if (sdk_.get_status(status.data(), device_.id) < 0) {
    return;  // a device that is gone fails its next read
  }
  const bool on = status[ForceDimensionSdk::kStatusForce] != 0;
  const bool tripped = !on && status[ForceDimensionSdk::kStatusForceOffCause] == ForceDimensionSdk::kForceOffByWatchdog;
  forces_seen_ = forces_seen_ || on;
  forces_off_ = !on && (forces_seen_ || tripped);
  if (tripped) {
    (void)enableForces();
  }
}

int ForceDimension::enableForces() noexcept {
  for (const int result :
       {sdk_.set_brakes(0, device_.id), sdk_.enable_force(1, device_.id), sendZero(sdk_, device_.id)}) {
    if (result < 0) {
      return result;
    }
  }
  return 0;
}

void ForceDimension::write(const DeviceOutput& output) noexcept {
  if (lost_by_ != Trouble::kNone) {
    return;
  }
  const InSdk in_sdk(*this);
  if (released_) {
    return;
  }
  if (send(output) < 0) {
    const int error = sdk_.error_get_last();
    write_error_ = error != 0 ? error : -1;
  }
}

/// Sends what the device has motors for; zero for what is not a number.
int ForceDimension::send(const DeviceOutput& output) noexcept {
  const DeviceOutput felt = isFinite(output) ? output : DeviceOutput{};
  const Vec3& force = felt.wrench.force_n;
  const Vec3 torque = active_wrist_ ? felt.wrench.torque_nm : Vec3::Zero();
  const double gripper = active_gripper_ ? hand_ * felt.gripper_force_n : 0;
  shows_force_ = !force.isZero(0) || !torque.isZero(0) || gripper != 0;
  return sdk_.set_force_and_torque_and_gripper_force(force.x(), force.y(), force.z(), torque.x(), torque.y(),
                                                     torque.z(), gripper, device_.id);
}

// --- releasing
// -------------------------------------------------------------------------------------------------------

void ForceDimension::releaseForce() noexcept {
  released_ = true;
  stopped_ = false;
  if (in_sdk_ == kNobody) {
    stop();
  }
}

ForceRelease ForceDimension::forceRelease() const noexcept {
  if (stopped_) {
    return ForceRelease::kDone;
  }
  const pthread_t asks = pthread_self();
  return in_sdk_ == asks || stopping_ == asks ? ForceRelease::kStuck : ForceRelease::kUnderWay;
}

/// Does not say that the device is stopped: a call that comes out after all shall stop it once more.
void ForceDimension::releaseForceRegardless() noexcept {
  released_ = true;
  sendZero(sdk_, device_.id);
  sdk_.stop(device_.id);
}

/// May be called from several threads, and from a signal's handler in the midst of itself.
void ForceDimension::stop() noexcept {
  pthread_t nobody = kNobody;
  if (!stopping_.compare_exchange_strong(nobody, pthread_self())) {
    return;
  }
  sendZero(sdk_, device_.id);
  stopped_ = sdk_.stop(device_.id) >= 0;
  stopping_ = kNobody;
}

void ForceDimension::resumeForce() noexcept {
  released_ = false;
  if (lost_by_ != Trouble::kNone) {
    return;
  }
  const InSdk in_sdk(*this);
  stopped_ = false;
  if (enableForces() < 0) {
    const int error = sdk_.error_get_last();
    write_error_ = error != 0 ? error : -1;
  }
  if (released_) {  // meanwhile; the thread that did so may have stopped the device before its forces came back
    stopped_ = false;
  }
}

std::string_view ForceDimension::problem() const noexcept {
  const char* what = nullptr;
  switch (lost_by_.load()) {
    case Trouble::kNone: return {};
    case Trouble::kPose: what = "dhdGetPositionAndOrientationFrame failed"; break;
    case Trouble::kVelocity: what = "dhdGetLinearVelocity failed"; break;
    case Trouble::kTurning: what = "dhdGetAngularVelocityRad failed"; break;
    case Trouble::kGripper: what = "dhdGetGripperAngleRad failed"; break;
    case Trouble::kForce: what = "dhdSetForceAndTorqueAndGripperForce failed"; break;
    case Trouble::kNotFinite: what = "it reported a pose that is not finite"; break;
    case Trouble::kNoRotation: what = "it reported an orientation of its handle that is not a rotation"; break;
  }
  const bool call_failed = lost_by_ != Trouble::kNotFinite && lost_by_ != Trouble::kNoRotation;
  const char* const reason = call_failed ? sdk_.error_get_str(lost_error_) : nullptr;
  const auto end =
      fmt::format_to_n(problem_.data(), problem_.size(),
                       "{} is lost: {} {} times in a row{}{}. What to do: check its power and USB cable, "
                       "switch it off and on, and start again",
                       name_, what, kFailuresUntilLost, reason != nullptr ? ": " : "", reason != nullptr ? reason : "");
  return {problem_.data(), std::min(end.size, problem_.size())};
}

}  // namespace haptolith
