#pragma once

#include <span>
#include <vector>

#include "haptolith/core/movement.h"
#include "haptolith/core/timed_pose.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// Movement of a tool, interpolated linearly between poses site_T_tool. Site frame: origin at the centre of the soil's
/// initial surface, z up.
class ToolMovement {
 public:
  /// @param poses  two or more, in ascending time from 0 s. @throws InvalidParameter otherwise.
  explicit ToolMovement(std::vector<TimedPose> poses);

  /// Returns the pose at `time_s`, in the frame of the poses; the first one before it, the last one afterwards.
  [[nodiscard]] Pose at(double time_s) const noexcept;
  [[nodiscard]] double duration() const noexcept { return poses_.back().time_s; }
  [[nodiscard]] const std::vector<TimedPose>& poses() const noexcept { return poses_; }

 private:
  std::vector<TimedPose> poses_;
};

/// Whether two movements are equal up to the rounding of a file.
[[nodiscard]] bool isSameMovement(const ToolMovement& one, const ToolMovement& other);

/// Returns a movement for identifying soil. A shovel's face is pressed 8 and 14 mm into undisturbed soil. Then the
/// shovel is drawn 70 mm with its edge ahead, 20 and 35 mm deep, upright and leaning back by 30 degrees. It takes 28 s
/// in a field of 260 mm by 250 mm; its parts do not share soil.
/// @throws InvalidParameter for a tool that is not a box of 30 to 60 mm by 30 to 50 mm.
[[nodiscard]] ToolMovement probeMovement(const ToolParameters& shovel);

/// Part of the probe movement; probeParts() returns them in order.
struct ProbePart {
  const char* name;
  double x_m, y_m;  ///< position of its first contact
  double depth_m;
  double rake_rad;  ///< angle of the blade over the horizontal ahead; 0: the face is pressed
};
[[nodiscard]] std::span<const ProbePart> probeParts();

}  // namespace haptolith
