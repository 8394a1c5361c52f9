#include "haptolith/haptics/loop/haptic_loop.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "haptolith/core/assert.h"
#include "haptolith/core/error.h"
#include "haptolith/core/overloaded.h"
#include "haptolith/core/platform/last_resort.h"
#include "haptolith/core/platform/signal_stack.h"
#include "haptolith/haptics/real_time.h"

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

}  // namespace

HapticLoop::HapticLoop(Scene& scene, std::span<const ToolHandling> hands, const LoopParameters& parameters,
                       bool keep_records)
    : first_(scene),
      shown_(&first_),
      scene_(&scene),
      parameters_(parameters),
      clock_(parameters.tick_s, parameters.real_time),
      telemetry_(parameters.tick_s, keep_records, std::max<std::size_t>(hands.size(), 1)),
      requests_(kRequestsWaiting) {
  validate(parameters);
  if (parameters.tick_s != scene.bed().parameters().tick_s) {  // else time would run faster or slower than the clock
    throw InvalidParameter("tick_s", fmt::format("{}", parameters.tick_s),
                           fmt::format("the bed's {}", scene.bed().parameters().tick_s));
  }
  if (hands.size() > scene.tools()) {
    throw InvalidParameter("hands", fmt::format("{}", hands.size()),
                           fmt::format("at most the {} tools of the scene", scene.tools()));
  }
  for (std::size_t tool = 0; tool < scene.tools(); ++tool) {
    if (tool < hands.size()) {
      hands_.emplace_back(scene, tool, hands[tool], parameters);
    } else {
      scene.setToolFade(0, tool);
    }
  }
  targets_.resize(hands_.size());
}

HapticLoop::HapticLoop(Scene& scene, HapticDevice& device, const LoopParameters& parameters, bool keep_records,
                       const HandlingParameters& handling)
    : HapticLoop(scene, std::array{ToolHandling{&device, handling}}, parameters, keep_records) {}

LoopEnd HapticLoop::tick() noexcept {
  clock_.beginTick();
  const bool released = std::ranges::any_of(hands_, &ToolHand::watched) && LastResort::releasedForceMeanwhile();
  for (ToolHand& hand : hands_) {
    hand.beginTick(released);
  }
  takeRequests();
  if (clock_.standsStill()) {
    standStill();
    return LoopEnd::kRunning;
  }

  // The tools follow the hands, and the soil answers.
  LoopEnd end = readHands();
  if (end == LoopEnd::kRunning) {
    end = moveTools();
  }
  if (end != LoopEnd::kRunning) {
    return finish(end);
  }

  // The hands feel it, as far as is safe.
  for (ToolHand& hand : hands_) {
    hand.feel(*scene_);
  }
  publish();
  const bool finished = !hands_.empty() && std::ranges::all_of(hands_, &ToolHand::finished);
  return finish(finished ? LoopEnd::kFinished : LoopEnd::kRunning);
}

/// Reads all hands and returns whether the run continues. A person's hand that has tripped recovers. The run ends when
/// the last person's device is lost, or when a simulated hand has left.
LoopEnd HapticLoop::readHands() noexcept {
  const bool late = clock_.late();
  const BedParameters& bed = scene_->bed().parameters();
  std::size_t people = 0, lost = 0;
  bool left = false;
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    ToolHand& hand = hands_[i];
    hand.resumeAfterStandstill();
    hand.read(bed, late, std::exchange(overridden_health_[i], std::nullopt));
    const bool simulated = hand.device().simulated();
    people += simulated ? 0 : 1;
    lost += hand.lost() ? 1 : 0;
    left = left || hand.left() || (simulated && hand.lost());
  }
  if (lost > 0 && (lost >= people || left)) {
    return LoopEnd::kLost;
  }
  return left ? LoopEnd::kHandLeft : LoopEnd::kRunning;
}

LoopEnd HapticLoop::moveTools() noexcept {
  fadeTools();
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    targets_[i] = hands_[i].target(*scene_);
  }
  const StepStatus status = scene_->tickAll(targets_);
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    const Wrench& soil = scene_->soilWrench(i);
    if (status == StepStatus::kOk && !(soil.force_n.allFinite() && soil.torque_nm.allFinite())) {
      return LoopEnd::kNotFinite;
    }
  }
  return failure(status);
}

void HapticLoop::fadeTools() noexcept {
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    scene_->setToolFade(hands_[i].fade(clock_.speed()), i);
  }
  if (replacement_ && isGone(*replacement_)) {
    carryOut(*std::exchange(replacement_, std::nullopt));
  }
}

/// Whether what is to be replaced has left the soil.
bool HapticLoop::isGone(const request::Replace& replaced) const noexcept {
  if (const auto* tool = std::get_if<request::ReplaceTool>(&replaced)) {
    return tool->number >= hands_.size() || hands_[tool->number].gone();
  }
  return std::ranges::all_of(hands_, &ToolHand::gone);
}

/// Counts a tick, records it, and reports its safety trips. A state that cannot be rendered ends the run; its tick is
/// counted, recorded and reported like others.
LoopEnd HapticLoop::finish(LoopEnd end) noexcept {
  const bool failed = end != LoopEnd::kRunning && end != LoopEnd::kFinished;
  if (failed) {
    for (ToolHand& hand : hands_) {
      hand.sendNothing();
    }
  }
  clock_.endTick(scene_->bed().awake());
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    TickRecord& tick = telemetry_.draft(i);
    hands_[i].fill(tick, *scene_, failed);
    tick.flags |= flags_;
  }
  flags_ = 0;
  telemetry_.record(clock_, *scene_);
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    const SafetyLayer& safety = hands_[i].safety();
    if (safety.justTripped() || (failed && i == 0)) {
      telemetry_.report(i, safety.trip(), failed ? end : LoopEnd::kRunning);
    }
  }
  return end;
}

void HapticLoop::softStop() noexcept {
  for (ToolHand& hand : hands_) {
    hand.safety().stop();
  }
}

bool HapticLoop::softlyStopped() const noexcept {
  return std::ranges::all_of(hands_, [](const ToolHand& hand) { return hand.safety().stopped(); });
}

LoopEnd HapticLoop::run(const std::atomic<bool>& stop) noexcept {
  const SignalStack stack;
  for (ToolHand& hand : hands_) {
    hand.startWatching();
  }
  const LoopEnd end = runTicks(stop);
  scene_->bed().scheduleHelpers({});  // its next caller may be an ordinary thread
  for (ToolHand& hand : hands_) {
    hand.stopWatching();
  }
  for (ToolHand& hand : hands_) {
    hand.device().write({});
  }
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
      if (softlyStopped() || clock_.paused()) {
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

/// Pauses time; the devices get no force.
void HapticLoop::standStill() noexcept {
  for (ToolHand& hand : hands_) {
    hand.standStill();
  }
  publish();
}

/// One replacement, adjustment or moved particle at a time: the requests behind it wait for the next tick.
bool HapticLoop::mayBeDoneNow(const LoopRequest& asked) const noexcept {
  return !(replacement_ && std::holds_alternative<request::Replace>(asked)) &&
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
                   for (ToolHand& hand : hands_) {
                     hand.touch(touch.on);
                   }
                 },
                 [this](const request::Replace& replace) {
                   if (clock_.paused()) {  // no force is rendered
                     carryOut(replace);
                   } else {
                     replacement_ = replace;
                     const auto* tool = std::get_if<request::ReplaceTool>(&replace);
                     for (std::size_t i = 0; i < hands_.size(); ++i) {
                       if (tool == nullptr || tool->number == i) {
                         hands_[i].leave();
                       }
                     }
                     flags_ |= kTickSceneChanged;  // tools begin to fade
                   }
                 }},
      asked);
}

void HapticLoop::carryOut(const request::Replace& replace) noexcept {
  flags_ |= kTickSceneChanged;
  const auto begin_again = [this](std::size_t tool) {
    if (tool < hands_.size()) {
      hands_[tool].restart();
      scene_->setToolFade(hands_[tool].stiffnessShare(), tool);
    }
  };
  if (const auto* tool = std::get_if<request::ReplaceTool>(&replace)) {
    scene_->setTool(tool->tool, tool->number);
    begin_again(tool->number);
    return;
  }
  ShownScene* next = std::get<request::ReplaceBed>(replace).shown;
  for (std::size_t i = 0; i < next->scene.tools(); ++i) {
    if (i < hands_.size()) {
      next->scene.placeTool({{scene_->toolPose(i), {}}, hands_[i].opening()}, i);
    } else {
      next->scene.setToolFade(0, i);
    }
  }
  scene_ = &next->scene;
  scene_->bed().scheduleHelpers(helpers_);
  shown_.store(next, std::memory_order_release);
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    begin_again(i);
  }
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
  HAPTO_ASSERT(snapshot.tools.size() == scene_->tools());
  for (std::size_t i = 0; i < snapshot.tools.size(); ++i) {
    const bool held = i < hands_.size();
    snapshot.tools[i] = {.scene_T_tool = scene_->toolPose(i),
                         .turned = scene_->turnedToolPose(i),
                         .opening_m = scene_->opening(i),
                         .joint = scene_->joint(i),
                         .soil_wrench = scene_->soilWrench(i),
                         .force_band = scene_->forceBand(i),
                         .device_wrench_in_scene = held ? hands_[i].sentInScene() : Wrench{},
                         .trip = held ? hands_[i].safety().trip() : SafetyTrip::kNone};
  }
  if (hands_.empty()) {
    return;
  }
  const ToolHand& first = hands_.front();
  snapshot.scene_T_tool = scene_->toolPose();
  snapshot.soil_wrench = scene_->soilWrench();
  snapshot.device_wrench = first.sent();
  snapshot.device_wrench_in_scene = first.sentInScene();
  snapshot.trip = first.safety().trip();
  snapshot.trips = first.safety().trips();
}

}  // namespace haptolith
