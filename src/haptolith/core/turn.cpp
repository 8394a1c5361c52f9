#include "haptolith/core/turn.h"

#include <cmath>
#include <limits>

#include "haptolith/core/math/portable_math.h"

namespace haptolith {

Quat turnAbout(const Vec3& axis, double angle_rad) noexcept {
  const Vec3 part = portable::sin(angle_rad / 2) * axis;
  return {portable::cos(angle_rad / 2), part.x(), part.y(), part.z()};
}

Quat turnAboutXyz(const Vec3& angles_rad) noexcept {
  return turnAbout(Vec3::UnitZ(), angles_rad.z()) * turnAbout(Vec3::UnitY(), angles_rad.y()) *
         turnAbout(Vec3::UnitX(), angles_rad.x());
}

Vec3 rotationVector(const Quat& turn) noexcept {
  const double sine = turn.vec().norm();
  if (sine == 0) {
    return Vec3::Zero();
  }
  const double angle = 2 * portable::atan2(sine, std::abs(turn.w()));
  return (turn.w() < 0 ? -angle : angle) / sine * turn.vec();
}

Quat slerp(const Quat& from, const Quat& to, double share) noexcept {
  const double cosine = from.dot(to);
  const double apart = portable::acos(std::abs(cosine));
  double of_from = 1 - share;
  double of_to = share;
  if (std::abs(cosine) < 1 - std::numeric_limits<double>::epsilon()) {
    const double sine = portable::sin(apart);
    of_from = portable::sin((1 - share) * apart) / sine;
    of_to = portable::sin(share * apart) / sine;
  }
  return Quat(of_from * from.coeffs() + (cosine < 0 ? -of_to : of_to) * to.coeffs());
}

}  // namespace haptolith
