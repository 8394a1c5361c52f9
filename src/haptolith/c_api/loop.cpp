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
#include "haptolith/device/declared_limits.h"
#include "haptolith/device/drivers/open_device.h"
#include "haptolith/device/hand/virtual_hand.h"
#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/haptics/loop/loop_thread.h"
#include "haptolith/haptics/safety/last_resort.h"

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

/// The hand begins above the soil that is there.
SceneFile above(SceneFile scene_file, double surface_m) {
  scene_file.hand.surface_m = scene_file.hand.surface_m.value_or(surface_m);
  return scene_file;
}

LoopParameters pacedBy(LoopParameters loop, bool caller) {
  loop.real_time = loop.real_time && !caller;
  return loop;
}

}  // namespace

/// A loop, its device, and the scene that it has for as long as it lives.
class Loop {
 public:
  Loop(Claim<hapto_scene> scene, const hapto_device* device, std::uint32_t flags)
      : scene_(std::move(scene)),
        ticked_by_caller_((flags & HAPTO_LOOP_TICKED_BY_CALLER) != 0),
        keeps_ticks_((flags & HAPTO_LOOP_KEEPS_TICKS) != 0),
        scene_file_(above(scene_->sceneFile(), scene_->scene().bed().surfaceHeight())),
        device_(deviceFor(scene_file_, device)),
        parameters_(pacedBy(scene_file_.loop, ticked_by_caller_)),
        start_tick_(scene_->startTick()) {
    if (!ticked_by_caller_ && !parameters_.real_time && !device_->simulated()) {
      throw InvalidParameter("loop.real_time", "false",
                             "true with a haptic device: forces on a hand must be rendered in real time");
    }
    const double surface_m = *scene_file_.hand.surface_m;
    loop_.emplace(scene_->scene(), *device_, parameters_, keeps_ticks_,
                  device == nullptr ? handlingOf(scene_file_, surface_m) : handlingOfOwnDevice(scene_file_, surface_m));
    if ((flags & HAPTO_LOOP_HASHES) != 0) {
      loop_->hashRecords();
    }
    if (device == nullptr && !device_->simulated()) {
      last_resort_.emplace(*device_);
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
    loop_->overrideHealth({.late = late != 0});
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
      device_->write({});
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

  void takeTicks(std::span<hapto_tick> out, std::uint64_t& count, std::uint64_t* lost) {
    if (!keeps_ticks_) {
      throw RefusedAction("loop", "cannot take ticks: the loop was made without HAPTO_LOOP_KEEPS_TICKS");
    }
    loop_->takeRecords(taken_);
    const std::size_t now = std::min(out.size(), taken_.size());
    std::ranges::transform(taken_.begin(), taken_.begin() + static_cast<std::ptrdiff_t>(now), out.begin(), tickOf);
    taken_.erase(taken_.begin(), taken_.begin() + static_cast<std::ptrdiff_t>(now));
    count = now;
    handed_out_ += now;
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
                                  {"device", device_->name()},
                                  {"device_limits", limitsText(device_->limits(), device_->simulated())},
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
  std::unique_ptr<HapticDevice> device_;
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

std::int32_t hapto_loop_create(hapto_scene* scene, const hapto_device* device, std::uint32_t flags, hapto_loop** out) {
  if (out == nullptr) {
    return wrongArgument(HAPTO_NULL, "out");
  }
  if (device != nullptr && sizeStatus(device) != HAPTO_OK) {
    return wrongArgument(sizeStatus(device), "device");
  }
  Claim claim(scene);
  if (const std::int32_t status = claim.status() != HAPTO_OK ? claim.status() : claim->condition();
      status != HAPTO_OK) {
    return wrongArgument(status, "scene");
  }
  return guarded([&] {
    constexpr std::uint32_t kKnown = HAPTO_LOOP_TICKED_BY_CALLER | HAPTO_LOOP_KEEPS_TICKS | HAPTO_LOOP_HASHES;
    if ((flags & ~kKnown) != 0) {
      throw InvalidParameter("flags", std::to_string(flags), "a sum of HAPTO_LOOP_...");
    }
    *out = Places<hapto_loop>::take(std::make_unique<Loop>(std::move(claim), device, flags));
    return HAPTO_OK;
  });
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
