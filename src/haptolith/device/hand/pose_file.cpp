#include "haptolith/device/hand/pose_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "haptolith/core/error.h"
#include "haptolith/core/number_rows.h"

namespace haptolith {

namespace {

constexpr std::array<std::string_view, 8> kColumns{"t_s", "x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"};
constexpr std::string_view kHeader = "t_s,x_m,y_m,z_m,qw,qx,qy,qz";

/// More than an hour at 1 kHz, with as many digits as numbers have.
constexpr TextLimits kLimits{.bytes = 1 << 30, .line_bytes = 1000, .rows = 5'000'000};

Pose poseFrom(const std::array<double, 8>& numbers, double largest_m, const NumberRows& rows) {
  for (std::size_t axis = 1; axis <= 3; ++axis) {
    requireInRange(rows.key(kColumns[axis]), numbers[axis], {-largest_m, largest_m});
  }
  const Quat turn(numbers[4], numbers[5], numbers[6], numbers[7]);
  requireInRange(rows.key("length of qw,qx,qy,qz"), turn.norm(), kUnitNorm);
  return {Vec3(numbers[1], numbers[2], numbers[3]), turn.normalized()};
}

}  // namespace

PoseFile PoseFile::read(const std::filesystem::path& path, double largest_m) {
  NumberRows rows(path, kHeader, kLimits);
  PoseFile file;
  std::array<double, 8> numbers{};
  while (rows.next(numbers)) {
    if (!file.times_s_.empty() && numbers[0] <= file.times_s_.back()) {
      throw InvalidParameter(rows.key("t_s"), fmt::format("{}", numbers[0]),
                             fmt::format("> {}, the time before: time goes forward", file.times_s_.back()));
    }
    file.times_s_.push_back(numbers[0]);
    file.poses_.push_back(poseFrom(numbers, largest_m, rows));
  }
  if (file.size() < 2) {
    throw InvalidParameter(path.string(), fmt::format("{} poses", file.size()),
                           "at least 2, under the header " + std::string(kHeader));
  }
  return file;
}

Pose PoseFile::at(double time_s) const noexcept {
  const double t = times_s_.front() + time_s;
  const auto after = std::upper_bound(times_s_.begin(), times_s_.end(), t);
  if (after == times_s_.begin()) {
    return poses_.front();
  }
  if (after == times_s_.end()) {
    return poses_.back();
  }
  const auto i = static_cast<std::size_t>(after - times_s_.begin());
  const double share = (t - times_s_[i - 1]) / (times_s_[i] - times_s_[i - 1]);
  const Pose& a = poses_[i - 1];
  const Pose& b = poses_[i];
  return {a.position_m + share * (b.position_m - a.position_m), a.orientation.slerp(share, b.orientation)};
}

}  // namespace haptolith
