// The loop that joins a scene and a device.

#include <fmt/format.h>
#include <haptolith/haptolith.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <atomic>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "haptolith/bed/kernel/simd_target.h"
#include "haptolith/c_api/errors.h"
#include "haptolith/c_api/handles.h"
#include "haptolith/c_api/scene_object.h"
#include "haptolith/c_api/ticks.h"
#include "haptolith/c_api/values.h"
#include "haptolith/c_api/with_handle.h"
#include "haptolith/core/error.h"
#include "haptolith/core/platform/last_resort.h"
#include "haptolith/device/declared_limits.h"
#include "haptolith/device/device_group.h"
#include "haptolith/device/drivers/open_device.h"
#include "haptolith/device/hand/virtual_hand.h"
#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/haptics/loop/loop_thread.h"

namespace haptolith::library {

namespace {

/// A device of the caller's.
class CallersDevice final : public HapticDevice {
 public:
  explicit CallersDevice(const hapto_device& device)
      : device_(taken(device)), name_(textOrNothing(device.name)), limits_(library::limits(device.limits)) {
    if (device.read == nullptr || device.write == nullptr) {
      throw InvalidParameter(device.read == nullptr ? "device.read" : "device.write", "NULL", "a function");
    }
    if (name_ == VirtualHand::kName) {  // whose poses are the scene's: a replay goes by the name
      throw InvalidParameter("device.name", fmt::format("'{}'", name_), "a name other than the virtual hand's");
    }
    told_.size = sizeof told_;
    told_.pose.orientation[0] = 1;
  }

  [[nodiscard]] std::string_view name() const noexcept override { return name_; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return limits_; }
  [[nodiscard]] bool simulated() const noexcept override { return device_.limits.simulated != 0; }
  [[nodiscard]] DeviceInput read() noexcept override {
    told_.state = HAPTO_DEVICE_LIVE;
    device_.read(device_.user, &told_);
    return input(told_);
  }
  void write(const DeviceOutput& force) noexcept override {
    const bool may = !released_.load(std::memory_order_relaxed);
    const hapto_device_output shown{sizeof shown, 0, may ? wrench(force.wrench) : hapto_wrench{},
                                    may ? force.gripper_force_n : 0};
    device_.write(device_.user, &shown);
  }
  void releaseForce() noexcept override {
    released_.store(true, std::memory_order_relaxed);
    if (device_.release_force != nullptr) {
      device_.release_force(device_.user);
    }
  }
  void resumeForce() noexcept override {
    if (released_.exchange(false, std::memory_order_relaxed) && device_.resume_force != nullptr) {
      device_.resume_force(device_.user);
    }
  }

 private:
  hapto_device device_;
  std::string name_;
  DeviceLimits limits_;
  hapto_device_input told_{};
  std::atomic<bool> released_{false};
};

std::unique_ptr<HapticDevice> deviceFor(const SceneFile& scene_file, const hapto_device* device) {
  if (device != nullptr) {
    return std::make_unique<CallersDevice>(*device);
  }
  if (scene_file.device.kind == DeviceKind::kVirtualHand) {
    return std::make_unique<VirtualHand>(scene_file.hand, scene_file.bed.tick_s);
  }
  return openDevice(scene_file.device, scene_file.bed.tick_s);
}

/// The hands begin above the soil that is there.
SceneFile above(SceneFile scene_file, double surface_m) {
  for (std::size_t tool = 0; tool < toolCount(scene_file); ++tool) {
    exchangeFirst(scene_file, tool);
    scene_file.hand.surface_m = scene_file.hand.surface_m.value_or(surface_m);
    exchangeFirst(scene_file, tool);
  }
  return scene_file;
}

LoopParameters pacedBy(LoopParameters loop, bool caller) {
  loop.real_time = loop.real_time && !caller;
  return loop;
}

}  // namespace

/// A loop, its devices, and the scene that it has for as long as it lives.
class Loop {
 public:
  /// @param devices  move the first tools; null: the one that the scene names.
  Loop(Claim<hapto_scene> scene, std::span<const hapto_device* const> devices, std::uint32_t flags)
      : scene_(std::move(scene)),
        ticked_by_caller_((flags & HAPTO_LOOP_TICKED_BY_CALLER) != 0),
        keeps_ticks_((flags & HAPTO_LOOP_KEEPS_TICKS) != 0),
        scene_file_(above(scene_->sceneFile(), scene_->scene().bed().surfaceHeight())),
        parameters_(pacedBy(scene_file_.loop, ticked_by_caller_)),
        start_tick_(scene_->startTick(devices.size())) {
    std::vector<ToolHandling> hands;
    std::vector<HapticDevice*> opened_at_people;
    for (std::size_t tool = 0; tool < devices.size(); ++tool) {
      exchangeFirst(scene_file_, tool);
      const double surface_m = *scene_file_.hand.surface_m;
      const hapto_device* own = devices[tool];
      devices_.push_back(deviceFor(scene_file_, own));
      hands.push_back({devices_.back().get(), own == nullptr ? handlingOf(scene_file_, surface_m)
                                                             : handlingOfOwnDevice(scene_file_, surface_m)});
      exchangeFirst(scene_file_, tool);
      const bool at_person = !devices_.back()->simulated();
      if (!ticked_by_caller_ && !parameters_.real_time && at_person) {
        throw InvalidParameter("loop.real_time", "false",
                               "true with a haptic device: forces on a hand must be rendered in real time");
      }
      if (own == nullptr && at_person) {
        opened_at_people.push_back(devices_.back().get());
      }
    }
    loop_.emplace(scene_->scene(), hands, parameters_, keeps_ticks_);
    for (std::size_t tool = 0; tool < hands.size(); ++tool) {
      scene_->enterSoil(tool);
    }
    if ((flags & HAPTO_LOOP_HASHES) != 0) {
      loop_->hashRecords();
    }
    if (!opened_at_people.empty()) {
      at_people_.emplace(std::move(opened_at_people));
      last_resort_.emplace(*at_people_);
    }
  }
  ~Loop() {
    try {
      stop();
    } catch (...) {  // it has ended all the same
    }
    scene_->takeBack(conditionAfter(end_));
  }
  Loop(const Loop&) = delete;
  Loop& operator=(const Loop&) = delete;

  void start() {
    if (ticked_by_caller_ || started_) {
      throw RefusedAction("loop", ticked_by_caller_ ? "cannot start the loop: hapto_loop_tick() ticks it"
                                                    : "cannot start the loop: it was already started");
    }
    started_ = true;
    thread_.emplace(*loop_, parameters_, stop_asked_);
  }

  std::int32_t tick(std::int32_t late) noexcept {
    if (!ticked_by_caller_) {
      return HAPTO_INVALID_PARAMETER;
    }
    if (end_ != LoopEnd::kRunning) {
      return HAPTO_ENDED;
    }
    for (std::size_t tool = 0; tool < devices_.size(); ++tool) {
      loop_->overrideHealth({.late = late != 0}, tool);
    }
    const LoopEnd end = loop_->tick();
    end_ = end;
    return end == LoopEnd::kRunning ? HAPTO_OK : HAPTO_ENDED;
  }

  void stop() {
    if (thread_) {
      stop_asked_ = true;
      end_ = thread_->join();
      thread_.reset();
    } else if (end_ == LoopEnd::kRunning) {
      for (const std::unique_ptr<HapticDevice>& device : devices_) {
        device->write({});
      }
      end_ = LoopEnd::kStopped;
    }
  }

  void snapshot(hapto_snapshot& out) {
    if (thread_ && thread_->done()) {
      end_ = thread_->join();
      thread_.reset();
    }
    if (ticked_by_caller_ && end_ != LoopEnd::kRunning && !end_published_) {
      loop_->publishEnd(end_);  // not in its last tick: of a large bed it takes long
      end_published_ = true;
    }
    LatestValue<SceneSnapshot>& snapshots = loop_->snapshots();
    (void)snapshots.update();
    const SceneSnapshot& now = snapshots.latest();
    const LoopEnd end = end_;
    const bool running = thread_ || (ticked_by_caller_ && end == LoopEnd::kRunning);
    give({.size = 0,
          .running = running ? 1 : 0,
          .end = end == LoopEnd::kRunning ? "" : text(end),
          .trip = now.trip == SafetyTrip::kNone ? "" : text(now.trip),
          .trips = now.trips,
          .paused = now.paused ? 1 : 0,
          .ticks = now.ticks,
          .deadline_misses = now.deadline_misses,
          .awake = now.awake,
          .time_s = now.time_s,
          .scene_T_tool = pose(now.scene_T_tool),
          .opening_m = now.opening_m,
          .felt = wrench(now.device_wrench_in_scene),
          .success_rate = now.success_rate,
          .tick_us_p50 = now.tick_us_p50,
          .tick_us_p99 = now.tick_us_p99,
          .tick_us_max = now.tick_us_max,
          .largest_speed_m_s = now.largest_speed_m_s,
          .position = {.size = sizeof out.position,
                       .type = HAPTO_FLOAT32,
                       .count = now.ticks > 0 ? now.position.size() : 0,
                       .components = 3,
                       .stride_bytes = sizeof(Float4),
                       .data = now.position.data()},
          .misses_too_long = now.misses_too_long,
          .misses_woken_late = now.misses_woken_late,
          .misses_preempted = now.misses_preempted,
          .soil_wrench = wrench(now.soil_wrench),
          .device_wrench = wrench(now.device_wrench)},
         out);
  }

  void getTool(std::uint32_t tool, hapto_tool_state& out) {
    const SceneSnapshot& now = loop_->snapshots().latest();
    const ToolParameters& parameters = scene_->scene().tool(tool);
    const ShownTool& shown = now.tools.at(tool);
    hapto_tool_state state{};
    state.in_soil = tool < devices_.size() ? 1 : 0;
    state.drive = static_cast<std::int32_t>(parameters.joint.drive);
    state.scene_T_tool = pose(shown.scene_T_tool);
    state.scene_T_turned = pose(shown.turned);
    state.soil_wrench = wrench(shown.soil_wrench);
    state.angle_rad = shown.joint.angle_rad;
    state.speed_rad_s = shown.joint.speed_rad_s;
    state.soil_torque_nm = shown.joint.soil_torque_nm;
    state.motor_torque_nm = shown.joint.motor_torque_nm;
    state.opening_m = shown.opening_m;
    giveBand(shown.force_band, state);
    give(state, out);
  }
  [[nodiscard]] std::size_t tools() const noexcept { return scene_->scene().tools(); }

  void takeTicks(std::span<hapto_tick> out, std::uint64_t& count, std::uint64_t* lost) {
    if (!keeps_ticks_) {
      throw RefusedAction("loop", "cannot take ticks: the loop was made without HAPTO_LOOP_KEEPS_TICKS");
    }
    loop_->takeRecords(taken_);
    const std::size_t now = std::min(out.size(), taken_.size());
    const auto end = taken_.begin() + static_cast<std::ptrdiff_t>(now);
    std::ranges::transform(taken_.begin(), end, out.begin(), tickOf);
    handed_out_ += static_cast<std::uint64_t>(
        std::count_if(taken_.begin(), end, [](const TickRecord& record) { return record.tool == 0; }));
    taken_.erase(taken_.begin(), end);
    count = now;
    if (lost != nullptr) {
      *lost = loop_->lostRecords();
    }
  }

  /// As RecordingHeader, except for fields that only its writer knows.
  [[nodiscard]] std::string header() {
    return nlohmann::ordered_json{{"scenario", sceneFileText(scene_file_)},
                                  {"title", scene_file_.title},
                                  {"instruction_set", simdTarget()},
                                  {"arithmetic", arithmetic()},
                                  {"device", devices_.front()->name()},
                                  {"device_limits", limitsOf(*devices_.front())},
                                  {"tools", toolsJson()},
                                  {"seed", scene_file_.bed.seed},
                                  {"threads", scene_file_.bed.threads},
                                  {"hashed_parts", loop_->hashedParts()},
                                  {"start_tick", start_tick_ + handed_out_ + loop_->lostRecords()},
                                  {"tick_s", parameters_.tick_s},
                                  {"paced", parameters_.real_time}}
        .dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);  // a device's name may hold any bytes
  }

  void pause(bool on) {
    if (on) {
      ask(request::Pause{});
    } else {
      ask(request::Resume{});
    }
  }

  void change(const std::vector<std::string>& overrides) {
    const SceneChanges changes = scene_->planned(overrides);
    if (changes.gravity_m_s2) {
      ask(request::Gravity{*changes.gravity_m_s2});
    }
    if (changes.laws) {
      ask(request::Soil{*changes.laws});
    }
    for (const ToolChange& change : changes.tools) {
      ask(request::Replace{request::ReplaceTool{change.parameters, change.tool}});
    }
    scene_->note(changes);
  }

 private:
  static std::string limitsOf(const HapticDevice& device) { return limitsText(device.limits(), device.simulated()); }

  /// As RecordedTool; joints are not in ticks. Empty where one device moves one tool.
  [[nodiscard]] std::string toolsJson() const {
    auto tools = nlohmann::ordered_json::array();
    const std::vector<std::string_view> names = toolNames(scene_file_);
    for (std::size_t tool = 0; tool < devices_.size(); ++tool) {
      tools.push_back({{"name", names[tool]},
                       {"device", devices_[tool]->name()},
                       {"device_limits", limitsOf(*devices_[tool])},
                       {"has_joint", false}});
    }
    return devices_.size() == 1 ? "" : tools.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  }

  void ask(const LoopRequest& request) {
    if (!loop_->ask(request)) {
      throw Failure("too many requests at once: try again");
    }
  }

  static std::int32_t conditionAfter(LoopEnd end) noexcept {
    return end == LoopEnd::kNotFinite ? HAPTO_NOT_FINITE : end == LoopEnd::kCollapsed ? HAPTO_COLLAPSED : HAPTO_OK;
  }

  Claim<hapto_scene> scene_;
  bool ticked_by_caller_, keeps_ticks_;
  SceneFile scene_file_;
  std::vector<std::unique_ptr<HapticDevice>> devices_;  ///< one per tool that the loop moves
  std::optional<DeviceGroup> at_people_;
  std::optional<LastResort> last_resort_;
  LoopParameters parameters_;
  std::uint64_t start_tick_;      ///< tick of the scene when it was handed over
  std::uint64_t handed_out_ = 0;  ///< ticks, by takeTicks()
  bool end_published_ = false;    ///< for a loop that its caller ticks
  std::optional<HapticLoop> loop_;
  std::vector<TickRecord> taken_;                ///< taken from the loop, not yet handed out
  std::atomic<LoopEnd> end_{LoopEnd::kRunning};  ///< the tick's thread writes it, the one that watches reads it
  bool started_ = false;
  std::atomic<bool> stop_asked_{false};
  std::optional<LoopThread> thread_;  // the last member: it ends before what it uses
};

}  // namespace haptolith::library

struct hapto_loop : haptolith::library::HandleOf<haptolith::library::Loop> {
  static constexpr std::uint32_t kKind = 0x48614c6f;
};

using namespace haptolith;
using namespace haptolith::library;

namespace {

/// By the thread that watches the loop.
template <class Body>
std::int32_t with(const hapto_loop* loop, Body&& body) {
  return withHandle(loop, "loop", std::forward<Body>(body), &Handle::observed);
}

}  // namespace

namespace {

/// Makes a loop of the scene. @param devices  of its first tools; without a count that it must have: of the first
/// alone.
std::int32_t createLoop(hapto_scene* scene, std::span<const hapto_device* const> devices, bool all_tools,
                        std::uint32_t flags, hapto_loop** out) {
  if (out == nullptr) {
    return wrongArgument(HAPTO_NULL, "out");
  }
  for (const hapto_device* device : devices) {
    if (device != nullptr && sizeStatus(device) != HAPTO_OK) {
      return wrongArgument(sizeStatus(device), all_tools ? "devices" : "device");
    }
  }
  Claim claim(scene);
  if (const std::int32_t status = claim.status() != HAPTO_OK ? claim.status() : claim->condition();
      status != HAPTO_OK) {
    return wrongArgument(status, "scene");
  }
  if (all_tools && devices.size() != claim->scene().tools()) {
    return wrongArgument(HAPTO_WRONG_TOOL, "count");
  }
  return guarded([&] {
    constexpr std::uint32_t kKnown = HAPTO_LOOP_TICKED_BY_CALLER | HAPTO_LOOP_KEEPS_TICKS | HAPTO_LOOP_HASHES;
    if ((flags & ~kKnown) != 0) {
      throw InvalidParameter("flags", std::to_string(flags), "a sum of HAPTO_LOOP_...");
    }
    *out = Places<hapto_loop>::take(std::make_unique<Loop>(std::move(claim), devices, flags));
    return HAPTO_OK;
  });
}

}  // namespace

std::int32_t hapto_loop_create(hapto_scene* scene, const hapto_device* device, std::uint32_t flags, hapto_loop** out) {
  return createLoop(scene, std::span(&device, 1), false, flags, out);
}

std::int32_t hapto_loop_create_tools(hapto_scene* scene, const hapto_device* const* devices, std::uint32_t count,
                                     std::uint32_t flags, hapto_loop** out) {
  return devices == nullptr ? wrongArgument(HAPTO_NULL, "devices")
                            : createLoop(scene, std::span(devices, count), true, flags, out);
}

std::int32_t hapto_loop_get_tool(hapto_loop* loop, std::uint32_t tool, hapto_tool_state* out) {
  if (const std::int32_t status = sizeStatus(out); status != HAPTO_OK) {
    return wrongArgument(status, "out");
  }
  std::int32_t found = HAPTO_OK;
  const std::int32_t status = with(loop, [&](Loop& object) {
    if (tool < object.tools()) {
      object.getTool(tool, *out);
    } else {
      found = HAPTO_WRONG_TOOL;
    }
  });
  return found == HAPTO_OK ? status : wrongArgument(found, "tool");
}

std::int32_t hapto_loop_start(hapto_loop* loop) {
  return with(loop, [](Loop& object) { object.start(); });
}

std::int32_t hapto_loop_tick(hapto_loop* loop, std::int32_t late) {
  const Claim claim(loop);
  return claim.status() != HAPTO_OK ? claim.status() : claim->tick(late);
}

std::int32_t hapto_loop_stop(hapto_loop* loop) {
  const Claim ticking(loop);
  return ticking.status() != HAPTO_OK ? wrongArgument(ticking.status(), "loop")
                                      : with(loop, [](Loop& object) { object.stop(); });
}

std::int32_t hapto_loop_destroy(hapto_loop* loop) {
  Claim ticking(loop);
  if (ticking.status() != HAPTO_OK) {
    return wrongArgument(ticking.status(), "loop");
  }
  Claim observing(loop, &Handle::observed);
  if (observing.status() != HAPTO_OK) {
    return wrongArgument(observing.status(), "loop");
  }
  ticking.forget();
  observing.destroy();
  return HAPTO_OK;
}

std::int32_t hapto_loop_snapshot(hapto_loop* loop, hapto_snapshot* out) {
  if (const std::int32_t status = sizeStatus(out); status != HAPTO_OK) {
    return wrongArgument(status, "out");
  }
  return with(loop, [out](Loop& object) { object.snapshot(*out); });
}

std::int32_t hapto_loop_take_ticks(hapto_loop* loop, hapto_tick* out, std::uint64_t capacity, std::uint64_t* count,
                                   std::uint64_t* lost) {
  if (out == nullptr || count == nullptr) {
    return wrongArgument(HAPTO_NULL, out == nullptr ? "out" : "count");
  }
  return with(loop, [&](Loop& object) { object.takeTicks({out, capacity}, *count, lost); });
}

std::int32_t hapto_loop_get_header(const hapto_loop* loop, char* json, std::uint64_t capacity, std::uint64_t* needed) {
  return with(loop, [&](Loop& object) {
    const std::string header = object.header();
    return handOut({header.c_str(), header.size() + 1}, json, capacity, needed);
  });
}

std::int32_t hapto_loop_pause(hapto_loop* loop, std::int32_t on) {
  return with(loop, [on](Loop& object) { object.pause(on != 0); });
}

std::int32_t hapto_loop_change(hapto_loop* loop, const char* const* overrides, std::uint32_t count) {
  return with(loop, [&](Loop& object) { object.change(texts(overrides, count)); });
}
