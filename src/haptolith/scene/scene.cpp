#include "haptolith/scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "haptolith/bed/critical_step.h"
#include "haptolith/bed/measure/bed_check.h"
#include "haptolith/core/assert.h"
#include "haptolith/core/interpolate.h"
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

}  // namespace

bool isNearBed(const BedParameters& bed, const Vec3& place_m) noexcept {
  constexpr double kBeside_m = 1;
  constexpr double kAbove_m = 3;
  return std::abs(place_m.x()) <= bed.width_m / 2 + kBeside_m &&
         std::abs(place_m.y()) <= bed.length_m / 2 + kBeside_m && place_m.z() >= -kBeside_m && place_m.z() <= kAbove_m;
}

int Scene::substepsOf(const BedParameters& bed, const ToolParameters& tool) {
  validate(bed);
  validate(tool);
  if (const double reach_m = contactReach(tool, bed);
      tool.shape == ToolShape::kMesh && tool.mesh->field.band() < reach_m) {
    throw InvalidParameter("mesh", fmt::format("with distances known to {:g} m", tool.mesh->field.band()),
                           fmt::format("one made for this soil, to {:g} m", reach_m));
  }
  return substepsFor(bed, stiffnessInStep(tool, bed.soil.friction));
}

Scene::Scene(const BedParameters& bed, const ToolParameters& tool, const SettleProgress& progress)
    : tool_(tool), substeps_(substepsOf(bed, tool)), bed_(bed, progress), opening_m_(tool.opening_m) {}

Scene::Scene(const BedParameters& bed, const ToolParameters& tool, const std::vector<Vec3>& centres_m,
             const std::vector<Pose>& stones)
    : tool_(tool), substeps_(substepsOf(bed, tool)), bed_(bed, centres_m, stones), opening_m_(tool.opening_m) {}

Scene::Scene(const BedParameters& bed, const ToolParameters& tool, const LyingSoil& lying)
    : tool_(tool), substeps_(substepsOf(bed, tool)), bed_(bed, lying), opening_m_(tool.opening_m) {}

void Scene::setTool(const ToolParameters& tool) noexcept {
  for (const std::uint32_t group : bed_.groupsNear(tool_pose_.position_m, 0)) {  // and those that the old one was near
    for (std::size_t i = group * kGroup; i < std::min((group + 1) * kGroup, bed_.particles()); ++i) {
      bed_.toolSides()[i] = 0;
      bed_.externalForces()[i] = {};
      if (!bed_.toolSlip().empty()) {
        bed_.toolSlip()[i] = {};
      }
    }
  }
  bed_.stones().forgetTool();
  tool_ = tool;
  opening_m_ = opening_ * tool.opening_m;
}

void Scene::open(double share) noexcept {
  if (std::isfinite(share)) {
    opening_ = std::clamp(share, 0.0, 1.0);
  }
}

void Scene::placeTool(const HandState& hand) noexcept {
  open(hand.opening);
  opening_m_ = opening_ * tool_.opening_m;
  if (isSomewhere(hand)) {
    tool_pose_ = hand.pose;
  }
}

bool Scene::moveGrain(const GrainMove& move) noexcept {
  const double clear_m = enclosingRadius(tool_) + 4 * bed_.parameters().soil.radius_m;
  const auto is_clear = [&](const Vec3& place_m) { return (place_m - tool_pose_.position_m).norm() > clear_m; };
  return is_clear(move.from_m) && is_clear(move.to_m) && bed_.moveGrain(move);
}

StepStatus Scene::tick(const HandState& hand) noexcept {
  HAPTO_ASSERT(substeps_ >= 1);
  HAPTO_ASSERT(tool_fade_ >= 0 && tool_fade_ <= 1);
  HAPTO_ASSERT(opening_ >= 0 && opening_ <= 1);
  if (!isSomewhere(hand)) {
    soil_force_ = {};
    stiffness_n_m_.setZero();
    return StepStatus::kNotFinite;
  }
  open(hand.opening);
  const double dt = bed_.parameters().tick_s / substeps_;
  const Pose from = tool_pose_;
  ToolParameters tool = tool_fade_ < 1 ? faded(tool_, tool_fade_) : tool_;
  const double opening_from_m = opening_m_;
  const double opening_to_m = opening_ * tool_.opening_m;
  const double opening_m_s = (opening_to_m - opening_from_m) / bed_.parameters().tick_s;
  Wrench sum;
  double grip_n = 0;
  StepStatus status = StepStatus::kOk;
  for (int substep = 1; substep <= substeps_ && status == StepStatus::kOk; ++substep) {
    const double share = static_cast<double>(substep) / substeps_;
    const Pose pose = interpolate(from, hand.pose, share);
    tool.opening_m = std::lerp(opening_from_m, opening_to_m, share);
    const ToolReaction now = applyToolContact(tool, pose, hand.twist, dt, bed_, opening_m_s);
    sum.force_n += now.wrench.force_n;
    sum.torque_nm += now.wrench.torque_nm;
    grip_n += now.grip_n;
    stiffness_n_m_ = now.stiffness_n_m;
    status = bed_.step(dt);
  }
  constexpr std::uint64_t kStepsPerCheck = 512;  // in debug and sanitizer builds; a check takes as long as a few steps
  HAPTO_ASSERT(status != StepStatus::kOk ||
               bed_.state().step % kStepsPerCheck >= static_cast<std::uint64_t>(substeps_) ||
               inconsistency(bed_.state()).empty());
  tool_pose_ = hand.pose;
  opening_m_ = opening_to_m;
  soil_force_ = {{sum.force_n / substeps_, sum.torque_nm / substeps_}, grip_n / substeps_};
  return status;
}

}  // namespace haptolith
