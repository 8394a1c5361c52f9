#include "haptolith/device/hand/pose_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <string_view>

#include "haptolith/core/error.h"
#include "haptolith/core/files/table_pose.h"
#include "haptolith/core/turn.h"

namespace haptolith {

namespace {

constexpr std::array<std::string_view, 8> kColumns{"t_s", "x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"};

/// More than an hour at 1 kHz, with as many digits as numbers have.
constexpr TextLimits kLimits{.bytes = 1 << 30, .line_bytes = 1000, .rows = 5'000'000};

}  // namespace

PoseFile PoseFile::read(const std::filesystem::path& path, double largest_m) {
  Table table(path, {.columns = kColumns, .limits = kLimits});
  const std::vector<Table::Column> columns = table.columns(kColumns);
  TimeColumn time(table, columns[0]);
  PoseFile file;
  while (table.next()) {
    file.times_s_.push_back(time.read());
    file.poses_.push_back(readPose(table, std::span(columns).subspan<1, 7>(), largest_m));
  }
  if (file.size() < 2) {
    throw InvalidParameter(path.string(), fmt::format("{} poses", file.size()), "a table of at least 2");
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
  return {a.position_m + share * (b.position_m - a.position_m), slerp(a.orientation, b.orientation, share)};
}

}  // namespace haptolith
