#include "haptolith/haptics/loop/haptic_loop.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/overloaded.h"
#include "haptolith/core/process/signal_stack.h"
#include "haptolith/haptics/real_time.h"
#include "haptolith/haptics/safety/last_resort.h"

namespace haptolith {

namespace {

constexpr std::size_t kRequestsWaiting = 64;

LoopEnd failure(StepStatus status) noexcept {
  switch (status) {
    case StepStatus::kOk: return LoopEnd::kRunning;
    case StepStatus::kNotFinite: return LoopEnd::kNotFinite;
    case StepStatus::kCollapsed: return LoopEnd::kCollapsed;
  }
  return LoopEnd::kNotFinite;
}

/// The softest spring, which stores the most energy for a force: see Passivity.
double softestSpring(const Scene& scene, const Coupling& coupling) noexcept {
  return std::min({scene.tool().stiffness_n_m, scene.bed().parameters().soil.stiffness_n_m, coupling.stiffness()});
}

/// With a virtual coupling the tool has a separate mass: at least the one that the hand should feel.
CouplingParameters withMassOf(const ToolParameters& tool, CouplingParameters coupling) noexcept {
  coupling.spring.mass_kg = std::max(coupling.spring.mass_kg, tool.mass_kg);
  return coupling;
}

}  // namespace

HapticLoop::HapticLoop(Scene& scene, HapticDevice& device, const LoopParameters& parameters, bool keep_records,
                       const HandlingParameters& handling)
    : first_(scene),
      shown_(&first_),
      scene_(&scene),
      device_(device),
      parameters_(parameters),
      mapping_(handling.mapping, device.limits(), parameters.tick_s),
      coupling_(withMassOf(scene.tool(), handling.coupling), suitsDirectly(device.limits()),
                parameters.filter_cutoff_hz, parameters.tick_s),
      safety_(handling.safety, device.limits(), device.simulated(), softestSpring(scene, coupling_), parameters.tick_s),
      clock_(parameters.tick_s, parameters.real_time),
      fade_(parameters.tick_s, device.simulated()),  // soil where a person's hand is moves out of its way gently
      telemetry_(parameters.tick_s, keep_records),
      requests_(kRequestsWaiting) {
  validate(parameters);
  if (parameters.tick_s != scene.bed().parameters().tick_s) {  // else time would run faster or slower than the clock
    throw InvalidParameter("tick_s", fmt::format("{}", parameters.tick_s),
                           fmt::format("the bed's {}", scene.bed().parameters().tick_s));
  }
  if (parameters.real_time && !device.simulated()) {
    watchdog_.emplace(device, handling.safety.watchdog_timeout_s);
  }
}

LoopEnd HapticLoop::tick() noexcept {
  clock_.beginTick();
  const bool silent = wasSilent();
  if (silent) {  // first of all: what the hand feels now is as old as the silence is long
    device_.write({});
  }
  takeRequests();
  if (clock_.standsStill()) {
    standStill();
    return LoopEnd::kRunning;
  }
  resumeAfterStandstill();

  // Reads the hand. An implausible reading leaves the tool in place, and it fades out of the soil.
  const DeviceInput input = device_.read();
  safety_.check(input, health(silent));
  followHand(input);
  LoopEnd end = endFor(safety_.trip());

  // The tool follows it, and the soil answers.
  if (end == LoopEnd::kRunning) {
    end = moveTool();
  }
  if (end != LoopEnd::kRunning) {
    return finish(end, input, {});
  }

  // The hand feels it, as far as is safe.
  DeviceOutput rendered = mapping_.toDevice(coupling_.feel(scene_->soilForce(), scene_->contactStiffness()));
  const Wrench weight = toolWeight();
  output_ = safety_.step(rendered, weight);
  if (!weight.isZero()) {
    rendered.wrench.add(weight);
  }
  // After a tick that took too long, the force belongs to an old position of the hand; the next tick trips.
  device_.write(watchdog_ && watchdog_->tooLate() ? DeviceOutput{} : output_);
  publish();
  return finish(input.state == DeviceState::kFinished ? LoopEnd::kFinished : LoopEnd::kRunning, input, rendered);
}

/// In the device's frame.
Wrench HapticLoop::toolWeight() const noexcept {
  const ToolParameters& tool = scene_->tool();
  if (tool.mass_kg == 0) {
    return {};
  }
  const Vec3& gravity_m_s2 = scene_->bed().parameters().gravity_m_s2;
  return mapping_.toDevice({weightOf(tool, scene_->toolPose().orientation, gravity_m_s2), 0}).wrench;
}

/// Counts a tick, records it, and reports its safety trip. A state that cannot be rendered ends the run; its tick is
/// counted, recorded and reported like others.
LoopEnd HapticLoop::finish(LoopEnd end, const DeviceInput& input, const DeviceOutput& rendered) noexcept {
  const bool failed = end != LoopEnd::kRunning && end != LoopEnd::kFinished;
  if (failed) {
    output_ = {};
    device_.write(output_);
  }
  clock_.endTick(scene_->bed().awake());
  TickRecord& tick = telemetry_.draft();
  tick.device = input;
  tick.scene_T_tool = scene_->toolPose();
  tick.rendered = rendered;
  tick.sent = output_;
  tick.injected_j = safety_.passivity().injected();
  tick.quick_injected_j = safety_.passivity().quickInjected();
  tick.flags = safety_.flags() | std::exchange(flags_, 0U) | (failed ? kTickFailed : 0U);
  tick.trip = static_cast<std::uint8_t>(safety_.trip());
  telemetry_.record(clock_, *scene_);
  if (failed || safety_.justTripped()) {
    telemetry_.report(safety_.trip(), failed ? end : LoopEnd::kRunning);
  }
  return end;
}

LoopEnd HapticLoop::run(const std::atomic<bool>& stop) noexcept {
  const SignalStack stack;
  if (watchdog_) {
    watchdog_->start();
  }
  const LoopEnd end = runTicks(stop);
  scene_->bed().scheduleHelpers({});  // its next caller may be an ordinary thread
  if (watchdog_) {
    watchdog_->stop();
  }
  device_.write({});
  publishEnd(end);
  return end;
}

LoopEnd HapticLoop::runTicks(const std::atomic<bool>& stop) noexcept {
  const auto last_tick = static_cast<std::uint64_t>(std::llround(parameters_.duration_s / parameters_.tick_s));
  LoopEnd wanted_end = LoopEnd::kRunning;
  helpers_ = helpersSchedule();
  scene_->bed().scheduleHelpers(helpers_);
  clock_.start();
  while (true) {
    if (parameters_.real_time) {
      telemetry_.addLateness(clock_.standsStill() ? clock_.waitForTick() : clock_.waitForTick(scene_->bed()));
    }
    if (const LoopEnd end = tick(); end != LoopEnd::kRunning) {
      return end;
    }
    if (wanted_end == LoopEnd::kRunning && stop.load(std::memory_order_relaxed)) {
      wanted_end = LoopEnd::kStopped;
    } else if (wanted_end == LoopEnd::kRunning && last_tick > 0 && statistics().ticks() >= last_tick) {
      wanted_end = LoopEnd::kDuration;
    }
    if (wanted_end != LoopEnd::kRunning) {  // forces on a person's hand fade out
      softStop();
      if (safety_.stopped() || clock_.paused()) {
        return wanted_end;
      }
    }
    if (parameters_.real_time) {
      clock_.planNextTick();
    } else if (clock_.standsStill()) {
      LoopClock::waitAMoment();
    } else {
      while (telemetry_.full() && !stop.load(std::memory_order_relaxed)) {
        LoopClock::waitAMoment();  // no hand is connected: the loop may wait for its recorder
      }
    }
  }
}

/// Whether the loop was silent for long enough that the watchdog tripped.
bool HapticLoop::wasSilent() noexcept {
  const bool silent = watchdog_ && watchdog_->beat();
  return (watchdog_ && LastResort::releasedForceMeanwhile()) || silent;
}

/// Health of the loop. After silence the device is taken up again immediately: the safety layer then sends no force for
/// a while.
LoopHealth HapticLoop::health(bool silent) noexcept {
  if (silent) {
    watchdog_->resumeForce();
  }
  const LoopHealth now = overridden_health_.value_or(LoopHealth{clock_.late(), silent});
  overridden_health_.reset();
  flags_ |= now.heartbeat_lost ? kTickHeartbeatLost : 0U;
  return now;
}

/// Moves hand_ to where the device has it, unless that is implausible.
void HapticLoop::followHand(const DeviceInput& input) noexcept {
  hand_.twist = {};
  if (!safety_.allWell()) {
    return;
  }
  const HandState there = mapping_.toScene(input);
  if (!isNearBed(scene_->bed().parameters(), there.pose.position_m)) {
    safety_.releaseForce(SafetyTrip::kWorkspace);
  } else if (safety_.trip() == SafetyTrip::kNone) {
    hand_ = there;
  }
}

LoopEnd HapticLoop::moveTool() noexcept {
  fadeTool();
  if (fade_.takePlacing()) {  // it begins where the hand is, not with a sweep through the soil to get there
    coupling_.place(hand_);
    scene_->placeTool(hand_);
  }
  const StepStatus status = scene_->tick(coupling_.moveTool(hand_));
  const Wrench& soil = scene_->soilWrench();
  const bool finite = soil.force_n.allFinite() && soil.torque_nm.allFinite();
  return status == StepStatus::kOk && !finite ? LoopEnd::kNotFinite : failure(status);
}

void HapticLoop::fadeTool() noexcept {
  if (safety_.justRecovered()) {
    fade_.begin();
  }
  if (const auto due = fade_.step(safety_.trip() == SafetyTrip::kNone, clock_.speed())) {
    carryOut(*due);
  }
  scene_->setToolFade(fade_.stiffnessShare());
}

/// Pauses time; the device gets no force.
void HapticLoop::standStill() noexcept {
  if (!device_.simulated()) {
    (void)device_.read();  // some devices fall asleep when they are not polled
  }
  device_.write({});
  released_ = true;
  publish();
}

/// Resumes time where it stopped. A simulated hand must not be affected; a person's has moved meanwhile.
void HapticLoop::resumeAfterStandstill() noexcept {
  if (!std::exchange(released_, false)) {
    return;
  }
  flags_ |= kTickResumed;
  if (device_.simulated()) {
    device_.write(output_);
  } else {
    safety_.restart();
    fade_.begin();
  }
}

/// End of the run after a trip, if it cannot continue: a person's hand recovers, a simulated one does not.
LoopEnd HapticLoop::endFor(SafetyTrip trip) const noexcept {
  if (trip == SafetyTrip::kLost) {
    return LoopEnd::kLost;
  }
  const bool away = trip == SafetyTrip::kDeviceNotFinite || trip == SafetyTrip::kWorkspace;
  return device_.simulated() && away ? LoopEnd::kHandLeft : LoopEnd::kRunning;
}

/// One replacement, adjustment or moved particle at a time: the requests behind it wait for the next tick.
bool HapticLoop::mayBeDoneNow(const LoopRequest& asked) const noexcept {
  return !(fade_.waits() && std::holds_alternative<request::Replace>(asked)) &&
         !((flags_ & kTickSoilAdjusted) != 0 && std::holds_alternative<request::Adjust>(asked)) &&
         !((flags_ & kTickParticleMoved) != 0 && std::holds_alternative<request::MoveGrain>(asked));
}

void HapticLoop::takeRequests() noexcept {
  while (requests_.read_available() > 0 && mayBeDoneNow(requests_.front())) {
    carryOut(requests_.front());
    requests_.pop();
  }
}

void HapticLoop::carryOut(const LoopRequest& asked) noexcept {
  std::visit(
      Overloaded{[this](const request::Pause&) { clock_.pause(); }, [this](const request::Resume&) { clock_.resume(); },
                 [this](const request::Advance& advance) { clock_.advance(advance.ticks); },
                 [this](const request::Speed& speed) { clock_.setSpeed(speed.factor); },
                 [this](const request::Gravity& gravity) {
                   flags_ |= kTickSceneChanged;
                   scene_->bed().setGravity(gravity.gravity_m_s2);
                 },
                 [this](const request::Soil& soil) {
                   flags_ |= kTickSceneChanged;
                   scene_->bed().setSoil(soil.laws);
                 },
                 [this](const request::Adjust& adjust) {
                   flags_ |= kTickSoilAdjusted;
                   scene_->bed().adjustSoil(adjust.laws);
                   scene_->setToolFriction(adjust.tool_friction);
                 },
                 [this](const request::MoveGrain& grain) {
                   flags_ |= kTickParticleMoved;
                   (void)scene_->moveGrain(grain.move);
                 },
                 [this](const request::SetContact& touch) {
                   flags_ |= kTickSceneChanged;
                   fade_.touch(touch.on);
                 },
                 [this](const request::Replace& replace) {
                   if (clock_.paused()) {  // no force is rendered
                     carryOut(replace);
                   } else {
                     fade_.replaceWhenFaded(replace);
                     flags_ |= kTickSceneChanged;  // the tool begins to fade
                   }
                 }},
      asked);
}

void HapticLoop::carryOut(const request::Replace& replace) noexcept {
  std::visit(Overloaded{[this](const request::ReplaceTool& tool) { scene_->setTool(tool.tool); },
                        [this](const request::ReplaceBed& next) {
                          next.shown->scene.placeTool({{scene_->toolPose(), {}}, hand_.opening});
                          scene_ = &next.shown->scene;
                          scene_->bed().scheduleHelpers(helpers_);
                          shown_.store(next.shown, std::memory_order_release);
                        }},
             replace);
  flags_ |= kTickSceneChanged;
  output_ = {};
  fade_.begin();
  scene_->setToolFade(fade_.stiffnessShare());
}

void HapticLoop::publish() noexcept {
  telemetry_.publish(shownScene(), clock_, [this](SceneSnapshot& snapshot) { tell(snapshot); });
}

void HapticLoop::publishEnd(LoopEnd end) noexcept {
  if (end != LoopEnd::kNotFinite && end != LoopEnd::kCollapsed) {  // states without a picture
    telemetry_.publishLast(shownScene(), clock_, [this](SceneSnapshot& snapshot) { tell(snapshot); });
  }
}

void HapticLoop::tell(SceneSnapshot& snapshot) const noexcept {
  snapshot.scene_T_tool = scene_->toolPose();
  snapshot.soil_wrench = scene_->soilWrench();
  snapshot.device_wrench = output_.wrench;
  snapshot.device_wrench_in_scene = mapping_.turnedIntoScene(output_.wrench);
  snapshot.trip = safety_.trip();
  snapshot.trips = safety_.trips();
}

}  // namespace haptolith
