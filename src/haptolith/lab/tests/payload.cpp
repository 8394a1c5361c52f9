#include "haptolith/lab/tests/payload.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "haptolith/core/error.h"
#include "haptolith/figure/figure.h"
#include "haptolith/lab/apparatus/lab_bed.h"

namespace haptolith {

namespace {

constexpr double kHeightRadii = 60;  ///< shovel height above the floor, in R; no heap of spilled soil reaches it
constexpr double kStart_s = 0.5;     ///< time from rest to full speed
constexpr double kSteady_s = 1;
constexpr double kBetweenRows_s = 5e-3;

double edge(const LabConditions& conditions, const PayloadOptions& options) {
  return options.shovel_radii * conditions.soil.radius_m;
}

/// Returns the distance from rest to rest, with ramps at both ends; one ramp's distance more than at full speed.
double way(const PayloadOptions& options) {
  return options.speed_m_s * (kSteady_s + kStart_s);
}

LabBox boxFor(const LabConditions& conditions, const PayloadOptions& options) {
  LabBox box;
  box.length_m = 2 * edge(conditions, options);
  box.width_m = box.length_m + way(options);
  return box;
}

ToolParameters shovelFor(const LabConditions& conditions, const PayloadOptions& options) {
  ToolParameters shovel = options.shovel;
  shovel.shape = ToolShape::kBox;
  shovel.size_m = {edge(conditions, options), edge(conditions, options), 0.7 * conditions.soil.radius_m};
  return shovel;
}

/// Mean forces on the shovel during a phase.
struct MeanForce {
  double down_n = 0, back_n = 0, mass_kg = 0;
  double change_times_acceleration = 0, mass_acceleration_squared = 0;
  long steps = 0;

  [[nodiscard]] double down() const { return down_n / static_cast<double>(steps); }
  [[nodiscard]] double back() const { return back_n / static_cast<double>(steps); }
  [[nodiscard]] double mass() const { return mass_kg / static_cast<double>(steps); }
};

/// Shovel with its soil.
class Carried {
 public:
  Carried(const LabConditions& conditions, const PayloadOptions& options)
      : conditions_(conditions),
        options_(options),
        start_(-way(options) / 2, 0, kHeightRadii * conditions.soil.radius_m),
        bed_(conditions, boxFor(conditions, options), heapAbove(), {}, shovelFor(conditions, options)) {
    bed_.placeTool({start_, Quat::Identity()});
    trace_.columns = {"time_s", "felt_down_n", "felt_back_n", "weight_n", "speed_m_s", "acceleration_up_m_s2"};
  }

  /// Lets the soil settle on the shovel and on the floor.
  void fill() {
    constexpr double kLongest_s = 10;
    const double at_rest = std::sqrt(2 * conditions_.gravity_m_s2 * conditions_.soil.radius_m / 500);
    const double falling_s = std::sqrt(2 * 2 * start_.z() / conditions_.gravity_m_s2);
    move(falling_s, "soil falls on the shovel", {});
    while (bed_.bed().largestSpeed() > at_rest) {
      move(0.1, "soil falls on the shovel", {});
      if (bed_.time() > kLongest_s + falling_s) {
        throw Failure("the soil on the shovel does not settle");
      }
    }
    if (carried() == 0) {
      throw Failure("no soil stays on the shovel");
    }
  }

  /// Moves the shovel with `velocity`, a function of the time since the phase began.
  MeanForce move(double duration_s, std::string_view what, const std::function<Vec3(double)>& velocity) {
    MeanForce mean;
    const double began = bed_.time();
    Vec3 before = velocity ? velocity(0) : Vec3(Vec3::Zero());
    const auto lead = [&] {
      Vec3 now = velocity ? velocity(bed_.time() - began + bed_.dt()) : Vec3(Vec3::Zero());
      bed_.moveTool({now, Vec3::Zero()});
      return now;
    };
    lead();
    bed_.run(duration_s, what, [&] {
      const Vec3 now = velocity ? velocity(bed_.time() - began) : Vec3(Vec3::Zero());
      note(mean, now, (now.z() - before.z()) / bed_.dt());
      before = now;
      lead();
    });
    return mean;
  }

  [[nodiscard]] std::size_t carried() const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < bed_.soil(); ++i) {
      count += isCarried(i) ? 1 : 0;
    }
    return count;
  }
  /// Returns the mean position of the carried soil along the movement.
  [[nodiscard]] double middle() const {
    double sum = 0;
    for (std::size_t i = 0; i < bed_.soil(); ++i) {
      sum += isCarried(i) ? bed_.centre(i).x() : 0;
    }
    return sum / static_cast<double>(carried());
  }
  [[nodiscard]] double carriedMass() const { return static_cast<double>(carried()) * bed_.bed().mass(); }
  [[nodiscard]] LabTrace& trace() { return trace_; }

 private:
  /// Whether a particle is not on the floor.
  [[nodiscard]] bool isCarried(std::size_t particle) const { return bed_.centre(particle).z() > start_.z() / 2; }

  [[nodiscard]] std::vector<Vec3> heapAbove() const {
    const double tube = 0.35 * edge(conditions_, options_);
    const Vec3 above = start_;
    std::vector<Vec3> soil =
        looseSoil(conditions_.soil, boxFor(conditions_, options_), static_cast<std::size_t>(options_.particles),
                  start_.z() + conditions_.soil.radius_m, conditions_.seed,
                  [above, tube](const Vec3& c) { return (c - above).head<2>().norm() < tube; });
    // Every layer is rotated against the one below, because particles that do not rotate would form stable columns.
    Quat turn = Quat::Identity();
    double height = start_.z();
    for (Vec3& centre : soil) {
      if (centre.z() > height + conditions_.soil.radius_m) {
        turn = turn * Quat(Eigen::AngleAxisd(1, Vec3::UnitZ()));
      }
      height = centre.z();
      centre = above + turn * (centre - above);
    }
    return soil;
  }

  void note(MeanForce& mean, const Vec3& velocity, double acceleration_up) {
    if (bed_.time() >= counted_until_s_) {
      mass_kg_ = carriedMass();
      counted_until_s_ = bed_.time() + kBetweenRows_s;
    }
    const Vec3& force = bed_.toolWrench().force_n;
    const double weight = mass_kg_ * conditions_.gravity_m_s2;
    mean.down_n -= force.z();
    mean.back_n -= force.x();
    mean.mass_kg += mass_kg_;
    mean.change_times_acceleration += (-force.z() - weight) * acceleration_up;
    mean.mass_acceleration_squared += mass_kg_ * acceleration_up * acceleration_up;
    ++mean.steps;

    row_.down_n -= force.z();
    row_.back_n -= force.x();
    row_acceleration_ += acceleration_up;
    if (++row_.steps; static_cast<double>(row_.steps) * bed_.dt() >= kBetweenRows_s) {
      trace_.rows.push_back({bed_.time(), row_.down(), row_.back(), weight, velocity.x(),
                             row_acceleration_ / static_cast<double>(row_.steps)});
      row_ = {};
      row_acceleration_ = 0;
    }
  }

  const LabConditions& conditions_;
  const PayloadOptions& options_;
  Vec3 start_;
  LabBed bed_;
  LabTrace trace_;
  MeanForce row_;
  double row_acceleration_ = 0;
  double mass_kg_ = 0;
  double counted_until_s_ = 0;
};

/// Rises from 0 to 1 within `duration`, with continuous acceleration.
double gently(double t, double duration) {
  return t >= duration ? 1 : t <= 0 ? 0 : (1 - std::cos(std::numbers::pi * t / duration)) / 2;
}

}  // namespace

void validate(const PayloadOptions& options) {
  requireInRange("particles", options.particles, PayloadRanges::particles);
  requireInRange("shovel_radii", options.shovel_radii, {8, 60});
  requireInRange("speed_m_s", options.speed_m_s, {0.01, 0.2});
  requireInRange("shake_g", options.shake_g, {0.01, 0.8});
  requireInRange("shake_hz", options.shake_hz, {0.2, 20});
  validate(options.shovel);
}

PayloadResult payloadTest(const LabConditions& conditions, const PayloadOptions& options) {
  validate(options);
  validate(conditions.soil);
  const double g = conditions.gravity_m_s2;
  requireInRange("gravity_m_s2", g, {0, 1000, Ends::kOpenBelow});
  const double v = options.speed_m_s;
  const double omega = 2 * std::numbers::pi * options.shake_hz;
  const auto sideways = [](double speed) { return Vec3(speed, 0, 0); };
  const auto shaking = [&](double t) {  // amplitude grows over two periods
    return Vec3(0, 0, options.shake_g * g / omega * std::sin(omega * t) * gently(t, 2 / options.shake_hz));
  };

  Carried soil(conditions, options);
  soil.fill();
  PayloadResult result;
  result.carried_kg = soil.carriedMass();
  soil.trace().rows.clear();
  const MeanForce still = soil.move(1, "the shovel stands still", {});
  const double before = soil.middle();
  soil.move(kStart_s, "the shovel starts", [&](double t) { return sideways(v * gently(t, kStart_s)); });
  const MeanForce steady = soil.move(kSteady_s, "the shovel moves", [&](double) { return sideways(v); });
  soil.move(kStart_s, "the shovel stops", [&](double t) { return sideways(v * (1 - gently(t, kStart_s))); });
  soil.move(0.5, "the shovel stands still", {});
  const double after = soil.middle();
  const double periods = std::ceil(options.shake_hz);  // at least a second and one period
  const MeanForce shaken = soil.move((2 + periods) / options.shake_hz, "the shovel is shaken", shaking);

  result.weight_ratio = still.down() / (still.mass() * g);
  result.drag_ratio = steady.back() / (steady.mass() * g);
  result.follow_ratio = (after - before) / way(options);
  result.shake_ratio = shaken.change_times_acceleration / shaken.mass_acceleration_squared;
  result.left_kg = soil.carriedMass();
  result.trace = std::move(soil.trace());
  return result;
}

void drawPayload(const OutputFile& path, const PayloadResult& result, std::string_view title) {
  std::vector<std::vector<double>> rows;
  const double began = result.trace.rows.empty() ? 0 : result.trace.rows.front()[0];
  for (const std::vector<double>& row : result.trace.rows) {
    rows.push_back({row[0] - began, row[1], row[2], row[3], 1e3 * row[4]});
  }
  Figure figure(path, 900, 560);
  figure.data("payload", rows);
  figure.command(
      fmt::format("set title {}; set grid lc '#dddddd'; set key tmargin center horizontal", gnuplotQuoted(title)));
  figure.command(
      "set xlabel 'time / s'; set ylabel 'force / N'; set y2label 'speed / (mm/s)'; set y2tics; "
      "set ytics nomirror; set y2range [0:*]");
  figure.command(fmt::format(
      "plot $payload using 1:2 with lines lw 1.5 lc '#1f6fb4' title 'felt weight ({:.3f} of it; shaken {:.3f})', "
      "$payload using 1:3 with lines lw 1.5 lc '#d2691e' title 'against the movement ({:.3f})', "
      "$payload using 1:4 with lines lw 1.5 dt 2 lc 'black' title 'weight of the soil', "
      "$payload using 1:5 axes x1y2 with lines dt 3 lc '#888888' title 'speed'",
      result.weight_ratio, result.shake_ratio, result.drag_ratio));
  figure.save();
}

}  // namespace haptolith
