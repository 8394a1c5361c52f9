#include "haptolith/haptics/loop/tool_hand.h"

#include <algorithm>
#include <utility>

namespace haptolith {

namespace {

/// The softest spring, which stores the most energy for a force: see Passivity.
double softestSpring(const ToolParameters& tool, const BedParameters& bed, const Coupling& coupling) noexcept {
  return std::min({tool.stiffness_n_m, bed.soil.stiffness_n_m, coupling.stiffness()});
}

/// With a virtual coupling the tool has a separate mass: at least the one that the hand should feel.
CouplingParameters withMassOf(const ToolParameters& tool, CouplingParameters coupling) noexcept {
  coupling.spring.mass_kg = std::max(coupling.spring.mass_kg, tool.mass_kg);
  return coupling;
}

}  // namespace

ToolHand::ToolHand(const Scene& scene, std::size_t tool, const ToolHandling& handling, const LoopParameters& parameters)
    : device_(handling.device),
      tool_(tool),
      mapping_(handling.handling.mapping, device_->limits(), parameters.tick_s),
      coupling_(withMassOf(scene.tool(tool), handling.handling.coupling), suitsDirectly(device_->limits()),
                parameters.filter_cutoff_hz, parameters.tick_s),
      safety_(handling.handling.safety, device_->limits(), device_->simulated(),
              softestSpring(scene.tool(tool), scene.bed().parameters(), coupling_), parameters.tick_s),
      fade_(parameters.tick_s, device_->simulated()) {  // soil where a person's hand is moves out of its way gently
  if (parameters.real_time && !device_->simulated()) {
    watchdog_.emplace(*device_, handling.handling.safety.watchdog_timeout_s);
  }
}

void ToolHand::startWatching() noexcept {
  if (watchdog_) {
    watchdog_->start();
  }
}

void ToolHand::stopWatching() noexcept {
  if (watchdog_) {
    watchdog_->stop();
  }
}

void ToolHand::beginTick(bool released) noexcept {
  const bool silent = watchdog_ && watchdog_->beat();
  silent_ = silent || (watchdog_ && released);
  if (silent_) {
    device_->write({});
  }
}

void ToolHand::standStill() noexcept {
  if (!device_->simulated()) {
    (void)device_->read();  // some devices fall asleep when they are not polled
  }
  device_->write({});
  released_ = true;
}

void ToolHand::resumeAfterStandstill() noexcept {
  if (!std::exchange(released_, false)) {
    return;
  }
  flags_ |= kTickResumed;
  if (device_->simulated()) {
    device_->write(output_);
  } else {
    safety_.restart();
    fade_.begin();
  }
}

/// After silence the device is taken up again immediately: the safety layer then sends no force for a while.
void ToolHand::read(const BedParameters& bed, bool late, const std::optional<LoopHealth>& overridden) noexcept {
  input_ = device_->read();
  rendered_ = {};
  if (silent_) {
    watchdog_->resumeForce();
  }
  const LoopHealth health = overridden.value_or(LoopHealth{late, silent_});
  flags_ |= health.heartbeat_lost ? kTickHeartbeatLost : 0U;
  safety_.check(input_, health);
  follow(bed);
}

/// Moves hand_ to where the device has it, unless that is implausible.
void ToolHand::follow(const BedParameters& bed) noexcept {
  hand_.twist = {};
  if (!safety_.allWell()) {
    return;
  }
  const HandState there = mapping_.toScene(input_);
  if (!isNearBed(bed, there.pose.position_m)) {
    safety_.releaseForce(SafetyTrip::kWorkspace);
  } else if (safety_.trip() == SafetyTrip::kNone) {
    hand_ = there;
  }
}

bool ToolHand::left() const noexcept {
  const SafetyTrip trip = safety_.trip();
  return device_->simulated() && (trip == SafetyTrip::kDeviceNotFinite || trip == SafetyTrip::kWorkspace);
}

double ToolHand::fade(double speed) noexcept {
  if (safety_.justRecovered()) {
    fade_.begin();
  }
  fade_.step(safety_.trip() == SafetyTrip::kNone, speed);
  return fade_.stiffnessShare();
}

const HandState& ToolHand::target(Scene& scene) noexcept {
  if (fade_.takePlacing()) {  // it begins where the hand is, not with a sweep through the soil to get there
    coupling_.place(hand_);
    scene.placeTool(hand_, tool_);
  }
  return coupling_.moveTool(hand_);
}

void ToolHand::feel(const Scene& scene) noexcept {
  rendered_ = mapping_.toDevice(coupling_.feel(scene.handForce(tool_), scene.contactStiffness(tool_)));
  const Wrench own = weight(scene);
  output_ = safety_.step(rendered_, own);
  if (!own.isZero()) {
    rendered_.wrench.add(own);
  }
  // After a tick that took too long, the force belongs to an old position of the hand; the next tick trips.
  device_->write(watchdog_ && watchdog_->tooLate() ? DeviceOutput{} : output_);
}

/// In the device's frame.
Wrench ToolHand::weight(const Scene& scene) const noexcept {
  const ToolParameters& tool = scene.tool(tool_);
  if (tool.mass_kg == 0) {
    return {};
  }
  const Vec3& gravity_m_s2 = scene.bed().parameters().gravity_m_s2;
  return mapping_.toDevice({weightOf(tool, scene.toolPose(tool_).orientation, gravity_m_s2), 0}).wrench;
}

void ToolHand::sendNothing() noexcept {
  output_ = {};
  device_->write(output_);
}

void ToolHand::fill(TickRecord& record, const Scene& scene, bool failed) noexcept {
  record.tool = static_cast<std::uint8_t>(tool_);
  record.device = input_;
  record.scene_T_tool = scene.toolPose(tool_);
  record.rendered = failed ? DeviceOutput{} : rendered_;
  record.sent = output_;
  record.injected_j = safety_.passivity().injected();
  record.quick_injected_j = safety_.passivity().quickInjected();
  record.joint = scene.joint(tool_);
  record.flags = safety_.flags() | std::exchange(flags_, 0U) | (failed ? kTickFailed : 0U);
  record.trip = static_cast<std::uint8_t>(safety_.trip());
}

void ToolHand::restart() noexcept {
  output_ = {};
  fade_.begin();
}

}  // namespace haptolith
