#include "haptolith/haptics/haptic_loop.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "haptolith/core/clock.h"
#include "haptolith/core/error.h"

namespace haptolith {

namespace {

/// Room for 8 s at 1 kHz while whoever writes them is held up.
constexpr std::size_t kRecordsInFlight = 8192;

/// Ticks between two snapshots: 62 a second at 1 kHz.
constexpr std::uint64_t kTicksPerSnapshot = 16;

/// The tool may leave the box, under it too, but not the space that a hand at a table reaches.
constexpr double kReachBesideBox_m = 1.0;

constexpr double kNsPerS = 1e9;
constexpr std::int64_t kUnpacedPause_ns = 1'000'000;

/// A bed as small as this is copied in one tick; of a larger one each tick copies a part.
constexpr std::size_t kCopiedAtOnce = 4096;

SceneSnapshot firstSnapshot(const Scene& scene) {
  SceneSnapshot snapshot;
  const std::vector<Float4>& position = scene.bed().state().position;
  snapshot.position.assign(position.begin(), position.begin() + static_cast<std::ptrdiff_t>(scene.bed().particles()));
  return snapshot;
}

LoopEnd endFor(StepStatus status) noexcept {
  switch (status) {
    case StepStatus::kOk: return LoopEnd::kRunning;
    case StepStatus::kNotFinite: return LoopEnd::kNotFinite;
    case StepStatus::kCollapsed: return LoopEnd::kCollapsed;
  }
  return LoopEnd::kNotFinite;
}

}  // namespace

const char* text(LoopEnd end) noexcept {
  switch (end) {
    case LoopEnd::kRunning: return "running";
    case LoopEnd::kDuration: return "the time asked for is over";
    case LoopEnd::kStopped: return "stopped";
    case LoopEnd::kFinished: return "the recorded movement is over";
    case LoopEnd::kHandLeft: return "the hand left the scene: it may move up to 1 m beyond the box";
    case LoopEnd::kNotFinite: return text(StepStatus::kNotFinite);
    case LoopEnd::kCollapsed: return text(StepStatus::kCollapsed);
  }
  return "";
}

HapticLoop::HapticLoop(Scene& scene, HapticDevice& device, const LoopParameters& parameters, bool keep_records)
    : scene_(scene),
      device_(device),
      parameters_(parameters),
      keep_records_(keep_records),
      filter_(parameters.filter_cutoff_hz, parameters.tick_s),
      quick_movement_(parameters.tick_s),
      records_(kRecordsInFlight),
      snapshots_(firstSnapshot(scene)) {
  validate(parameters);
  if (parameters.tick_s != scene.bed().parameters().tick_s) {  // else time would run faster or slower than the clock
    throw InvalidParameter("tick_s", fmt::format("{}", parameters.tick_s),
                           fmt::format("the bed's {}", scene.bed().parameters().tick_s));
  }
}

LoopEnd HapticLoop::tick() noexcept {
  const std::int64_t start_ns = monotonicNs();
  const DeviceInput hand = device_.read();
  if (!inWorkspace(hand)) {
    device_.write(Wrench{});
    return LoopEnd::kHandLeft;
  }
  if (statistics_.ticks() == 0) {
    scene_.placeTool(hand.scene_T_tool);  // it begins where the hand is, not with a sweep through the soil to get there
  }
  const StepStatus status = scene_.tick(hand.scene_T_tool, hand.twist);
  if (status != StepStatus::kOk || !scene_.wrench().force_n.allFinite() || !scene_.wrench().torque_nm.allFinite()) {
    device_.write(Wrench{});
    return status == StepStatus::kOk ? LoopEnd::kNotFinite : endFor(status);
  }
  const Vec3 own_change_n =
      -parameters_.tick_s * scene_.contactStiffness() * quick_movement_.step(hand.twist.linear_m_s);
  const Wrench felt = limited(filter_.step(scene_.wrench(), own_change_n), device_.limits());
  device_.write(felt);
  publish(hand, felt);

  const std::int64_t end_ns = monotonicNs();
  const double tick_us = 1e-3 * static_cast<double>(end_ns - start_ns);
  const bool in_time = deadline_ns_ == 0 ? tick_us <= 1e6 * parameters_.tick_s : end_ns <= deadline_ns_;
  statistics_.add(tick_us, in_time, felt);
  record(hand, felt, tick_us);
  return hand.finished ? LoopEnd::kFinished : LoopEnd::kRunning;
}

LoopEnd HapticLoop::run(const std::atomic<bool>& stop) noexcept {
  const auto period_ns = static_cast<std::int64_t>(std::llround(parameters_.tick_s * kNsPerS));
  const auto last_tick = static_cast<std::uint64_t>(std::llround(parameters_.duration_s / parameters_.tick_s));
  std::int64_t start_ns = monotonicNs();
  LoopEnd end = LoopEnd::kRunning;
  while (end == LoopEnd::kRunning) {
    if (parameters_.paced) {
      sleepUntilNs(start_ns);
      deadline_ns_ = start_ns + period_ns;
    }
    end = tick();
    if (end != LoopEnd::kRunning) {
      break;
    }
    if (stop.load(std::memory_order_relaxed)) {
      end = LoopEnd::kStopped;
    } else if (last_tick > 0 && statistics_.ticks() >= last_tick) {
      end = LoopEnd::kDuration;
    } else if (parameters_.paced) {
      // A late tick is not made up for by a burst of early ones: the hand would feel time run faster.
      start_ns = std::max(start_ns + period_ns, monotonicNs() - period_ns);
    } else {
      while (keep_records_ && records_.write_available() == 0 && !stop.load(std::memory_order_relaxed)) {
        sleepUntilNs(monotonicNs() + kUnpacedPause_ns);  // nobody feels this loop: it may wait for its recorder
      }
    }
  }
  device_.write(Wrench{});
  return end;
}

bool HapticLoop::inWorkspace(const DeviceInput& hand) const noexcept {
  const BedParameters& bed = scene_.bed().parameters();
  const Pose& pose = hand.scene_T_tool;
  const Vec3& p = pose.position_m;
  // Written so that NaN is outside.
  return std::abs(p.x()) <= bed.width_m / 2 + kReachBesideBox_m &&
         std::abs(p.y()) <= bed.length_m / 2 + kReachBesideBox_m && p.z() >= -kReachBesideBox_m &&
         p.z() <= 3 * kReachBesideBox_m && pose.orientation.coeffs().allFinite() && hand.twist.linear_m_s.allFinite() &&
         hand.twist.angular_rad_s.allFinite();
}

void HapticLoop::publish(const DeviceInput& hand, const Wrench& felt) noexcept {
  // Part 0 in the tick after a snapshot went out, the last part in the tick of the next one.
  const std::uint64_t part = (statistics_.ticks() + kTicksPerSnapshot - 1) % kTicksPerSnapshot;
  const bool complete = part + 1 == kTicksPerSnapshot;
  const std::size_t n = scene_.bed().particles();
  const bool at_once = n <= kCopiedAtOnce;
  if (at_once && !complete) {
    return;
  }
  SceneSnapshot& snapshot = snapshots_.draft();
  const std::size_t first = at_once ? 0 : n * part / kTicksPerSnapshot;
  const std::size_t last = n * (part + 1) / kTicksPerSnapshot;
  const auto from = scene_.bed().state().position.begin();
  std::copy(from + static_cast<std::ptrdiff_t>(first), from + static_cast<std::ptrdiff_t>(last),
            snapshot.position.begin() + static_cast<std::ptrdiff_t>(first));
  snapshot.largest_speed_m_s =
      std::max(first == 0 ? 0 : snapshot.largest_speed_m_s, scene_.bed().largestSpeed(first, last));
  if (!complete) {
    return;
  }
  snapshot.time_s = time();
  snapshot.awake = scene_.bed().awake();
  snapshot.scene_T_tool = hand.scene_T_tool;
  snapshot.felt = felt;
  snapshot.ticks = statistics_.ticks();
  snapshot.deadline_misses = statistics_.deadlineMisses();
  snapshot.success_rate = statistics_.successRate();
  snapshot.tick_us_p99 = statistics_.tickUs().percentile(0.99);
  snapshots_.publish();
}

void HapticLoop::record(const DeviceInput& hand, const Wrench& felt, double tick_us) noexcept {
  if (keep_records_ && !records_.push({time(), hand.scene_T_tool, scene_.wrench(), felt, tick_us})) {
    lost_records_.fetch_add(1, std::memory_order_relaxed);
  }
}

void HapticLoop::takeRecords(std::vector<TickRecord>& records) {
  records_.consume_all([&records](const TickRecord& record) { records.push_back(record); });
}

}  // namespace haptolith
