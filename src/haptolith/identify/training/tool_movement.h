#pragma once

#include <span>
#include <vector>

#include "haptolith/core/movement.h"
#include "haptolith/core/timed_pose.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// A movement of a tool, straight and even from pose to pose: site_T_tool. Site frame: origin in the middle of the
/// soil's first surface, z up.
class ToolMovement {
 public:
  /// @param poses  two or more, later and later, the first at 0 s. @throws InvalidParameter otherwise.
  explicit ToolMovement(std::vector<TimedPose> poses);

  /// Pose at `time_s`, in the frame of the poses given; the first before it, the last afterwards.
  [[nodiscard]] Pose at(double time_s) const noexcept;
  [[nodiscard]] double duration() const noexcept { return poses_.back().time_s; }
  [[nodiscard]] const std::vector<TimedPose>& poses() const noexcept { return poses_; }

 private:
  std::vector<TimedPose> poses_;
};

/// Whether two movements are one, but for what a file rounds.
[[nodiscard]] bool isSameMovement(const ToolMovement& one, const ToolMovement& other);

/// A movement from which soil can be told: a shovel's face is pressed 8 and 14 mm into soil that nothing has touched,
/// and the shovel is drawn 70 mm, its edge ahead, 20 and 35 mm deep, upright and leaning back by 30 degrees. 28 s, in
/// a field of 260 mm by 250 mm; no two of these share their soil.
/// @throws InvalidParameter for a tool that is not a box of 30 to 60 mm by 30 to 50 mm.
[[nodiscard]] ToolMovement probeMovement(const ToolParameters& shovel);

/// What it is made of, in its order.
struct ProbePart {
  const char* name;
  double x_m, y_m;  ///< where it goes down
  double depth_m;
  double rake_rad;  ///< of the blade over the horizontal ahead; 0: the face is pressed
};
[[nodiscard]] std::span<const ProbePart> probeParts();

}  // namespace haptolith
