// libhaptolith for C++17: handles that destroy themselves, exceptions instead of statuses. Header only, over haptolith.h, where
// every function is explained.
//
//     hapto::Scene scene = hapto::Scene::fromFile("regolith", {"bed.threads=2"});
//     hapto_wrench soil_wrench = scene.step({{0, 0, 0.06}, {1, 0, 0, 0}});
#ifndef HAPTOLITH_HAPTOLITH_HPP
#define HAPTOLITH_HAPTOLITH_HPP

#include <haptolith/haptolith.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hapto {

/// Failure of a function: its status and reason; for an invalid value its key, value and valid range.
class Error : public std::runtime_error {
 public:
  Error(std::int32_t status, const hapto_error &error)
      : std::runtime_error(*error.message != '\0' ? error.message : hapto_status_text(status)),
        status_(status),
        key_(error.key),
        value_(error.value),
        valid_(error.valid) {}

  std::int32_t status() const noexcept { return status_; }
  const std::string &key() const noexcept { return key_; }
  const std::string &value() const noexcept { return value_; }
  const std::string &valid() const noexcept { return valid_; }

 private:
  std::int32_t status_;
  std::string key_, value_, valid_;
};

/// @throws Error unless the status is HAPTO_OK; std::bad_alloc.
inline void require(std::int32_t status) {
  if (status == HAPTO_OK) {
    return;
  }
  if (status == HAPTO_NO_MEMORY) {
    throw std::bad_alloc();
  }
  hapto_error error{};
  error.size = sizeof error;
  hapto_last_error(&error);
  if (error.status != status) {  // a function for 1 kHz notes nothing
    error.message = error.key = error.value = error.valid = "";
  }
  throw Error(status, error);
}

/// A struct with its size in it.
template <class Struct>
Struct sized() noexcept {
  Struct value{};
  value.size = sizeof value;
  return value;
}

/// Receives the current work and its progress, 0 to 1, or -1; false gives up.
using Progress = std::function<bool(const char *what, double share)>;

namespace detail {

template <class Handle, std::int32_t (*kDestroy)(Handle *)>
struct Destroy {
  void operator()(Handle *handle) const noexcept { kDestroy(handle); }
};
template <class Handle, std::int32_t (*kDestroy)(Handle *)>
using Unique = std::unique_ptr<Handle, Destroy<Handle, kDestroy>>;

/// A C++ function where C wants one; what it throws ends the work, and is thrown again behind it.
class ProgressCall {
 public:
  explicit ProgressCall(const Progress &progress) : progress_(progress) {}

  hapto_progress function() const noexcept { return progress_ ? &call : nullptr; }
  void require(std::int32_t status) const {
    if (thrown_) {
      std::rethrow_exception(thrown_);
    }
    hapto::require(status);
  }

 private:
  static std::int32_t call(void *self_, const char *what, double share) {
    auto &self = *static_cast<ProgressCall *>(self_);
    try {
      return self.progress_(what, share) ? 1 : 0;
    } catch (...) {
      self.thrown_ = std::current_exception();
      return 0;
    }
  }

  const Progress &progress_;
  std::exception_ptr thrown_;
};

/// Text of a function that returns the needed length when there is too little room.
template <class Handle>
std::string textFrom(std::int32_t (*get)(const Handle *, char *, std::uint64_t, std::uint64_t *), const Handle *handle) {
  std::uint64_t needed = 0;
  std::string text;
  while (get(handle, text.data(), text.size(), &needed) == HAPTO_TOO_SMALL) {
    text.resize(needed);
  }
  require(get(handle, text.data(), text.size(), &needed));
  text.resize(needed - 1);
  return text;
}

/// Texts as C wants them, for as long as the texts live.
inline std::vector<const char *> pointers(const std::vector<std::string> &texts) {
  std::vector<const char *> pointers;
  for (const std::string &text : texts) {
    pointers.push_back(text.c_str());
  }
  return pointers;
}

}  // namespace detail

/// Numbers in memory of the library, `components` to an element.
template <class T>
class View {
 public:
  explicit View(const hapto_array &array)
      : data_(static_cast<const char *>(array.data)), count_(array.count), stride_(array.stride_bytes) {}

  std::size_t size() const noexcept { return count_; }
  /// The first component of element i; the others follow it.
  const T *operator[](std::size_t i) const noexcept { return reinterpret_cast<const T *>(data_ + i * stride_); }

 private:
  const char *data_;
  std::size_t count_, stride_;
};

/// A JSON object and a table.
class Result {
 public:
  explicit Result(hapto_result *taken_over) : handle_(taken_over) {}

  std::string_view json() const {
    const char *text = nullptr;
    require(hapto_result_json(handle_.get(), &text));
    return text;
  }
  double value(const std::string &path) const {
    double number = 0;
    require(hapto_result_value(handle_.get(), path.c_str(), &number));
    return number;
  }
  View<double> column(const std::string &name) const {
    auto array = sized<hapto_array>();
    require(hapto_result_column(handle_.get(), name.c_str(), &array));
    return View<double>(array);
  }

 private:
  detail::Unique<hapto_result, hapto_result_destroy> handle_;
};

/// hapto_list(): {"names": [...]}.
inline Result list(const std::string &what) {
  hapto_result *made = nullptr;
  require(hapto_list(what.c_str(), &made));
  return Result(made);
}

/// Soil in a box and a tool, or several. Functions without a tool's number are for the first.
class Scene {
 public:
  using Overrides = std::vector<std::string>;

  explicit Scene(hapto_scene *taken_over) : handle_(taken_over) {}
  static Scene fromFile(const std::string &name_or_path, const Overrides &overrides = {}, const Progress &progress = {}) {
    detail::ProgressCall told(progress);
    const auto list = detail::pointers(overrides);
    hapto_scene *made = nullptr;
    told.require(hapto_scene_from_file(name_or_path.c_str(), list.data(), static_cast<std::uint32_t>(list.size()),
                                       told.function(), &told, &made));
    return Scene(made);
  }
  static Scene fromToml(const std::string &text, const Overrides &overrides = {}, const Progress &progress = {}) {
    detail::ProgressCall told(progress);
    const auto list = detail::pointers(overrides);
    hapto_scene *made = nullptr;
    told.require(hapto_scene_from_toml(text.c_str(), nullptr, list.data(), static_cast<std::uint32_t>(list.size()),
                                       told.function(), &told, &made));
    return Scene(made);
  }
  static Scene fromState(const std::vector<std::byte> &state) {
    hapto_scene *made = nullptr;
    require(hapto_scene_from_state(state.data(), state.size(), &made));
    return Scene(made);
  }
  Scene clone() const {
    hapto_scene *made = nullptr;
    require(hapto_scene_clone(get(), &made));
    return Scene(made);
  }

  /// One tick; gives the soil wrench: of the soil on the tool, about its origin, scene frame. Throws nothing that is not wrong;
  /// allocates nothing.
  hapto_wrench step(const hapto_pose &scene_T_tool, const hapto_twist *twist = nullptr) {
    hapto_wrench soil_wrench;
    require(hapto_scene_step(get(), &scene_T_tool, twist, &soil_wrench));
    return soil_wrench;
  }
  /// The soil wrench of each tick.
  std::vector<hapto_wrench> steps(const std::vector<hapto_pose> &poses) {
    std::vector<hapto_wrench> soil_wrenches(poses.size());
    require(hapto_scene_steps(get(), poses.size(), poses.data(), nullptr, soil_wrenches.data(), nullptr));
    return soil_wrenches;
  }

  /// The number of its tools.
  std::uint32_t tools() const {
    std::uint32_t count = 0;
    require(hapto_scene_tools(get(), &count));
    return count;
  }
  std::string toolName(std::uint32_t tool) const {
    const char *name = nullptr;
    require(hapto_scene_tool_name(get(), tool, &name));
    return name;
  }
  std::uint32_t findTool(const std::string &name) const {
    std::uint32_t tool = 0;
    require(hapto_scene_find_tool(get(), name.c_str(), &tool));
    return tool;
  }
  /// One tick of all `count` tools; fills soil_wrenches, unless it is null. Allocates nothing.
  void stepTools(const hapto_pose *poses, std::uint32_t count, hapto_wrench *soil_wrenches,
                 const hapto_twist *twists = nullptr) {
    require(hapto_scene_step_tools(get(), poses, twists, count, soil_wrenches));
  }
  /// As above with a pose for each tool; gives the soil wrench of each.
  template <std::size_t kCount>
  std::array<hapto_wrench, kCount> stepTools(const std::array<hapto_pose, kCount> &poses) {
    std::array<hapto_wrench, kCount> soil_wrenches;
    stepTools(poses.data(), static_cast<std::uint32_t>(kCount), soil_wrenches.data());
    return soil_wrenches;
  }
  std::vector<hapto_wrench> stepTools(const std::vector<hapto_pose> &poses) {
    std::vector<hapto_wrench> soil_wrenches(poses.size());
    stepTools(poses.data(), static_cast<std::uint32_t>(poses.size()), soil_wrenches.data());
    return soil_wrenches;
  }
  /// Pose, soil wrench, joint, stiffness of a tool.
  hapto_tool_state toolState(std::uint32_t tool) const {
    auto state = sized<hapto_tool_state>();
    require(hapto_scene_tool_get_state(get(), tool, &state));
    return state;
  }
  void placeTool(std::uint32_t tool, const hapto_pose &scene_T_tool) {
    require(hapto_scene_tool_place(get(), tool, &scene_T_tool));
  }
  void setOpening(std::uint32_t tool, double share) { require(hapto_scene_tool_set_opening(get(), tool, share)); }
  void setToolFade(std::uint32_t tool, double share) { require(hapto_scene_tool_set_fade(get(), tool, share)); }
  /// Speed in rad/s or torque in N m of the drive of the tool's joint.
  void setDrive(std::uint32_t tool, double value) { require(hapto_scene_tool_set_drive(get(), tool, value)); }

  void placeTool(const hapto_pose &scene_T_tool) { require(hapto_scene_place_tool(get(), &scene_T_tool)); }
  hapto_pose toolPose() const {
    hapto_pose pose;
    require(hapto_scene_get_tool_pose(get(), &pose));
    return pose;
  }
  /// The soil wrench of the last tick.
  hapto_wrench wrench() const {
    hapto_wrench soil_wrench;
    require(hapto_scene_get_wrench(get(), &soil_wrench));
    return soil_wrench;
  }
  /// dF = -K dx, row by row in N/m, scene frame.
  std::array<double, 9> contactStiffness() const {
    std::array<double, 9> n_m{};
    require(hapto_scene_get_contact_stiffness(get(), n_m.data()));
    return n_m;
  }
  void setOpening(double share) { require(hapto_scene_set_opening(get(), share)); }
  double gripForce() const {
    double n = 0;
    require(hapto_scene_get_grip_force(get(), &n));
    return n;
  }
  void setToolFade(double share) { require(hapto_scene_set_tool_fade(get(), share)); }
  void setGravity(double x, double y, double z) {
    const double m_s2[3] = {x, y, z};
    require(hapto_scene_set_gravity(get(), m_s2));
  }
  void change(const Overrides &overrides) {
    const auto list = detail::pointers(overrides);
    require(hapto_scene_change(get(), list.data(), static_cast<std::uint32_t>(list.size())));
  }

  hapto_scene_info info() const {
    auto info = sized<hapto_scene_info>();
    require(hapto_scene_get_info(get(), &info));
    return info;
  }
  /// HAPTO_POSITION or HAPTO_VELOCITY, until the next step.
  View<float> view(std::int32_t field) const {
    auto array = sized<hapto_array>();
    require(hapto_scene_view(get(), field, &array));
    return View<float>(array);
  }
  std::string toml() const { return detail::textFrom(hapto_scene_get_toml, get()); }
  std::vector<std::byte> state() const {
    std::uint64_t needed = 0;
    (void)hapto_scene_get_state(get(), nullptr, 0, &needed);
    std::vector<std::byte> bytes(needed);
    require(hapto_scene_get_state(get(), bytes.data(), bytes.size(), &needed));
    return bytes;
  }
  void setState(const std::vector<std::byte> &bytes) { require(hapto_scene_set_state(get(), bytes.data(), bytes.size())); }
  std::uint64_t stateHash() const {
    std::uint64_t hash = 0;
    require(hapto_scene_state_hash(get(), &hash));
    return hash;
  }

  hapto_scene *get() const noexcept { return handle_.get(); }

 private:
  detail::Unique<hapto_scene, hapto_scene_destroy> handle_;
};

/// A soil with a name.
class Soil {
 public:
  explicit Soil(hapto_soil *taken_over) : handle_(taken_over) {}
  static Soil find(const std::string &name_or_path) {
    hapto_soil *made = nullptr;
    require(hapto_soil_find(name_or_path.c_str(), &made));
    return Soil(made);
  }

  double number(const std::string &key) const {
    double number = 0;
    require(hapto_soil_get(get(), key.c_str(), &number));
    return number;
  }
  Result profile(double gravity_m_s2, double depth_m) const {
    hapto_result *made = nullptr;
    require(hapto_soil_profile(get(), gravity_m_s2, depth_m, &made));
    return Result(made);
  }

  hapto_soil *get() const noexcept { return handle_.get(); }

 private:
  detail::Unique<hapto_soil, hapto_soil_destroy> handle_;
};

/// hapto_scene_trust(): options in TOML, "minutes = 2".
inline Result trust(const Scene &scene, const std::string &options = {}, const Progress &progress = {}) {
  detail::ProgressCall told(progress);
  hapto_result *made = nullptr;
  told.require(hapto_scene_trust(scene.get(), options.c_str(), told.function(), &told, &made));
  return Result(made);
}

/// hapto_lab_test(): options in TOML, "normal_pa = [300, 1000, 3000]".
inline Result labTest(const std::string &test, const Soil &soil, const std::string &options = {}, const Progress &progress = {}) {
  detail::ProgressCall told(progress);
  hapto_result *made = nullptr;
  told.require(hapto_lab_test(test.c_str(), soil.get(), options.c_str(), told.function(), &told, &made));
  return Result(made);
}

/// hapto_soil_calibrate(): the soil, and what the laboratory measured of it.
inline std::pair<Soil, Result> calibrate(const std::string &target, const Progress &progress = {}) {
  detail::ProgressCall told(progress);
  hapto_soil *soil = nullptr;
  hapto_result *report = nullptr;
  told.require(hapto_soil_calibrate(target.c_str(), told.function(), &told, &soil, &report));
  return {Soil(soil), Result(report)};
}

/// Many scenes on several threads; the scenes must outlive it.
class Batch {
 public:
  explicit Batch(const std::vector<Scene> &scenes, std::uint32_t threads = 0) : scenes_(scenes.size()) {
    std::vector<hapto_scene *> handles;
    for (const Scene &scene : scenes) {
      handles.push_back(scene.get());
    }
    hapto_batch *made = nullptr;
    require(hapto_batch_create(handles.data(), static_cast<std::uint32_t>(handles.size()), threads, &made));
    handle_.reset(made);
  }

  /// poses[i * ticks + t] of scene i give its soil wrench [i * ticks + t].
  std::vector<hapto_wrench> step(std::uint64_t ticks, const std::vector<hapto_pose> &poses) {
    if (poses.size() != scenes_ * ticks) {
      throw std::invalid_argument("a batch of " + std::to_string(scenes_) + " scenes needs " +
                                  std::to_string(scenes_ * ticks) + " poses for so many ticks");
    }
    std::vector<hapto_wrench> soil_wrenches(poses.size());
    require(hapto_batch_step(handle_.get(), ticks, poses.data(), nullptr, soil_wrenches.data(), nullptr));
    return soil_wrenches;
  }
  /// Poses of all tools: for each scene, for each tick, for each tool one.
  std::vector<hapto_wrench> stepTools(std::uint64_t ticks, const std::vector<hapto_pose> &poses) {
    std::vector<hapto_wrench> soil_wrenches(poses.size());
    require(hapto_batch_step_tools(handle_.get(), ticks, poses.data(), nullptr, poses.size(), soil_wrenches.data(), nullptr));
    return soil_wrenches;
  }

 private:
  std::size_t scenes_;
  detail::Unique<hapto_batch, hapto_batch_destroy> handle_;
};

/// A device of one's own. read() and write() are called once a tick from the loop's thread: they must not wait, lock,
/// allocate or throw.
class Device {
 public:
  virtual ~Device() = default;

  virtual const char *name() const noexcept { return "device"; }
  /// hapto_device_limits_init() has filled in an ideal device.
  virtual void declare(hapto_device_limits &limits) const noexcept = 0;
  /// The handle now, device frame.
  virtual void read(hapto_device_input &told) noexcept = 0;
  /// Takes the device wrench, device frame.
  virtual void write(const hapto_device_output &force) noexcept = 0;
  /// From any thread: zero force at once and until resumeForce().
  virtual void releaseForce() noexcept { letGo(); }  // the deprecated name still works
  virtual void resumeForce() noexcept { takeUp(); }  // the deprecated name still works
  virtual void letGo() noexcept {}   ///< deprecated: releaseForce()
  virtual void takeUp() noexcept {}  ///< deprecated: resumeForce()
};

/// A scene and a device, joined at 1 kHz; both must outlive it.
class Loop {
 public:
  enum class Ticked { kByItsThread, kByCaller };
  /// Kept, with hashes of the soil: for takeTicks() and for a Recorder.
  enum class Ticks { kNotKept, kKept };

  Loop(Scene &scene, Device &device, Ticked ticked = Ticked::kByItsThread, Ticks ticks = Ticks::kNotKept) {
    const hapto_device own = described(device);
    create(scene, &own, ticked, ticks);
  }
  /// With a device for each tool of the scene; null: the one that the scene names for it.
  Loop(Scene &scene, const std::vector<Device *> &devices, Ticked ticked = Ticked::kByItsThread,
       Ticks ticks = Ticks::kNotKept) {
    std::vector<hapto_device> own(devices.size());
    std::vector<const hapto_device *> list(devices.size(), nullptr);
    for (std::size_t tool = 0; tool < devices.size(); ++tool) {
      if (devices[tool] != nullptr) {
        own[tool] = described(*devices[tool]);
        list[tool] = &own[tool];
      }
    }
    hapto_loop *made = nullptr;
    const hapto_device *none = nullptr;
    require(hapto_loop_create_tools(scene.get(), list.empty() ? &none : list.data(), static_cast<std::uint32_t>(list.size()),
                                    flags(ticked, ticks), &made));
    handle_.reset(made);
  }
  /// With the device that the scene names, a virtual hand by default.
  explicit Loop(Scene &scene, Ticked ticked = Ticked::kByItsThread, Ticks ticks = Ticks::kNotKept) {
    create(scene, nullptr, ticked, ticks);
  }

  void start() { require(hapto_loop_start(handle_.get())); }
  /// One tick of Ticked::kByCaller. False: it was the last.
  bool tick(bool late = false) {
    const std::int32_t status = hapto_loop_tick(handle_.get(), late ? 1 : 0);
    if (status != HAPTO_ENDED) {
      require(status);
    }
    return status == HAPTO_OK;
  }
  void stop() { require(hapto_loop_stop(handle_.get())); }
  /// soil_wrench is in the scene frame, device_wrench in the device frame.
  hapto_snapshot snapshot() {
    auto snapshot = sized<hapto_snapshot>();
    require(hapto_loop_snapshot(handle_.get(), &snapshot));
    return snapshot;
  }
  /// A tool in the last snapshot.
  hapto_tool_state tool(std::uint32_t number) {
    auto state = sized<hapto_tool_state>();
    require(hapto_loop_get_tool(handle_.get(), number, &state));
    return state;
  }
  void pause(bool on) { require(hapto_loop_pause(handle_.get(), on ? 1 : 0)); }
  void change(const std::vector<std::string> &overrides) {
    const auto list = detail::pointers(overrides);
    require(hapto_loop_change(handle_.get(), list.data(), static_cast<std::uint32_t>(list.size())));
  }
  /// Up to `most` of the ticks that wait, the oldest first; take them every second or more often.
  std::vector<hapto_tick> takeTicks(std::uint64_t most = 10'000) {
    std::vector<hapto_tick> ticks(most);
    std::uint64_t count = 0;
    require(hapto_loop_take_ticks(handle_.get(), ticks.data(), most, &count, nullptr));
    ticks.resize(count);
    return ticks;
  }

  hapto_loop *get() const noexcept { return handle_.get(); }

 private:
  static std::uint32_t flags(Ticked ticked, Ticks ticks) {
    return (ticked == Ticked::kByCaller ? HAPTO_LOOP_TICKED_BY_CALLER : 0) |
           (ticks == Ticks::kKept ? HAPTO_LOOP_KEEPS_TICKS | HAPTO_LOOP_HASHES : 0);
  }
  static hapto_device described(Device &device) {
    auto own = sized<hapto_device>();
    own.user = &device;
    own.name = device.name();
    require(hapto_device_limits_init(&own.limits));
    device.declare(own.limits);
    own.read = [](void *user, hapto_device_input *told) { static_cast<Device *>(user)->read(*told); };
    own.write = [](void *user, const hapto_device_output *force) { static_cast<Device *>(user)->write(*force); };
    own.release_force = [](void *user) { static_cast<Device *>(user)->releaseForce(); };
    own.resume_force = [](void *user) { static_cast<Device *>(user)->resumeForce(); };
    return own;
  }
  void create(Scene &scene, const hapto_device *device, Ticked ticked, Ticks ticks) {
    hapto_loop *made = nullptr;
    require(hapto_loop_create(scene.get(), device, flags(ticked, ticks), &made));
    handle_.reset(made);
  }

  detail::Unique<hapto_loop, hapto_loop_destroy> handle_;
};

/// The safety layer alone.
class Safety {
 public:
  Safety(const hapto_device_limits &limits, double tick_s, double stiffness_n_m,
         const std::vector<std::string> &overrides = {}) {
    const auto list = detail::pointers(overrides);
    hapto_safety *made = nullptr;
    require(hapto_safety_create(&limits, list.data(), static_cast<std::uint32_t>(list.size()), tick_s, stiffness_n_m, &made));
    handle_.reset(made);
  }

  /// Returns the permitted part of `force`.
  hapto_wrench step(const hapto_device_input &told, const hapto_wrench &force, bool late = false) {
    auto shown = sized<hapto_device_output>();
    shown.wrench = force;
    require(hapto_safety_step(handle_.get(), &told, late ? 1 : 0, &shown));
    return shown.wrench;
  }
  hapto_safety_info info() const {
    auto info = sized<hapto_safety_info>();
    require(hapto_safety_get_info(handle_.get(), &info));
    return info;
  }
  void stop() { require(hapto_safety_stop(handle_.get())); }

 private:
  detail::Unique<hapto_safety, hapto_safety_destroy> handle_;
};

}  // namespace hapto

#endif
