#include "study/teleop_work.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "haptolith/identify/training/training_file.h"
#include "haptolith/teleop/operator/learning_model.h"
#include "haptolith/teleop/operator/surface_mender.h"

namespace haptolith {

namespace {

constexpr double kEver_s = std::numeric_limits<double>::infinity();

TeleopSetup setupFor(const StudyProtocol& protocol, const StudyBlock& block, std::uint64_t seed) {
  const TeleopWork& work = *block.teleop;
  const LinkProfile link = linkOf(work);
  TeleopSetup setup;
  setup.model = modelOf(protocol, block);
  setup.site = findSceneFile(work.site);
  setup.up = link.up;
  setup.down = link.down;
  setup.model.bed.seed += seed;
  setup.site.bed.seed += seed;
  setup.sending = sendingOver(link.up, link.down);
  setup.feedback = work.force == TeleopForce::kNone ? Feedback::kNone : Feedback::kModel;
  setup.duration_s = block.interval_s;
  setup.task = work.task;
  if (work.force == TeleopForce::kLearning) {
    setup.learns.emplace(probeTraining().runs);
    setup.mends = canMend(setup.model.bed);
  }
  return setup;
}

}  // namespace

LinkProfile linkOf(const TeleopWork& work) {
  LinkProfile link;
  link.up.delay_s = link.down.delay_s = work.round_trip_s / 2;
  return link;
}

TeleopSummary summaryOf(const ForceAgreement& agreement, const std::optional<ModelSoil>& learned) {
  TeleopSummary summary;
  summary.force_error = agreement.share(0, kEver_s);
  summary.met_rms_n = agreement.rmsMet(0, kEver_s);
  summary.met_peak_n = 0;
  for (const AgreementPoint& window : agreement.windows()) {
    summary.met_peak_n = std::max(summary.met_peak_n, window.met_n.norm());
  }
  if (learned) {
    summary.friction_angle_deg = learned->friction_angle_deg.middle;
    summary.cohesion_pa = learned->cohesion_pa.middle;
    summary.tool_friction_angle_deg = learned->tool_friction_angle_deg.middle;
  }
  return summary;
}

SceneFile modelOf(const StudyProtocol& protocol, const StudyBlock& block) {
  SceneFile model = sceneOf(protocol, block, block.reference);
  return block.teleop->force == TeleopForce::kLearning ? readyToLearn(model) : model;
}

void SimulatedTeleopRig::prepare(const StudyBlock& block, const Stimulus& stimulus) {
  show(block, stimulus);
}

void SimulatedTeleopRig::show(const StudyBlock& block, const Stimulus& stimulus) {
  work_ = block.teleop ? &block : nullptr;
  if (work_ == nullptr) {
    other_->show(block, stimulus);
  }
}

void SimulatedTeleopRig::feel() {
  if (work_ == nullptr) {
    other_->feel();
    return;
  }
  const TeleopResult result = simulateTeleop(setupFor(protocol_, *work_, next_seed_++), progress_);
  summary_ = summaryOf(result.agreement, result.learned);
  const bool done = std::isfinite(result.task->done_s);
  summary_.done = done ? 1 : 0;
  summary_.time_s = done ? result.task->done_s : work_->interval_s;
  summary_.reached = result.task->reached;
  summary_.stops = static_cast<double>(result.stops);
  trial_summary_ = {.duration_s = result.duration_s};
}

TrialSummary SimulatedTeleopRig::rest() {
  return work_ == nullptr ? other_->rest() : trial_summary_;
}

}  // namespace haptolith
