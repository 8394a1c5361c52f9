#include "haptolith/core/movement.h"

#include "haptolith/core/assert.h"
#include "haptolith/core/turn.h"

namespace haptolith {

Quat turnedBy(const Vec3& rotation, const Quat& orientation) noexcept {
  const double angle = rotation.norm();
  if (angle == 0) {
    return orientation;
  }
  return (turnAbout(rotation / angle, angle) * orientation).normalized();
}

Vec3 atMost(double largest, const Vec3& v) noexcept {
  HAPTO_ASSERT(largest >= 0);
  const double norm = v.norm();
  return norm > largest ? Vec3(largest / norm * v) : v;
}

Vec3 rotationBetween(const Quat& from, const Quat& to) noexcept {
  return rotationVector((to * from.conjugate()).normalized());
}

Movement movement(const Pose& from, const Pose& to, double tick_s) noexcept {
  HAPTO_ASSERT(tick_s > 0);
  return {to, {(to.position_m - from.position_m) / tick_s, rotationBetween(from.orientation, to.orientation) / tick_s}};
}

}  // namespace haptolith
