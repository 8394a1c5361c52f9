#pragma once

#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/core/movement.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// A bed and a tool in it: what stands between a pose and a wrench. No device and no clock.
class Scene {
 public:
  /// @throws InvalidParameter when the parameters are not valid, or when one tick would need too many substeps; Failure
  /// as Bed::settle().
  Scene(const BedParameters& bed, const ToolParameters& tool, const SettleProgress& progress = {});

  /// The same with its soil where the caller wants it, at rest.
  Scene(const BedParameters& bed, const ToolParameters& tool, const std::vector<Vec3>& centres_m);

  /// One tick: moves the tool from where it was to where `hand` has it, and opens jaws, in equal substeps, steps the
  /// bed each time, and leaves the mean of what was felt in felt(). An opening that is not finite changes nothing; no
  /// tool but jaws takes notice of one. May be called in the tick.
  [[nodiscard]] StepStatus tick(const HandState& hand) noexcept;

  /// Force and torque of the soil on the tool over the last tick, about the tool's origin, scene frame, unfiltered; and
  /// how hard it pushed jaws apart (see ToolReaction), 0 with another tool.
  [[nodiscard]] const Felt& felt() const noexcept { return felt_; }

  /// How the force changes with the tool's place at the end of the last tick: see ToolReaction.
  [[nodiscard]] const Eigen::Matrix3d& contactStiffness() const noexcept { return stiffness_n_m_; }

  /// Between the jaws now, in m; 0 with another tool.
  [[nodiscard]] double opening() const noexcept { return tool_.shape == ToolShape::kJaws ? opening_m_ : 0; }

  /// Puts the tool where `hand` has it, without moving it there, and opens jaws likewise.
  void placeTool(const HandState& hand) noexcept;

  /// How much of itself the tool is, 0 to 1: with less than 1 it presses, damps and coheres by so much less, and the
  /// soil on it likewise. Soil that finds itself inside a tool is moved out gently when this grows slowly. May be
  /// called in the tick.
  void setToolFade(double share) noexcept { tool_fade_ = share; }

  /// Another tool, as stiff as the one before it (else a tick might need more substeps), which forgets what the other
  /// touched. May be called in the tick.
  void setTool(const ToolParameters& tool) noexcept;

  [[nodiscard]] Bed& bed() noexcept { return bed_; }
  [[nodiscard]] const Bed& bed() const noexcept { return bed_; }
  [[nodiscard]] const ToolParameters& tool() const noexcept { return tool_; }
  [[nodiscard]] const Pose& toolPose() const noexcept { return tool_pose_; }
  [[nodiscard]] int substeps() const noexcept { return substeps_; }

 private:
  void open(double share) noexcept;

  ToolParameters tool_;
  int substeps_;
  Bed bed_;
  Pose tool_pose_;
  double opening_ = 1;  ///< of the jaws, to be reached by the end of a tick
  double opening_m_;    ///< now
  double tool_fade_ = 1;
  Felt felt_;
  Eigen::Matrix3d stiffness_n_m_ = Eigen::Matrix3d::Zero();
};

}  // namespace haptolith
