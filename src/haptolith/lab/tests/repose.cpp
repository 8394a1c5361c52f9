#include "haptolith/lab/tests/repose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "haptolith/core/error.h"
#include "haptolith/figure/figure.h"
#include "haptolith/lab/apparatus/lab_bed.h"
#include "haptolith/lab/staged_progress.h"

namespace haptolith {

namespace {

/// Min. slope of a heap that fits into the box. Flatter ones reach the walls, which is reported.
constexpr double kFlattestHeap_rad = 20 * std::numbers::pi / 180;

/// Max. time for the heap to settle, in sqrt(R / g). Flanks continue to creep for several tens of them.
constexpr double kLongestHeapRest = 1000;

void validate(const LabConditions& conditions, const ReposeOptions& options) {
  validate(conditions.soil);
  requireInRange("gravity_m_s2", conditions.gravity_m_s2, {0, 1000, Ends::kOpenBelow});
  requireInRange("tube_radius", options.tube_radius, {4, 100});
  requireInRange("fill", options.fill, {4, 500});
  requireInRange("lift_speed", options.lift_speed, {0, 5, Ends::kOpenBelow});
  requireInRange("ring_width", options.ring_width, {2, 20});
}

/// Dimensions of the apparatus, in m.
struct ReposeApparatus {
  double inner_m, fill_m, spread_m, floor_z_m;
  LabBox box;
  ToolParameters tube;

  ReposeApparatus(const SoilParameters& soil, const ReposeOptions& options)
      : inner_m(options.tube_radius * soil.radius_m), fill_m(options.fill * soil.radius_m) {
    const double r = soil.radius_m;
    // Radius of a cone with the volume of the tube: V = pi s^3 tan(angle) / 3.
    const double cone_m = std::cbrt(3 * inner_m * inner_m * fill_m / std::tan(kFlattestHeap_rad));
    spread_m = std::max(cone_m, inner_m) + 6 * r;
    floor_z_m = 2 * r;
    box.width_m = box.length_m = 2 * spread_m;

    constexpr double kLooseness = 4;  // max. volume of loose soil over that of settled soil
    tube.shape = ToolShape::kTube;
    tube.thickness_m = r;  // thick enough to stop a particle, and to round its lower edge
    tube.diameter_m = 2 * inner_m + tube.thickness_m;
    tube.length_m = kLooseness * fill_m + 4 * inner_m;
    tube.stiffness_n_m = soil.stiffness_n_m;
    tube.friction = 0;
  }

  [[nodiscard]] std::vector<Vec3> floor(const SoilParameters& soil, std::uint64_t seed) const {
    std::vector<Vec3> plate = roughPlate(soil, box, floor_z_m - soil.radius_m, seed);
    std::erase_if(plate, [&](const Vec3& c) { return std::hypot(c.x(), c.y()) > spread_m; });  // no soil reaches it
    return plate;
  }

  [[nodiscard]] std::vector<Vec3> fillOf(const SoilParameters& soil, std::uint64_t seed,
                                         Preparation preparation) const {
    const double most = inner_m - (1 + soil.size_spread) * soil.radius_m;
    const auto inside = [&](const Vec3& c) { return std::hypot(c.x(), c.y()) < most; };
    const std::size_t particles = particlesFor(soil, std::numbers::pi * inner_m * inner_m * fill_m);
    return looseSoil(soil, box, particles, floor_z_m + 2 * soil.radius_m, seed, inside, preparation);
  }

  /// Returns the pose of the tube with the round end of its wall `gap_m` above the floor.
  [[nodiscard]] Pose tubeAt(double gap_m) const {
    return {.position_m = {0, 0, floor_z_m + gap_m + tube.thickness_m / 2 + tube.length_m / 2}};
  }
  [[nodiscard]] double gap(const Pose& tube_pose) const { return tube_pose.position_m.z() - tubeAt(0).position_m.z(); }
};

/// One running test.
class HeapOnFloor {
 public:
  HeapOnFloor(const LabConditions& conditions, const ReposeOptions& options, const ReposeApparatus& apparatus,
              const LabConditions& inner)
      : conditions_(conditions),
        options_(options),
        apparatus_(apparatus),
        bed_(inner, apparatus.box, apparatus.fillOf(conditions.soil, conditions.seed, options.preparation),
             {apparatus.floor(conditions.soil, conditions.seed)}, apparatus.tube) {
    bed_.placeTool(apparatus.tubeAt(0));
    trace_.columns = {"time_s", "tube_m", "heap_m", "fastest_m_s"};
  }

  void settle() { bed_.settle(options_.preparation); }

  /// Lifts the tube until its lower edge is above all soil; only then it contains no soil.
  void lift(StagedProgress& progress) {
    const double speed = options_.lift_speed * std::sqrt(conditions_.gravity_m_s2 * conditions_.soil.radius_m);
    const double highest = 1.2 * apparatus_.fill_m + 4 * conditions_.soil.radius_m;
    bed_.moveTool({.linear_m_s = {0, 0, speed}});
    for (double gap = 0; gap < highest && gap < heapHeight(); gap = apparatus_.gap(bed_.toolPose())) {
      progress.enter(kLiftBegins + gap / highest * (kRestBegins - kLiftBegins), kRestBegins);
      bed_.run(look(), "the tube is lifted");
      note();
    }
    bed_.placeTool(apparatus_.tubeAt(3 * highest));
    bed_.moveTool({});
  }

  void rest(StagedProgress& progress) {
    progress.enter(kRestBegins, 1);
    for (double t = 0; t < kLongestHeapRest; t += kLook) {
      bed_.run(look(), "the heap settles");
      note();
      if (bed_.bed().largestSpeed() < restSpeed()) {
        return;
      }
    }
    throw Failure(
        fmt::format("the heap did not settle: its fastest particle moves at {:.2g} m/s", bed_.bed().largestSpeed()));
  }

  [[nodiscard]] ReposeResult result() {
    const double r = conditions_.soil.radius_m;
    ReposeResult result;
    result.centres_m = bed_.soilCentres();
    result.radius_m = r;
    result.floor_z_m = apparatus_.floor_z_m;
    refuseFlood(result.centres_m);
    result.profile = heapProfile(
        result.centres_m, {.radius_m = r, .floor_z_m = apparatus_.floor_z_m, .ring_width_m = options_.ring_width * r});
    result.angle_rad = result.profile.angle_of_repose_rad;
    result.angle_se_rad = result.profile.angle_se_rad;
    result.height_m = result.profile.height_m;
    result.trace = std::move(trace_);
    return result;
  }

  // Fractions of a test's time, for progress.
  static constexpr double kLiftBegins = 0.3;
  static constexpr double kRestBegins = 0.85;

 private:
  static constexpr double kLook = 3;  // interval between samples, in sqrt(R / g)

  [[nodiscard]] double look() const { return kLook * std::sqrt(conditions_.soil.radius_m / conditions_.gravity_m_s2); }

  /// Returns the speed of a particle that has fallen by 1/500 of its radius, as in LabBed::settle().
  [[nodiscard]] double restSpeed() const {
    return std::sqrt(2 * conditions_.gravity_m_s2 * conditions_.soil.radius_m / 500);
  }

  [[nodiscard]] double heapHeight() const { return bed_.surfaceHeight(1) - apparatus_.floor_z_m; }

  void note() {
    trace_.rows.push_back({bed_.time(), apparatus_.gap(bed_.toolPose()), heapHeight(), bed_.bed().largestSpeed()});
  }

  void refuseFlood(const std::vector<Vec3>& centres_m) const {
    const double wall = apparatus_.spread_m - 3 * conditions_.soil.radius_m;
    const auto there = std::ranges::count_if(
        centres_m, [&](const Vec3& c) { return std::max(std::abs(c.x()), std::abs(c.y())) > wall; });
    constexpr double kStragglers = 0.01;
    if (static_cast<double>(there) > kStragglers * static_cast<double>(centres_m.size())) {
      throw Failure(fmt::format("the soil spread as far as the walls ({} of {} particles): flatter than {:.0f} degrees",
                                there, centres_m.size(), kFlattestHeap_rad * 180 / std::numbers::pi));
    }
  }

  const LabConditions& conditions_;
  const ReposeOptions& options_;
  const ReposeApparatus& apparatus_;
  LabBed bed_;
  LabTrace trace_;
};

}  // namespace

ReposeResult reposeTest(const LabConditions& conditions, const ReposeOptions& options) {
  validate(conditions, options);
  StagedProgress progress(conditions.progress);
  progress.enter(0, HeapOnFloor::kLiftBegins);
  LabConditions inner = conditions;
  inner.progress = progress.inner();

  const ReposeApparatus apparatus(conditions.soil, options);
  HeapOnFloor heap(conditions, options, apparatus, inner);
  heap.settle();
  heap.lift(progress);
  heap.rest(progress);
  return heap.result();
}

void drawRepose(const OutputFile& path, const ReposeResult& result, std::string_view title) {
  constexpr double kDegree = std::numbers::pi / 180;
  constexpr double kMm = 1e3;
  std::vector<std::vector<double>> slice;
  for (const Vec3& c : result.centres_m) {
    if (std::abs(c.y()) < 2 * result.radius_m) {
      slice.push_back({c.x() * kMm, (c.z() - result.floor_z_m) * kMm, result.radius_m * kMm});
    }
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::vector<double>> rings;
  std::vector<std::vector<double>> line;
  for (const double side : {-1.0, 1.0}) {
    for (const HeapRing& ring : result.profile.rings) {
      rings.push_back({side * ring.radius_m * kMm, ring.height_m * kMm});
    }
    const double foot = -result.profile.line.intercept / result.profile.line.slope;
    line.push_back({0, result.profile.line.intercept * kMm});
    line.push_back({side * foot * kMm, 0});
    line.push_back({nan, nan});
  }
  Figure figure(path, 1000, 480);
  figure.data("slice", slice);
  figure.data("rings", rings);
  figure.data("line", line);
  figure.command(fmt::format(R"(
set xlabel 'distance from the axis / mm'
set ylabel 'height / mm'
set size ratio -1
set yrange [0:*]
set key tmargin center horizontal
set title {}."\n".'angle of repose {:.1f} ± {:.1f}°'
plot $slice using 1:2:3 with circles linecolor rgb '#cbb899' fillstyle solid 0.7 border linecolor rgb '#8c7b6b' title 'particles within 2 R of the plane', \
     $rings using 1:2 with points pointtype 7 pointsize 0.8 linecolor rgb '#1f4e79' title 'profile, mean of each ring', \
     $line using 1:2 with lines linewidth 3 linecolor rgb '#c0392b' title 'fitted between 20 % and 80 % of the height'
)",
                             gnuplotQuoted(title), result.angle_rad / kDegree, result.angle_se_rad / kDegree));
  figure.save();
}

}  // namespace haptolith
