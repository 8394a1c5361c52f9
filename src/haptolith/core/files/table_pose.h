#pragma once

#include <span>

#include "haptolith/core/files/table.h"
#include "haptolith/core/vec.h"

namespace haptolith {

/// Reads the pose in a row of a table, in the frame of the table, from columns in m and a quaternion, w first, which is
/// made unit.
/// @param columns  of x, y, z, qw, qx, qy and qz.
/// @throws InvalidParameter as Table::number(), for a position beyond `largest_m` from the origin on any axis and for a
/// quaternion outside kUnitNorm.
[[nodiscard]] Pose readPose(Table& table, std::span<const Table::Column, 7> columns, double largest_m);

}  // namespace haptolith
