#include "haptolith/tool/scene.h"

#include "haptolith/bed/critical_step.h"
#include "haptolith/tool/tool_contact.h"

namespace haptolith {

namespace {

int checkedSubsteps(const BedParameters& bed, const ToolParameters& tool) {
  validate(bed);
  validate(tool);
  return substepsFor(bed.soil, tool.stiffness_n_m, bed.tick_s, bed.max_substeps);
}

/// The pose a share of the way from one to the other; exactly `to` at 1.
Pose between(const Pose& from, const Pose& to, double share) noexcept {
  if (share == 1) {
    return to;
  }
  return {from.position_m + share * (to.position_m - from.position_m), from.orientation.slerp(share, to.orientation)};
}

}  // namespace

Scene::Scene(const BedParameters& bed, const ToolParameters& tool, const SettleProgress& progress)
    : tool_(tool), substeps_(checkedSubsteps(bed, tool)), bed_(bed, progress) {}

StepStatus Scene::tick(const Pose& scene_T_tool, const Twist& twist) noexcept {
  const double dt = bed_.parameters().tick_s / substeps_;
  const Pose from = tool_pose_;
  Wrench sum;
  StepStatus status = StepStatus::kOk;
  for (int substep = 1; substep <= substeps_ && status == StepStatus::kOk; ++substep) {
    const Pose pose = between(from, scene_T_tool, static_cast<double>(substep) / substeps_);
    const ToolReaction now = applyToolContact(tool_, pose, twist, dt, bed_);
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
