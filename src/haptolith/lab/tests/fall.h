#pragma once

#include <string_view>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/lab/laboratory.h"

namespace haptolith {

struct FallOptions {
  double ball_radii = 6;  ///< radius of the clump in mean particle radii, 3 to 12: some hundred particles
  double fall_m = 0.3;    ///< how far a free body falls in the time that is looked at, 0.01 to 5
};

struct FallResult {
  /// Acceleration of the centre of mass over g: 1 for whatever falls freely, however its parts push and rub.
  double acceleration_ratio = 0;
  std::size_t particles = 0;
  LabTrace trace;  ///< time_s, fallen_m, free_fall_m
};

/// A ball of touching particles is let go in empty space. Inner forces cannot move its centre of mass, so it must fall
/// as one particle does; a model that brakes particles against space makes it hang or sink instead. The acceleration is
/// that of the parabola with the least squares through the centre's heights; the fall ends before anybody is near the
/// floor.
/// @throws InvalidParameter for nonsense, and without gravity; Failure as LabBed::run().
[[nodiscard]] FallResult fallTest(const LabConditions& conditions, const FallOptions& options = {});

/// @throws InvalidParameter with the key, the value and the valid range.
void validate(const FallOptions& options);

/// How far the clump has fallen against time, and free fall. @throws as Figure.
void drawFall(const OutputFile& path, const FallResult& result, std::string_view title);

}  // namespace haptolith
