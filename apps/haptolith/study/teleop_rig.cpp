#include "study/teleop_rig.h"

#include <chrono>
#include <limits>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/scene_file/site_task.h"

#include "study/teleop_work.h"

namespace haptolith {

namespace {

using namespace std::chrono_literals;

constexpr double kLost_s = 5;  ///< timeout of the robot's reports, beyond the round trip

}  // namespace

/// Requests a site; its soil settles once on a separate thread.
void TeleopRig::wantSite(const std::string& name) {
  if (name == site_name_) {
    return;
  }
  site_.reset();
  site_name_ = name;
  coming_ = std::async(std::launch::async, [name] {
    SceneFile scene_file = findSceneFile(name);
    validate(scene_file);
    const Scene scene(scene_file.bed, scene_file.tool);
    SavedScene level = scene.save();
    return Site{std::move(scene_file), std::move(level)};
  });
}

void TeleopRig::prepare(const StudyBlock& block, const Stimulus& stimulus) {
  show(block, stimulus);
  wants_robot_ = false;
}

void TeleopRig::show(const StudyBlock& block, const Stimulus& stimulus) {
  dismissRobot();
  work_ = block.teleop;
  if (work_) {
    wantSite(work_->site);
  }
  wants_robot_ = work_.has_value();
  rig_.show(block, stimulus);
}

bool TeleopRig::ready() {
  const bool session_is_ready = rig_.ready();
  if (!work_) {
    return session_is_ready;
  }
  if (!site_ && coming_.valid() && coming_.wait_for(0s) == std::future_status::ready) {
    try {
      site_ = coming_.get();
    } catch (...) {
      site_name_.clear();  // the next attempt starts over
      throw;
    }
  }
  if (!site_) {
    return false;
  }
  if (wants_robot_ && !robot_) {
    const LinkProfile link = linkOf(*work_);
    robot_ = std::make_unique<RobotBehindLink>(
        site_->scene_file, std::make_unique<Scene>(site_->scene_file.bed, site_->scene_file.tool, site_->level),
        link.up, link.down);
  }
  if (robot_ && !robot_->problem().empty()) {
    throw Failure(robot_->problem());
  }
  return session_is_ready && (!wants_robot_ || robot_->isReady());
}

void TeleopRig::feel() {
  if (work_) {
    const LinkProfile link = linkOf(*work_);
    EndOptions end;
    end.sending = sendingOver(link.up, link.down);
    lead_.emplace(session_, robot_->address(), end,
                  Likening{.strength = work_->force == TeleopForce::kLearning,
                           .surface = work_->force == TeleopForce::kLearning});
    judge_.emplace(work_->task);
    silent_since_s_ = 0;
    state_ = RobotState::kTaring;
    follows_s_.reset();
    done_s_.reset();
    stops_ = 0;
  }
  rig_.feel();
}

TrialSummary TeleopRig::rest() {
  dismissRobot();
  return rig_.rest();
}

void TeleopRig::dismissRobot() {
  lead_.reset();
  judge_.reset();
  robot_.reset();
}

void TeleopRig::follow(const std::vector<TickRecord>& ticks) {
  rig_.follow(ticks);
  if (!lead_) {
    return;
  }
  const double tick_s = session_.shown().loop.tick_s;
  lead_->follow(session_, ticks, recording_, {.report = [&](const RobotReport& report, const std::optional<Vec3>&) {
                  judge_->met(report, tick_s);
                }});
  watchRobot();
}

/// Updates the reported state of the robot, and whether its work is done.
void TeleopRig::watchRobot() {
  const OperatorEnd& end = lead_->end();
  const double now_s = static_cast<double>(end.ticks()) * session_.shown().loop.tick_s;
  if (end.news().heard) {
    silent_since_s_ = now_s;
  }
  if (const RobotState state = end.news().state.state; end.news().ever && state != state_) {
    const bool stopped = state == RobotState::kHolding || state == RobotState::kRetracting;
    stops_ += state_ == RobotState::kFollowing && stopped ? 1 : 0;
    state_ = state;
  }
  if (state_ == RobotState::kFollowing && !follows_s_) {
    follows_s_ = now_s;
  }
  judge_->look(end.site());
  if (judge_->done() && !done_s_) {
    done_s_ = now_s;
  }
}

bool TeleopRig::workIsDone() {
  if (!lead_) {
    return false;
  }
  if (!robot_->problem().empty()) {
    throw Failure(robot_->problem());
  }
  const double now_s = static_cast<double>(lead_->end().ticks()) * session_.shown().loop.tick_s;
  if (now_s - silent_since_s_ > kLost_s + work_->round_trip_s) {
    throw Failure("the robot stopped responding: the trial is repeated when the study continues");
  }
  if (state_ == RobotState::kFailed) {
    throw Failure("the robot failed: its readings are invalid; the trial is repeated when the study continues");
  }
  return judge_->done();
}

std::string TeleopRig::workText() const {
  return judge_ ? reachedText(work_->task, judge_->reached()) : "";
}

TeleopSummary TeleopRig::work() const {
  if (!lead_) {
    return {};
  }
  const double now_s = static_cast<double>(lead_->end().ticks()) * session_.shown().loop.tick_s;
  TeleopSummary summary =
      summaryOf(lead_->end().agreement(),
                lead_->learning() != nullptr ? std::optional(lead_->learning()->learned()) : std::nullopt);
  summary.done = done_s_ ? 1 : 0;
  summary.time_s = done_s_.value_or(now_s);
  summary.follows_s = follows_s_.value_or(std::numeric_limits<double>::quiet_NaN());
  summary.reached = judge_->reached();
  summary.stops = stops_;
  return summary;
}

}  // namespace haptolith
