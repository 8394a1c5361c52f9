// CHAI3D 3.3 and libhaptolith, both ways (docs/how-to/chai3d.md). Header only, over haptolith.h; C++11, as CHAI3D itself.
//
//     auto *bed = new hapto::cHaptolithBed(scene);            // a CHAI3D object: the soil, drawn
//     auto *tool = new hapto::cHaptolithTool(world, *bed);    // a CHAI3D tool: the shovel that feels it
//     hapto::cHaptolithLoop loop(scene, chai3d_device);       // or: a CHAI3D device in haptolith's own loop
//
// The scene stays the caller's: destroy it last. Destroying it, the bed or the tool earlier sets the force to zero.
#ifndef HAPTOLITH_CHAI3D_HPP
#define HAPTOLITH_CHAI3D_HPP

#include <chai3d.h>
#include <haptolith/haptolith.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

namespace hapto {

/// Limits that a CHAI3D device declares, in haptolith's terms. CHAI3D reports neither delay nor resolution: 0 and 0.1 mm.
inline hapto_device_limits limitsOf(const chai3d::cHapticDeviceInfo &info) {
  const double shortest_rise_s = 0.003;  // full force in no less, as haptolith's own drivers
  hapto_device_limits limits = hapto_device_limits();
  hapto_device_limits_init(&limits);
  limits.turns = info.m_sensedRotation ? 1 : 0;
  limits.shows_force = info.m_actuatedPosition ? 1 : 0;
  limits.grips = info.m_sensedGripper ? 1 : 0;
  limits.max_force_n = info.m_actuatedPosition ? info.m_maxLinearForce : 0;
  limits.max_torque_nm = info.m_actuatedRotation ? info.m_maxAngularTorque : 0;
  limits.max_gripper_force_n = info.m_actuatedGripper ? info.m_maxGripperForce : 0;
  limits.max_force_rate_n_s = limits.max_force_n / shortest_rise_s;
  limits.max_torque_rate_nm_s = limits.max_torque_nm / shortest_rise_s;
  limits.max_gripper_rate_n_s = limits.max_gripper_force_n / shortest_rise_s;
  limits.max_stiffness_n_m = info.m_maxLinearStiffness;
  if (info.m_actuatedRotation) {
    limits.max_stiffness_nm_rad = info.m_maxAngularStiffness;
  }
  limits.damping_n_s_m = info.m_maxLinearStiffness * 1e-3 / 2;  // a device that renders K every 1 ms has at least that
  limits.turn_rad[2] = -chai3d::C_PI / 2;                       // x is to the person, y to the right
  limits.workspace_radius_m = info.m_workspaceRadius;
  limits.resolution_m = 1e-4;
  return limits;
}

namespace detail {

inline double norm(const double (&v)[3]) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

inline void put(const chai3d::cVector3d &v, double (&out)[3]) {
  for (int axis = 0; axis < 3; ++axis) {
    out[axis] = v(axis);
  }
}

inline chai3d::cVector3d vectorOf(const double (&v)[3]) {
  return chai3d::cVector3d(v[0], v[1], v[2]);
}

/// An exact quarter turn about z: CHAI3D's x (to the person), y (right) from haptolith's x (right), y (away).
inline chai3d::cMatrix3d quarterTurn() {
  chai3d::cMatrix3d turn;
  turn.set(0, -1, 0, 1, 0, 0, 0, 0, 1);
  return turn;
}

/// w x y z of a rotation.
inline void put(const chai3d::cMatrix3d &r, double (&q)[4]) {
  const double trace = r(0, 0) + r(1, 1) + r(2, 2);
  if (!(trace <= 0)) {  // a NaN stays one
    q[0] = std::sqrt(1 + trace) / 2;
    for (int axis = 0; axis < 3; ++axis) {
      const int next = (axis + 1) % 3, last = (axis + 2) % 3;
      q[axis + 1] = (r(last, next) - r(next, last)) / (4 * q[0]);
    }
    return;
  }
  int largest = 0;
  for (int axis = 1; axis < 3; ++axis) {
    largest = r(axis, axis) > r(largest, largest) ? axis : largest;
  }
  const int next = (largest + 1) % 3, last = (largest + 2) % 3;
  const double root = std::sqrt(1 + r(largest, largest) - r(next, next) - r(last, last));
  q[0] = (r(last, next) - r(next, last)) / (2 * root);
  q[largest + 1] = root / 2;
  q[next + 1] = (r(next, largest) + r(largest, next)) / (2 * root);
  q[last + 1] = (r(last, largest) + r(largest, last)) / (2 * root);
}

inline bool isFinite(const hapto_pose &pose, const hapto_twist &twist) {
  bool finite = std::isfinite(pose.orientation[3]);
  for (int i = 0; i < 3; ++i) {
    finite = finite && std::isfinite(pose.position_m[i]) && std::isfinite(pose.orientation[i]) &&
             std::isfinite(twist.linear_m_s[i]) && std::isfinite(twist.angular_rad_s[i]);
  }
  return finite;
}

inline double distance(const hapto_pose &a, const hapto_pose &b) {
  double way[3];
  for (int axis = 0; axis < 3; ++axis) {
    way[axis] = b.position_m[axis] - a.position_m[axis];
  }
  return norm(way);
}

inline hapto_pose between(const hapto_pose &from, const hapto_pose &to, double share) {
  hapto_pose pose;
  double same = 0, square = 0;
  for (int axis = 0; axis < 3; ++axis) {
    pose.position_m[axis] = from.position_m[axis] + share * (to.position_m[axis] - from.position_m[axis]);
  }
  for (int i = 0; i < 4; ++i) {
    same += from.orientation[i] * to.orientation[i];
  }
  for (int i = 0; i < 4; ++i) {  // the shorter way round
    pose.orientation[i] = (same < 0 ? share - 1 : 1 - share) * from.orientation[i] + share * to.orientation[i];
    square += pose.orientation[i] * pose.orientation[i];
  }
  for (int i = 0; i < 4; ++i) {
    pose.orientation[i] /= std::sqrt(square);
  }
  return pose;
}

inline hapto_twist between(const hapto_twist &from, const hapto_twist &to, double share) {
  hapto_twist twist;
  for (int axis = 0; axis < 3; ++axis) {
    twist.linear_m_s[axis] = from.linear_m_s[axis] + share * (to.linear_m_s[axis] - from.linear_m_s[axis]);
    twist.angular_rad_s[axis] = from.angular_rad_s[axis] + share * (to.angular_rad_s[axis] - from.angular_rad_s[axis]);
  }
  return twist;
}

/// Positions of particles, from the haptic thread to the one that draws. Neither waits for the other.
class ParticleSnapshot {
 public:
  /// Call before the first step: takes the first snapshot. False if there is no such scene.
  bool begin(const hapto_scene *scene) {
    hapto_array now = hapto_array();
    now.size = sizeof now;
    if (hapto_scene_view(scene, HAPTO_POSITION, &now) != HAPTO_OK) {
      return false;
    }
    for (std::vector<float> &buffer : buffers_) {
      buffer.resize(3 * static_cast<std::size_t>(now.count));
    }
    copy(now, 0, buffers_[0].size() / 3, buffers_[back_]);
    publish();
    return true;
  }

  /// Haptic thread, after a tick: copies some of the next snapshot once the last one has been taken.
  void copySome(const hapto_scene *scene) {
    const std::size_t kAtOnce = 4096;
    const std::size_t count = buffers_[0].size() / 3;
    if (copied_ == 0 && (middle_.load(std::memory_order_relaxed) & kNew) != 0) {
      return;
    }
    hapto_array now = hapto_array();
    now.size = sizeof now;
    if (hapto_scene_view(scene, HAPTO_POSITION, &now) != HAPTO_OK || now.count != count) {
      return;
    }
    const std::size_t end = std::min(copied_ + kAtOnce, count);
    copy(now, copied_, end, buffers_[back_]);
    copied_ = end;
    if (copied_ == count) {
      publish();
    }
  }

  /// Thread that draws: x y z of each particle, or null when there is no newer snapshot. Valid until the next call.
  const std::vector<float> *take() {
    if ((middle_.load(std::memory_order_acquire) & kNew) == 0) {
      return nullptr;
    }
    front_ = middle_.exchange(front_, std::memory_order_acq_rel) & ~kNew;
    return &buffers_[front_];
  }

 private:
  static void copy(const hapto_array &from, std::size_t begin, std::size_t end, std::vector<float> &to) {
    for (std::size_t i = begin; i < end; ++i) {
      const float *position_m = reinterpret_cast<const float *>(static_cast<const char *>(from.data) + i * from.stride_bytes);
      std::copy(position_m, position_m + 3, to.begin() + static_cast<std::ptrdiff_t>(3 * i));
    }
  }
  void publish() {
    back_ = middle_.exchange(back_ | kNew, std::memory_order_acq_rel) & ~kNew;
    copied_ = 0;
  }

  enum { kNew = 4 };
  std::vector<float> buffers_[3];
  std::size_t copied_ = 0;
  int back_ = 0, front_ = 1;
  std::atomic<int> middle_{2};
};

/// Data shared by a bed and its tool, while either exists.
struct SoilLink {
  hapto_scene *scene = nullptr;
  ParticleSnapshot snapshot;
  std::atomic<bool> placed{false};  // whether the frame is known
  chai3d::cVector3d world_P_scene_m;
  chai3d::cMatrix3d world_R_scene;
};

}  // namespace detail

/// Soil as a CHAI3D object: its particles as points. Its frame is the scene's: m, z up, the origin on the floor at the centre
/// of the box. It begins turned by 90 degrees about z, so that a person at CHAI3D's positive x axis has the scene's x to the
/// right. Move it before a hand is in it, or from the haptic thread.
class cHaptolithBed : public chai3d::cMultiPoint {
 public:
  explicit cHaptolithBed(hapto_scene *scene) : link_(std::make_shared<detail::SoilLink>()) {
    link_->scene = scene;
    hapto_scene_info info = hapto_scene_info();
    info.size = sizeof info;
    if (hapto_scene_get_info(scene, &info) == HAPTO_OK && link_->snapshot.begin(scene)) {
      surface_m_ = info.surface_m;
      updateFromScene();
    }
    setLocalRot(detail::quarterTurn());
    setPointSize(3);
  }

  std::string getClassName() override { return "HaptolithBed"; }
  /// Initial height of the soil's surface above the bed's origin, m.
  double getSurfaceHeight() const { return surface_m_; }

  /// The newest particles of a tool's scene; whether there were any. Drawing calls it: only for who draws otherwise.
  bool updateFromScene() {
    const std::vector<float> *const snapshot = link_->snapshot.take();
    if (snapshot != nullptr) {
      setPoints(snapshot->data(), snapshot->size() / 3, 3 * sizeof(float));
    }
    return snapshot != nullptr;
  }
  /// The particles of a loop's snapshot, from the thread that takes snapshots.
  bool updateFromSnapshot(const hapto_snapshot &snapshot) {
    if (snapshot.position.data == nullptr || snapshot.position.type != HAPTO_FLOAT32) {
      return false;
    }
    setPoints(snapshot.position.data, static_cast<std::size_t>(snapshot.position.count), snapshot.position.stride_bytes);
    return true;
  }

 protected:
  void render(chai3d::cRenderOptions &a_options) override {
    updateFromScene();
    chai3d::cMultiPoint::render(a_options);
  }
  /// Called by computeGlobalPositions(), from the haptic thread and from the one that draws: writes what has changed only.
  void updateGlobalPositions(const bool a_frameOnly) override {
    const chai3d::cVector3d position_m = getGlobalPos();
    const chai3d::cMatrix3d rotation = getGlobalRot();
    bool same = link_->placed.load(std::memory_order_acquire);
    for (int i = 0; i < 3; ++i) {
      same = same && link_->world_P_scene_m(i) == position_m(i);
      for (int j = 0; j < 3; ++j) {
        same = same && link_->world_R_scene(i, j) == rotation(i, j);
      }
    }
    if (!same) {
      link_->world_P_scene_m = position_m;
      link_->world_R_scene = rotation;
      link_->placed.store(true, std::memory_order_release);
    }
    chai3d::cMultiPoint::updateGlobalPositions(a_frameOnly);
  }

 private:
  friend class cHaptolithTool;

  void setPoints(const void *data, std::size_t count, std::size_t stride_bytes) {
    while (getNumPoints() < count) {
      newPoint(chai3d::cVector3d(0, 0, 0), chai3d::cColorf(0.55F, 0.52F, 0.48F));
    }
    for (std::size_t i = 0; i < count; ++i) {
      const float *at_m = reinterpret_cast<const float *>(static_cast<const char *>(data) + i * stride_bytes);
      m_vertices->setLocalPos(static_cast<unsigned int>(i), at_m[0], at_m[1], at_m[2]);
    }
  }

  std::shared_ptr<detail::SoilLink> link_;
  double surface_m_ = 0;
};

/// The scene's tool in CHAI3D's loop, which may turn at any rate: ticks of the soil come at whole milliseconds, with the hand
/// where it was then; between them the force follows the contact stiffness. The force passes through haptolith's safety
/// layer. One tool has a scene; no other code may use the scene while it is in the loop.
class cHaptolithTool : public chai3d::cGenericTool {
 public:
  cHaptolithTool(chai3d::cWorld *a_parentWorld, const cHaptolithBed &bed)
      : chai3d::cGenericTool(a_parentWorld), link_(bed.link_), device_R_tool_(detail::quarterTurn()) {
    setUseForceRise(false);
  }
  ~cHaptolithTool() override {
    destroySafety();
    if (fade_ < 1) {  // the next user of the scene finds the complete tool
      hapto_scene_set_tool_fade(link_->scene, 1);
    }
  }
  cHaptolithTool(const cHaptolithTool &) = delete;
  cHaptolithTool &operator=(const cHaptolithTool &) = delete;

  std::string getClassName() override { return "HaptolithTool"; }

  // --- before the loop ------------------------------------------------------------------------------------------------

  /// Sets the limits of the device for the safety layer, instead of CHAI3D's.
  void setDeviceLimits(const hapto_device_limits &limits) {
    own_limits_ = limits;
    has_own_limits_ = true;
    prepared_ = false;
  }
  /// Keys of [safety], "safety.max_force_n=6", and the stiffness of the softest contact, of the soil or of the tool.
  void setSafetyParameters(const std::vector<std::string> &overrides, double softest_spring_n_m = 100) {
    overrides_ = overrides;
    softest_spring_n_m_ = softest_spring_n_m;
    prepared_ = false;
  }
  /// Off for a simulated hand only; a reading that is not a number trips in any case.
  void setUseSafety(bool on) {
    use_safety_ = on;
    prepared_ = false;
  }
  bool getUseSafety() const { return use_safety_; }
  /// A share of the soil's force for the hand. The workspace's scale factor stretches movements, never forces.
  void setForceScale(double scale) { force_scale_ = scale; }
  /// Sets the orientation of the tool in the handle. Initially that of the bed: both are then as in haptolith's browser view.
  void setToolRotation(const chai3d::cMatrix3d &device_R_tool) { device_R_tool_ = device_R_tool; }
  /// Whether the soil uses the velocity that the device reports (default), or the difference of positions from tick to tick.
  void setUseDeviceVelocity(bool on) { use_device_velocity_ = on; }

  // --- CHAI3D's loop --------------------------------------------------------------------------------------------------

  /// Opens the device. CHAI3D's own rise of the force is off: the safety layer's soft start would be doubled.
  bool start() override {
    setUseForceRise(false);
    prepared_ = false;
    return chai3d::cGenericTool::start();
  }
  /// As much of the soil's time as has passed on the clock since the last call.
  void computeInteractionForces() override {
    const std::chrono::steady_clock::time_point now = std::chrono::steady_clock::now();
    const double elapsed_s = known_ ? std::chrono::duration<double>(now - last_call_).count() : 0;
    last_call_ = now;
    advance(elapsed_s);
  }
  /// As above for callers with their own clock: simulated time, or a loop in real time.
  void advance(double elapsed_s) {
    if (!prepared_) {
      prepare();
    }
    if (status_ != HAPTO_OK || !link_->placed.load(std::memory_order_acquire)) {
      showNothing(status_ != HAPTO_OK ? hapto_status_text(status_) : "the bed is nowhere: world->computeGlobalPositions()");
      return;
    }
    const Hand hand = read();
    elapsed_s = elapsed_s > 0 ? elapsed_s : 0;
    if (!known_) {
      known_ = true;
      since_tick_s_ = elapsed_s = 0;
    }
    odd_ = odd_ || !isPlausible(hand, elapsed_s);
    runTicks(hand, elapsed_s);
    last_ = hand;
    show(hand);
  }
  /// Draws m_image, a mesh of the tool that the application has loaded.
  void render(chai3d::cRenderOptions &a_options) override {
    if (m_image != nullptr) {
      m_image->renderSceneGraph(a_options);
    }
  }

  // --- asking, from any thread ----------------------------------------------------------------------------------------

  std::uint64_t getTicks() const { return ticks_.load(std::memory_order_relaxed); }
  /// Why the hand feels nothing just now; "" when it does.
  const char *getTripReason() const { return reason_.load(std::memory_order_relaxed); }
  const char *getLetGoReason() const { return getTripReason(); }  ///< deprecated: getTripReason()
  /// Pose of the tool in the last tick, scene frame, and the soil wrench. Haptic thread.
  const hapto_pose &getScenePose() const { return tool_; }
  const hapto_wrench &getSceneWrench() const { return soil_wrench_; }

 private:
  /// Reading of the device, in its own frame and in the scene's.
  struct Hand {
    hapto_pose device;
    hapto_twist device_twist;
    hapto_pose scene;
    hapto_twist scene_twist;
    double open;
  };

  static hapto_device_output nothing() {
    hapto_device_output output = hapto_device_output();
    output.size = sizeof output;
    return output;
  }

  /// Allocates: before the first tick.
  void prepare() {
    prepared_ = true;
    destroySafety();
    known_ = false;
    odd_ = tripped_ = false;
    why_ = "";
    shown_ = rendered_ = nothing();
    gripper_rad_ = 0;
    hapto_device_limits_init(&limits_);
    if (m_hapticDevice != nullptr) {
      limits_ = limitsOf(m_hapticDevice->m_specifications);
      gripper_rad_ = limits_.grips != 0 ? m_hapticDevice->m_specifications.m_gripperMaxAngleRad : 0;
    }
    if (has_own_limits_) {
      limits_ = own_limits_;
    }
    hapto_scene_info info = hapto_scene_info();
    info.size = sizeof info;
    status_ = hapto_scene_get_info(link_->scene, &info);
    tick_s_ = info.tick_s;
    place_ = true;
    fade_ = use_safety_ && limits_.simulated == 0 ? 0 : 1;  // soil where a person's hand is gives way gently
    if (status_ != HAPTO_OK || !use_safety_) {
      return;
    }
    std::vector<const char *> keys;
    for (const std::string &key : overrides_) {
      keys.push_back(key.c_str());
      lowerLimit(key, "safety.max_force_n=", limits_.max_force_n);
    }
    status_ = hapto_safety_create(&limits_, keys.data(), static_cast<std::uint32_t>(keys.size()), tick_s_, softest_spring_n_m_,
                                  &safety_);
  }
  void destroySafety() {
    if (safety_ != nullptr) {
      hapto_safety_destroy(safety_);
      safety_ = nullptr;
    }
  }
  static void lowerLimit(const std::string &key, const std::string &name, double &limit) {
    if (key.compare(0, name.size(), name) == 0) {
      limit = std::min(limit, std::strtod(key.c_str() + name.size(), nullptr));
    }
  }

  Hand read() const {
    Hand hand;
    const chai3d::cMatrix3d scene_R_world = chai3d::cTranspose(link_->world_R_scene);
    detail::put(m_deviceLocalPos / m_workspaceScaleFactor, hand.device.position_m);
    detail::put(m_deviceLocalRot, hand.device.orientation);
    detail::put(m_deviceLocalLinVel / m_workspaceScaleFactor, hand.device_twist.linear_m_s);
    detail::put(m_deviceLocalAngVel, hand.device_twist.angular_rad_s);
    detail::put(scene_R_world * (m_deviceGlobalPos - link_->world_P_scene_m), hand.scene.position_m);
    detail::put(scene_R_world * m_deviceGlobalRot * device_R_tool_, hand.scene.orientation);
    detail::put(scene_R_world * m_deviceGlobalLinVel, hand.scene_twist.linear_m_s);
    detail::put(scene_R_world * m_deviceGlobalAngVel, hand.scene_twist.angular_rad_s);
    hand.open = gripper_rad_ > 0 ? m_gripperAngle / gripper_rad_ : 1;
    hand.open = hand.open < 0 ? 0 : hand.open > 1 ? 1 : hand.open;  // a NaN stays one
    return hand;
  }

  /// Numbers, and no faster than a hand: what the safety layer would refuse only after it has moved the soil.
  bool isPlausible(const Hand &hand, double elapsed_s) const {
    const double fastest_m_s = 10;
    return detail::isFinite(hand.device, hand.device_twist) && detail::isFinite(hand.scene, hand.scene_twist) &&
           std::isfinite(hand.open) &&
           (elapsed_s == 0 || !detail::isFinite(last_.device, last_.device_twist) ||
            detail::distance(last_.device, hand.device) <= fastest_m_s * std::max(elapsed_s, tick_s_));
  }

  void runTicks(const Hand &hand, double elapsed_s) {
    const double longest_silence_s = 0.02, late_s = 0.004;
    const double since_s = since_tick_s_;
    const bool odd = odd_;
    const char *const why = odd ? oddReason() : m_forceOn ? "" : "forces are off";
    if (elapsed_s > longest_silence_s) {  // missed time is not made up for
      since_tick_s_ = 0;
      odd_ = false;
      tick(hand, true, odd ? why : "the loop did not answer in time", odd);
      return;
    }
    const int due = static_cast<int>(std::floor((since_s + elapsed_s) / tick_s_ + 1e-6));
    since_tick_s_ = since_s + elapsed_s - due * tick_s_;
    for (int i = 1; i <= due; ++i) {
      const double share = (i * tick_s_ - since_s) / elapsed_s;
      const bool now = odd || share > 1 - 1e-6;
      tick(now ? hand : betweenHands(last_, hand, std::max(share, 0.0)), elapsed_s > late_s, why, odd);
      odd_ = false;
    }
  }
  static const char *oddReason() { return "the device tells what no hand does"; }
  static Hand betweenHands(const Hand &from, const Hand &to, double share) {
    Hand hand;
    hand.device = detail::between(from.device, to.device, share);
    hand.device_twist = detail::between(from.device_twist, to.device_twist, share);
    hand.scene = detail::between(from.scene, to.scene, share);
    hand.scene_twist = detail::between(from.scene_twist, to.scene_twist, share);
    hand.open = from.open + share * (to.open - from.open);
    return hand;
  }

  /// One tick of the soil. why: not "" when the force has to be zero whatever the device reports. odd: because of
  /// what it reports.
  void tick(const Hand &hand, bool late, const char *why, bool odd) {
    const std::int32_t status = moveTool(hand, *why == '\0' && !tripped_);
    if (status != HAPTO_OK && *why == '\0') {
      why = status == HAPTO_INVALID_PARAMETER ? "the tool left the space around the bed" : hapto_status_text(status);
    }
    rendered_ = status == HAPTO_OK ? toDevice() : nothing();
    shown_ = *why == '\0' ? rendered_ : nothing();
    const bool was_tripped = tripped_;
    if (safety_ != nullptr) {
      passSafety(hand, late, why, odd);
    } else {
      tripped_ = *why != '\0';
      why_ = why;
    }
    if (was_tripped && !tripped_) {  // the hand is somewhere else now
      place_ = true;
      fade_ = use_safety_ && limits_.simulated == 0 ? 0 : 1;
    }
    link_->snapshot.copySome(link_->scene);
    ticks_.fetch_add(1, std::memory_order_relaxed);
  }

  /// A hand that is not followed leaves the tool where it was, and the tool fades out of the soil.
  std::int32_t moveTool(const Hand &hand, bool follow) {
    const double in_s = 0.3, out_s = 0.1;
    hapto_scene *const scene = link_->scene;
    if (follow && place_) {
      const std::int32_t status = hapto_scene_place_tool(scene, &hand.scene);
      if (status != HAPTO_OK) {
        return status;
      }
      tool_ = hand.scene;
      place_ = false;
    }
    if (place_) {  // there is no place yet where it could stay
      return HAPTO_OK;
    }
    if (use_safety_ && limits_.simulated == 0) {
      fade_ = follow ? std::min(1.0, fade_ + tick_s_ / in_s) : std::max(0.0, fade_ - tick_s_ / out_s);
      hapto_scene_set_tool_fade(scene, fade_ * fade_);
    }
    if (follow) {
      hapto_scene_set_opening(scene, hand.open);
    }
    const hapto_twist *const twist = follow && use_device_velocity_ ? &hand.scene_twist : nullptr;
    const std::int32_t status = hapto_scene_step(scene, follow ? &hand.scene : &tool_, twist, &soil_wrench_);
    if (status == HAPTO_OK && follow) {
      tool_ = hand.scene;
    }
    return status;
  }

  /// Passes the force through the safety layer. A reading that the layer itself refuses is passed unchanged: it reports the reason.
  void passSafety(const Hand &hand, bool late, const char *why, bool odd) {
    hapto_device_input told = hapto_device_input();
    told.size = sizeof told;
    told.state = *why == '\0' || odd ? HAPTO_DEVICE_LIVE : HAPTO_DEVICE_STALE;
    told.pose = hand.device;
    told.twist = hand.device_twist;
    told.gripper_open = hand.open;
    told.buttons = m_userSwitches;
    hapto_safety_info info = hapto_safety_info();
    info.size = sizeof info;
    std::int32_t status = hapto_safety_step(safety_, &told, late ? 1 : 0, &shown_);
    status = status == HAPTO_OK ? hapto_safety_get_info(safety_, &info) : status;
    if (status == HAPTO_OK && odd && *info.trip == '\0') {
      told.state = HAPTO_DEVICE_STALE;
      shown_ = nothing();
      hapto_safety_step(safety_, &told, late ? 1 : 0, &shown_);
      status = hapto_safety_get_info(safety_, &info);
    }
    tripped_ = status != HAPTO_OK || *info.trip != '\0';
    saturated_ = (info.flags & HAPTO_SAFETY_SATURATED) != 0;
    if (!tripped_) {
      why_ = "";
      return;
    }
    shown_ = nothing();
    if (*why != '\0' && !odd) {
      why_ = why;
    } else if (*why_ == '\0') {  // the first reason stays until all has been well for a while
      why_ = status == HAPTO_OK ? info.trip : hapto_status_text(status);
    }
  }

  /// The soil's wrench on the tool, in the device's frame. Levers in the hand are as much shorter as movements are.
  hapto_device_output toDevice() const {
    hapto_device_output output = nothing();
    detail::put(force_scale_ * toDevice(soil_wrench_.force_n), output.wrench.force_n);
    detail::put(force_scale_ / m_workspaceScaleFactor * toDevice(soil_wrench_.torque_nm), output.wrench.torque_nm);
    hapto_scene_get_grip_force(link_->scene, &output.gripper_force_n);
    output.gripper_force_n *= force_scale_;
    return output;
  }
  chai3d::cVector3d toDevice(const double (&scene)[3]) const {
    return chai3d::cTranspose(getGlobalRot()) * (link_->world_R_scene * detail::vectorOf(scene));
  }

  /// The force of the last tick, moved on to where the hand is now.
  void show(const Hand &hand) {
    if (odd_ || tripped_ || place_) {
      showNothing(odd_ ? oddReason() : why_);
      return;
    }
    reason_.store("", std::memory_order_relaxed);
    hapto_device_output now = shown_;
    const double tick_n = detail::norm(shown_.wrench.force_n), rendered_n = detail::norm(rendered_.wrench.force_n);
    double k_n_m[9];
    if (detail::distance(tool_, hand.scene) > 0 && rendered_n > 0 &&
        hapto_scene_get_contact_stiffness(link_->scene, k_n_m) == HAPTO_OK) {
      const double share = force_scale_ * std::min(1.0, tick_n / rendered_n);  // fraction of the force that the safety layer passes
      double change_n[3], most_n = saturated_ ? tick_n : limits_.max_force_n;
      for (int i = 0; i < 3; ++i) {
        change_n[i] = 0;
        for (int j = 0; j < 3; ++j) {
          change_n[i] -= share * k_n_m[3 * i + j] * (hand.scene.position_m[j] - tool_.position_m[j]);
        }
      }
      detail::put(toDevice(change_n), change_n);
      if (safety_ != nullptr) {
        shorten(change_n, tick_s_ * limits_.max_force_rate_n_s);
      }
      for (int i = 0; i < 3; ++i) {
        now.wrench.force_n[i] += change_n[i];
      }
      if (safety_ != nullptr) {
        shorten(now.wrench.force_n, most_n);
      }
    }
    setDeviceLocalForce(detail::vectorOf(now.wrench.force_n));
    setDeviceLocalTorque(detail::vectorOf(now.wrench.torque_nm));
    setGripperForce(now.gripper_force_n);
  }
  static void shorten(double (&v)[3], double most) {
    const double length = detail::norm(v);
    for (int axis = 0; axis < 3 && length > most; ++axis) {
      v[axis] *= most / length;
    }
  }
  void showNothing(const char *why) {
    reason_.store(why, std::memory_order_relaxed);
    setDeviceLocalForce(chai3d::cVector3d(0, 0, 0));
    setDeviceLocalTorque(chai3d::cVector3d(0, 0, 0));
    setGripperForce(0);
  }

  std::shared_ptr<detail::SoilLink> link_;
  chai3d::cMatrix3d device_R_tool_;
  bool use_safety_ = true, use_device_velocity_ = true, has_own_limits_ = false;
  double force_scale_ = 1, softest_spring_n_m_ = 100;
  std::vector<std::string> overrides_;
  hapto_device_limits own_limits_ = hapto_device_limits(), limits_ = hapto_device_limits();

  hapto_safety *safety_ = nullptr;
  bool prepared_ = false;
  std::int32_t status_ = HAPTO_OK;  // status of preparing
  double tick_s_ = 1e-3, gripper_rad_ = 0;
  std::chrono::steady_clock::time_point last_call_;

  bool known_ = false;           // whether last_ is
  Hand last_ = Hand();           // at the last call
  double since_tick_s_ = 0;      // from the last tick to the last call
  bool odd_ = false;             // since the last tick the device has sent an implausible reading
  bool tripped_ = false, saturated_ = false, place_ = true;
  double fade_ = 1;              // square root of the present fraction of the tool
  const char *why_ = "";
  hapto_pose tool_ = hapto_pose();  // in the last tick, scene frame
  hapto_wrench soil_wrench_ = hapto_wrench();
  hapto_device_output rendered_ = nothing(), shown_ = nothing();  // before and after the safety layer, device's frame
  std::atomic<std::uint64_t> ticks_{0};
  std::atomic<const char *> reason_{""};
};

/// Any CHAI3D device in haptolith's own loop: mapping, coupling, filter, safety layer and watchdog as the scene's tables say.
/// Open and calibrate the device before. While this lives the scene is the loop's, and destroying it gives HAPTO_BUSY.
class cHaptolithLoop {
 public:
  /// flags: HAPTO_LOOP_... as of hapto_loop_create(). limits: instead of what CHAI3D says of the device.
  cHaptolithLoop(hapto_scene *scene, chai3d::cGenericHapticDevicePtr device, std::uint32_t flags = 0,
                 const hapto_device_limits *limits = nullptr)
      : device_(device) {
    if (device_ == nullptr) {
      status_ = HAPTO_NULL;
      return;
    }
    hapto_device own = hapto_device();
    own.size = sizeof own;
    own.user = this;
    own.name = "chai3d";
    own.limits = limits != nullptr ? *limits : limitsOf(device_->m_specifications);
    own.read = [](void *user, hapto_device_input *out) { static_cast<cHaptolithLoop *>(user)->read(*out); };
    own.write = [](void *user, const hapto_device_output *force) { static_cast<cHaptolithLoop *>(user)->write(*force); };
    own.release_force = [](void *user) { static_cast<cHaptolithLoop *>(user)->releaseForce(); };
    own.resume_force = [](void *user) { static_cast<cHaptolithLoop *>(user)->released_.store(false); };
    turns_ = own.limits.turns != 0;
    gripper_rad_ = own.limits.grips != 0 ? device_->m_specifications.m_gripperMaxAngleRad : 0;
    status_ = hapto_loop_create(scene, &own, flags, &loop_);
  }
  ~cHaptolithLoop() {
    if (loop_ != nullptr) {
      hapto_loop_destroy(loop_);
    }
    if (device_ != nullptr) {
      releaseForce();
    }
  }
  cHaptolithLoop(const cHaptolithLoop &) = delete;
  cHaptolithLoop &operator=(const cHaptolithLoop &) = delete;

  /// HAPTO_OK, or why there is no loop: hapto_last_error() says more.
  std::int32_t getStatus() const { return status_; }
  std::int32_t start() { return hapto_loop_start(loop_); }
  std::int32_t tick(bool late = false) { return hapto_loop_tick(loop_, late ? 1 : 0); }
  std::int32_t stop() { return hapto_loop_stop(loop_); }
  /// Handle for further functions of a loop; null without one.
  hapto_loop *get() const { return loop_; }
  /// Draws the loop's soil: from the thread that draws, once a frame. The bed was made before the loop.
  bool draw(cHaptolithBed &bed) {
    hapto_snapshot now = hapto_snapshot();
    now.size = sizeof now;
    return hapto_loop_snapshot(loop_, &now) == HAPTO_OK && bed.updateFromSnapshot(now);
  }

 private:
  void read(hapto_device_input &told) {
    if (!enter()) {
      told.state = HAPTO_DEVICE_STALE;
      return;
    }
    chai3d::cVector3d position_m(0, 0, 0), velocity_m_s(0, 0, 0), turning_rad_s(0, 0, 0);
    chai3d::cMatrix3d rotation;
    rotation.identity();
    double gripper_rad = gripper_rad_;
    unsigned int switches = 0;
    bool well = device_->getPosition(position_m);
    device_->getLinearVelocity(velocity_m_s);
    if (turns_) {
      well = device_->getRotation(rotation) && well;
      device_->getAngularVelocity(turning_rad_s);
    }
    if (gripper_rad_ > 0) {
      well = device_->getGripperAngleRad(gripper_rad) && well;
    }
    device_->getUserSwitches(switches);
    leave();
    if (!well) {
      told.state = HAPTO_DEVICE_STALE;
      return;
    }
    detail::put(position_m, told.pose.position_m);
    detail::put(rotation, told.pose.orientation);
    detail::put(velocity_m_s, told.twist.linear_m_s);
    detail::put(turning_rad_s, told.twist.angular_rad_s);
    told.gripper_open = gripper_rad_ > 0 ? std::max(0.0, std::min(1.0, gripper_rad / gripper_rad_)) : 1;
    told.buttons = switches;
  }
  void write(const hapto_device_output &force) {
    if (!released_.load() && enter()) {
      device_->setForceAndTorqueAndGripperForce(detail::vectorOf(force.wrench.force_n),
                                                detail::vectorOf(force.wrench.torque_nm), force.gripper_force_n);
      leave();
    }
  }
  /// From any thread. A thread that is inside the device shows zero on its way out.
  void releaseForce() {
    released_.store(true);
    showZero();
  }
  void showZero() {
    if (enter()) {
      device_->setForceAndTorqueAndGripperForce(chai3d::cVector3d(0, 0, 0), chai3d::cVector3d(0, 0, 0), 0);
      in_device_.store(false);
    }
  }
  bool enter() { return !in_device_.exchange(true); }
  void leave() {
    in_device_.store(false);
    if (released_.load()) {
      showZero();
    }
  }

  chai3d::cGenericHapticDevicePtr device_;
  hapto_loop *loop_ = nullptr;
  std::int32_t status_ = HAPTO_OK;
  bool turns_ = false;
  double gripper_rad_ = 0;
  std::atomic<bool> in_device_{false}, released_{false};
};

}  // namespace hapto

#endif
