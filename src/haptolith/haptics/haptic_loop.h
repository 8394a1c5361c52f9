#pragma once

#include <boost/lockfree/spsc_queue.hpp>

#include <atomic>
#include <cstdint>
#include <optional>
#include <vector>

#include "haptolith/device/haptic_device.h"
#include "haptolith/haptics/loop_parameters.h"
#include "haptolith/haptics/loop_request.h"
#include "haptolith/haptics/loop_statistics.h"
#include "haptolith/haptics/real_time.h"
#include "haptolith/haptics/stage.h"
#include "haptolith/haptics/wrench_filter.h"
#include "haptolith/tool/scene.h"

namespace haptolith {

/// One tick, as it is recorded.
struct TickRecord {
  double time_s = 0;
  Pose scene_T_tool;
  Wrench soil;         ///< of the soil on the tool, unfiltered
  Wrench felt;         ///< what went to the hand: filtered and limited
  double tick_us = 0;  ///< work of this tick, without sleep
};

/// Why a loop ended.
enum class LoopEnd {
  kRunning,
  kDuration,   ///< the time asked for is over
  kStopped,    ///< somebody asked it to stop
  kFinished,   ///< the device has nothing more to give: a pose file's end
  kHandLeft,   ///< the tool left the space around the bed, or its pose or velocity is no number
  kNotFinite,  ///< the bed, the tool or the wrench is no longer a number
  kCollapsed,  ///< the bed has collapsed onto itself
};

[[nodiscard]] const char* text(LoopEnd end) noexcept;

/// Soil and hand, joined at 1 kHz. Records and snapshots leave through lock-free queues; nobody can delay a tick.
class HapticLoop {
 public:
  /// @param keep_records  whether anyone will call takeRecords(); without, records are not kept.
  /// @throws InvalidParameter as validate(LoopParameters), and when the bed was made for another tick.
  HapticLoop(Scene& scene, HapticDevice& device, const LoopParameters& parameters, bool keep_records);

  /// Runs ticks on the calling thread until something ends it, in step with the clock when paced. On return the device
  /// has been given zero force.
  LoopEnd run(const std::atomic<bool>& stop) noexcept;

  /// One tick without pacing: read device, move tool, step bed, sum wrench, filter, limit, send, publish. Does not
  /// allocate, lock, throw, log or touch a file.
  LoopEnd tick() noexcept;

  /// For one other thread: moves all waiting records to the end of `records`.
  void takeRecords(std::vector<TickRecord>& records);
  /// For one other thread: newest snapshot of the scene that is shown. From the thread that ask()s.
  [[nodiscard]] LatestValue<SceneSnapshot>& snapshots() noexcept { return stage().snapshots; }

  /// For one other thread: asks for a change between two ticks. False when too many wait already.
  bool ask(const LoopRequest& request) noexcept { return requests_.push(request); }
  /// For one other thread: the stage that is shown. Another one is no longer touched, and may be shown again or go.
  [[nodiscard]] Stage& stage() const noexcept { return *shown_.load(std::memory_order_acquire); }

  /// Records that nobody took in time; only a paced loop loses any.
  [[nodiscard]] std::uint64_t lostRecords() const noexcept { return lost_records_.load(std::memory_order_relaxed); }
  /// Only after run() has returned.
  [[nodiscard]] const LoopStatistics& statistics() const noexcept { return statistics_; }
  [[nodiscard]] double time() const noexcept { return static_cast<double>(statistics_.ticks()) * parameters_.tick_s; }

 private:
  void takeRequests() noexcept;
  void carryOut(const LoopRequest& asked) noexcept;
  void carryOut(const request::Exchange& exchange) noexcept;
  void fadeTool() noexcept;
  [[nodiscard]] bool inWorkspace(const DeviceInput& hand) const noexcept;
  void publish(const Pose& scene_T_tool, const Wrench& felt) noexcept;
  void record(const DeviceInput& hand, const Wrench& felt, double tick_us) noexcept;

  Stage first_;
  std::atomic<Stage*> shown_;
  Scene* scene_;  ///< of the stage that is shown
  HapticDevice& device_;
  LoopParameters parameters_;
  bool keep_records_;
  WrenchFilter filter_;
  QuickMovement quick_movement_;
  LoopStatistics statistics_;
  std::int64_t deadline_ns_ = 0;  ///< when the present tick has to be done; 0 when nobody paces
  boost::lockfree::spsc_queue<TickRecord> records_;
  std::atomic<std::uint64_t> lost_records_{0};

  boost::lockfree::spsc_queue<LoopRequest> requests_;
  Wrench felt_;          ///< in the last tick
  bool let_go_ = false;  ///< the hand feels nothing, because time stands still
  bool paused_ = false;
  int ticks_left_ = 0;                         ///< to go while paused
  double speed_ = 1;                           ///< of time
  bool placed_ = false;                        ///< whether the tool has been where the hand is, in this scene
  std::optional<request::Exchange> exchange_;  ///< waits until the tool has faded
  double presence_ = 1;                        ///< of the tool; the scene is given its square
  std::uint64_t published_ = 0;                ///< calls of publish()
  double longest_tick_us_ = 0;                 ///< since the last snapshot while time went on
};

}  // namespace haptolith
