#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "haptolith/identify/movement_part.h"
#include "haptolith/identify/training/force_emulator.h"
#include "haptolith/identify/training/tool_movement.h"

namespace haptolith {

/// Pose of a tool and force of the soil on it, both in the frame of the file.
struct MeasuredSample {
  double time_s = 0;
  Pose pose;     ///< file_T_tool
  Vec3 force_n;  ///< of the soil on the tool, in the same frame
};

/// Reads a table (core/files/table.h) with the columns t_s, x_m, y_m, z_m, qw, qx, qy, qz, soil_fx_n, soil_fy_n and
/// soil_fz_n, as `haptolith run --trace` writes one, or with tool_ before those of the pose, as `haptolith export`
/// does; others are ignored. Two rows or more; time has any zero, see TimeColumn.
/// @throws InvalidParameter, Failure: as Table, TimeColumn and readPose(); for positions and forces beyond 1e6.
[[nodiscard]] std::vector<MeasuredSample> readMeasured(const std::filesystem::path& path);

/// Forces of a movement that was looked for in what was measured.
struct MatchedForces {
  MeasuredForces forces;
  double begin_s = 0;       ///< when it began, by the times of the samples
  std::size_t windows = 0;  ///< in which the tool was where it should have been
};

/// How far from there it may be: further down, and the force is another one.
inline constexpr double kPoseTolerance_m = 3e-3, kTurnTolerance_rad = 0.05;

/// Finds when the movement was made, and the mean force in each of its windows: where the tool was within the
/// tolerances of the movement from the window's beginning to its end, and something was measured at least every fifth
/// of it.
/// @param origin_m  the site's origin, in the middle of the soil's first surface, in the frame of the samples.
[[nodiscard]] MatchedForces matchForces(const ToolMovement& movement, std::span<const MeasuredSample> samples,
                                        const Vec3& origin_m);

/// Where a part of a movement was found.
struct FoundPart {
  std::size_t course = 0;   ///< of those that were looked through
  double begin_s = 0;       ///< by the times of its samples
  std::size_t windows = 0;  ///< in place; 0: nowhere
};

/// Forces of a movement whose parts were made in whatever order, in one course or several.
struct MatchedParts {
  MeasuredForces forces;
  std::vector<FoundPart> parts;  ///< one for each
  std::size_t windows = 0;       ///< in place
};

/// Looks for the whole movement in each course, and for each part by itself; a part counts where the most of its
/// windows are in place, and of equal places in the first: what was made again lies in soil that was touched.
[[nodiscard]] MatchedParts matchParts(const ToolMovement& movement, const std::vector<MovementPart>& parts,
                                      const std::vector<std::vector<MeasuredSample>>& courses, const Vec3& origin_m);

}  // namespace haptolith
