#include "haptolith/haptics/loop/loop_telemetry.h"

#include <algorithm>

#include "haptolith/core/assert.h"

namespace haptolith {

namespace {

/// Room for 8 s at 1 kHz while the thread that writes them is held up.
constexpr std::size_t kRecordsInFlight = 8192;

/// A bed as small as this is copied in one tick; of a larger one each tick copies a part.
constexpr std::size_t kCopiedAtOnce = 4096;

/// 4 us of hashing.
constexpr std::size_t kHashedAtOnce = 1024;

}  // namespace

LoopTelemetry::LoopTelemetry(double tick_s, bool keep_records, std::size_t hands)
    : tick_s_(tick_s), keep_records_(keep_records), records_(kRecordsInFlight * hands), last_(hands) {}

std::size_t LoopTelemetry::hashedParts(const Bed& bed) noexcept {
  return (bed.particles() + kHashedAtOnce - 1) / kHashedAtOnce;
}

bool LoopTelemetry::copiesInParts(const Bed& bed) noexcept {
  return bed.particles() > kCopiedAtOnce;
}

void LoopTelemetry::record(const LoopClock& clock, const Scene& scene) noexcept {
  statistics_.add(clock.tickUs(), clock.miss(), draft(0).sent.wrench);  // counts: the drafts are the last ticks now
  longest_tick_us_ = std::max(longest_tick_us_, clock.tickUs());
  // A bed that has failed has been stepped in part only.
  const std::size_t parts = hashedParts(scene.bed());
  const bool hash = keep_records_ && hashes_ && (last(0).flags & kTickFailed) == 0;
  const std::uint64_t state_hash = hash ? scene.hash(statistics_.ticks() % parts, parts) : 0;
  for (std::size_t hand = 0; hand < last_.size(); ++hand) {
    TickRecord& now = last(hand);
    now.time_s = time();
    now.tick_us = clock.tickUs();
    now.late_us = clock.lateUs();
    now.flags |= clock.late() ? kTickLate : 0U;
    now.soil = hand < scene.tools() ? scene.soilWrench(hand) : Wrench{};
    now.state_hash = state_hash;
  }
  if (!keep_records_) {
    return;
  }
  if (records_.write_available() < last_.size()) {  // a tick has the records of all hands, or none
    lost_records_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  for (std::size_t hand = 0; hand < last_.size(); ++hand) {
    (void)records_.push(last(hand));
  }
}

void LoopTelemetry::report(std::size_t hand, SafetyTrip trip, LoopEnd end) noexcept {
  TripReport& report = trip_reports_.draft();
  const std::uint64_t ticks = statistics_.ticks();
  report.trip = trip;
  report.tool = hand;
  report.end = end;
  report.time_s = time();
  report.count = std::min<std::uint64_t>(ticks, TripReport::kTicks);
  for (std::size_t i = 0; i < report.count; ++i) {
    report.ticks[i] = last_[hand][(ticks + 1 - report.count + i) % TripReport::kTicks];
  }
  trip_reports_.publish();
}

/// @return the snapshot when this was its last part.
SceneSnapshot* LoopTelemetry::copyPart(ShownScene& shown) noexcept {
  // Part 0 in the tick after a snapshot went out, the last part in the tick of the next one.
  const std::size_t part = (published_++ + kTicksPerSnapshot - 1) % kTicksPerSnapshot;
  const bool complete = part + 1 == kTicksPerSnapshot;
  const bool at_once = !copiesInParts(shown.scene.bed());
  if (at_once && !complete) {
    return nullptr;
  }
  SceneSnapshot& snapshot = shown.snapshots.draft();
  copyParts(snapshot, shown.scene, at_once ? 0 : part, part + 1);
  return complete ? &snapshot : nullptr;
}

void LoopTelemetry::copyParts(SceneSnapshot& snapshot, const Scene& scene, std::size_t first_part,
                              std::size_t last_part) noexcept {
  for (std::size_t part = first_part; part < last_part; ++part) {
    copyPart(snapshot, scene, part);
  }
}

void LoopTelemetry::copyPart(SceneSnapshot& snapshot, const Scene& scene, std::size_t part) noexcept {
  const std::size_t groups = scene.bed().state().rested.size();
  const std::size_t first_group = groups * part / kTicksPerSnapshot;
  const std::size_t last_group = groups * (part + 1) / kTicksPerSnapshot;
  HAPTO_ASSERT(snapshot.position.size() >= scene.bed().particles());
  HAPTO_ASSERT(snapshot.asleep.size() >= last_group);
  HAPTO_ASSERT(snapshot.stones.size() == scene.bed().stones().size());
  const Bed& bed = scene.bed();
  const std::size_t first = first_group * kGroup;
  const std::size_t last = std::min(last_group * kGroup, bed.particles());
  for (std::size_t group = first_group; group < last_group; ++group) {
    if (bed.changed(group) > snapshot.copied_at[part]) {
      const std::size_t of_group = std::min(kGroup, last - group * kGroup);
      std::copy_n(bed.state().position.data() + group * kGroup, of_group, snapshot.position.data() + group * kGroup);
      snapshot.asleep[group] = bed.state().asleep(group) ? 1 : 0;
    }
  }
  snapshot.copied_at[part] = bed.changes();
  if (last_group == bed.state().rested.size()) {  // few: all with the last part
    for (std::size_t stone = 0; stone < snapshot.stones.size(); ++stone) {
      snapshot.stones[stone] = bed.stones().pose(stone);
    }
  }
  snapshot.largest_speed_m_s = std::max(first == 0 ? 0 : snapshot.largest_speed_m_s, bed.largestSpeed(first, last));
  snapshot.awake = bed.awake();
  snapshot.opening_m = scene.opening();
}

void LoopTelemetry::tell(SceneSnapshot& snapshot, const LoopClock& clock, std::uint64_t ticks) noexcept {
  snapshot.ticks = ticks;
  snapshot.time_s = static_cast<double>(snapshot.ticks) * tick_s_;
  snapshot.deadline_misses = statistics_.deadlineMisses();
  snapshot.misses_too_long = statistics_.misses(Miss::kTooLong);
  snapshot.misses_woken_late = statistics_.misses(Miss::kWokenLate);
  snapshot.misses_preempted = statistics_.misses(Miss::kPreempted);
  snapshot.success_rate = statistics_.successRate();
  snapshot.tick_us_p50 = statistics_.tickUs().percentile(0.5);
  snapshot.tick_us_p99 = statistics_.tickUs().percentile(0.99);
  snapshot.tick_us_max = statistics_.tickUs().max();
  snapshot.tick_us_lately = longest_tick_us_;
  snapshot.paused = clock.paused();
  if (!clock.standsStill()) {
    longest_tick_us_ = 0;
  }
}

void LoopTelemetry::takeRecords(std::vector<TickRecord>& records) {
  records_.consume_all([&records](const TickRecord& record) { records.push_back(record); });
}

}  // namespace haptolith
