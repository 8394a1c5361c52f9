#include "haptolith/study/run/session_rig.h"

#include <array>
#include <utility>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

/// Fractions of a gripper's opening; between the two the state is unchanged (hysteresis).
constexpr double kSqueezed = 0.3;
constexpr double kOpen = 0.5;

}  // namespace

SessionRig::SessionRig(Session& session, Recorder recorder) : session_(session), recorder_(std::move(recorder)) {
  session_.touch(false);
}

void SessionRig::follow(const std::vector<TickRecord>& ticks) {
  for (const TickRecord& tick : ticks) {
    if (feels_) {
      felt_.add(tick);
    }
  }
  if (ticks.empty()) {
    return;
  }
  const DeviceInput& now = ticks.back().device;
  const bool grips = session_.device().limits().grips && !session_.device().simulated();
  squeezed_ = grips && now.gripper_open < (squeezed_ ? kOpen : kSqueezed);
  buttons_ = now.buttons | (squeezed_ ? 1U : 0U);
}

void SessionRig::show(const StudyBlock& block, const Stimulus& stimulus) {
  feels_ = false;
  touches_ = !block.teleop || block.teleop->force != TeleopForce::kNone;
  session_.touch(false);
  session_.show(std::array{block.scene, stimulus.change});
}

bool SessionRig::ready() {
  if (!session_.problem().empty()) {
    throw Failure("cannot prepare the bed: " + session_.problem());
  }
  return session_.settled();
}

void SessionRig::feel() {
  felt_ = {};
  feels_ = true;
  session_.touch(touches_);
}

TrialSummary SessionRig::rest() {
  feels_ = false;
  session_.touch(false);
  return felt_.summary();
}

void SessionRig::pause() {
  session_.pause();
}

void SessionRig::resume() {
  session_.resume();
}

void SessionRig::startRecording(const std::filesystem::path& file) {
  if (recorder_.start) {
    recorder_.start(file);
  }
}

void SessionRig::stopRecording() {
  if (recorder_.stop) {
    recorder_.stop();
  }
}

double SessionRig::force() const {
  return session_.snapshot().device_wrench.force_n.norm();
}

bool SessionRig::pageMayHold() const {
  return session_.device().simulated();
}

}  // namespace haptolith
