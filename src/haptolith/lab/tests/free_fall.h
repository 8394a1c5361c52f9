#pragma once

#include <string_view>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/lab/laboratory.h"

namespace haptolith {

struct FreeFallOptions {
  double ball_radii = 6;  ///< radius of the clump in mean particle radii, 3 to 12: a few hundred particles
  double fall_m = 0.3;    ///< distance that a free body falls in the observed time, 0.01 to 5
};

struct FreeFallResult {
  /// Acceleration of the centre of mass over g: 1 in free fall, for any internal forces.
  double acceleration_ratio = 0;
  std::size_t particles = 0;
  LabTrace trace;  ///< time_s, fallen_m, free_fall_m
};

/// Releases a sphere of touching particles in empty space. Internal forces cannot move its centre of mass, so it must
/// fall like a single particle. In a model that brakes particles against space it hangs or sinks instead. The
/// acceleration is that of the least-squares parabola through the heights of the centre; the fall ends far above the
/// floor.
/// @throws InvalidParameter for values out of range, and without gravity; Failure as LabBed::run().
[[nodiscard]] FreeFallResult freeFallTest(const LabConditions& conditions, const FreeFallOptions& options = {});

/// @throws InvalidParameter with the key, the value and the valid range.
void validate(const FreeFallOptions& options);

/// Draws the distance fallen against time, and free fall. @throws as Figure.
void drawFreeFall(const OutputFile& path, const FreeFallResult& result, std::string_view title);

}  // namespace haptolith
