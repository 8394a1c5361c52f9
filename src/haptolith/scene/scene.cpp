#include "haptolith/scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "haptolith/bed/critical_step.h"
#include "haptolith/bed/measure/bed_check.h"
#include "haptolith/core/assert.h"
#include "haptolith/core/interpolate.h"
#include "haptolith/core/math/portable_math.h"
#include "haptolith/tool/tool_contact.h"
#include "haptolith/tool/tool_mesh.h"
#include "haptolith/tool/tool_shape.h"

namespace haptolith {

namespace {

/// A tool that is only partly there.
ToolParameters faded(ToolParameters tool, double fade) noexcept {
  HAPTO_ASSERT(fade >= 0 && fade <= 1);
  tool.stiffness_n_m *= fade;  // and with it damping, friction, and the paper's adhesion
  tool.adhesion_n *= fade;
  return tool;
}

/// Whether the soil can be asked what it does there: a search for neighbours of NaN would leave the grid.
bool isSomewhere(const Movement& movement) noexcept {
  return movement.pose.position_m.allFinite() && isUnit(movement.pose.orientation) &&
         movement.twist.linear_m_s.allFinite() && movement.twist.angular_rad_s.allFinite();
}

/// The least moment of inertia that a step bears: dt^2 k r^2 with as many particles at the tool's rim as its
/// cross-section holds. Symplectic Euler bears a fourth of that.
double leastInertia(const ToolParameters& tool, const BedParameters& bed, double dt_s) {
  const double rim_m = enclosingRadius(tool);
  const double particles = std::max(1.0, portable::square(rim_m / bed.soil.radius_m));
  return particles * tool.stiffness_n_m * portable::square(dt_s * rim_m);
}

}  // namespace

bool isNearBed(const BedParameters& bed, const Vec3& place_m) noexcept {
  constexpr double kBeside_m = 1;
  constexpr double kAbove_m = 3;
  return std::abs(place_m.x()) <= bed.width_m / 2 + kBeside_m &&
         std::abs(place_m.y()) <= bed.length_m / 2 + kBeside_m && place_m.z() >= -kBeside_m && place_m.z() <= kAbove_m;
}

void requireEnoughInertia(const BedParameters& bed, const ToolSet& tools, int substeps) {
  for (const ToolParameters& tool : tools.all()) {
    if (tool.joint.drive == Drive::kTorque || tool.joint.drive == Drive::kFree) {
      requireInRange("joint_inertia_kg_m2", tool.joint.inertia_kg_m2,
                     {leastInertia(tool, bed, bed.tick_s / substeps), JointRanges::inertia_kg_m2.highest});
    }
  }
}

ToolSet::ToolSet(std::vector<ToolParameters> tools) : tools_(std::move(tools)) {
  if (tools_.size() > kMost) {
    throw InvalidParameter("tools", fmt::format("{}", tools_.size()), fmt::format("at most {}", kMost));
  }
}

int Scene::substepsOf(const BedParameters& bed, const ToolSet& tools) {
  validate(bed);
  for (const ToolParameters& tool : tools.all()) {
    validate(tool);
    if (const double reach_m = contactReach(tool, bed);
        tool.shape == ToolShape::kMesh && tool.mesh->field.band() < reach_m) {
      throw InvalidParameter("mesh", fmt::format("with distances known to {:g} m", tool.mesh->field.band()),
                             fmt::format("one made for this soil, to {:g} m", reach_m));
    }
  }
  const int substeps = substepsFor(bed, stiffnessInStep(tools.all(), bed.soil));
  requireEnoughInertia(bed, tools, substeps);
  return substeps;
}

Scene::Scene(const BedParameters& bed, const ToolSet& tools, const SettleProgress& progress)
    : substeps_(substepsOf(bed, tools)), bed_(bed, progress) {
  makeTools(tools);
}

Scene::Scene(const BedParameters& bed, const ToolSet& tools, const std::vector<Vec3>& centres_m,
             const std::vector<Pose>& stones)
    : substeps_(substepsOf(bed, tools)), bed_(bed, centres_m, stones) {
  makeTools(tools);
}

Scene::Scene(const BedParameters& bed, const ToolSet& tools, const LyingSoil& lying)
    : substeps_(substepsOf(bed, tools)), bed_(bed, lying) {
  makeTools(tools);
}

void Scene::makeTools(const ToolSet& tools) {
  tools_.reserve(tools.all().size());
  for (const ToolParameters& tool : tools.all()) {
    tools_.emplace_back(tool, bed_);
  }
}

void Scene::setTool(const ToolParameters& parameters, std::size_t tool) noexcept {
  Tool& changed = at(tool);
  changed.memory.forget(bed_.groupsNear(changed.memory.nearGroups(), changed.turnedPose().position_m, 0));
  changed.parameters = parameters;
  changed.joint = Tool::atStart(parameters);
  changed.opening_m = changed.opening * parameters.opening_m;
  changed.recent_force.restart();
}

void Scene::Tool::open(double share) noexcept {
  if (std::isfinite(share)) {
    opening = std::clamp(share, 0.0, 1.0);
  }
}

void Scene::placeTool(const HandState& hand, std::size_t tool) noexcept {
  Tool& placed = at(tool);
  placed.open(hand.opening);
  placed.opening_m = placed.opening * placed.parameters.opening_m;
  if (isSomewhere(hand)) {
    placed.pose = hand.pose;
  }
}

bool Scene::moveGrain(const GrainMove& move) noexcept {
  const auto is_clear_of = [&](const Tool& tool) {
    const double clear_m = enclosingRadius(tool.parameters) + 4 * bed_.parameters().soil.radius_m;
    const auto is_clear = [&](const Vec3& place_m) {
      return (place_m - tool.turnedPose().position_m).norm() > clear_m;
    };
    return is_clear(move.from_m) && is_clear(move.to_m);
  };
  return std::ranges::all_of(tools_, is_clear_of) && bed_.moveGrain(move);
}

std::uint64_t Scene::hash(std::size_t part, std::size_t parts) const noexcept {
  std::array<ToolTrace, ToolSet::kMost> traces;
  std::ranges::transform(tools_, traces.begin(), [](const Tool& tool) { return tool.memory.trace(); });
  return bed_.hash({traces.data(), tools_.size()}, part, parts);
}

std::size_t Scene::bytes() const noexcept {
  std::size_t bytes = bed_.bytes();
  for (const Tool& tool : tools_) {
    bytes += tool.memory.bytes();
  }
  return bytes;
}

void Scene::Tool::startTick(double tick_s) noexcept {
  HAPTO_ASSERT(fade >= 0 && fade <= 1);
  HAPTO_ASSERT(opening >= 0 && opening <= 1);
  present = fade < 1 ? faded(parameters, fade) : parameters;
  opening_m_s = (opening * parameters.opening_m - opening_m) / tick_s;
  sum = {};
  soil_torque_sum_nm = motor_torque_sum_nm = 0;
  if (parameters.joint.drive == Drive::kSpeed) {
    joint.speed_rad_s = parameters.joint.speed_rad_s;
  }
}

MeanForce Scene::Tool::nowInSoil() const noexcept {
  const double one_n_m = parameters.stiffness_n_m;
  return {.force_n = soil_force.wrench.force_n.norm(), .contacts = one_n_m > 0 ? stiffness_n_m.trace() / one_n_m : 0};
}

Pose Scene::Tool::turnedPose() const noexcept {
  return parameters.joint.any() ? turned(pose, parameters.joint, joint.angle_rad) : pose;
}

ToolForce Scene::handForce(std::size_t tool) const noexcept {
  const Tool& held = at(tool);
  ToolForce force = held.soil_force;
  if (held.parameters.joint.any()) {
    const double missing_nm = -held.joint.motor_torque_nm - held.joint.soil_torque_nm;
    force.wrench.torque_nm += missing_nm * (held.pose.orientation * held.parameters.joint.axis);
  }
  return force;
}

std::optional<ForceRange> Scene::forceBand(std::size_t tool) const noexcept {
  const BedParameters& bed = bed_.parameters();
  const std::optional<MeanForce> mean = at(tool).recent_force.mean();
  return mean && bed.grading.fine_radius_m == 0 ? forceRange(*mean, bed.soil, bed.gravity_m_s2.norm()) : std::nullopt;
}

void Scene::setDrive(double value, std::size_t tool) noexcept {
  Joint& joint = at(tool).parameters.joint;
  if (std::isnan(value)) {
    return;
  }
  if (joint.drive == Drive::kSpeed) {
    joint.speed_rad_s = std::clamp(value, JointRanges::speed_rad_s.lowest, JointRanges::speed_rad_s.highest);
  } else if (joint.drive == Drive::kTorque) {
    joint.torque_nm = std::clamp(value, JointRanges::torque_nm.lowest, JointRanges::torque_nm.highest);
  }
}

/// A tool's part of a substep that ends when `share` of the tick is over.
void Scene::meetSoil(Tool& tool, const HandState& hand, double share, double dt_s) noexcept {
  const Pose hub = interpolate(tool.pose, hand.pose, share);
  tool.present.opening_m = std::lerp(tool.opening_m, tool.opening * tool.parameters.opening_m, share);
  const auto contact = [&](const Pose& pose, const Twist& twist) {
    return applyToolContact(tool.present, pose, twist, dt_s, bed_, tool.memory, tool.opening_m_s);
  };
  ToolReaction now;
  if (const Joint& joint = tool.parameters.joint; joint.any()) {
    turn(tool.joint, dt_s);
    const Pose pose = turned(hub, joint, tool.joint.angle_rad);
    now = contact(pose, turning(hub, hand.twist, joint, tool.joint.speed_rad_s, pose));
    const double soil_torque_nm = torqueAboutAxis(hub, joint, pose, now.wrench);
    tool.soil_torque_sum_nm += soil_torque_nm;
    tool.motor_torque_sum_nm += drive(joint, tool.joint, soil_torque_nm, dt_s);
    now.wrench.torque_nm += (pose.position_m - hub.position_m).cross(now.wrench.force_n);
  } else {
    now = contact(hub, hand.twist);
  }
  tool.sum.wrench.force_n += now.wrench.force_n;
  tool.sum.wrench.torque_nm += now.wrench.torque_nm;
  tool.sum.grip_n += now.grip_n;
  tool.stiffness_n_m = now.stiffness_n_m;
}

StepStatus Scene::tickAll(std::span<const HandState> hands) noexcept {
  HAPTO_ASSERT(substeps_ >= 1);
  HAPTO_ASSERT(hands.size() <= tools_.size());
  if (!std::ranges::all_of(hands, isSomewhere)) {
    for (Tool& tool : tools_) {
      tool.soil_force = {};
      tool.stiffness_n_m.setZero();
      tool.joint.soil_torque_nm = tool.joint.motor_torque_nm = 0;
    }
    return StepStatus::kNotFinite;
  }
  const double tick_s = bed_.parameters().tick_s;
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    if (i < hands.size()) {
      tools_[i].open(hands[i].opening);
    }
    tools_[i].startTick(tick_s);
  }
  const double dt_s = tick_s / substeps_;
  StepStatus status = StepStatus::kOk;
  for (int substep = 1; substep <= substeps_ && status == StepStatus::kOk; ++substep) {
    const double share = static_cast<double>(substep) / substeps_;
    for (std::size_t i = 0; i < tools_.size(); ++i) {
      if (i < hands.size()) {
        meetSoil(tools_[i], hands[i], share, dt_s);
      } else {
        meetSoil(tools_[i], HandState{{tools_[i].pose, {}}, 1}, share, dt_s);
      }
    }
    status = bed_.step(dt_s);
  }
  constexpr std::uint64_t kStepsPerCheck = 512;  // in debug and sanitizer builds; a check takes as long as a few steps
  HAPTO_ASSERT(status != StepStatus::kOk ||
               bed_.state().step % kStepsPerCheck >= static_cast<std::uint64_t>(substeps_) ||
               inconsistency(bed_.state()).empty());
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    Tool& tool = tools_[i];
    tool.pose = i < hands.size() ? hands[i].pose : tool.pose;
    tool.opening_m = tool.opening * tool.parameters.opening_m;
    tool.soil_force = {{tool.sum.wrench.force_n / substeps_, tool.sum.wrench.torque_nm / substeps_},
                       tool.sum.grip_n / substeps_};
    tool.recent_force.add(tool.nowInSoil());
    tool.joint.soil_torque_nm = tool.soil_torque_sum_nm / substeps_;
    tool.joint.motor_torque_nm = tool.motor_torque_sum_nm / substeps_;
  }
  return status;
}

}  // namespace haptolith
