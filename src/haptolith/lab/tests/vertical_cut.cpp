#include "haptolith/lab/tests/vertical_cut.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "haptolith/core/error.h"
#include "haptolith/figure/figure.h"
#include "haptolith/lab/apparatus/lab_bed.h"
#include "haptolith/lab/staged_progress.h"

namespace haptolith {

namespace {

constexpr double kCrest = 0.9;
constexpr double kToe = 0.1;
constexpr double kStrip = 0.25;          // in H, range behind the face over which the height is averaged
constexpr double kLongestCutRest = 100;  // in sqrt(H / g)
constexpr double kCutLook = 0.25;        // in sqrt(H / g)
constexpr double kLetGo = 0.4;           // fraction of the test's time before the plate retreats

void validate(const LabConditions& conditions, const VerticalCutOptions& options) {
  validate(conditions.soil);
  requireInRange("gravity_m_s2", conditions.gravity_m_s2, {0, 1000, Ends::kOpenBelow});
  requireInRange("height_m", options.height_m, {6 * conditions.soil.radius_m, 1000 * conditions.soil.radius_m});
  requireInRange("depth", options.depth, {1, 10});
  requireInRange("room", options.room, {1, 10});
  requireInRange("width", options.width, {12, 1000});
  requireInRange("retreat_speed", options.retreat_speed, {0, 10, Ends::kOpenBelow});
}

/// Box, divided by the plate. The bed's x is 0 in its centre; in results x is 0 at the face.
struct VerticalCutApparatus {
  double depth_m, room_m, face_x_m, floor_z_m;
  LabBox box;
  ToolParameters plate;

  VerticalCutApparatus(const SoilParameters& soil, const VerticalCutOptions& options)
      : depth_m(options.depth * options.height_m),
        room_m(options.room * options.height_m),
        face_x_m((depth_m - room_m) / 2),
        floor_z_m(2 * soil.radius_m) {
    box.width_m = depth_m + room_m;
    box.length_m = options.width * soil.radius_m;
    box.periodic_y = true;

    // A slab across the box and beyond, taller than loose soil: its thickness is along the tool's z.
    constexpr double kLooseness = 4;
    plate.shape = ToolShape::kBox;
    plate.size_m = {2 * kLooseness * (options.height_m + floor_z_m), 3 * box.length_m, 3 * soil.radius_m};
    plate.stiffness_n_m = soil.stiffness_n_m;
    plate.friction = 0;
    plate.adhesion_n = 0;
    plate.adhesion_ratio = 0;
  }

  /// Returns the pose of the plate with its face `ahead_m` in front of the cut.
  [[nodiscard]] Pose plateAt(double ahead_m) const {
    return {.position_m = {face_x_m + ahead_m + plate.size_m.z() / 2, 0, 0},
            .orientation = Quat(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitY()))};
  }

  /// Returns centres that fill the box behind the plate to this height. The hollows of the floor take up about 2 R of
  /// it.
  [[nodiscard]] std::vector<Vec3> fill(const SoilParameters& soil, double height_m, std::uint64_t seed) const {
    const double nearest = face_x_m - (1 + soil.size_spread) * soil.radius_m;
    const auto behind = [&](const Vec3& c) { return c.x() < nearest; };
    return looseSoil(soil, box, particlesFor(soil, depth_m * box.length_m * height_m), floor_z_m + 2 * soil.radius_m,
                     seed, behind);
  }

  [[nodiscard]] std::vector<Vec3> fromFace(std::vector<Vec3> centres_m) const {
    for (Vec3& c : centres_m) {
      c.x() -= face_x_m;
      c.z() -= floor_z_m;
    }
    return centres_m;
  }
};

/// Returns the surface over x: the mean, over columns two particles wide, of the top of the highest particle in each.
std::vector<CutProfilePoint> profileOf(const std::vector<Vec3>& centres_m, double radius_m, double width_m) {
  const double column = 4 * radius_m;
  const auto columns = std::max(1, int(width_m / column));
  std::map<int, std::map<int, double>> tops;
  for (const Vec3& c : centres_m) {
    const double y = c.y() / width_m;
    const int across = std::min(int((y - std::floor(y)) * columns), columns - 1);  // the bed is periodic along y
    double& top = tops[int(std::floor(c.x() / column))].try_emplace(across, 0).first->second;
    top = std::max(top, c.z() + radius_m);
  }
  std::vector<CutProfilePoint> profile;
  for (const auto& [along, highest] : tops) {
    double sum = 0;
    for (const auto& [across, top] : highest) {
      sum += top;
    }
    profile.push_back({(along + 0.5) * column, sum / columns});
  }
  return profile;
}

/// Returns the mean height of the columns within `strip_m` behind the face; there is at least one.
double heightBehindFace(const std::vector<CutProfilePoint>& profile, double strip_m) {
  double sum = 0;
  int columns = 0;
  for (const CutProfilePoint& point : profile) {
    if (point.x_m < 0 && point.x_m > -strip_m) {
      sum += point.height_m;
      ++columns;
    }
  }
  return sum / std::max(columns, 1);
}

/// Returns the largest x at which the surface has this height.
double lastAbove(const std::vector<CutProfilePoint>& profile, double height_m, double fallback_m) {
  double at = fallback_m;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    if (profile[i].height_m >= height_m) {
      at = profile[i].x_m;
      if (i + 1 < profile.size()) {  // between this point and the next, lower one
        const CutProfilePoint& next = profile[i + 1];
        const double drop = profile[i].height_m - next.height_m;
        at += drop > 0 ? (profile[i].height_m - height_m) / drop * (next.x_m - at) : 0;
      }
    }
  }
  return at;
}

}  // namespace

double criticalCutHeight(double cohesion_pa, double friction_angle_rad, double density_kg_m3, double gravity_m_s2) {
  constexpr double kQuarter = std::numbers::pi / 4;
  requireInRange("cohesion_pa", cohesion_pa, {0, 1e9});
  requireInRange("friction_angle_rad", friction_angle_rad, {0, 2 * kQuarter - 1e-6});
  requireInRange("density_kg_m3", density_kg_m3, {0, Range{}.highest, Ends::kOpen});
  requireInRange("gravity_m_s2", gravity_m_s2, {0, Range{}.highest, Ends::kOpen});
  return 4 * cohesion_pa / (density_kg_m3 * gravity_m_s2) * std::tan(kQuarter + friction_angle_rad / 2);
}

VerticalCutResult verticalCutTest(const LabConditions& conditions, const VerticalCutOptions& options) {
  validate(conditions, options);
  StagedProgress progress(conditions.progress);
  progress.enter(0, kLetGo);
  LabConditions inner = conditions;
  inner.progress = progress.inner();

  const SoilParameters& soil = conditions.soil;
  const VerticalCutApparatus apparatus(soil, options);
  LabBed bed(inner, apparatus.box, apparatus.fill(soil, options.height_m + 2 * soil.radius_m, conditions.seed),
             {roughPlate(soil, apparatus.box, apparatus.floor_z_m - soil.radius_m, conditions.seed)}, apparatus.plate);
  bed.placeTool(apparatus.plateAt(0));
  bed.settle();

  VerticalCutResult result;
  result.radius_m = soil.radius_m;
  const double strip_m = std::max(kStrip * options.height_m, 4 * soil.radius_m);
  const auto profile_now = [&] {
    return profileOf(apparatus.fromFace(bed.soilCentres()), soil.radius_m, apparatus.box.length_m);
  };
  result.centres_before_m = apparatus.fromFace(bed.soilCentres());
  result.before = profile_now();
  result.height_before_m = heightBehindFace(result.before, strip_m);

  const double fall_s = std::sqrt(options.height_m / conditions.gravity_m_s2);
  const double speed = options.retreat_speed * std::sqrt(conditions.gravity_m_s2 * options.height_m);
  const double far_m = apparatus.room_m + apparatus.plate.size_m.z();                   // outside the box
  const double at_rest = std::sqrt(2 * conditions.gravity_m_s2 * soil.radius_m / 500);  // as LabBed::settle()
  result.trace.columns = {"time_s", "plate_m", "height_m", "fastest_m_s"};
  bed.moveTool({.linear_m_s = {speed, 0, 0}});
  const double begin_s = bed.time();
  for (bool rests = false; !rests;) {
    const double t = bed.time() - begin_s;
    if (t > kLongestCutRest * fall_s + far_m / speed) {
      throw Failure(
          fmt::format("the cut did not settle: its fastest particle moves at {:.2g} m/s", bed.bed().largestSpeed()));
    }
    progress.enter(kLetGo + (1 - kLetGo) * t / (t + far_m / speed + 4 * fall_s), 1);
    bed.run(kCutLook * fall_s, "the plate is gone, the cut stands or falls");
    const double ahead = bed.toolPose().position_m.x() - apparatus.plateAt(0).position_m.x();
    if (ahead > far_m) {
      bed.moveTool({});
    }
    const double fastest = bed.bed().largestSpeed();
    result.trace.rows.push_back({bed.time(), ahead, heightBehindFace(profile_now(), strip_m), fastest});
    rests = ahead > far_m && fastest < at_rest;
  }

  result.centres_after_m = apparatus.fromFace(bed.soilCentres());
  result.after = profile_now();
  result.height_after_m = heightBehindFace(result.after, strip_m);
  result.height_kept = result.height_after_m / result.height_before_m;
  result.stands = result.height_kept >= kStandingCut;
  const auto moved = [&](double share) {
    const double height = share * result.height_before_m;
    return lastAbove(result.after, height, -apparatus.depth_m) - lastAbove(result.before, height, 0);
  };
  result.crest_back_m = -moved(kCrest);
  result.toe_ahead_m = moved(kToe);
  return result;
}

void drawVerticalCut(const OutputFile& path, const VerticalCutResult& result, std::string_view title) {
  constexpr double kMm = 1e3;
  const double r = result.radius_m;
  Figure figure(path, 1000, 760);
  const auto draw = [&](const char* name, const std::vector<Vec3>& centres_m, const std::vector<CutProfilePoint>& top) {
    std::vector<std::vector<double>> slice;
    for (const Vec3& c : centres_m) {
      if (std::abs(c.y()) < 2 * r) {
        slice.push_back({c.x() * kMm, c.z() * kMm, r * kMm});
      }
    }
    std::vector<std::vector<double>> line;
    line.reserve(top.size());
    for (const CutProfilePoint& point : top) {
      line.push_back({point.x_m * kMm, point.height_m * kMm});
    }
    figure.data(name, slice);
    figure.data(fmt::format("{}_top", name), line);
  };
  draw("before", result.centres_before_m, result.before);
  draw("after", result.centres_after_m, result.after);
  double back = 0;
  double ahead = 0.5 * result.height_before_m * kMm;
  double high = 0;
  for (const auto* centres : {&result.centres_before_m, &result.centres_after_m}) {
    for (const Vec3& c : *centres) {
      back = std::min(back, (c.x() - r) * kMm);
      ahead = std::max(ahead, (c.x() + r) * kMm);
      high = std::max(high, (c.z() + r) * kMm);
    }
  }
  figure.command(fmt::format(R"(
set multiplot layout 2,1 margins 0.28,0.76,0.1,0.88 spacing 0,0.13 title {}
set size ratio -1
set xrange [{:g}:{:g}]
set yrange [0:{:g}]
set ylabel 'height / mm'
set arrow 1 from 0,0 to 0,graph 1 nohead linewidth 3 linecolor rgb '#1f4e79'
set title 'Held by a plate'
plot $before using 1:2:3 with circles linecolor rgb '#cbb899' fillstyle solid 0.7 border linecolor rgb '#8c7b6b' notitle, \
     $before_top using 1:2 with linespoints pointtype 7 pointsize 0.6 linewidth 2 linecolor rgb '#c0392b' notitle
set arrow 1 from 0,0 to 0,graph 1 nohead linewidth 1 dashtype 2 linecolor rgb '#1f4e79'
set xlabel 'distance in front of the cut / mm'
set title 'Without: {}, {:.0f} % of its height kept'
plot $after using 1:2:3 with circles linecolor rgb '#cbb899' fillstyle solid 0.7 border linecolor rgb '#8c7b6b' notitle, \
     $after_top using 1:2 with linespoints pointtype 7 pointsize 0.6 linewidth 2 linecolor rgb '#c0392b' notitle
unset multiplot
)",
                             gnuplotQuoted(title), back - 5, ahead + 5, 1.1 * high,
                             result.stands ? "it stands" : "it falls", 100 * result.height_kept));
  figure.save();
}

}  // namespace haptolith
