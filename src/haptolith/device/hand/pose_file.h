#pragma once

#include <filesystem>
#include <vector>

#include "haptolith/core/vec.h"

namespace haptolith {

/// A recorded movement of the tool: poses over time, between which positions go straight and rotations evenly.
class PoseFile {
 public:
  /// Reads a table (core/files/table.h) with the columns t_s, x_m, y_m, z_m, qw, qx, qy and qz: seconds as TimeColumn
  /// reads them, metres in the scene's frame, a quaternion that turns the tool's frame into the scene's; 2 to 5 million
  /// rows.
  /// @throws Failure when the file cannot be read; InvalidParameter with file, line, column and value as Table and
  /// TimeColumn, for a quaternion not of unit length within 1 %, too few or many rows, or a position beyond
  /// `largest_m` from the origin on any axis.
  static PoseFile read(const std::filesystem::path& path, double largest_m = 10);

  /// Pose scene_T_tool at `time_s` after the first one; the last pose afterwards. May be called in the tick.
  [[nodiscard]] Pose at(double time_s) const noexcept;
  [[nodiscard]] double duration() const noexcept { return times_s_.back() - times_s_.front(); }
  [[nodiscard]] std::size_t size() const noexcept { return times_s_.size(); }

 private:
  std::vector<double> times_s_;
  std::vector<Pose> poses_;
};

}  // namespace haptolith
