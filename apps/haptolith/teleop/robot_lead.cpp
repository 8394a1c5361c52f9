#include "teleop/robot_lead.h"

#include "haptolith/bed/surface_height.h"
#include "haptolith/identify/training_file.h"
#include "haptolith/recording/recording_format.h"

namespace haptolith {

namespace {

constexpr double kInSoil_n = 0.2;  ///< more than this on the hand, and it is not in the air

}  // namespace

RobotLead::RobotLead(const Session& session, const std::string& to, const EndOptions& options, bool learns)
    : end_(to, options, meanSurfaceHeight(session.scene().bed()), session.shown().loop.tick_s), learns_(learns) {
  if (learns_) {
    begin(session.shown());
  }
}

void RobotLead::begin(const Scenario& model) {
  soil_ = model.bed.soil;
  tool_friction_ = model.tool.friction;
  learning_.reset();
  if (canLearn(model)) {
    learning_.emplace(model, StrengthMap(probeTraining().runs), Work::kBeside);
  }
}

void RobotLead::follow(Session& session, std::span<const TickRecord> ticks, SessionRecording& recording) {
  end_.follow(ticks);
  end_.receive([this](const RobotReport& report, const Vec3& felt_n) {
    if (learning_) {
      learning_->met(report, felt_n);
    }
  });
  if (!ticks.empty()) {
    in_air_ = ticks.back().rendered.wrench.force_n.norm() < kInSoil_n;
    time_s_ = ticks.back().time_s;
  }
  if (learns_) {
    learn(session, recording);
  }
}

void RobotLead::learn(Session& session, SessionRecording& recording) {
  const Scenario& shown = session.shown();
  if (shown.bed.soil != soil_ || shown.tool.friction != tool_friction_) {  // somebody wants another soil
    begin(shown);
  }
  const std::optional<SoilAdjustment> step = learning_ ? learning_->at(end_.ticks(), in_air_) : std::nullopt;
  if (step && session.adjust(*step)) {
    recording.note(kAdjustmentKind, time_s_, adjustmentText(*step));
    soil_ = session.shown().bed.soil;
    tool_friction_ = session.shown().tool.friction;
  }
}

}  // namespace haptolith
