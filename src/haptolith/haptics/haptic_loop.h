#pragma once

#include <boost/lockfree/spsc_queue.hpp>

#include <atomic>
#include <cstdint>
#include <vector>

#include "haptolith/core/exchange.h"
#include "haptolith/device/haptic_device.h"
#include "haptolith/haptics/loop_parameters.h"
#include "haptolith/haptics/loop_statistics.h"
#include "haptolith/haptics/real_time.h"
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

/// A picture of the scene for whoever looks on, about 60 times a second. Of a large bed each tick copies a part, so
/// that no tick is long: its first particles are then 15 ticks older than its last.
struct SceneSnapshot {
  double time_s = 0;
  Pose scene_T_tool;
  Wrench felt;
  std::vector<Float4> position;  ///< m; one per particle
  std::uint64_t ticks = 0, deadline_misses = 0;
  double success_rate = 1, tick_us_p99 = 0, largest_speed_m_s = 0;
  std::size_t awake = 0;  ///< particles that are worked on: see Wakefulness
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
  /// For one other thread: newest snapshot.
  [[nodiscard]] LatestValue<SceneSnapshot>& snapshots() noexcept { return snapshots_; }

  /// Records that nobody took in time; only a paced loop loses any.
  [[nodiscard]] std::uint64_t lostRecords() const noexcept { return lost_records_.load(std::memory_order_relaxed); }
  /// Only after run() has returned.
  [[nodiscard]] const LoopStatistics& statistics() const noexcept { return statistics_; }
  [[nodiscard]] double time() const noexcept { return static_cast<double>(statistics_.ticks()) * parameters_.tick_s; }

 private:
  [[nodiscard]] bool inWorkspace(const DeviceInput& hand) const noexcept;
  void publish(const DeviceInput& hand, const Wrench& felt) noexcept;
  void record(const DeviceInput& hand, const Wrench& felt, double tick_us) noexcept;

  Scene& scene_;
  HapticDevice& device_;
  LoopParameters parameters_;
  bool keep_records_;
  WrenchFilter filter_;
  QuickMovement quick_movement_;
  LoopStatistics statistics_;
  std::int64_t deadline_ns_ = 0;  ///< when the present tick has to be done; 0 when nobody paces
  boost::lockfree::spsc_queue<TickRecord> records_;
  std::atomic<std::uint64_t> lost_records_{0};
  LatestValue<SceneSnapshot> snapshots_;
};

}  // namespace haptolith
