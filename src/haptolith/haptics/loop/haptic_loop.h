#pragma once

#include <boost/lockfree/spsc_queue.hpp>

#include <array>
#include <atomic>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "haptolith/device/haptic_device.h"
#include "haptolith/haptics/loop/handling_parameters.h"
#include "haptolith/haptics/loop/loop_clock.h"
#include "haptolith/haptics/loop/loop_request.h"
#include "haptolith/haptics/loop/loop_telemetry.h"
#include "haptolith/haptics/loop/shown_scene.h"
#include "haptolith/haptics/loop/tool_hand.h"
#include "haptolith/haptics/loop_parameters.h"
#include "haptolith/haptics/real_time.h"
#include "haptolith/haptics/safety/trip_report.h"
#include "haptolith/scene/scene.h"

namespace haptolith {

/// Soil and hands, joined at 1 kHz. Records and snapshots leave through lock-free queues, whose readers cannot delay a
/// tick.
class HapticLoop {
 public:
  /// @param hands  of the scene's first tools; the others are not there (Scene::setToolFade()).
  /// @param keep_records  whether anyone will call takeRecords(); without, records are not kept.
  /// @throws InvalidParameter as validate() of all parameters, for more hands than tools, and when the bed was made for
  /// another tick; Failure when there is no thread for the watchdog of a person's device.
  HapticLoop(Scene& scene, std::span<const ToolHandling> hands, const LoopParameters& parameters, bool keep_records);

  /// As above with the first tool's hand alone.
  HapticLoop(Scene& scene, HapticDevice& device, const LoopParameters& parameters, bool keep_records,
             const HandlingParameters& handling = {});

  /// Runs ticks on the calling thread until something ends it, in step with the clock when in real time. On return the
  /// device has been given zero force.
  LoopEnd run(const std::atomic<bool>& stop) noexcept;

  /// One tick without pacing: read devices, move tools, step bed, sum wrenches, filter, limit, send, publish. Does not
  /// allocate, lock, throw, log or touch a file. A trip of one hand releases that hand only; the run ends
  /// when the last person's device is lost.
  LoopEnd tick() noexcept;

  /// Publishes a final, complete snapshot. To be called after the last tick(); run() does so itself.
  void publishEnd(LoopEnd end) noexcept;

  /// Before the first tick: records hold hashes of the bed, of a part of it in each tick (see stateHash()).
  void hashRecords() noexcept { telemetry_.hashRecords(); }
  /// After how many ticks all of the bed has been hashed.
  [[nodiscard]] std::size_t hashedParts() const noexcept { return LoopTelemetry::hashedParts(scene_->bed()); }

  /// Before tick(): how the loop was doing when what is now replayed was recorded, instead of how it is doing now.
  void overrideHealth(const LoopHealth& health, std::size_t tool = 0) noexcept { overridden_health_[tool] = health; }

  /// Fades the force out because the run is about to end. From the loop's thread.
  void softStop() noexcept;

  /// For one other thread: moves all waiting records to the end of `records`: of each tick one for each hand, in order.
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
  [[nodiscard]] std::size_t hands() const noexcept { return hands_.size(); }

 private:
  [[nodiscard]] LoopEnd runTicks(const std::atomic<bool>& stop) noexcept;
  [[nodiscard]] bool mayBeDoneNow(const LoopRequest& asked) const noexcept;
  void takeRequests() noexcept;
  void carryOut(const LoopRequest& asked) noexcept;
  void carryOut(const request::Replace& replace) noexcept;
  void standStill() noexcept;
  [[nodiscard]] LoopEnd readHands() noexcept;
  [[nodiscard]] LoopEnd moveTools() noexcept;
  void fadeTools() noexcept;
  [[nodiscard]] bool isGone(const request::Replace& replaced) const noexcept;
  [[nodiscard]] bool softlyStopped() const noexcept;
  [[nodiscard]] LoopEnd finish(LoopEnd end) noexcept;
  void publish() noexcept;
  void tell(SceneSnapshot& snapshot) const noexcept;

  ShownScene first_;
  std::atomic<ShownScene*> shown_;
  Scene* scene_;  ///< the rendered scene
  LoopParameters parameters_;
  std::deque<ToolHand> hands_;  ///< hands of the first tools, in order; they do not move in memory
  LoopClock clock_;
  LoopTelemetry telemetry_;
  boost::lockfree::spsc_queue<LoopRequest> requests_;
  std::optional<request::Replace> replacement_;  ///< that waits until its tools have left the soil
  std::array<std::optional<LoopHealth>, ToolSet::kMost> overridden_health_;
  std::vector<HandState> targets_;  ///< targets of the hands in this tick
  HelperSchedule helpers_;          ///< scheduling of the threads that share the bed's steps
  std::uint32_t flags_ = 0;         ///< TickFlag of events before the current tick
};

}  // namespace haptolith
