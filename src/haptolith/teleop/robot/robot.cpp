#include "haptolith/teleop/robot/robot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "haptolith/teleop/robot/simulated_arm.h"

namespace haptolith {

namespace {

constexpr double kTooStrongFor_s = 0.02;
constexpr double kThere_m = 5e-4, kThere_rad = 0.01;  // an approach has arrived
constexpr double kAbove_m = 2e-3, kAbove_rad = 0.03;  // and may begin to descend
constexpr double kAstray_m = 0.02;                    // and has to rise again
constexpr double kLongestPlayout_s = 2;
constexpr double kPlayoutGrowth = 1.5;
constexpr double kSlowest = 0.95, kFastest = 1.1;  // paces at which commands are carried out
constexpr double kPaceTime_s = 2;                  // in which the pace evens out what is in hand

}  // namespace

void validate(const RobotParameters& robot, double tick_s) {
  using Ranges = RobotRanges;
  requireInRange("max_force_n", robot.max_force_n, Ranges::force_n);
  requireInRange("stop_force_n", robot.stop_force_n, Ranges::force_n);
  requireInRange("max_speed_m_s", robot.max_speed_m_s, Ranges::speed_m_s);
  requireInRange("jump_m_s", robot.jump_m_s, Ranges::speed_m_s);
  requireInRange("approach_m_s", robot.approach_m_s, Ranges::speed_m_s);
  requireInRange("approach_rad_s", robot.approach_rad_s, Ranges::turning_rad_s);
  requireInRange("clear_m", robot.clear_m, Ranges::length_m);
  requireInRange("playout_s", robot.playout_s, Ranges::time_s);
  requireInRange("longest_gap_s", robot.longest_gap_s, Ranges::time_s);
  requireInRange("silence_s", robot.silence_s, Ranges::time_s);
  requireInRange("hold_s", robot.hold_s, Ranges::time_s);
  for (int axis = 0; axis < 3; ++axis) {
    requireInRange("lowest_m", robot.lowest_m[axis], Ranges::length_m);
    requireInRange("highest_m", robot.highest_m[axis], {robot.lowest_m[axis], Ranges::length_m.highest});
  }
  if (const double lightest_kg = lightestArm(robot.arm, tick_s); robot.arm.mass_kg <= lightest_kg) {
    throw InvalidParameter(
        "arm.mass_kg", fmt::format("{:g}", robot.arm.mass_kg),
        fmt::format("> {:g}, or the arm is numerically unstable at a tick of {:g} s", lightest_kg, tick_s));
  }
  validate(robot.sensor);
}

Robot::Robot(const RobotParameters& parameters, Scene& scene, double surface_m, const Pose& home)
    : parameters_(parameters),
      tick_s_(scene.bed().parameters().tick_s),
      track_(tick_s_),
      playout_s_(parameters.playout_s),
      wanted_{{home, {}}, 1},
      tool_{home, {}} {
  validate(parameters_, tick_s_);
  arm_ = std::make_unique<SimulatedArm>(parameters_.arm, parameters_.max_force_n, parameters_.sensor, scene, surface_m,
                                        home);
}

Robot::Robot(const RobotParameters& parameters, std::unique_ptr<RobotArm> arm, double tick_s)
    : parameters_(parameters),
      tick_s_(tick_s),
      arm_(std::move(arm)),
      begins_at_tool_(true),
      track_(tick_s_),
      playout_s_(parameters.playout_s) {
  validate(parameters_, tick_s_);
}

void Robot::take(std::uint32_t connection, bool held, std::span<const Keyframe> keyframes) {
  if (connection != connection_) {  // another program, or the same once more: its indices are others
    track_.clear();
    plays_ = false;
    const bool first = connection_ == 0;
    connection_ = connection;
    if (!first && state_ != RobotState::kTaring) {
      stop(StopReason::kRestart);
    }
  }
  silent_s_ = 0;
  held_ = held;
  for (const Keyframe& key : keyframes) {
    track_.add(key);
  }
}

void Robot::tick() {
  in_state_s_ += tick_s_;
  silent_s_ += tick_s_;
  play();
  decide();
  moveTool();
  account();
}

/// Advances to the next command, if it has arrived.
void Robot::play() {
  pace_ = 0;
  if (track_.empty()) {
    return;
  }
  const auto newest = static_cast<double>(track_.newest());
  const auto oldest = static_cast<double>(track_.oldest());
  if (!plays_ && (play_ < oldest || play_ > newest)) {  // the first that have come; what was long ago is over
    play_ = std::max(oldest, newest - playout_s_ / tick_s_);
    reported_index_ = play_;
  }
  const double in_hand_s = (newest - play_) * tick_s_;
  plays_ = plays_ || in_hand_s >= playout_s_;
  if (!plays_ || newest <= play_) {
    return;
  }
  pace_ = std::clamp(1 + (in_hand_s - playout_s_) / kPaceTime_s, kSlowest, kFastest);
  play_ = std::min(newest, play_ + pace_);
  track_.forgetBefore(play_);
  bridge();
  if (play_ >= newest) {
    plays_ = false;
    ++ran_out_;
    playout_s_ = std::min(kLongestPlayout_s, std::max(playout_s_, tick_s_) * kPlayoutGrowth);
  }
}

/// Checks the stretch under execution: implausible movements are not executed.
void Robot::bridge() {
  if (track_.oldest() == track_.newest()) {
    return;
  }
  const auto [from, to] = track_.around(play_);
  const double time_s = static_cast<double>(to.index - from.index) * tick_s_;
  const double way_m = (to.hand.pose.position_m - from.hand.pose.position_m).norm();
  const bool gap = time_s > parameters_.longest_gap_s;
  const bool jump = way_m > parameters_.jump_m_s * time_s;
  if (gap || jump) {
    play_ = static_cast<double>(to.index);
    reported_index_ = play_;
    if (state_ == RobotState::kFollowing || state_ == RobotState::kApproaching) {
      stop(jump ? StopReason::kJump : StopReason::kGap);
    }
  }
}

void Robot::become(RobotState state) noexcept {
  state_ = state;
  in_state_s_ = 0;
  descends_ = false;
}

void Robot::stop(StopReason reason) noexcept {
  reason_ = reason;
  ++stops_;
  become(reason == StopReason::kFault ? RobotState::kFailed : RobotState::kHolding);
  wanted_ = {{tool_.pose, {}}, wanted_.opening};  // its current place: releases the pressure
}

void Robot::decide() {
  const bool silent = silent_s_ > parameters_.silence_s;
  if (!arm_->ready() && state_ != RobotState::kTaring && state_ != RobotState::kFailed) {
    stop(StopReason::kFault);
    become(RobotState::kTaring);  // until it reports its pose again
  }
  const bool commanded = !track_.empty() && held_ && !silent;
  switch (state_) {
    case RobotState::kFailed: return;
    case RobotState::kTaring:
      if (arm_->ready()) {
        become(RobotState::kWaiting);
      }
      return;
    case RobotState::kWaiting:
      if (wants_tare_ && tool_.pose.position_m.z() >= parameters_.clear_m) {
        wants_tare_ = false;
        arm_->tare();
        become(RobotState::kTaring);
      } else if (commanded) {
        if (begins_at_tool_) {
          wanted_ = {{tool_.pose, {}}, wanted_.opening};
        }
        become(RobotState::kApproaching);
      }
      return;
    case RobotState::kHolding:
      if (in_state_s_ >= parameters_.hold_s) {
        become(RobotState::kRetracting);
      }
      return;
    case RobotState::kRetracting: rise(); return;
    case RobotState::kApproaching:
    case RobotState::kFollowing: break;
  }
  if (silent || !held_) {
    stop(silent ? StopReason::kSilence : StopReason::kReleased);
    return;
  }
  const HandState wanted = command();
  if (state_ == RobotState::kApproaching) {
    approach(wanted);
  } else {
    follow(wanted);
  }
}

/// The operator's tool, limited to the workspace.
HandState Robot::command() noexcept {
  HandState command = track_.at(play_);
  const Vec3 inside = command.pose.position_m.cwiseMax(parameters_.lowest_m).cwiseMin(parameters_.highest_m);
  at_edge_ = inside != command.pose.position_m;
  if (at_edge_) {
    command.pose.position_m = inside;
    command.twist = {};
  }
  command.twist.linear_m_s *= pace_;
  command.twist.angular_rad_s *= pace_;
  return command;
}

void Robot::follow(const HandState& command) noexcept {
  const double most_m = parameters_.max_speed_m_s * tick_s_;
  const Vec3 step_m = command.pose.position_m - wanted_.pose.position_m;
  at_speed_cap_ = step_m.norm() > most_m;
  if (at_speed_cap_) {
    Pose pose = command.pose;
    pose.position_m = wanted_.pose.position_m + atMost(most_m, step_m);
    want(pose, command.opening);
  } else {
    wanted_ = command;
  }
}

/// Up, across, and down: no automatic path leads through soil.
void Robot::approach(const HandState& command) noexcept {
  const double most_m = parameters_.approach_m_s * tick_s_;
  const double most_rad = parameters_.approach_rad_s * tick_s_;
  const Vec3 way_m = command.pose.position_m - wanted_.pose.position_m;
  const Vec3 turn = rotationBetween(wanted_.pose.orientation, command.pose.orientation);
  const double aside_m = std::hypot(way_m.x(), way_m.y());
  descends_ = descends_ ? aside_m < kAstray_m : aside_m < kAbove_m && turn.norm() < kAbove_rad;

  Pose next = wanted_.pose;
  const double across_z_m = std::max(parameters_.clear_m, command.pose.position_m.z());
  const bool may_cross = descends_ || next.position_m.z() >= std::min(parameters_.clear_m, across_z_m) - kThere_m;
  const double aim_z_m = descends_ ? command.pose.position_m.z() : across_z_m;
  next.position_m.z() += std::clamp(aim_z_m - next.position_m.z(), -most_m, most_m);
  if (may_cross) {
    next.position_m += atMost(most_m, Vec3(way_m.x(), way_m.y(), 0));
    next.orientation = turnedBy(atMost(most_rad, turn), next.orientation);
  }
  want(next, command.opening);
  if (descends_ && (command.pose.position_m - next.position_m).norm() < kThere_m &&
      rotationBetween(next.orientation, command.pose.orientation).norm() < kThere_rad) {
    reason_ = StopReason::kNone;
    become(RobotState::kFollowing);
  }
}

/// Straight up, out of the soil.
void Robot::rise() noexcept {
  Pose next = wanted_.pose;
  const double left_m = parameters_.clear_m - next.position_m.z();
  if (left_m <= 0) {
    become(RobotState::kWaiting);
    return;
  }
  next.position_m.z() += std::min(left_m, parameters_.approach_m_s * tick_s_);
  want(next, wanted_.opening);
}

/// Wants the tool there in the next tick.
void Robot::want(const Pose& pose, double opening) noexcept {
  wanted_.twist = {(pose.position_m - wanted_.pose.position_m) / tick_s_,
                   rotationBetween(wanted_.pose.orientation, pose.orientation) / tick_s_};
  wanted_.pose = pose;
  wanted_.opening = opening;
}

/// Whether the target of the tool is a command.
bool Robot::commandsArm() const noexcept {
  return state_ == RobotState::kApproaching || state_ == RobotState::kFollowing || state_ == RobotState::kHolding ||
         state_ == RobotState::kRetracting;
}

void Robot::moveTool() noexcept {
  if (state_ == RobotState::kFailed) {
    return;
  }
  if (state_ != RobotState::kFollowing && state_ != RobotState::kApproaching && state_ != RobotState::kRetracting) {
    wanted_.twist = {};
  }
  const ArmReading now = arm_->move(wanted_, commandsArm());
  tool_ = now.tool;
  met_ = now.met;
  at_force_cap_ = now.at_force_cap;
  if (now.fault) {
    stop(StopReason::kFault);
    return;
  }
  too_strong_s_ = met_.force_n.norm() > parameters_.stop_force_n ? too_strong_s_ + tick_s_ : 0;
  if (too_strong_s_ > kTooStrongFor_s && (state_ == RobotState::kFollowing || state_ == RobotState::kApproaching)) {
    too_strong_s_ = 0;
    stop(StopReason::kForce);
  }
}

void Robot::account() noexcept {
  if (state_ == RobotState::kFollowing && pace_ > 0) {
    sum_.add(met_);
    ++readings_;
  } else if (state_ != RobotState::kFollowing) {
    reported_index_ = play_;
    sum_ = {};
    readings_ = 0;
  }
}

RobotReport Robot::report() noexcept {
  RobotReport report;
  report.index = static_cast<std::uint64_t>(std::floor(play_));
  report.pose = tool_.pose;
  if (readings_ > 0) {
    report.ticks = static_cast<std::uint32_t>(report.index - static_cast<std::uint64_t>(std::floor(reported_index_)));
    report.met = {sum_.force_n / readings_, sum_.torque_nm / readings_};
  } else {
    report.met = met_;
  }
  reported_index_ = play_;
  sum_ = {};
  readings_ = 0;
  return report;
}

}  // namespace haptolith
