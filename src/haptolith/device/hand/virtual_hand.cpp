#include "haptolith/device/hand/virtual_hand.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "haptolith/core/error.h"
#include "haptolith/core/interpolate.h"
#include "haptolith/core/math/portable_math.h"
#include "haptolith/device/hand/hand_motion.h"

namespace haptolith {

namespace {

/// Poses come 60 times a second: their steps are rounded off with this time constant.
constexpr double kSmoothing_s = 0.02;

/// Duration of the way from a released tool to the begin of a motion.
constexpr double kReturn_s = 1;

/// From closed to wide open, at the fastest. A motion that is broken off opens the gripper as quickly.
constexpr double kGrip_s = 0.1;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void requireStableArm(const HandParameters& hand, double tick_s) {
  const double least_mass_kg = lightestArm(armOf(hand), tick_s);
  if (hand.compliance == HandCompliance::kArm && hand.mass_kg <= least_mass_kg) {
    throw InvalidParameter(
        "mass_kg", fmt::format("{:g}", hand.mass_kg),
        fmt::format("> {:g}, or the arm's spring and damper are numerically unstable at a tick of {:g} s",
                    least_mass_kg, tick_s));
  }
}

}  // namespace

VirtualHand::VirtualHand(const HandParameters& hand, double tick_s) : hand_(hand), tick_s_(tick_s) {
  validate(hand);
  requireStableArm(hand, tick_s);
  if (hand.motion == HandMotion::kPoses) {
    poses_ = PoseFile::read(hand.poses_file);
  }
  tool_.pose = wanted(0);
}

void VirtualHand::command(const HandCommand& command) noexcept {
  commands_.draft() = command;
  commands_.publish();
}

DeviceLimits VirtualHand::limits() const noexcept {
  DeviceLimits limits;
  limits.max_force_n = hand_.max_force_n;
  limits.max_torque_nm = hand_.max_torque_nm;
  limits.grips = true;
  return limits;
}

DeviceInput VirtualHand::read() noexcept {
  if (released_.load(std::memory_order_relaxed)) {
    output_ = {};
  }
  takeCommand();
  if (commands_.latest().held) {
    followCommand(*commands_.latest().held);
  } else {
    followMotion();
  }
  moveGripper();
  const bool finished = poses_ && hand_.motion == HandMotion::kPoses && !commands_.latest().held &&
                        static_cast<double>(ticks_) * tick_s_ > poses_->duration();
  DeviceInput input;
  input.pose = tool_.pose;
  input.twist = tool_.twist;
  input.gripper_open = gripper_open_;
  input.state = finished ? DeviceState::kFinished : DeviceState::kLive;
  return input;
}

void VirtualHand::takeCommand() noexcept {
  const bool was_held = commands_.latest().held.has_value();
  if (!commands_.update()) {
    return;
  }
  const HandCommand& now = commands_.latest();
  hand_.surface_m = now.surface_m;
  hand_.motion = now.motion;
  if (now.held && !was_held) {
    smooth_ = tool_.pose;
  }
  if (beginnings_ != now.beginnings) {
    beginnings_ = now.beginnings;
    ticks_ = 0;
    return_ticks_ = 0;
    return_from_ = tool_.pose;
  }
}

void VirtualHand::followMotion() noexcept {
  const auto time_s = [this](std::uint64_t ticks) { return static_cast<double>(ticks) * tick_s_; };
  Pose from;
  Pose to;
  if (return_from_) {
    const auto on_the_way = [&](std::uint64_t ticks) {
      const double s = std::min(1.0, time_s(ticks) / kReturn_s);
      return interpolate(*return_from_, wanted(0), s * s * (3 - 2 * s));
    };
    from = on_the_way(return_ticks_);
    to = on_the_way(++return_ticks_);
    if (time_s(return_ticks_) >= kReturn_s) {
      return_from_.reset();
    }
  } else {
    from = wanted(time_s(ticks_));
    to = wanted(time_s(++ticks_));
  }
  const Movement wanted_movement = movement(from, to, tick_s_);
  if (hand_.compliance == HandCompliance::kRigid) {
    tool_ = wanted_movement;
  } else {
    moveArm(armOf(hand_), wanted_movement, output_, kInfinity, tick_s_, tool_);
  }
}

void VirtualHand::followCommand(const Pose& held) noexcept {
  const Pose before = smooth_;
  smooth_ = interpolate(before, held, 1 - portable::exp(-tick_s_ / kSmoothing_s));
  moveArm(kPull, movement(before, smooth_, tick_s_), output_, hand_.max_force_n, tick_s_, tool_);
}

void VirtualHand::moveGripper() noexcept {
  const bool follows = !commands_.latest().held && !return_from_ && hand_.motion != HandMotion::kPoses;
  const double wanted = follows ? handMotionOpening(hand_, static_cast<double>(ticks_) * tick_s_) : 1;
  const double most = tick_s_ / kGrip_s;
  gripper_open_ += std::clamp(wanted - gripper_open_, -most, most);
}

Pose VirtualHand::wanted(double time_s) const noexcept {
  return poses_ && hand_.motion == HandMotion::kPoses ? poses_->at(time_s) : handMotionPose(hand_, time_s);
}

}  // namespace haptolith
