#pragma once

#include <boost/lockfree/spsc_queue.hpp>

#include <atomic>
#include <cstdint>
#include <optional>
#include <vector>

#include "haptolith/core/movement.h"
#include "haptolith/device/haptic_device.h"
#include "haptolith/haptics/loop/handling_parameters.h"
#include "haptolith/haptics/loop/loop_clock.h"
#include "haptolith/haptics/loop/loop_request.h"
#include "haptolith/haptics/loop/loop_telemetry.h"
#include "haptolith/haptics/loop/shown_scene.h"
#include "haptolith/haptics/loop/tool_fade.h"
#include "haptolith/haptics/loop_parameters.h"
#include "haptolith/haptics/real_time.h"
#include "haptolith/haptics/safety/safety_layer.h"
#include "haptolith/haptics/safety/trip_report.h"
#include "haptolith/haptics/safety/watchdog.h"
#include "haptolith/scene/scene.h"

namespace haptolith {

/// Soil and hand, joined at 1 kHz. Records and snapshots leave through lock-free queues, whose readers cannot delay a
/// tick.
class HapticLoop {
 public:
  /// @param keep_records  whether anyone will call takeRecords(); without, records are not kept.
  /// @throws InvalidParameter as validate() of all parameters, and when the bed was made for another tick; Failure when
  /// there is no thread for the watchdog of a person's device.
  HapticLoop(Scene& scene, HapticDevice& device, const LoopParameters& parameters, bool keep_records,
             const HandlingParameters& handling = {});

  /// Runs ticks on the calling thread until something ends it, in step with the clock when in real time. On return the
  /// device has been given zero force.
  LoopEnd run(const std::atomic<bool>& stop) noexcept;

  /// One tick without pacing: read device, move tool, step bed, sum wrench, filter, limit, send, publish. Does not
  /// allocate, lock, throw, log or touch a file.
  LoopEnd tick() noexcept;

  /// Publishes a final, complete snapshot. To be called after the last tick(); run() does so itself.
  void publishEnd(LoopEnd end) noexcept;

  /// Before the first tick: records hold hashes of the bed, of a part of it in each tick (see stateHash()).
  void hashRecords() noexcept { telemetry_.hashRecords(); }
  /// After how many ticks all of the bed has been hashed.
  [[nodiscard]] std::size_t hashedParts() const noexcept { return LoopTelemetry::hashedParts(scene_->bed()); }

  /// Before tick(): how the loop was doing when what is now replayed was recorded, instead of how it is doing now.
  void overrideHealth(const LoopHealth& health) noexcept { overridden_health_ = health; }

  /// Fades the force out because the run is about to end. From the loop's thread.
  void softStop() noexcept { safety_.stop(); }

  /// For one other thread: moves all waiting records to the end of `records`.
  void takeRecords(std::vector<TickRecord>& records) { telemetry_.takeRecords(records); }
  /// For one other thread: what led to the newest trip of the safety layer.
  [[nodiscard]] LatestValue<TripReport>& trips() noexcept { return telemetry_.trips(); }
  /// For one other thread: newest snapshot of the scene that is shown. From the thread that ask()s.
  [[nodiscard]] LatestValue<SceneSnapshot>& snapshots() noexcept { return shownScene().snapshots; }

  /// For one other thread: asks for a change between two ticks. False when too many wait already.
  bool ask(const LoopRequest& request) noexcept { return requests_.push(request); }
  /// For one other thread: the scene that is shown. Another one is no longer touched, and may be shown again or go.
  [[nodiscard]] ShownScene& shownScene() const noexcept { return *shown_.load(std::memory_order_acquire); }

  /// Number of records lost because they were not read in time; only a loop in real time loses any.
  [[nodiscard]] std::uint64_t lostRecords() const noexcept { return telemetry_.lostRecords(); }
  /// Only after run() has returned.
  [[nodiscard]] const LoopStatistics& statistics() const noexcept { return telemetry_.statistics(); }
  [[nodiscard]] double time() const noexcept { return telemetry_.time(); }

 private:
  [[nodiscard]] LoopEnd runTicks(const std::atomic<bool>& stop) noexcept;
  [[nodiscard]] bool mayBeDoneNow(const LoopRequest& asked) const noexcept;
  void takeRequests() noexcept;
  void carryOut(const LoopRequest& asked) noexcept;
  void carryOut(const request::Replace& replace) noexcept;
  [[nodiscard]] bool wasSilent() noexcept;
  [[nodiscard]] LoopHealth health(bool silent) noexcept;
  void standStill() noexcept;
  void resumeAfterStandstill() noexcept;
  void followHand(const DeviceInput& input) noexcept;
  void fadeTool() noexcept;
  [[nodiscard]] LoopEnd moveTool() noexcept;
  [[nodiscard]] Wrench toolWeight() const noexcept;
  [[nodiscard]] LoopEnd endFor(SafetyTrip trip) const noexcept;
  [[nodiscard]] LoopEnd finish(LoopEnd end, const DeviceInput& input, const DeviceOutput& rendered) noexcept;
  void publish() noexcept;
  void tell(SceneSnapshot& snapshot) const noexcept;

  ShownScene first_;
  std::atomic<ShownScene*> shown_;
  Scene* scene_;  ///< the rendered scene
  HapticDevice& device_;
  LoopParameters parameters_;
  Mapping mapping_;
  Coupling coupling_;
  SafetyLayer safety_;
  std::optional<Watchdog> watchdog_;  ///< for a person's device, paced by the clock
  LoopClock clock_;
  ToolFade fade_;
  LoopTelemetry telemetry_;
  boost::lockfree::spsc_queue<LoopRequest> requests_;
  std::optional<LoopHealth> overridden_health_;
  HandState hand_;           ///< the last plausible one, in the scene
  DeviceOutput output_;      ///< output of the last tick, device frame
  HelperSchedule helpers_;   ///< scheduling of the threads that share the bed's steps
  bool released_ = false;    ///< the device gets no force, because time is paused
  std::uint32_t flags_ = 0;  ///< TickFlag of events before the current tick
};

}  // namespace haptolith
