#include "haptolith/identify/measured_movement.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string_view>

#include "haptolith/core/error.h"
#include "haptolith/core/files/table_pose.h"

namespace haptolith {

namespace {

constexpr TextLimits kLimits{.bytes = std::uintmax_t{1} << 30, .line_bytes = 4000, .rows = 5'000'000};
constexpr std::array<std::string_view, 11> kColumns{"t_s", "x_m", "y_m",       "z_m",       "qw",       "qx",
                                                    "qy",  "qz",  "soil_fx_n", "soil_fy_n", "soil_fz_n"};
constexpr std::array<std::string_view, 11> kExportColumns{"t_s",       "tool_x_m",  "tool_y_m", "tool_z_m",
                                                          "tool_qw",   "tool_qx",   "tool_qy",  "tool_qz",
                                                          "soil_fx_n", "soil_fy_n", "soil_fz_n"};
constexpr double kLargest = 1e6;
constexpr double kLongestStep_s = kForceWindow_s / 5 + 1e-6;  // max. interval between samples in a valid window

bool isThere(const Pose& tool, const Pose& wanted) {
  return (tool.position_m - wanted.position_m).norm() <= kPoseTolerance_m &&
         tool.orientation.angularDistance(wanted.orientation) <= kTurnTolerance_rad;
}

std::size_t windowsOf(const ToolMovement& movement) {
  return static_cast<std::size_t>(movement.duration() / kForceWindow_s);
}

/// Samples in the site's frame, with access by time.
class Course {
 public:
  Course(std::span<const MeasuredSample> samples, const Vec3& origin_m) : samples_(samples), origin_m_(origin_m) {}

  [[nodiscard]] Pose pose(const MeasuredSample& sample) const {
    return {sample.pose.position_m - origin_m_, sample.pose.orientation};
  }
  /// Returns the first sample at or after a time; null behind the last.
  [[nodiscard]] const MeasuredSample* after(double time_s) const {
    const auto found = std::ranges::lower_bound(samples_, time_s, {}, &MeasuredSample::time_s);
    return found == samples_.end() ? nullptr : &*found;
  }
  [[nodiscard]] std::span<const MeasuredSample> between(double from_s, double to_s) const {
    const auto from = std::ranges::lower_bound(samples_, from_s, {}, &MeasuredSample::time_s);
    const auto to = std::ranges::lower_bound(samples_, to_s, {}, &MeasuredSample::time_s);
    return {from, to};
  }

 private:
  std::span<const MeasuredSample> samples_;
  Vec3 origin_m_;
};

/// Returns the number of windows with the tool in place at their centre, for a movement that begins at `begin_s`.
int agreement(const ToolMovement& movement, const Course& course, double begin_s) {
  int count = 0;
  for (std::size_t window = 0; window < windowsOf(movement); ++window) {
    const double middle_s = (static_cast<double>(window) + 0.5) * kForceWindow_s;
    const MeasuredSample* sample = course.after(begin_s + middle_s);
    count += sample != nullptr && sample->time_s < begin_s + middle_s + kForceWindow_s / 2 &&
                     isThere(course.pose(*sample), movement.at(sample->time_s - begin_s))
                 ? 1
                 : 0;
  }
  return count;
}

/// Whether the samples are at most a fifth of a window apart.
bool isCovered(std::span<const MeasuredSample> inside, double from_s) {
  double last_s = from_s;
  for (const MeasuredSample& sample : inside) {
    if (sample.time_s - last_s > kLongestStep_s) {
      return false;
    }
    last_s = sample.time_s;
  }
  return from_s + kForceWindow_s - last_s <= kLongestStep_s;
}

/// Whether there are enough consecutive samples for at least one window.
bool coversAWindow(std::span<const MeasuredSample> samples) {
  double from_s = samples.front().time_s;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double time_s = samples[i].time_s;
    if (time_s - samples[i - 1].time_s > kLongestStep_s) {
      from_s = time_s;
    } else if (time_s - from_s >= kForceWindow_s - 2 * kLongestStep_s) {
      return true;
    }
  }
  return false;
}

}  // namespace

std::vector<MeasuredSample> readMeasured(const std::filesystem::path& path) {
  Table table(path, {.columns = kColumns, .limits = kLimits});
  // In an export the tool's pose has the prefix tool_; x_m and so on are the device's.
  const std::vector<Table::Column> columns = table.columns(table.find("tool_x_m") ? kExportColumns : kColumns);
  TimeColumn time(table, columns[0]);
  std::vector<MeasuredSample> samples;
  while (table.next()) {
    const double time_s = time.read();
    const Pose pose = readPose(table, std::span(columns).subspan<1, 7>(), kLargest);
    const auto force_n = [&](std::size_t axis) { return table.number(columns[8 + axis], {-kLargest, kLargest}); };
    const double x_n = force_n(0), y_n = force_n(1), z_n = force_n(2);
    samples.push_back({time_s, pose, {x_n, y_n, z_n}});
  }
  if (samples.size() < 2) {
    throw InvalidParameter(path.string(), fmt::format("{} rows", samples.size()), "two or more");
  }
  return samples;
}

MatchedForces matchForces(const ToolMovement& movement, std::span<const MeasuredSample> samples, const Vec3& origin_m) {
  const Course course(samples, origin_m);
  MatchedForces matched;
  matched.forces.resize(windowsOf(movement));
  if (!coversAWindow(samples)) {
    return matched;
  }
  constexpr double kStep_s = 0.02;
  int most = 0;
  double first_s = 0, last_s = 0;  // first interval of times with the best agreement
  for (double begin_s = samples.front().time_s - movement.duration(); begin_s < samples.back().time_s;
       begin_s += kStep_s) {
    // If there is no sample within the movement's duration, continue at the next one.
    const MeasuredSample* next = course.after(begin_s);
    const double idle_s = next == nullptr ? 0 : next->time_s - movement.duration() - begin_s;
    if (idle_s > kStep_s) {
      begin_s += std::floor(idle_s / kStep_s) * kStep_s;
    }
    const int count = agreement(movement, course, begin_s);
    if (count > most) {
      most = count;
      first_s = last_s = begin_s;
    } else if (count == most && begin_s - last_s < 1.5 * kStep_s) {
      last_s = begin_s;
    }
  }
  if (most == 0) {
    return matched;
  }
  matched.begin_s = (first_s + last_s) / 2;
  for (std::size_t window = 0; window < matched.forces.size(); ++window) {
    const double from_s = matched.begin_s + static_cast<double>(window) * kForceWindow_s;
    const std::span<const MeasuredSample> inside = course.between(from_s, from_s + kForceWindow_s);
    const auto here = [&](const MeasuredSample& sample) {
      return isThere(course.pose(sample), movement.at(sample.time_s - matched.begin_s));
    };
    if (!isCovered(inside, from_s) || !std::ranges::all_of(inside, here)) {
      continue;
    }
    Vec3 sum_n = Vec3::Zero();
    for (const MeasuredSample& sample : inside) {
      sum_n += sample.force_n;
    }
    matched.forces[window] = sum_n / static_cast<double>(inside.size());
    ++matched.windows;
  }
  return matched;
}

MatchedParts matchParts(const ToolMovement& movement, const std::vector<MovementPart>& parts,
                        const std::vector<std::vector<MeasuredSample>>& courses, const Vec3& origin_m) {
  MatchedParts matched;
  matched.forces.resize(windowsOf(movement));
  matched.parts.resize(parts.size());
  for (std::size_t course = 0; course < courses.size(); ++course) {
    const MatchedForces whole = matchForces(movement, courses[course], origin_m);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const MovementPart& part = parts[i];
      const auto take = [&](std::span<const std::optional<Vec3>> forces, double begin_s) {
        const auto windows = static_cast<std::size_t>(
            std::ranges::count_if(forces, [](const std::optional<Vec3>& force) { return force.has_value(); }));
        if (windows > matched.parts[i].windows) {
          matched.parts[i] = {course, begin_s, windows};
          std::ranges::copy(forces, matched.forces.begin() + static_cast<std::ptrdiff_t>(part.first_window));
        }
      };
      take(std::span(whole.forces).subspan(part.first_window, part.windows),
           whole.begin_s + static_cast<double>(part.first_window) * kForceWindow_s);
      const MatchedForces alone = matchForces(part.movement, courses[course], origin_m);
      take(std::span(alone.forces).first(part.windows), alone.begin_s);
    }
  }
  for (const FoundPart& part : matched.parts) {
    matched.windows += part.windows;
  }
  return matched;
}

}  // namespace haptolith
