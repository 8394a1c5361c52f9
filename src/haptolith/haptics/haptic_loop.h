#pragma once

#include <boost/lockfree/spsc_queue.hpp>

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <vector>

#include "haptolith/device/haptic_device.h"
#include "haptolith/haptics/handling_parameters.h"
#include "haptolith/haptics/loop_parameters.h"
#include "haptolith/haptics/loop_request.h"
#include "haptolith/haptics/loop_statistics.h"
#include "haptolith/haptics/real_time.h"
#include "haptolith/haptics/safety_layer.h"
#include "haptolith/haptics/stage.h"
#include "haptolith/haptics/tick_record.h"
#include "haptolith/haptics/watchdog.h"
#include "haptolith/tool/scene.h"

namespace haptolith {

/// Why a loop ended.
enum class LoopEnd {
  kRunning,
  kDuration,   ///< the time asked for is over
  kStopped,    ///< somebody asked it to stop
  kFinished,   ///< the device has nothing more to give: a pose file's end
  kHandLeft,   ///< a simulated hand left the space around the bed, or its pose or velocity is no number
  kLost,       ///< the device is gone
  kNotFinite,  ///< the bed, the tool or the wrench is no longer a number
  kCollapsed,  ///< the bed has collapsed onto itself
};

[[nodiscard]] const char* text(LoopEnd end) noexcept;

/// The last ticks before the hand was let go, and the one that did it, oldest first.
struct TripReport {
  static constexpr std::size_t kTicks = 50;

  SafetyTrip trip = SafetyTrip::kNone;
  LoopEnd end = LoopEnd::kRunning;  ///< of the run, when it ended with that
  double time_s = 0;
  std::size_t count = 0;
  std::array<TickRecord, kTicks> ticks;

  [[nodiscard]] const char* reason() const noexcept;
};

/// Soil and hand, joined at 1 kHz. Records and snapshots leave through lock-free queues; nobody can delay a tick.
class HapticLoop {
 public:
  /// @param keep_records  whether anyone will call takeRecords(); without, records are not kept.
  /// @throws InvalidParameter as validate() of all parameters, and when the bed was made for another tick; Failure when
  /// there is no thread for the watchdog of a person's device.
  HapticLoop(Scene& scene, HapticDevice& device, const LoopParameters& parameters, bool keep_records,
             const HandlingParameters& handling = {});

  /// Runs ticks on the calling thread until something ends it, in step with the clock when paced. On return the device
  /// has been given zero force.
  LoopEnd run(const std::atomic<bool>& stop) noexcept;

  /// One tick without pacing: read device, move tool, step bed, sum wrench, filter, limit, send, publish. Does not
  /// allocate, lock, throw, log or touch a file.
  LoopEnd tick() noexcept;

  /// Before the first tick: records hold hashes of the bed, of a part of it in each tick (see stateHash()).
  void hashRecords() noexcept { hashes_ = true; }
  /// After how many ticks all of the bed has been hashed.
  [[nodiscard]] std::size_t hashedParts() const noexcept;

  /// Before tick(): how the loop was doing when what is now replayed was recorded, instead of how it is doing now.
  void believe(const LoopHealth& health) noexcept { believed_ = health; }

  /// From the loop's thread: the run is about to end, and a person's hand is let go softly.
  void letGoSoftly() noexcept { safety_.stop(); }

  /// For one other thread: moves all waiting records to the end of `records`.
  void takeRecords(std::vector<TickRecord>& records);
  /// For one other thread: what led to the newest trip of the safety layer.
  [[nodiscard]] LatestValue<TripReport>& trips() noexcept { return trip_reports_; }
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
  [[nodiscard]] LoopEnd runTicks(const std::atomic<bool>& stop) noexcept;
  void standStill() noexcept;
  void takeUpAgain() noexcept;
  [[nodiscard]] LoopHealth health() noexcept;
  void takeRequests() noexcept;
  void carryOut(const LoopRequest& asked) noexcept;
  void carryOut(const request::Exchange& exchange) noexcept;
  void fadeTool() noexcept;
  void followHand(const DeviceInput& input) noexcept;
  [[nodiscard]] LoopEnd endFor(SafetyTrip trip) const noexcept;
  [[nodiscard]] bool nearBed(const Vec3& position_m) const noexcept;
  void publish(const Pose& scene_T_tool) noexcept;
  void record(const DeviceInput& input, const Pose& scene_T_tool, const DeviceOutput& rendered,
              double tick_us) noexcept;
  [[nodiscard]] LoopEnd endWith(LoopEnd end, const DeviceInput& input, std::int64_t start_ns) noexcept;
  double count(std::int64_t start_ns) noexcept;
  void reportTrip(LoopEnd end = LoopEnd::kRunning) noexcept;

  Stage first_;
  std::atomic<Stage*> shown_;
  Scene* scene_;  ///< of the stage that is shown
  HapticDevice& device_;
  LoopParameters parameters_;
  bool keep_records_;
  Mapping mapping_;
  Coupling coupling_;
  SafetyLayer safety_;
  std::optional<Watchdog> watchdog_;  ///< of a person's device, in step with the clock
  LoopStatistics statistics_;
  Movement hand_;                 ///< the last that could be believed, in the scene
  double opening_ = 1;            ///< of the jaws, 0 to 1
  std::int64_t deadline_ns_ = 0;  ///< when the present tick has to be done; 0 when nobody paces
  boost::lockfree::spsc_queue<TickRecord> records_;
  std::atomic<std::uint64_t> lost_records_{0};

  boost::lockfree::spsc_queue<LoopRequest> requests_;
  DeviceOutput felt_;    ///< in the last tick
  bool let_go_ = false;  ///< the hand feels nothing, because time stands still
  bool paused_ = false;
  int ticks_left_ = 0;                         ///< to go while paused
  double speed_ = 1;                           ///< of time
  bool placed_ = false;                        ///< whether the tool has been where the hand is, in this scene
  std::optional<request::Exchange> exchange_;  ///< waits until the tool has faded
  bool touches_ = true;                        ///< whether the tool is to be felt
  double presence_ = 1;                        ///< of the tool; the scene is given its square
  std::uint64_t published_ = 0;                ///< calls of publish()
  bool scene_changed_ = false;                 ///< before this tick
  bool failed_ = false;                        ///< the run ends with this tick
  bool silent_ = false;                        ///< whether the loop was, for too long, before this tick
  bool heartbeat_lost_ = false;                ///< before this tick; in a replay, as it was recorded
  bool late_ = false;                          ///< whether the last tick was
  double late_us_ = 0;                         ///< how late this one began
  bool hashes_ = false;
  bool resumed_ = false;  ///< whether time stood still before this tick
  std::optional<LoopHealth> believed_;
  std::array<TickRecord, TripReport::kTicks> last_;  ///< the last ticks, round and round
  LatestValue<TripReport> trip_reports_;
  double longest_tick_us_ = 0;  ///< since the last snapshot while time went on
};

}  // namespace haptolith
