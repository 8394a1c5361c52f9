#include "haptolith/haptics/haptic_loop.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "haptolith/core/clock.h"
#include "haptolith/core/error.h"
#include "haptolith/core/one_of.h"
#include "haptolith/core/signal_stack.h"
#include "haptolith/haptics/last_resort.h"

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

/// 4 us of hashing.
constexpr std::size_t kHashedAtOnce = 1024;

constexpr std::size_t kRequestsWaiting = 64;

/// How long the tool takes to leave the soil before an exchange, by the clock, and to come back, in simulated time.
constexpr double kFadeOut_s = 0.1;
constexpr double kFadeIn_s = 0.3;

LoopEnd failure(StepStatus status) noexcept {
  switch (status) {
    case StepStatus::kOk: return LoopEnd::kRunning;
    case StepStatus::kNotFinite: return LoopEnd::kNotFinite;
    case StepStatus::kCollapsed: return LoopEnd::kCollapsed;
  }
  return LoopEnd::kNotFinite;
}

/// What stores the most energy for a force: see Passivity.
double softestSpring(const Scene& scene, const Coupling& coupling) noexcept {
  return std::min({scene.tool().stiffness_n_m, scene.bed().parameters().soil.stiffness_n_m, coupling.stiffness()});
}

}  // namespace

const char* text(LoopEnd end) noexcept {
  switch (end) {
    case LoopEnd::kRunning: return "running";
    case LoopEnd::kDuration: return "the time asked for is over";
    case LoopEnd::kStopped: return "stopped";
    case LoopEnd::kFinished: return "the recorded movement is over";
    case LoopEnd::kHandLeft: return "the hand left the scene: it may move up to 1 m beyond the box";
    case LoopEnd::kLost: return text(SafetyTrip::kLost);
    case LoopEnd::kNotFinite: return text(StepStatus::kNotFinite);
    case LoopEnd::kCollapsed: return text(StepStatus::kCollapsed);
  }
  return "";
}

const char* TripReport::reason() const noexcept {
  return end == LoopEnd::kRunning ? text(trip) : text(end);
}

HapticLoop::HapticLoop(Scene& scene, HapticDevice& device, const LoopParameters& parameters, bool keep_records,
                       const HandlingParameters& handling)
    : first_(scene),
      shown_(&first_),
      scene_(&scene),
      device_(device),
      parameters_(parameters),
      keep_records_(keep_records),
      mapping_(handling.mapping, device.limits(), parameters.tick_s),
      coupling_(handling.coupling, suitsDirectly(device.limits()), parameters.filter_cutoff_hz, parameters.tick_s),
      safety_(handling.safety, device.limits(), device.simulated(), softestSpring(scene, coupling_), parameters.tick_s),
      records_(kRecordsInFlight),
      requests_(kRequestsWaiting) {
  validate(parameters);
  if (parameters.tick_s != scene.bed().parameters().tick_s) {  // else time would run faster or slower than the clock
    throw InvalidParameter("tick_s", fmt::format("{}", parameters.tick_s),
                           fmt::format("the bed's {}", scene.bed().parameters().tick_s));
  }
  if (parameters.paced && !device.simulated()) {
    watchdog_.emplace(device, handling.safety.heartbeat_s);
  }
  presence_ = device.simulated() ? 1 : 0;  // soil that lies where a person's hand is moves out of its way gently
}

LoopEnd HapticLoop::tick() noexcept {
  const std::int64_t start_ns = monotonicNs();
  silent_ = watchdog_ && watchdog_->beat();
  silent_ = (watchdog_ && LastResort::letGoMeanwhile()) || silent_;
  if (silent_) {  // first of all: what the hand feels now is as old as the silence is long
    device_.write({});
  }
  takeRequests();
  if (paused_ && ticks_left_ == 0) {
    standStill();
    return LoopEnd::kRunning;
  }
  takeUpAgain();

  // Where is the hand? What cannot be believed leaves the tool where it was, and it fades out of the soil.
  const DeviceInput input = device_.read();
  safety_.check(input, health());
  followHand(input);
  if (const LoopEnd end = endFor(safety_.trip()); end != LoopEnd::kRunning) {
    return endWith(end, input, start_ns);
  }

  // The tool follows it, and the soil answers.
  fadeTool();
  scene_->setOpening(opening_);
  if (!placed_) {  // it begins where the hand is, not with a sweep through the soil to get there
    coupling_.place(hand_);
    scene_->placeTool(hand_.pose);
    placed_ = true;
  }
  const Movement& tool = coupling_.moveTool(hand_);
  const StepStatus status = scene_->tick(tool.pose, tool.twist);
  if (status != StepStatus::kOk || !scene_->wrench().force_n.allFinite() || !scene_->wrench().torque_nm.allFinite()) {
    return endWith(status == StepStatus::kOk ? LoopEnd::kNotFinite : failure(status), input, start_ns);
  }

  // The hand feels it, as far as is safe.
  const DeviceOutput rendered{mapping_.toDevice(coupling_.feel(scene_->wrench(), scene_->contactStiffness())),
                              mapping_.toGripper(coupling_.feelGrip(scene_->gripForce()))};
  felt_ = safety_.step(rendered);
  // After a tick that took too long, the force in it comes from where the hand no longer is; the next tick trips.
  device_.write(watchdog_ && watchdog_->tooLate() ? DeviceOutput{} : felt_);
  publish(tool.pose);

  record(input, tool.pose, rendered, count(start_ns));
  if (safety_.justTripped()) {
    reportTrip();
  }
  return input.state == DeviceState::kFinished ? LoopEnd::kFinished : LoopEnd::kRunning;
}

/// Counts a tick that is done, and returns the work that it was, in us.
double HapticLoop::count(std::int64_t start_ns) noexcept {
  const std::int64_t end_ns = monotonicNs();
  const double tick_us = 1e-3 * static_cast<double>(end_ns - start_ns);
  const bool in_time = deadline_ns_ == 0 ? tick_us <= 1e6 * parameters_.tick_s : end_ns <= deadline_ns_;
  late_ = deadline_ns_ != 0 && !in_time;
  statistics_.add(tick_us, in_time, felt_.wrench);
  longest_tick_us_ = std::max(longest_tick_us_, tick_us);
  ticks_left_ -= paused_ ? 1 : 0;
  return tick_us;
}

/// A tick that cannot be felt ends the run; it is counted, recorded and reported as others are.
LoopEnd HapticLoop::endWith(LoopEnd end, const DeviceInput& input, std::int64_t start_ns) noexcept {
  felt_ = {};
  device_.write(felt_);
  failed_ = true;
  record(input, scene_->toolPose(), {}, count(start_ns));
  reportTrip(end);
  return end;
}

LoopEnd HapticLoop::run(const std::atomic<bool>& stop) noexcept {
  const SignalStack stack;
  if (watchdog_) {
    watchdog_->start();
  }
  const LoopEnd end = runTicks(stop);
  if (watchdog_) {
    watchdog_->stop();
  }
  device_.write({});
  return end;
}

LoopEnd HapticLoop::runTicks(const std::atomic<bool>& stop) noexcept {
  const auto period_ns = static_cast<std::int64_t>(std::llround(parameters_.tick_s * kNsPerS));
  const auto last_tick = static_cast<std::uint64_t>(std::llround(parameters_.duration_s / parameters_.tick_s));
  std::int64_t start_ns = monotonicNs();
  LoopEnd wanted_end = LoopEnd::kRunning;
  while (true) {
    if (parameters_.paced) {
      sleepUntilNs(start_ns);
      deadline_ns_ = start_ns + period_ns;
      late_us_ = 1e-3 * static_cast<double>(monotonicNs() - start_ns);
      statistics_.addLateness(late_us_);
    }
    if (const LoopEnd end = tick(); end != LoopEnd::kRunning) {
      return end;
    }
    if (wanted_end == LoopEnd::kRunning && stop.load(std::memory_order_relaxed)) {
      wanted_end = LoopEnd::kStopped;
    } else if (wanted_end == LoopEnd::kRunning && last_tick > 0 && statistics_.ticks() >= last_tick) {
      wanted_end = LoopEnd::kDuration;
    }
    if (wanted_end != LoopEnd::kRunning) {  // a person's hand is let go softly
      letGoSoftly();
      if (safety_.stopped() || paused_) {
        return wanted_end;
      }
    }
    if (parameters_.paced) {
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
}

/// Moves hand_ to where the device has it, unless that cannot be believed.
void HapticLoop::followHand(const DeviceInput& input) noexcept {
  hand_.twist = {};
  if (!safety_.allWell()) {
    return;
  }
  const Movement there = mapping_.toScene(input);
  if (!nearBed(there.pose.position_m)) {
    safety_.letGo(SafetyTrip::kWorkspace);
  } else if (safety_.trip() == SafetyTrip::kNone) {
    hand_ = there;
    opening_ = mapping_.opening(input);
  }
}

/// Time stands still, and the hand is let go.
void HapticLoop::standStill() noexcept {
  if (!device_.simulated()) {
    (void)device_.read();  // some devices fall asleep when nobody asks
  }
  device_.write({});
  let_go_ = true;
  publish(scene_->toolPose());
}

/// Time goes on where it stopped. A hand that is simulated must not notice; a person's has moved meanwhile.
void HapticLoop::takeUpAgain() noexcept {
  resumed_ = let_go_;
  if (!let_go_) {
    return;
  }
  let_go_ = false;
  if (device_.simulated()) {
    device_.write(felt_);
  } else {
    safety_.restart();
    presence_ = 0;
    placed_ = false;
  }
}

/// How the loop is doing. After silence the hand is taken up again at once: the safety layer then shows it nothing for
/// a while.
LoopHealth HapticLoop::health() noexcept {
  LoopHealth now{late_, silent_};
  if (silent_) {
    watchdog_->takeUp();
  }
  now = believed_.value_or(now);
  believed_.reset();
  heartbeat_lost_ = now.heartbeat_lost;
  return now;
}

/// Whether a run cannot go on after this: a person's hand comes back, a simulated one does not.
LoopEnd HapticLoop::endFor(SafetyTrip trip) const noexcept {
  if (trip == SafetyTrip::kLost) {
    return LoopEnd::kLost;
  }
  const bool away = trip == SafetyTrip::kDeviceNotFinite || trip == SafetyTrip::kWorkspace;
  return device_.simulated() && away ? LoopEnd::kHandLeft : LoopEnd::kRunning;
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
                   [this](const request::Gravity& gravity) {
                     scene_changed_ = true;
                     scene_->bed().setGravity(gravity.gravity_m_s2);
                   },
                   [this](const request::Soil& soil) {
                     scene_changed_ = true;
                     scene_->bed().setSoil(soil.laws);
                   },
                   [this](const request::Touch& touch) {
                     scene_changed_ = true;
                     touches_ = touch.on;
                   },
                   [this](const request::Exchange& exchange) {
                     if (paused_) {  // nobody feels anything
                       carryOut(exchange);
                     } else {
                       exchange_ = exchange;
                       scene_changed_ = true;  // the tool begins to fade
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
  scene_changed_ = true;
  placed_ = false;
  felt_ = {};
  presence_ = 0;
  scene_->setToolPresence(0);
}

void HapticLoop::fadeTool() noexcept {
  if (safety_.justRecovered()) {
    placed_ = false;
    presence_ = 0;
  }
  if (!exchange_ && (!touches_ || safety_.trip() != SafetyTrip::kNone)) {
    presence_ = std::max(0.0, presence_ - parameters_.tick_s / kFadeOut_s);
  } else if (exchange_) {
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

bool HapticLoop::nearBed(const Vec3& p) const noexcept {
  const BedParameters& bed = scene_->bed().parameters();
  return std::abs(p.x()) <= bed.width_m / 2 + kReachBesideBox_m &&
         std::abs(p.y()) <= bed.length_m / 2 + kReachBesideBox_m && p.z() >= -kReachBesideBox_m &&
         p.z() <= 3 * kReachBesideBox_m;
}

void HapticLoop::publish(const Pose& scene_T_tool) noexcept {
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
  snapshot.opening_m = scene_->opening();
  snapshot.felt = mapping_.shownInScene(felt_.wrench);
  snapshot.ticks = statistics_.ticks();
  snapshot.deadline_misses = statistics_.deadlineMisses();
  snapshot.success_rate = statistics_.successRate();
  snapshot.tick_us_p50 = statistics_.tickUs().percentile(0.5);
  snapshot.tick_us_p99 = statistics_.tickUs().percentile(0.99);
  snapshot.tick_us_max = statistics_.tickUs().max();
  snapshot.tick_us_lately = longest_tick_us_;
  snapshot.paused = paused_;
  snapshot.trip = safety_.trip();
  snapshot.trips = safety_.trips();
  if (!paused_ || ticks_left_ > 0) {
    longest_tick_us_ = 0;
  }
  stage().snapshots.publish();
}

void HapticLoop::record(const DeviceInput& input, const Pose& scene_T_tool, const DeviceOutput& rendered,
                        double tick_us) noexcept {
  TickRecord& now = last_[statistics_.ticks() % last_.size()];
  now.time_s = time();
  now.device = input;
  now.scene_T_tool = scene_T_tool;
  now.soil = scene_->wrench();
  now.rendered = rendered;
  now.felt = felt_;
  now.injected_j = safety_.passivity().injected();
  now.quick_injected_j = safety_.passivity().quickInjected();
  now.tick_us = tick_us;
  now.late_us = late_us_;
  now.flags = safety_.flags() | (late_ ? kTickLate : 0U) | (resumed_ ? kTickResumed : 0U) |
              (heartbeat_lost_ ? kTickHeartbeatLost : 0U) | (scene_changed_ ? kTickSceneChanged : 0U) |
              (failed_ ? kTickFailed : 0U);
  scene_changed_ = false;
  now.trip = static_cast<std::uint8_t>(safety_.trip());
  if (!keep_records_) {
    return;
  }
  const std::size_t parts = hashedParts();
  // A bed that has failed has been stepped in part only.
  now.state_hash = hashes_ && !failed_ ? stateHash(scene_->bed().state(), statistics_.ticks() % parts, parts) : 0;
  if (!records_.push(now)) {
    lost_records_.fetch_add(1, std::memory_order_relaxed);
  }
}

std::size_t HapticLoop::hashedParts() const noexcept {
  return (scene_->bed().particles() + kHashedAtOnce - 1) / kHashedAtOnce;
}

void HapticLoop::reportTrip(LoopEnd end) noexcept {
  TripReport& report = trip_reports_.draft();
  const std::uint64_t ticks = statistics_.ticks();
  report.trip = safety_.trip();
  report.end = end;
  report.time_s = time();
  report.count = std::min<std::uint64_t>(ticks, TripReport::kTicks);
  for (std::size_t i = 0; i < report.count; ++i) {
    report.ticks[i] = last_[(ticks + 1 - report.count + i) % last_.size()];
  }
  trip_reports_.publish();
}

void HapticLoop::takeRecords(std::vector<TickRecord>& records) {
  records_.consume_all([&records](const TickRecord& record) { records.push_back(record); });
}

}  // namespace haptolith
