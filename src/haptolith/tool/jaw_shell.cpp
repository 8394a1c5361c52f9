#include "haptolith/tool/jaw_shell.h"

#include <cmath>

#include "haptolith/core/assert.h"
#include "haptolith/core/math/portable_math.h"

namespace haptolith {

JawShell::JawShell(const ToolParameters& tool, int side) noexcept
    : side_(side),
      half_length_m_(tool.size_m.x() / 2),
      end_x_m_(side * (tool.opening_m + tool.size_m.z()) / 2),
      farthest_x_m_(tool.opening_m / 2 + tool.size_m.z()),
      half_height_m_(half_length_m_),
      bend_rad_(tool.jaw_bend_rad),
      radius_m_(bend_rad_ > 0 ? tool.size_m.x() / bend_rad_ : 0) {
  if (bend_rad_ > 0) {
    cosine_ = portable::cos(bend_rad_ / 2);
    sine_ = portable::sin(bend_rad_ / 2);
    axis_x_m_ = end_x_m_ - side_ * radius_m_ * cosine_;
    const double outer_m = radius_m_ + tool.size_m.z() / 2;
    farthest_x_m_ = side_ * axis_x_m_ + outer_m;
    half_height_m_ = outer_m * sine_;
  }
}

JawShell::Place JawShell::flattened(const Vec3& tool_m) const noexcept {
  HAPTO_ASSERT(side_ == -1 || side_ == 1);
  if (bend_rad_ == 0) {
    return {Vec3(tool_m.z(), tool_m.y(), tool_m.x() - end_x_m_), 1, 0};
  }
  const double out_m = side_ * (tool_m.x() - axis_x_m_);  // from the axis, seen towards the jaw
  const double theta = portable::atan2(tool_m.z(), out_m);
  if (std::abs(theta) <= bend_rad_ / 2) {
    const double r_m = portable::hypot(out_m, tool_m.z());
    const double cosine = r_m > 0 ? out_m / r_m : 1;
    const double sine = r_m > 0 ? tool_m.z() / r_m : 0;
    return {Vec3(radius_m_ * theta, tool_m.y(), side_ * (r_m - radius_m_)), cosine, sine};
  }
  const double up = tool_m.z() < 0 ? -1 : 1;
  const double from_end_out_m = out_m - radius_m_ * cosine_;
  const double from_end_up_m = tool_m.z() - up * radius_m_ * sine_;
  const double along_m = up * half_length_m_ - up * sine_ * from_end_out_m + cosine_ * from_end_up_m;
  const double off_m = cosine_ * from_end_out_m + up * sine_ * from_end_up_m;
  return {Vec3(along_m, tool_m.y(), side_ * off_m), cosine_, up * sine_};
}

Vec3 JawShell::bent(const Vec3& flat, const Place& place) const noexcept {
  if (bend_rad_ == 0) {
    return {flat.z(), flat.y(), flat.x()};
  }
  const double out = side_ * flat.z();
  return {side_ * (place.cosine * out - place.sine * flat.x()), flat.y(), place.sine * out + place.cosine * flat.x()};
}

Vec3 JawShell::onTool(const Vec3& flat_m) const noexcept {
  HAPTO_ASSERT(bend_rad_ == 0 || radius_m_ > 0);
  if (bend_rad_ == 0) {
    return {end_x_m_ + flat_m.z(), flat_m.y(), flat_m.x()};
  }
  const double theta = flat_m.x() / radius_m_;
  const double r_m = radius_m_ + side_ * flat_m.z();
  return {axis_x_m_ + side_ * r_m * portable::cos(theta), flat_m.y(), r_m * portable::sin(theta)};
}

}  // namespace haptolith
