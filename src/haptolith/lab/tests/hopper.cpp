#include "haptolith/lab/tests/hopper.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "haptolith/core/error.h"
#include "haptolith/figure/figure.h"
#include "haptolith/lab/apparatus/lab_bed.h"
#include "haptolith/lab/staged_progress.h"
#include "haptolith/lab/theory/straight_line.h"

namespace haptolith {

namespace {

// Times in sqrt(d / g).
constexpr double kHopperLook = 0.5;
constexpr double kQuiet = 20;      // a longer pause counts as clogged
constexpr double kLongest = 2000;  // max. duration of a discharge

constexpr std::size_t kPlug = 1;  // index of the body; the floor is 0

constexpr double kSteadyFrom = 0.25;  // in the mass discharged while the opening was covered
constexpr int kFewestPassed = 30;     // min. number of particles in the fitted part for a rate

void validate(const LabConditions& conditions, const HopperOptions& options) {
  validate(conditions.soil);
  requireInRange("gravity_m_s2", conditions.gravity_m_s2, {0, 1000, Ends::kOpenBelow});
  requireInRange("number of openings", static_cast<double>(options.openings.size()), {1, 100});
  for (const double opening : options.openings) {
    requireInRange("opening", opening, {1, 40});
  }
  requireInRange("fill", options.fill, {5, 200});
  requireInRange("fill_openings", options.fill_openings, {0, 20});
  requireInRange("margin", options.margin, {3, 100});
  requireInRange("smallest_fitted", options.smallest_fitted, {kBeverlooGap, 40, Ends::kOpenBelow});
}

/// Container and bin for one opening, in m.
struct HopperApparatus {
  double opening_m, fill_m, floor_z_m;
  LabBox box;

  HopperApparatus(const SoilParameters& soil, const HopperOptions& options, double opening)
      : opening_m(opening * 2 * soil.radius_m),
        fill_m(std::max(options.fill, options.fill_openings * opening) * 2 * soil.radius_m) {
    box.width_m = box.length_m = opening_m + 2 * options.margin * 2 * soil.radius_m;
    // The bin holds all of the soil, even in a heap of 45 degrees, below the opening.
    floor_z_m = fill_m + box.width_m / 2;
  }

  [[nodiscard]] static double fromAxis(const Vec3& c) { return std::hypot(c.x(), c.y()); }

  /// Returns a ring of particles as wide as the opening with a rough floor around it, and the plug that closes it.
  [[nodiscard]] std::vector<std::vector<Vec3>> floorAndPlug(const SoilParameters& soil, std::uint64_t seed) const {
    const double r = soil.radius_m;
    constexpr double kSpacing = 1.2;  // in R, along the ring: smooth
    constexpr double kSeam = 0.2;     // in R, from the ring to the plug and the floor: no particle fits between
    const double ring_m = opening_m / 2 + r;
    std::vector<Vec3> floor;
    const auto around = static_cast<int>(std::ceil(2 * std::numbers::pi * ring_m / (kSpacing * r)));
    for (int i = 0; i < around; ++i) {
      const double turn = 2 * std::numbers::pi * i / around;
      floor.emplace_back(ring_m * std::cos(turn), ring_m * std::sin(turn), floor_z_m);
    }
    std::vector<Vec3> plug;
    for (const Vec3& c : roughPlate(soil, box, floor_z_m, seed)) {
      if (fromAxis(c) > ring_m + kSeam * r) {
        floor.push_back(c);
      } else if (fromAxis(c) < ring_m - kSeam * r) {
        plug.push_back(c);
      }
    }
    return {floor, plug};
  }

  [[nodiscard]] std::vector<Vec3> fill(const SoilParameters& soil, std::uint64_t seed) const {
    return looseSoil(soil, box, particlesFor(soil, box.width_m * box.length_m * fill_m),
                     floor_z_m + 2.6 * soil.radius_m, seed);
  }
};

/// Test of one opening, from filling to the end of flow.
class Discharge {
 public:
  Discharge(const LabConditions& conditions, const HopperApparatus& apparatus)
      : conditions_(conditions),
        apparatus_(apparatus),
        unit_s_(std::sqrt(2 * conditions.soil.radius_m / conditions.gravity_m_s2)),
        bed_(conditions, apparatus.box, apparatus.fill(conditions.soil, conditions.seed),
             apparatus.floorAndPlug(conditions.soil, conditions.seed)) {
    point_.opening_m = apparatus.opening_m;
    point_.trace.columns = {"time_s", "discharged_kg", "cover_m", "fastest_m_s"};
  }

  HopperPoint run(StagedProgress& progress, double from, double to) {
    const double half_way = from + 0.5 * (to - from);
    progress.enter(from, half_way);
    bed_.settle();
    count();
    settled_below_ = passed_;
    pullPlug();
    int last_passed = 0;
    double last_came = bed_.time();
    const double begin = bed_.time();
    const double first_cover = cover();
    bool flows = true;
    while (flows && bed_.time() - begin < kLongest * unit_s_) {
      note();
      progress.enter(half_way + (to - half_way) * std::clamp(1 - cover() / first_cover, 0.0, 1.0), to);
      bed_.run(kHopperLook * unit_s_, fmt::format("soil runs through {:.3g} mm", apparatus_.opening_m * 1e3));
      parkPlug();
      count();
      if (passed_ > last_passed) {
        last_passed = passed_;
        last_came = bed_.time();
      }
      if (half_way_.empty() && cover() < 0.7 * first_cover) {
        half_way_ = bed_.soilCentres();
      }
      point_.clogged = bed_.time() - last_came > kQuiet * unit_s_ && cover() >= conditions_.soil.radius_m;
      flows = !point_.clogged && cover() >= std::min(apparatus_.opening_m, 0.5 * first_cover);
    }
    note();
    fitRate();
    return std::move(point_);
  }

  [[nodiscard]] std::vector<Vec3> flowing() const { return half_way_.empty() ? bed_.soilCentres() : half_way_; }

 private:
  /// Pulls the plug down faster than falling soil for at least 200 R, through the bin's floor, which does not stop it.
  void pullPlug() { bed_.moveBody(kPlug, {0, 0, -7 * std::sqrt(conditions_.gravity_m_s2 * apparatus_.floor_z_m)}); }
  void parkPlug() {
    if (bed_.centreOfBody(kPlug).z() < -10 * conditions_.soil.radius_m) {
      bed_.moveBody(kPlug, Vec3::Zero());
    }
  }

  void count() {
    const double passed_below = apparatus_.floor_z_m - 3 * conditions_.soil.radius_m;
    // In the centre, which empties first: soil around the rim flows down the sides and does not cover the opening.
    const double middle = std::max(apparatus_.opening_m / 4, 2 * conditions_.soil.radius_m);
    int passed = 0;
    cover_m_ = 0;
    for (std::size_t i = 0; i < bed_.soil(); ++i) {
      const Vec3 c = bed_.centre(i);
      passed += c.z() < passed_below ? 1 : 0;
      if (HopperApparatus::fromAxis(c) < middle) {
        cover_m_ = std::max(cover_m_, c.z() - apparatus_.floor_z_m);
      }
    }
    passed_ = passed - settled_below_;
  }
  [[nodiscard]] double cover() const { return cover_m_; }

  void note() {
    point_.discharged_kg = passed_ * bed_.bed().mass();
    point_.trace.rows.push_back({bed_.time(), point_.discharged_kg, cover(), bed_.bed().largestSpeed()});
  }

  void fitRate() {
    const double all = point_.discharged_kg;
    std::vector<double> time_s;
    std::vector<double> mass_kg;
    for (const std::vector<double>& row : point_.trace.rows) {
      if (row[1] >= kSteadyFrom * all && (!point_.clogged || row[1] < all)) {
        time_s.push_back(row[0]);
        mass_kg.push_back(row[1]);
      }
    }
    if (time_s.size() < 4 || mass_kg.back() - mass_kg.front() < kFewestPassed * bed_.bed().mass()) {
      return;
    }
    const StraightLine line = fitStraightLine(time_s, mass_kg);
    point_.rate_kg_s = line.slope;
    point_.rate_se_kg_s = line.slope_se;
  }

  const LabConditions& conditions_;
  const HopperApparatus& apparatus_;
  double unit_s_;
  LabBed bed_;
  int settled_below_ = 0;  ///< particles under the floor before the plug was pulled
  int passed_ = 0;
  double cover_m_ = 0;
  std::vector<Vec3> half_way_;
  HopperPoint point_;
};

/// Fits the power law to the openings that are included.
DischargeFit fitOf(const HopperResult& result, double smallest_m) {
  std::vector<DischargePoint> points;
  std::set<double> openings;
  for (const HopperPoint& point : result.points) {
    if (!point.clogged && point.rate_kg_s > 0 && point.opening_m >= smallest_m * (1 - 1e-9)) {
      points.push_back({point.opening_m, point.rate_kg_s});
      openings.insert(point.opening_m);
    }
  }
  if (points.size() < 3 || openings.size() < 2) {
    return {};
  }
  return fitDischarge(points, result.particle_diameter_m);
}

}  // namespace

HopperResult hopperTest(const LabConditions& conditions, const HopperOptions& options) {
  validate(conditions, options);
  StagedProgress progress(conditions.progress);
  LabConditions inner = conditions;
  inner.progress = progress.inner();

  HopperResult result;
  result.particle_diameter_m = 2 * conditions.soil.radius_m;
  result.trace.columns = {"opening_m", "rate_kg_s", "rate_se_kg_s", "clogged"};
  const auto openings = static_cast<double>(options.openings.size());
  for (std::size_t i = 0; i < options.openings.size(); ++i) {
    const HopperApparatus apparatus(conditions.soil, options, options.openings[i]);
    Discharge discharge(inner, apparatus);
    const auto done = static_cast<double>(i);
    HopperPoint point = discharge.run(progress, done / openings, (done + 1) / openings);
    if (point.opening_m > result.widest_m) {
      result.widest_m = point.opening_m;
      result.centres_m = discharge.flowing();
      result.floor_z_m = apparatus.floor_z_m;
    }
    if (point.clogged) {
      result.clogged_m.push_back(point.opening_m);
    }
    result.trace.rows.push_back({point.opening_m, point.rate_kg_s, point.rate_se_kg_s, point.clogged ? 1.0 : 0.0});
    result.points.push_back(std::move(point));
  }
  result.fit = fitOf(result, options.smallest_fitted * result.particle_diameter_m);
  return result;
}

void drawHopper(const OutputFile& path, const HopperResult& result, std::string_view title) {
  constexpr double kMm = 1e3;
  const double d = result.particle_diameter_m;
  std::vector<std::vector<double>> ran;
  std::vector<std::vector<double>> stopped;
  std::vector<std::vector<double>> law;
  double widest = 0;
  for (const HopperPoint& point : result.points) {
    const double free = point.opening_m / d - kBeverlooGap;
    if (free > 0) {
      widest = std::max(widest, free);
      (point.clogged ? stopped : ran).push_back({free, point.rate_kg_s > 0 ? point.rate_kg_s : 0});
    }
  }
  // A clogged opening without a rate is marked at the bottom of the axis.
  double lowest = std::numeric_limits<double>::infinity();
  for (const auto* rows : {&ran, &stopped}) {
    for (const std::vector<double>& row : *rows) {
      lowest = row[1] > 0 ? std::min(lowest, row[1]) : lowest;
    }
  }
  lowest = std::isfinite(lowest) ? lowest / 3 : 1e-3;
  for (auto* rows : {&ran, &stopped}) {
    for (std::vector<double>& row : *rows) {
      row[1] = std::max(row[1], lowest);
    }
  }
  if (result.hasExponent()) {
    for (const double free : {0.3, 1.2 * widest}) {
      law.push_back({free, result.fit.rateAt((free + kBeverlooGap) * d, d)});
    }
  }
  std::vector<std::vector<double>> slice;
  for (const Vec3& c : result.centres_m) {
    if (std::abs(c.y()) < d) {
      slice.push_back({c.x() * kMm, (c.z() - result.floor_z_m) * kMm, d / 2 * kMm});
    }
  }
  // gnuplot fails on empty data.
  for (auto* rows : {&ran, &stopped, &law, &slice}) {
    if (rows->empty()) {
      const double nan = std::numeric_limits<double>::quiet_NaN();
      rows->push_back({nan, nan, nan});
    }
  }
  Figure figure(path, 1100, 560);
  figure.data("ran", ran);
  figure.data("stopped", stopped);
  figure.data("law", law);
  figure.data("slice", slice);
  double wall = result.widest_m / 2;
  for (const Vec3& c : result.centres_m) {
    wall = std::max(wall, std::abs(c.x()) + d / 2);
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double rim = result.widest_m / 2;
  figure.data("floor", {{-wall * kMm, 0}, {-rim * kMm, 0}, {nan, nan}, {rim * kMm, 0}, {wall * kMm, 0}});
  figure.command(fmt::format(
      R"(
set multiplot layout 1,2 title {}
set logscale xy
set xrange [0.4:{:g}]
set yrange [{:g}:*]
set xlabel '(D - {:.2g} d) / d'
set ylabel 'discharge / (kg/s)'
set key inside top left
set title 'Rate over opening'
plot $law using 1:2 with lines linewidth 2 linecolor rgb '#c0392b' {}, \
     $ran using 1:2 with points pointtype 7 pointsize 1.2 linecolor rgb '#1f4e79' title 'ran out', \
     $stopped using 1:2 with points pointtype 2 pointsize 1.5 linewidth 2 linecolor rgb '#555555' title 'clogged'
unset logscale
set xrange [*:*]
set yrange [*:*]
set size ratio -1
set xlabel 'distance from the axis / mm'
set xtics 100
set ylabel 'height above the opening / mm'
set title 'Opening of {:.3g} d'
plot $slice using 1:2:3 with circles linecolor rgb '#cbb899' fillstyle solid 0.7 border linecolor rgb '#8c7b6b' notitle, \
     $floor using 1:2 with lines linewidth 3 linecolor rgb '#333333' notitle
unset multiplot
)",
      gnuplotQuoted(title), 1.3 * std::max(widest, 1.0), lowest / 1.5, kBeverlooGap,
      result.hasExponent() ? fmt::format("title 'power {:.2f} ± {:.2f}'", result.fit.exponent, result.fit.exponent_se)
                           : "notitle",
      result.widest_m / d));
  figure.save();
}

}  // namespace haptolith
