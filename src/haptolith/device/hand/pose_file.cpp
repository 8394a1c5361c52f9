#include "haptolith/device/hand/pose_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

#include "haptolith/core/error.h"
#include "haptolith/core/input_file.h"
#include "haptolith/core/plain_text.h"

namespace haptolith {

namespace {

constexpr std::array<std::string_view, 8> kColumns{"t_s", "x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"};
constexpr std::string_view kHeader = "t_s,x_m,y_m,z_m,qw,qx,qy,qz";

/// More than an hour at 1 kHz, with as many digits as numbers have.
constexpr TextLimits kLimits{.bytes = 1 << 30, .line_bytes = 1000, .rows = 5'000'000};

struct Place {
  const std::filesystem::path& path;
  int line;

  [[nodiscard]] std::string key(std::string_view column) const {
    return fmt::format("{}:{}: {}", path.string(), line, column);
  }
};

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlank);
  return first == std::string_view::npos ? std::string_view{}
                                         : text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

std::array<double, 8> numbersIn(std::string_view line, const Place& place) {
  std::array<double, 8> numbers{};
  std::size_t column = 0;
  for (std::string_view rest = line;; ++column) {
    const std::size_t comma = rest.find(',');
    const std::string_view field = trimmed(rest.substr(0, comma));
    if (column == numbers.size()) {
      throw InvalidParameter(place.key("line"), inQuotes(line), "eight numbers");
    }
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), numbers[column]);
    if (error != std::errc{} || end != field.data() + field.size() || !std::isfinite(numbers[column])) {
      throw InvalidParameter(place.key(kColumns[column]), inQuotes(field), "a finite number");
    }
    if (comma == std::string_view::npos) {
      break;
    }
    rest.remove_prefix(comma + 1);
  }
  if (column + 1 != numbers.size()) {
    throw InvalidParameter(place.key("line"), inQuotes(line), "eight numbers");
  }
  return numbers;
}

Pose poseFrom(const std::array<double, 8>& numbers, double largest_m, const Place& place) {
  for (std::size_t axis = 1; axis <= 3; ++axis) {
    requireInRange(place.key(kColumns[axis]), numbers[axis], {-largest_m, largest_m});
  }
  const Quat turn(numbers[4], numbers[5], numbers[6], numbers[7]);
  requireInRange(place.key("length of qw,qx,qy,qz"), turn.norm(), kUnitNorm);
  return {Vec3(numbers[1], numbers[2], numbers[3]), turn.normalized()};
}

}  // namespace

PoseFile PoseFile::read(const std::filesystem::path& path, double largest_m) {
  std::ifstream in = openInput(path, kLimits.bytes);
  LineReader lines(in, path.string(), kLimits);
  PoseFile file;
  bool header_seen = false;
  std::string text;
  while (lines.next(text)) {
    const Place place{path, lines.number()};
    const std::string_view row = trimmed(text);
    if (row.empty() || row.front() == '#') {
      continue;
    }
    if (!header_seen) {
      if (row != kHeader) {
        throw InvalidParameter(place.key("header"), inQuotes(row), fmt::format("'{}'", kHeader));
      }
      header_seen = true;
      continue;
    }
    const std::array<double, 8> numbers = numbersIn(row, place);
    if (!file.times_s_.empty() && numbers[0] <= file.times_s_.back()) {
      throw InvalidParameter(place.key("t_s"), fmt::format("{}", numbers[0]),
                             fmt::format("> {}, the time before: time goes forward", file.times_s_.back()));
    }
    if (file.size() == static_cast<std::size_t>(kLimits.rows)) {
      throw InvalidParameter(place.key("row"), fmt::format("{}", file.size() + 1),
                             fmt::format("at most {} poses", kLimits.rows));
    }
    file.times_s_.push_back(numbers[0]);
    file.poses_.push_back(poseFrom(numbers, largest_m, place));
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
