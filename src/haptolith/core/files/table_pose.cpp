#include "haptolith/core/files/table_pose.h"

namespace haptolith {

Pose readPose(Table& table, std::span<const Table::Column, 7> columns, double largest_m) {
  const Range near_m{-largest_m, largest_m};
  const Vec3 position_m(table.number(columns[0], near_m), table.number(columns[1], near_m),
                        table.number(columns[2], near_m));
  const Quat turn(table.number(columns[3]), table.number(columns[4]), table.number(columns[5]),
                  table.number(columns[6]));
  if (!isUnit(turn)) {
    throw InvalidParameter(table.key("length of qw,qx,qy,qz"), turn.norm(), kUnitNorm);
  }
  return {position_m, turn.normalized()};
}

}  // namespace haptolith
