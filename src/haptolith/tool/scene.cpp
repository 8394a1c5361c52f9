#include "haptolith/tool/scene.h"

#include <algorithm>
#include <cstdint>

#include "haptolith/bed/critical_step.h"
#include "haptolith/core/between.h"
#include "haptolith/tool/tool_contact.h"

namespace haptolith {

namespace {

int checkedSubsteps(const BedParameters& bed, const ToolParameters& tool) {
  validate(bed);
  validate(tool);
  return substepsFor(bed.soil, tool.stiffness_n_m, bed.tick_s, bed.max_substeps);
}

/// A tool that is only partly there.
ToolParameters faded(ToolParameters tool, double presence) noexcept {
  tool.stiffness_n_m *= presence;  // and with it damping, friction, and the paper's adhesion
  tool.adhesion_n *= presence;
  return tool;
}

}  // namespace

Scene::Scene(const BedParameters& bed, const ToolParameters& tool, const SettleProgress& progress)
    : tool_(tool), substeps_(checkedSubsteps(bed, tool)), bed_(bed, progress) {}

Scene::Scene(const BedParameters& bed, const ToolParameters& tool, const std::vector<Vec3>& centres_m)
    : tool_(tool), substeps_(checkedSubsteps(bed, tool)), bed_(bed, centres_m) {}

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
  tool_ = tool;
}

StepStatus Scene::tick(const Pose& scene_T_tool, const Twist& twist) noexcept {
  const double dt = bed_.parameters().tick_s / substeps_;
  const Pose from = tool_pose_;
  const ToolParameters tool = presence_ < 1 ? faded(tool_, presence_) : tool_;
  Wrench sum;
  StepStatus status = StepStatus::kOk;
  for (int substep = 1; substep <= substeps_ && status == StepStatus::kOk; ++substep) {
    const Pose pose = between(from, scene_T_tool, static_cast<double>(substep) / substeps_);
    const ToolReaction now = applyToolContact(tool, pose, twist, dt, bed_);
    sum.force_n += now.wrench.force_n;
    sum.torque_nm += now.wrench.torque_nm;
    stiffness_n_m_ = now.stiffness_n_m;
    status = bed_.step(dt);
  }
  tool_pose_ = scene_T_tool;
  wrench_ = {sum.force_n / substeps_, sum.torque_nm / substeps_};
  return status;
}

}  // namespace haptolith
