#include "haptolith/haptics/haptic_loop.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "haptolith/core/clock.h"
#include "haptolith/core/error.h"
#include "haptolith/core/one_of.h"

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

constexpr std::size_t kRequestsWaiting = 64;

/// How long the tool takes to leave the soil before an exchange, by the clock, and to come back, in simulated time.
constexpr double kFadeOut_s = 0.1;
constexpr double kFadeIn_s = 0.3;

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
    : first_(scene),
      shown_(&first_),
      scene_(&scene),
      device_(device),
      parameters_(parameters),
      keep_records_(keep_records),
      filter_(parameters.filter_cutoff_hz, parameters.tick_s),
      quick_movement_(parameters.tick_s),
      records_(kRecordsInFlight),
      requests_(kRequestsWaiting) {
  validate(parameters);
  if (parameters.tick_s != scene.bed().parameters().tick_s) {  // else time would run faster or slower than the clock
    throw InvalidParameter("tick_s", fmt::format("{}", parameters.tick_s),
                           fmt::format("the bed's {}", scene.bed().parameters().tick_s));
  }
}

LoopEnd HapticLoop::tick() noexcept {
  const std::int64_t start_ns = monotonicNs();
  takeRequests();
  if (paused_ && ticks_left_ == 0) {
    device_.write(Wrench{});
    let_go_ = true;
    publish(scene_->toolPose(), felt_);
    return LoopEnd::kRunning;
  }
  if (let_go_) {  // time goes on where it stopped: a hand that is simulated must not notice
    device_.write(felt_);
    let_go_ = false;
  }
  const DeviceInput hand = device_.read();
  if (!inWorkspace(hand)) {
    device_.write(Wrench{});
    return LoopEnd::kHandLeft;
  }
  fadeTool();
  if (!placed_) {
    scene_->placeTool(
        hand.scene_T_tool);  // it begins where the hand is, not with a sweep through the soil to get there
    placed_ = true;
  }
  const StepStatus status = scene_->tick(hand.scene_T_tool, hand.twist);
  if (status != StepStatus::kOk || !scene_->wrench().force_n.allFinite() || !scene_->wrench().torque_nm.allFinite()) {
    device_.write(Wrench{});
    return status == StepStatus::kOk ? LoopEnd::kNotFinite : endFor(status);
  }
  const Vec3 own_change_n =
      -parameters_.tick_s * scene_->contactStiffness() * quick_movement_.step(hand.twist.linear_m_s);
  felt_ = limited(filter_.step(scene_->wrench(), own_change_n), device_.limits());
  device_.write(felt_);
  publish(hand.scene_T_tool, felt_);

  const std::int64_t end_ns = monotonicNs();
  const double tick_us = 1e-3 * static_cast<double>(end_ns - start_ns);
  const bool in_time = deadline_ns_ == 0 ? tick_us <= 1e6 * parameters_.tick_s : end_ns <= deadline_ns_;
  statistics_.add(tick_us, in_time, felt_);
  longest_tick_us_ = std::max(longest_tick_us_, tick_us);
  ticks_left_ -= paused_ ? 1 : 0;
  record(hand, felt_, tick_us);
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
      const auto stretched_ns = static_cast<std::int64_t>(static_cast<double>(period_ns) / speed_);
      start_ns = std::max(start_ns + stretched_ns, monotonicNs() - period_ns);
    } else if (paused_ && ticks_left_ == 0) {
      sleepUntilNs(monotonicNs() + kUnpacedPause_ns);
    } else {
      while (keep_records_ && records_.write_available() == 0 && !stop.load(std::memory_order_relaxed)) {
        sleepUntilNs(monotonicNs() + kUnpacedPause_ns);  // nobody feels this loop: it may wait for its recorder
      }
    }
  }
  device_.write(Wrench{});
  return end;
}

void HapticLoop::takeRequests() noexcept {
  // One exchange at a time: what stands behind another waits with it.
  while (requests_.read_available() > 0 &&
         !(exchange_ && std::holds_alternative<request::Exchange>(requests_.front()))) {
    carryOut(requests_.front());
    requests_.pop();
  }
}

void HapticLoop::carryOut(const LoopRequest& asked) noexcept {
  std::visit(OneOf{[this](const request::Pause&) { paused_ = true; },
                   [this](const request::Resume&) {
                     paused_ = false;
                     ticks_left_ = 0;
                   },
                   [this](const request::Advance& advance) { ticks_left_ += paused_ ? advance.ticks : 0; },
                   [this](const request::Speed& speed) { speed_ = speed.factor; },
                   [this](const request::Gravity& gravity) { scene_->bed().setGravity(gravity.gravity_m_s2); },
                   [this](const request::Soil& soil) { scene_->bed().setSoil(soil.laws); },
                   [this](const request::Exchange& exchange) {
                     if (paused_) {  // nobody feels anything
                       carryOut(exchange);
                     } else {
                       exchange_ = exchange;
                     }
                   }},
             asked);
}

void HapticLoop::carryOut(const request::Exchange& exchange) noexcept {
  std::visit(OneOf{[this](const request::ExchangeTool& tool) { scene_->setTool(tool.tool); },
                   [this](const request::ExchangeStage& next) {
                     next.stage->scene.placeTool(scene_->toolPose());
                     scene_ = &next.stage->scene;
                     shown_.store(next.stage, std::memory_order_release);
                   }},
             exchange);
  placed_ = false;
  felt_ = {};
  presence_ = 0;
  scene_->setToolPresence(0);
}

void HapticLoop::fadeTool() noexcept {
  if (exchange_) {
    presence_ = std::max(0.0, presence_ - parameters_.tick_s / (kFadeOut_s * speed_));
    if (presence_ == 0) {
      carryOut(*exchange_);
      exchange_.reset();
    }
  } else {
    presence_ = std::min(1.0, presence_ + parameters_.tick_s / kFadeIn_s);
  }
  scene_->setToolPresence(presence_ * presence_);
}

bool HapticLoop::inWorkspace(const DeviceInput& hand) const noexcept {
  const BedParameters& bed = scene_->bed().parameters();
  const Pose& pose = hand.scene_T_tool;
  const Vec3& p = pose.position_m;
  // Written so that NaN is outside.
  return std::abs(p.x()) <= bed.width_m / 2 + kReachBesideBox_m &&
         std::abs(p.y()) <= bed.length_m / 2 + kReachBesideBox_m && p.z() >= -kReachBesideBox_m &&
         p.z() <= 3 * kReachBesideBox_m && pose.orientation.coeffs().allFinite() && hand.twist.linear_m_s.allFinite() &&
         hand.twist.angular_rad_s.allFinite();
}

void HapticLoop::publish(const Pose& scene_T_tool, const Wrench& felt) noexcept {
  // Part 0 in the tick after a snapshot went out, the last part in the tick of the next one.
  const std::uint64_t part = (published_++ + kTicksPerSnapshot - 1) % kTicksPerSnapshot;
  const bool complete = part + 1 == kTicksPerSnapshot;
  const Bed& bed = scene_->bed();
  const std::size_t groups = bed.state().rested.size();
  const bool at_once = bed.particles() <= kCopiedAtOnce;
  if (at_once && !complete) {
    return;
  }
  SceneSnapshot& snapshot = stage().snapshots.draft();
  const std::size_t first_group = at_once ? 0 : groups * part / kTicksPerSnapshot;
  const std::size_t last_group = groups * (part + 1) / kTicksPerSnapshot;
  const std::size_t first = first_group * kGroup;
  const std::size_t last = std::min(last_group * kGroup, bed.particles());
  std::copy_n(bed.state().position.data() + first, last - first, snapshot.position.data() + first);
  for (std::size_t group = first_group; group < last_group; ++group) {
    snapshot.asleep[group] = bed.state().rested[group] == BedState::kAsleep ? 1 : 0;
  }
  snapshot.largest_speed_m_s = std::max(first == 0 ? 0 : snapshot.largest_speed_m_s, bed.largestSpeed(first, last));
  if (!complete) {
    return;
  }
  snapshot.time_s = time();
  snapshot.awake = bed.awake();
  snapshot.scene_T_tool = scene_T_tool;
  snapshot.felt = felt;
  snapshot.ticks = statistics_.ticks();
  snapshot.deadline_misses = statistics_.deadlineMisses();
  snapshot.success_rate = statistics_.successRate();
  snapshot.tick_us_p50 = statistics_.tickUs().percentile(0.5);
  snapshot.tick_us_p99 = statistics_.tickUs().percentile(0.99);
  snapshot.tick_us_max = statistics_.tickUs().max();
  snapshot.tick_us_lately = longest_tick_us_;
  snapshot.paused = paused_;
  if (!paused_ || ticks_left_ > 0) {
    longest_tick_us_ = 0;
  }
  stage().snapshots.publish();
}

void HapticLoop::record(const DeviceInput& hand, const Wrench& felt, double tick_us) noexcept {
  if (keep_records_ && !records_.push({time(), hand.scene_T_tool, scene_->wrench(), felt, tick_us})) {
    lost_records_.fetch_add(1, std::memory_order_relaxed);
  }
}

void HapticLoop::takeRecords(std::vector<TickRecord>& records) {
  records_.consume_all([&records](const TickRecord& record) { records.push_back(record); });
}

}  // namespace haptolith
