#include "haptolith/lab/tests/shear.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>
#include <string>

#include "haptolith/core/error.h"
#include "haptolith/core/process/in_parallel.h"
#include "haptolith/figure/figure.h"
#include "haptolith/lab/apparatus/lab_bed.h"
#include "haptolith/lab/shared_progress.h"
#include "haptolith/lab/staged_progress.h"

namespace haptolith {

namespace {

constexpr std::size_t kLower = 0, kUpper = 1;  // bodies of the shear cell
constexpr double kPeakWindow = 0.05;           // strain over which stresses are averaged for the peak
constexpr double kModulusWindow = 0.01;        // strain over which they are averaged for the modulus
constexpr std::size_t kTraceRows = 400;

/// Shear cell: two rough plates with soil between them.
class ShearCell {
 public:
  ShearCell(const LabConditions& conditions, const ShearOptions& options)
      : conditions_(conditions), box_(boxFor(conditions.soil, options)), lab_(makeBed(conditions, options, box_)) {}

  /// Settles the soil and lowers the upper plate on it until it carries the load.
  void load(double normal_pa) {
    lab_.settle();
    lab_.bed().setGravity(Vec3::Zero());
    load_n_ = normal_pa * area();
    plate_mass_kg_ = lab_.bed().mass() * area() / std::pow(2 * conditions_.soil.radius_m, 2);
    damping_n_s_m_ = std::sqrt(plate_mass_kg_ * conditions_.soil.stiffness_n_m * area()) /
                     (2 * conditions_.soil.radius_m) * kPlateDamping;
    constexpr double kLongest_s = 20;
    constexpr double kBetweenLooks_s = 0.1;
    double waited = 0;
    do {
      double carried = 0;
      double steps = 0;
      lab_.run(kBetweenLooks_s, "the plate comes down", [&] {
        movePlate(0);
        carried += lab_.forceOnBody(kUpper).z();
        ++steps;
      });
      waited += kBetweenLooks_s;
      carried_n_ = carried / steps;
    } while ((std::abs(carried_n_ - load_n_) > 0.01 * load_n_ || std::abs(vertical_m_s_) > 1e-4) &&
             waited < kLongest_s);
    if (std::abs(carried_n_ - load_n_) > 0.2 * load_n_) {
      throw Failure(fmt::format("the specimen does not hold a plate with {:g} Pa: it carries {:.3g} Pa", normal_pa,
                                carried_n_ / area()));
    }
  }

  /// Advances the shear by one time step at `speed_m_s`.
  void movePlate(double speed_m_s) {
    // The plate is a rigid body with vertical motion only: Newton's law with load, soil force and slight damping.
    const double soil_n = lab_.forceOnBody(kUpper).z();
    vertical_m_s_ += lab_.dt() / plate_mass_kg_ * (soil_n - load_n_ - damping_n_s_m_ * vertical_m_s_);
    vertical_m_s_ = std::clamp(vertical_m_s_, -kFastest_m_s, kFastest_m_s);
    lab_.moveBody(kUpper, {speed_m_s, 0, vertical_m_s_});
  }

  [[nodiscard]] double shear() const { return -lab_.forceOnBody(kUpper).x() / area(); }
  [[nodiscard]] double normal() const { return lab_.forceOnBody(kUpper).z() / area(); }
  [[nodiscard]] double area() const { return box_.width_m * box_.length_m; }
  [[nodiscard]] double height() const { return lab_.centreOfBody(kUpper).z() - lab_.centreOfBody(kLower).z(); }
  [[nodiscard]] double bulkDensity() const {
    const double lower = lab_.centreOfBody(kLower).z();
    return lab_.bulkDensity(lower + 0.2 * height(), lower + 0.8 * height());  // away from the plates
  }
  [[nodiscard]] LabBed& lab() { return lab_; }

 private:
  static constexpr double kFastest_m_s = 0.15;
  static constexpr double kPlateDamping = 0.1;

  static LabBox boxFor(const SoilParameters& soil, const ShearOptions& options) {
    const double d = 2 * soil.radius_m;
    return {.width_m = options.width_diameters * d,
            .length_m = options.length_diameters * d,
            .periodic_x = true,
            .periodic_y = true};
  }

  static LabBed makeBed(const LabConditions& conditions, const ShearOptions& options, const LabBox& box) {
    const SoilParameters& soil = conditions.soil;
    const double r = soil.radius_m;
    const double volume = box.width_m * box.length_m * options.height_diameters * 2 * r;
    const std::vector<Vec3> loose = looseSoil(soil, box, particlesFor(soil, volume), 4 * r, conditions.seed);
    const std::vector<std::vector<Vec3>> plates{roughPlate(soil, box, 2 * r, conditions.seed + 1),
                                                roughPlate(soil, box, loose.back().z() + 5 * r, conditions.seed + 2)};
    return options.grain_classes == 1
               ? LabBed(conditions, box, loose, plates)
               : LabBed(conditions, box, mixedGrains(soil, loose, options.grain_classes, conditions.seed + 3),
                        options.grain_classes, plates);
  }

  const LabConditions& conditions_;
  LabBox box_;
  LabBed lab_;
  double load_n_ = 0, plate_mass_kg_ = 0, damping_n_s_m_ = 0, vertical_m_s_ = 0, carried_n_ = 0;
};

/// Mean of the latest values.
class MovingMean {
 public:
  explicit MovingMean(std::size_t length) : length_(std::max<std::size_t>(1, length)) {}
  void add(double value) {
    values_.push_back(value);
    sum_ += value;
    if (values_.size() > length_) {
      sum_ -= values_.front();
      values_.pop_front();
    }
  }
  [[nodiscard]] bool full() const { return values_.size() == length_; }
  [[nodiscard]] double mean() const { return sum_ / static_cast<double>(values_.size()); }

 private:
  std::size_t length_;
  std::deque<double> values_;
  double sum_ = 0;
};

/// Stress over strain while it rises, as means over a short strain.
class StressRise {
 public:
  explicit StressRise(std::size_t window) : mean_(window) {}
  void add(double strain, double stress_pa) {
    mean_.add(stress_pa);
    if (mean_.full() && (points_.empty() || mean_.mean() > points_.back().stress_pa)) {
      points_.push_back({strain, mean_.mean()});
    }
  }
  /// Returns the strain at which the mean first reached a stress; NaN if it never did.
  [[nodiscard]] double strainAt(double stress_pa) const {
    const auto first = std::ranges::lower_bound(points_, stress_pa, {}, &Point::stress_pa);
    return first == points_.end() ? std::numeric_limits<double>::quiet_NaN() : first->strain;
  }

 private:
  struct Point {
    double strain, stress_pa;
  };
  MovingMean mean_;
  std::vector<Point> points_;  ///< each stress larger than the one before
};

double shearSpeed(const LabConditions& conditions, const ShearOptions& options, double height_m, double density) {
  const double smallest = *std::min_element(options.normal_stresses_pa.begin(), options.normal_stresses_pa.end());
  return options.inertial_number * height_m / (2 * conditions.soil.radius_m) * std::sqrt(smallest / density);
}

ShearPointResult shearOne(const LabConditions& conditions, const ShearOptions& options, double normal_pa,
                          double& bulk_density) {
  constexpr double kSheared = 0.3;  // fraction of the test's time before shearing
  StagedProgress progress(conditions.progress);
  progress.enter(0, kSheared);
  LabConditions staged = conditions;
  staged.progress = progress.inner();
  ShearCell cell(staged, options);
  cell.load(normal_pa);
  progress.enter(kSheared, 1);
  bulk_density = cell.bulkDensity();
  const double height = cell.height();
  const double speed = shearSpeed(conditions, options, height, bulk_density);
  const double duration = options.strain * height / speed;
  const auto steps = duration / cell.lab().dt();

  ShearPointResult result;
  result.trace.columns = {"displacement_m", "shear_pa", "normal_pa", "height_m"};
  MovingMean shear(static_cast<std::size_t>(kPeakWindow / options.strain * steps));
  MovingMean normal(static_cast<std::size_t>(kPeakWindow / options.strain * steps));
  StressRise rise(static_cast<std::size_t>(kModulusWindow / options.strain * steps));
  double moved_m = 0, lowest_height = height, height_at_peak = height;
  double displacement = 0, residual = 0, residual_normal = 0, residual_height = 0;
  double counted = 0;
  const double start = cell.lab().time();
  cell.lab().run(duration, fmt::format("shear under {:g} Pa", normal_pa), [&] {
    const double plate_m_s = std::min(1.0, (cell.lab().time() - start) / (0.02 * duration)) * speed;
    cell.movePlate(plate_m_s);
    moved_m += cell.lab().dt() * plate_m_s;
    displacement += cell.lab().dt() * speed;
    shear.add(cell.shear());
    normal.add(cell.normal());
    rise.add(moved_m / height, cell.shear());
    lowest_height = std::min(lowest_height, cell.height());
    if (shear.full() && displacement <= options.peak_until * height && shear.mean() > result.peak_pa) {
      result.peak_pa = shear.mean();
      height_at_peak = lowest_height;
    }
    if (displacement > options.residual_from * height) {
      residual += cell.shear();
      residual_normal += cell.normal();
      ++counted;
    }
    if (displacement >= static_cast<double>(result.trace.rows.size()) / kTraceRows * options.strain * height) {
      result.trace.rows.push_back({displacement, shear.mean(), normal.mean(), cell.height()});
      residual_height = cell.height();
    }
  });
  result.residual_pa = residual / counted;
  result.normal_pa = residual_normal / counted;
  result.modulus_pa = result.peak_pa / 2 / rise.strainAt(result.peak_pa / 2);
  result.compression = 1 - height_at_peak / height;
  result.dilation = residual_height / height - 1;
  return result;
}

MohrCoulomb lineThrough(const std::vector<ShearPointResult>& points, double ShearPointResult::*stress) {
  std::vector<ShearPoint> line;
  line.reserve(points.size());
  for (const ShearPointResult& point : points) {
    line.push_back({point.normal_pa, point.*stress});
  }
  return fitMohrCoulomb(line);
}

}  // namespace

void validate(const ShearOptions& options) {
  std::vector<double> stresses = options.normal_stresses_pa;
  std::sort(stresses.begin(), stresses.end());
  stresses.erase(std::unique(stresses.begin(), stresses.end()), stresses.end());
  requireInRange("number of different normal_stresses_pa", static_cast<double>(stresses.size()), {3, 100});
  for (const double stress : stresses) {
    requireInRange("normal_stresses_pa", stress, {0, 1e6, Ends::kOpenBelow});
  }
  requireInRange("width_diameters", options.width_diameters, {6, 1000});
  requireInRange("length_diameters", options.length_diameters, {6, 1000});
  requireInRange("height_diameters", options.height_diameters, {5, 1000});
  requireInRange("grain_classes", options.grain_classes, {1, GrainClasses::kMost});
  requireInRange("residual_from", options.residual_from, {0, 99, Ends::kOpenBelow});
  requireInRange("strain", options.strain, {options.residual_from, 100, Ends::kOpenBelow});
  requireInRange("peak_until", options.peak_until, {0, 99, Ends::kOpenBelow});
  requireInRange("inertial_number", options.inertial_number, {1e-5, 0.1});
}

ShearResult ShearMemory::get(const LabConditions& conditions, const ShearOptions& options,
                             const std::function<ShearResult()>& simulate) {
  std::unique_lock lock(mutex_);
  const auto is_same = [&](const Entry& entry) {
    return entry.soil == conditions.soil && entry.gravity_m_s2 == conditions.gravity_m_s2 &&
           entry.seed == conditions.seed && entry.options == options;
  };
  auto entry = std::ranges::find_if(entries_, is_same);
  while (entry != entries_.end() && !entry->result) {
    changed_.wait(lock);
    entry = std::ranges::find_if(entries_, is_same);
  }
  if (entry != entries_.end()) {
    return *entry->result;
  }
  const auto own = entries_.insert(entries_.end(), {.soil = conditions.soil,
                                                    .gravity_m_s2 = conditions.gravity_m_s2,
                                                    .seed = conditions.seed,
                                                    .options = options,
                                                    .result = {}});
  lock.unlock();
  try {
    ShearResult result = simulate();
    lock.lock();
    own->result = result;
    changed_.notify_all();
    return result;
  } catch (...) {
    if (!lock.owns_lock()) {
      lock.lock();
    }
    entries_.erase(own);
    changed_.notify_all();
    throw;
  }
}

ShearResult shearTest(const LabConditions& conditions, const ShearOptions& options) {
  if (conditions.shear_memory != nullptr) {
    LabConditions alone = conditions;
    alone.shear_memory = nullptr;
    return conditions.shear_memory->get(conditions, options, [&] { return shearTest(alone, options); });
  }
  validate(options);
  std::vector<double> stresses = options.normal_stresses_pa;
  std::sort(stresses.begin(), stresses.end());
  ShearResult result;
  result.points.resize(stresses.size());
  std::vector<double> densities(stresses.size());
  SharedProgress progress(conditions, stresses.size());
  inParallel(stresses.size(), conditions.threads, [&](std::size_t i) {
    LabConditions specimen = progress.conditionsOf(i);
    specimen.seed = conditions.seed * stresses.size() + i;
    result.points[i] = shearOne(specimen, options, stresses[i], densities[i]);
  });
  result.bulk_density_kg_m3 = densities.front();
  result.peak = lineThrough(result.points, &ShearPointResult::peak_pa);
  result.residual = lineThrough(result.points, &ShearPointResult::residual_pa);
  return result;
}

ShearPointResult shearUnder(const LabConditions& conditions, ShearOptions options, double normal_pa) {
  requireInRange("normal_pa", normal_pa, {0, 1e6, Ends::kOpenBelow});
  validate(options);
  options.normal_stresses_pa = {normal_pa};
  double bulk_density = 0;
  return shearOne(conditions, options, normal_pa, bulk_density);
}

double frictionWithoutCohesion(const std::vector<ShearPointResult>& points,
                               double ShearPointResult::*shear_pa) noexcept {
  double stresses = 0;
  double squares = 0;
  for (const ShearPointResult& point : points) {
    stresses += point.normal_pa * point.*shear_pa;
    squares += point.normal_pa * point.normal_pa;
  }
  return stresses / squares;
}

void drawShear(const OutputFile& path, const ShearResult& result, std::string_view title) {
  Figure figure(path, 1100, 480);
  std::vector<std::vector<double>> points;
  double largest = 0;
  for (const ShearPointResult& point : result.points) {
    points.push_back({point.normal_pa / 1e3, point.peak_pa / 1e3, point.residual_pa / 1e3});
    largest = std::max(largest, point.normal_pa / 1e3);
  }
  figure.data("points", points);
  figure.command(fmt::format("set multiplot layout 1,2 title {}; set grid lc '#dddddd'", gnuplotQuoted(title)));
  figure.command(
      "set xlabel 'displacement / mm'; set ylabel 'shear stress / normal stress'; set yrange [0:*]; "
      "set key tmargin center horizontal title 'normal stress'");
  std::string curves;
  for (std::size_t i = 0; i < result.points.size(); ++i) {
    const ShearPointResult& point = result.points[i];
    std::vector<std::vector<double>> rows;
    for (const std::vector<double>& row : point.trace.rows) {
      rows.push_back({row[0] * 1e3, row[1] / point.normal_pa});
    }
    figure.data(fmt::format("curve{}", i), rows);
    curves += fmt::format("{}$curve{} with lines lw 1.5 title '{:.2g} kPa'", i == 0 ? "plot " : ", ", i,
                          point.normal_pa / 1e3);
  }
  figure.command(curves);
  const auto line = [](const MohrCoulomb& fit) {
    return fmt::format("{} + {}*x", fit.cohesion_pa / 1e3, std::tan(fit.friction_angle_rad));
  };
  const auto label = [](std::string_view what, const MohrCoulomb& fit) {
    return fmt::format("{}: {:.1f}°, {:.0f} Pa", what, fit.friction_angle_rad * 180 / std::numbers::pi,
                       fit.cohesion_pa);
  };
  figure.command(fmt::format(
      "set xlabel 'normal stress / kPa'; set ylabel 'shear stress / kPa'; set key inside top left vertical title ''; "
      "set xrange [0:{:g}]; set yrange [0:*]",
      1.1 * largest));
  figure.command(fmt::format(
      "plot $points using 1:2 with points pt 9 ps 1.3 lc '#d2691e' notitle, {} lw 2 dt 2 lc '#d2691e' title '{}', "
      "$points using 1:3 with points pt 7 ps 1.2 lc '#1f6fb4' notitle, {} lw 2 lc '#1f6fb4' title '{}'",
      line(result.peak), label("peak", result.peak), line(result.residual), label("residual", result.residual)));
  figure.command("unset multiplot");
  figure.save();
}

}  // namespace haptolith
