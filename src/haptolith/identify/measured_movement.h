#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "haptolith/identify/movement_part.h"
#include "haptolith/identify/training/force_emulator.h"
#include "haptolith/identify/training/tool_movement.h"

namespace haptolith {

/// Sample of a tool's pose and the force of the soil on it, both in the frame of the file.
struct MeasuredSample {
  double time_s = 0;
  Pose pose;     ///< file_T_tool
  Vec3 force_n;  ///< force of the soil on the tool, file frame
};

/// Reads a table (core/files/table.h) with the columns t_s, x_m, y_m, z_m, qw, qx, qy, qz, soil_fx_n, soil_fy_n and
/// soil_fz_n, as written by `haptolith run --trace`. The pose columns may have the prefix tool_, as written by
/// `haptolith export`. Other columns are ignored. Two rows or more; the zero of time is arbitrary, see TimeColumn.
/// @throws InvalidParameter, Failure as Table, TimeColumn and readPose(); also for positions and forces beyond 1e6.
[[nodiscard]] std::vector<MeasuredSample> readMeasured(const std::filesystem::path& path);

/// Forces of a movement that was found in measured samples.
struct MatchedForces {
  MeasuredForces forces;
  double begin_s = 0;       ///< begin of the movement, on the time axis of the samples
  std::size_t windows = 0;  ///< number of windows with the tool in place
};

/// Tolerances of the tool's pose; at a different depth the force would differ.
inline constexpr double kPoseTolerance_m = 3e-3, kTurnTolerance_rad = 0.05;

/// Finds the begin of the movement, and the mean force in each of its windows. In a valid window the tool is within the
/// tolerances from begin to end, and samples are at most a fifth of it apart.
/// @param origin_m  origin of the site, the centre of the soil's initial surface, in the frame of the samples.
[[nodiscard]] MatchedForces matchForces(const ToolMovement& movement, std::span<const MeasuredSample> samples,
                                        const Vec3& origin_m);

/// Location of a part of a movement in the samples.
struct FoundPart {
  std::size_t course = 0;   ///< index of the course
  double begin_s = 0;       ///< begin, on the time axis of its samples
  std::size_t windows = 0;  ///< number of windows in place; 0: not found
};

/// Forces of a movement whose parts were made in any order, in one or more courses.
struct MatchedParts {
  MeasuredForces forces;
  std::vector<FoundPart> parts;  ///< location of each part
  std::size_t windows = 0;       ///< number of windows in place
};

/// Searches each course for the entire movement and for each part separately. The location with most windows in place
/// counts for a part. If several are equal, the first counts, because a repeated part is in disturbed soil.
[[nodiscard]] MatchedParts matchParts(const ToolMovement& movement, const std::vector<MovementPart>& parts,
                                      const std::vector<std::vector<MeasuredSample>>& courses, const Vec3& origin_m);

}  // namespace haptolith
