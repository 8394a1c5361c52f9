#include "haptolith/device/virtual_hand.h"

#include <fmt/format.h>

#include "haptolith/core/error.h"
#include "haptolith/device/manoeuvre.h"

namespace haptolith {

namespace {

/// The rotation from one orientation to another as a vector: axis times angle, in rad, scene frame.
Vec3 rotationBetween(const Quat& from, const Quat& to) {
  const Eigen::AngleAxisd turn((to * from.conjugate()).normalized());
  return turn.angle() > EIGEN_PI ? Vec3((turn.angle() - 2 * EIGEN_PI) * turn.axis()) : Vec3(turn.angle() * turn.axis());
}

Quat turnedBy(const Vec3& rotation, const Quat& orientation) {
  const double angle = rotation.norm();
  if (angle == 0) {
    return orientation;
  }
  return (Quat(Eigen::AngleAxisd(angle, rotation / angle)) * orientation).normalized();
}

/// The semi-implicit step of yield() is stable for K dt^2 / m + 2 B dt / m < 4; for rotation the lever cancels out.
void requireStableArm(const HandParameters& hand, double tick_s) {
  const double least_mass_kg = (hand.stiffness_n_m * tick_s * tick_s + 2 * hand.damping_n_s_m * tick_s) / 4;
  if (hand.compliance == HandCompliance::kArm && hand.mass_kg <= least_mass_kg) {
    throw InvalidParameter(
        "mass_kg", fmt::format("{:g}", hand.mass_kg),
        fmt::format("> {:g}, or the arm's stiffness and damping shake it to pieces at a tick of {:g} s", least_mass_kg,
                    tick_s));
  }
}

}  // namespace

VirtualHand::VirtualHand(const HandParameters& hand, double tick_s) : hand_(hand), tick_s_(tick_s) {
  validate(hand);
  requireStableArm(hand, tick_s);
  if (hand.manoeuvre == Manoeuvre::kPoses) {
    poses_ = PoseFile::read(hand.poses_file);
  }
  pose_ = wanted(0);
}

Pose VirtualHand::wanted(double time_s) const noexcept {
  return poses_ ? poses_->at(time_s) : manoeuvrePose(hand_, time_s);
}

DeviceInput VirtualHand::read() noexcept {
  const double now_s = static_cast<double>(ticks_) * tick_s_;
  const double next_s = static_cast<double>(++ticks_) * tick_s_;
  const Pose from = wanted(now_s);
  const Pose to = wanted(next_s);
  const Twist wanted_twist{(to.position_m - from.position_m) / tick_s_,
                           rotationBetween(from.orientation, to.orientation) / tick_s_};
  if (hand_.compliance == HandCompliance::kRigid) {
    pose_ = to;
    twist_ = wanted_twist;
  } else {
    yield(to, wanted_twist);
  }
  return {pose_, twist_, poses_ && next_s > poses_->duration()};
}

void VirtualHand::yield(const Pose& wanted_pose, const Twist& wanted_twist) noexcept {
  const double lever_squared = hand_.lever_m * hand_.lever_m;
  const Vec3 force = hand_.stiffness_n_m * (wanted_pose.position_m - pose_.position_m) +
                     hand_.damping_n_s_m * (wanted_twist.linear_m_s - twist_.linear_m_s) + felt_.force_n;
  const Vec3 torque =
      lever_squared * hand_.stiffness_n_m * rotationBetween(pose_.orientation, wanted_pose.orientation) +
      lever_squared * hand_.damping_n_s_m * (wanted_twist.angular_rad_s - twist_.angular_rad_s) + felt_.torque_nm;
  twist_.linear_m_s += tick_s_ / hand_.mass_kg * force;
  twist_.angular_rad_s += tick_s_ / (hand_.mass_kg * lever_squared) * torque;
  pose_.position_m += tick_s_ * twist_.linear_m_s;
  pose_.orientation = turnedBy(tick_s_ * twist_.angular_rad_s, pose_.orientation);
}

}  // namespace haptolith
