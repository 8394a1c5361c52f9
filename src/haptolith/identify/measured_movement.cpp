#include "haptolith/identify/measured_movement.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "haptolith/core/error.h"
#include "haptolith/core/input_file.h"
#include "haptolith/core/number_rows.h"

namespace haptolith {

namespace {

constexpr TextLimits kLimits{.bytes = std::uintmax_t{1} << 30, .line_bytes = 4000, .rows = 5'000'000};
constexpr std::string_view kColumns = "t_s,x_m,y_m,z_m,qw,qx,qy,qz,soil_fx_n,soil_fy_n,soil_fz_n";
constexpr std::string_view kExportColumns =
    "t_s,tool_x_m,tool_y_m,tool_z_m,tool_qw,tool_qx,tool_qy,tool_qz,soil_fx_n,soil_fy_n,soil_fz_n";
constexpr double kLargest = 1e6;

bool isThere(const Pose& tool, const Pose& wanted) {
  return (tool.position_m - wanted.position_m).norm() <= kPoseTolerance_m &&
         tool.orientation.angularDistance(wanted.orientation) <= kTurnTolerance_rad;
}

std::size_t windowsOf(const ToolMovement& movement) {
  return static_cast<std::size_t>(movement.duration() / kForceWindow_s);
}

/// Samples in the site's frame, and where in time they are.
class Course {
 public:
  Course(std::span<const MeasuredSample> samples, const Vec3& origin_m) : samples_(samples), origin_m_(origin_m) {}

  [[nodiscard]] Pose pose(const MeasuredSample& sample) const {
    return {sample.pose.position_m - origin_m_, sample.pose.orientation};
  }
  /// The sample next after a time; none behind the last.
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

/// In how many windows the tool is in its place at their middle, if the movement began then.
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

/// Whether something was measured at least every fifth of a window.
bool isCovered(std::span<const MeasuredSample> inside, double from_s) {
  constexpr double kLongest_s = kForceWindow_s / 5 + 1e-6;
  double last_s = from_s;
  for (const MeasuredSample& sample : inside) {
    if (sample.time_s - last_s > kLongest_s) {
      return false;
    }
    last_s = sample.time_s;
  }
  return from_s + kForceWindow_s - last_s <= kLongest_s;
}

/// Whose columns a file has: an export's, where it says which pose is the tool's, or else a trace's.
std::string_view columnsOf(const std::filesystem::path& path) {
  std::ifstream file = openInput(path, kLimits.bytes);
  LineReader lines(file, path.string(), kLimits);
  std::string line;
  while (lines.next(line) && (line.empty() || line.front() == '#')) {
  }
  return line.find("tool_x_m") == std::string::npos ? kColumns : kExportColumns;
}

}  // namespace

std::vector<MeasuredSample> readMeasured(const std::filesystem::path& path) {
  NumberRows rows(path, columnsOf(path), kLimits, OtherColumns::kPassedOver);
  std::vector<MeasuredSample> samples;
  std::array<double, 11> v{};
  while (rows.next(v)) {
    for (const double value : v) {
      requireInRange(rows.key("number"), value, {-kLargest, kLargest});
    }
    const Quat turn(v[4], v[5], v[6], v[7]);
    requireInRange(rows.key("length of qw,qx,qy,qz"), turn.norm(), kUnitNorm);
    if (!samples.empty() && !(v[0] > samples.back().time_s)) {
      throw InvalidParameter(rows.key("t_s"), fmt::format("{}", v[0]),
                             fmt::format("> {}, the time before: time goes forward", samples.back().time_s));
    }
    samples.push_back({v[0], {{v[1], v[2], v[3]}, turn.normalized()}, {v[8], v[9], v[10]}});
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
  constexpr double kStep_s = 0.02;
  int most = 0;
  double first_s = 0, last_s = 0;  // of the first times that agree as well as any
  for (double begin_s = samples.front().time_s - movement.duration(); begin_s < samples.back().time_s;
       begin_s += kStep_s) {
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
