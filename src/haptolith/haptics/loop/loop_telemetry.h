#pragma once

#include <boost/lockfree/spsc_queue.hpp>

#include <array>
#include <atomic>
#include <cstdint>
#include <vector>

#include "haptolith/core/process/latest_value.h"
#include "haptolith/haptics/loop/loop_clock.h"
#include "haptolith/haptics/loop/loop_statistics.h"
#include "haptolith/haptics/loop/shown_scene.h"
#include "haptolith/haptics/safety/safety_layer.h"
#include "haptolith/haptics/safety/trip_report.h"
#include "haptolith/haptics/tick_record.h"

namespace haptolith {

/// Output of the loop: statistics, records of every tick, reports of trips and snapshots of the scene, through
/// lock-free queues. Functions may be called in the tick, except those of another thread.
class LoopTelemetry {
 public:
  /// @param keep_records  whether anyone will call takeRecords().
  /// @param hands  for each of which there is a record in each tick; at least 1.
  LoopTelemetry(double tick_s, bool keep_records, std::size_t hands);

  /// Records hold hashes of the bed, of a part of it in each tick (see stateHash()).
  void hashRecords() noexcept { hashes_ = true; }
  /// After how many ticks all of the bed has been hashed.
  [[nodiscard]] static std::size_t hashedParts(const Bed& bed) noexcept;
  /// Whether a snapshot is copied in kTicksPerSnapshot parts, one in each tick, beginning with part 0.
  [[nodiscard]] static bool copiesInParts(const Bed& bed) noexcept;

  /// A hand's record of the present tick, to be filled before record(). It holds an old one.
  [[nodiscard]] TickRecord& draft(std::size_t hand) noexcept {
    return last_[hand][(statistics_.ticks() + 1) % TripReport::kTicks];
  }
  /// The present tick has ended: counts it, adds times, soil and hash to the drafts, and hands them out.
  void record(const LoopClock& clock, const Scene& scene) noexcept;
  /// Reports the ticks that led to a hand's trip in the last tick.
  void report(std::size_t hand, SafetyTrip trip, LoopEnd end) noexcept;
  /// A part of a snapshot of the scene, or the last one, which `rest` completes with what the bed does not know.
  template <class Rest>
  void publish(ShownScene& shown, const LoopClock& clock, const Rest& rest) noexcept {
    if (SceneSnapshot* complete = copyPart(shown); complete != nullptr) {
      // The current tick of this scene is counted only when it has ended. While time is paused there is
      // no tick.
      tell(*complete, clock, statistics_.ticks() + (clock.standsStill() ? 0 : 1));
      rest(*complete);
      shown.snapshots.publish();
    }
  }
  /// A whole snapshot after the last tick. Not for the tick: of a large bed it takes long.
  template <class Rest>
  void publishLast(ShownScene& shown, const LoopClock& clock, const Rest& rest) noexcept {
    SceneSnapshot& snapshot = shown.snapshots.draft();
    copyParts(snapshot, shown.scene, 0, kTicksPerSnapshot);
    tell(snapshot, clock, statistics_.ticks());
    rest(snapshot);
    shown.snapshots.publish();
  }
  void addLateness(double late_us) noexcept { statistics_.addLateness(late_us); }

  /// For one other thread.
  void takeRecords(std::vector<TickRecord>& records);
  [[nodiscard]] LatestValue<TripReport>& trips() noexcept { return trip_reports_; }
  [[nodiscard]] std::uint64_t lostRecords() const noexcept { return lost_records_.load(std::memory_order_relaxed); }

  [[nodiscard]] bool full() const noexcept { return keep_records_ && records_.write_available() < last_.size(); }
  [[nodiscard]] const LoopStatistics& statistics() const noexcept { return statistics_; }
  [[nodiscard]] double time() const noexcept { return static_cast<double>(statistics_.ticks()) * tick_s_; }

 private:
  [[nodiscard]] TickRecord& last(std::size_t hand) noexcept {
    return last_[hand][statistics_.ticks() % TripReport::kTicks];
  }
  [[nodiscard]] SceneSnapshot* copyPart(ShownScene& shown) noexcept;
  static void copyParts(SceneSnapshot& snapshot, const Scene& scene, std::size_t first, std::size_t last) noexcept;
  static void copyPart(SceneSnapshot& snapshot, const Scene& scene, std::size_t part) noexcept;
  void tell(SceneSnapshot& snapshot, const LoopClock& clock, std::uint64_t ticks) noexcept;

  double tick_s_;
  bool keep_records_;
  bool hashes_ = false;
  LoopStatistics statistics_;
  boost::lockfree::spsc_queue<TickRecord> records_;
  std::atomic<std::uint64_t> lost_records_{0};
  std::vector<std::array<TickRecord, TripReport::kTicks>> last_;  ///< the last ticks of each hand, round and round
  LatestValue<TripReport> trip_reports_;
  std::uint64_t published_ = 0;  ///< number of calls of publish()
  double longest_tick_us_ = 0;   ///< since the last snapshot, pauses excluded
};

}  // namespace haptolith
