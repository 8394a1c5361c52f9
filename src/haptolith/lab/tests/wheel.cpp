#include "haptolith/lab/tests/wheel.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/statistics.h"
#include "haptolith/core/turn.h"
#include "haptolith/figure/figure.h"
#include "haptolith/lab/staged_progress.h"

namespace haptolith {

namespace {

constexpr double kBehindRadii = 0.6;    // soil behind the wheel at the start
constexpr double kAheadRadii = 1.6;     // soil ahead of the wheel at the end
constexpr double kSteadyChange = 0.03;  // of the radius
constexpr double kRightAngle = std::numbers::pi / 2;

double radiusOf(const WheelOptions& options) {
  return options.wheel.diameter_m / 2;
}

/// Returns the distance from the axle to the lowest point.
double lowestOf(const WheelOptions& options) {
  return radiusOf(options) + (options.wheel.grousers > 0 ? options.wheel.grouser_height_m : 0);
}

double depthOf(const WheelOptions& options) {
  return options.bed_depth_m > 0 ? options.bed_depth_m : options.wheel.diameter_m;
}

/// Returns the box for all settings, with the wheel's path along x.
LabBox wheelBox(const WheelOptions& options) {
  const double reach_m = lowestOf(options);
  const double room_m = options.side_room_m > 0 ? options.side_room_m : 0.75 * options.wheel.diameter_m;
  double across_m = 0;
  double along_m = 0;
  for (const WheelSetting& setting : options.settings) {
    const double sine = std::abs(std::sin(setting.slip_angle_rad));
    const double cosine = std::abs(std::cos(setting.slip_angle_rad));
    across_m = std::max(across_m, 2 * reach_m * sine + options.wheel.width_m * cosine);
    along_m = std::max(along_m, 2 * reach_m * cosine + options.wheel.width_m * sine);
  }
  LabBox box;
  box.width_m = along_m + options.travel_m + (kBehindRadii + kAheadRadii) * reach_m;
  box.length_m = across_m + 2 * room_m;
  return box;
}

/// Returns the speed of travel.
double speedFor(const WheelOptions& options, double slip) {
  return slip > 0 ? std::min(options.travel_m_s, (1 - slip) * options.max_rim_m_s) : options.travel_m_s;
}

double rimSpeed(double travel_m_s, double slip) {
  return slip == -1 ? 0 : travel_m_s / travelOverRim(slip);
}

WheelPoint::Resistive atSinkage(const WheelOptions& options, const ToolParameters& tool, const WheelSetting& setting,
                                const ResistiveSoil& soil, double sinkage_m) {
  constexpr int kAnglesOfPitch = 6;
  const int angles = options.wheel.grousers > 0 ? kAnglesOfPitch : 1;
  const Quat heading = turnAbout(Vec3::UnitZ(), setting.slip_angle_rad);
  const Vec3 forwards = heading * Vec3::UnitX();
  const Vec3 left = heading * Vec3::UnitY();
  const Quat hub = heading * turnAbout(Vec3::UnitX(), -kRightAngle);
  const double speed_m_s = speedFor(options, setting.slip);
  const Twist twist{speed_m_s * Vec3::UnitX(), rimSpeed(speed_m_s, setting.slip) / radiusOf(options) * left};
  const Vec3 axle_m(0, 0, soil.surface_m + radiusOf(options) - sinkage_m);
  WheelPoint::Resistive sum{.sinkage_m = sinkage_m};
  for (int i = 0; i < angles; ++i) {
    const double angle = options.wheel.grousers > 0 ? 2 * std::numbers::pi * i / angles / options.wheel.grousers : 0;
    const Wrench wrench = resistiveForce(tool, 0, {axle_m, hub * turnAbout(Vec3::UnitZ(), angle)}, twist, soil);
    sum.vertical_n += wrench.force_n.z() / angles;
    sum.drawbar_n += wrench.force_n.dot(forwards) / angles;
    sum.side_n += wrench.force_n.dot(left) / angles;
    sum.torque_nm -= wrench.torque_nm.dot(left) / angles;
  }
  return sum;
}

std::optional<WheelForces> bekkerWheel(const WheelOptions& options, const WheelSetting& setting) {
  if (options.plate.modulus <= 0 || options.friction_angle_rad <= 0 || options.wheel.grousers > 0 ||
      setting.slip_angle_rad != 0) {
    return std::nullopt;
  }
  RigidWheel wheel;
  wheel.radius_m = radiusOf(options);
  wheel.width_m = options.wheel.width_m;
  wheel.modulus = options.plate.modulus;
  wheel.exponent = options.plate.exponent;
  wheel.friction_angle_rad = std::min(options.friction_angle_rad, std::atan(options.wheel.friction));
  try {
    return options.sinkage_m > 0 ? rigidWheelForces(wheel, setting.slip, options.sinkage_m)
                                 : rigidWheelUnderLoad(wheel, setting.slip, setting.load_n);
  } catch (const InvalidParameter&) {
    return std::nullopt;  // too deep for the theory: the simulated result is still valid
  }
}

WheelRun runFor(const LabConditions& conditions, const WheelOptions& options, const WheelSetting& setting,
                const LabBox& box, double along_m) {
  WheelRun run;
  run.radius_m = radiusOf(options);
  run.below_m = lowestOf(options);
  run.slip_angle_rad = setting.slip_angle_rad;
  run.travel_m_s = speedFor(options, setting.slip);
  run.travel_m = options.travel_m;
  run.drive = rimSpeed(run.travel_m_s, setting.slip) / run.radius_m;
  run.sinkage_m = options.sinkage_m;
  if (options.sinkage_m == 0) {
    run.load_n = setting.load_n;
    run.mass_kg = options.mass_kg > 0 ? options.mass_kg : setting.load_n / conditions.gravity_m_s2;
  }
  run.start_x_m = -box.width_m / 2 + kBehindRadii * run.below_m + along_m / 2;
  return run;
}

WheelPoint pointOf(const WheelOptions& options, const WheelSetting& setting, const WheelRun& run,
                   const std::vector<WheelReading>& readings) {
  const auto first = std::ranges::find_if(
      readings, [&](const WheelReading& reading) { return reading.travel_m >= options.steady_from * run.travel_m; });
  const std::span<const WheelReading> steady(first, readings.end());
  WheelPoint point;
  point.setting = setting;
  point.travel_m_s = run.travel_m_s;
  point.rim_m_s = meanOf(steady, &WheelReading::rim_m_s).value;
  point.drawbar_n = meanOf(steady, &WheelReading::drawbar_n);
  point.side_n = meanOf(steady, &WheelReading::side_n);
  point.vertical_n = meanOf(steady, &WheelReading::vertical_n);
  point.torque_nm = meanOf(steady, &WheelReading::torque_nm);
  point.sinkage_m = meanOf(steady, &WheelReading::sinkage_m);
  const auto half = steady.size() / 2;
  point.sinkage_change_m = meanOf(steady.subspan(half), &WheelReading::sinkage_m).value -
                           meanOf(steady.first(half), &WheelReading::sinkage_m).value;
  point.is_steady = std::abs(point.sinkage_change_m) <= kSteadyChange * run.radius_m;
  return point;
}

bool sameSign(double a, double b) {
  return (a > 0) == (b > 0);
}

}  // namespace

void validate(const LabConditions& conditions, const WheelOptions& options) {
  validate(conditions.soil);
  requireInRange("gravity_m_s2", conditions.gravity_m_s2, {0, 1000, Ends::kOpenBelow});
  validate(options.wheel, conditions.soil);
  if (options.settings.empty()) {
    throw InvalidParameter("slip", "none", "one or more");
  }
  for (const WheelSetting& setting : options.settings) {
    requireInRange("slip", setting.slip, {-1, 0.95});
    requireInRange("slip_angle_rad", setting.slip_angle_rad, {-kRightAngle, kRightAngle});
    if (options.sinkage_m == 0) {
      requireInRange("load_n", setting.load_n, {0, 1e5, Ends::kOpenBelow});
    }
  }
  requireInRange("sinkage_m", options.sinkage_m, {0, options.wheel.diameter_m});
  requireInRange("mass_kg", options.mass_kg, {0, 1e5});
  requireInRange("travel_m_s", options.travel_m_s, {0, 1, Ends::kOpenBelow});
  requireInRange("max_rim_m_s", options.max_rim_m_s, {0, 10, Ends::kOpenBelow});
  requireInRange("travel_m", options.travel_m, {0.02, 10});
  requireInRange("steady_from", options.steady_from, {0.1, 0.9});
  const double shallowest_m = options.sinkage_m + lowestOf(options) - radiusOf(options) + 2 * conditions.soil.radius_m;
  requireInRange("bed_depth_m", depthOf(options), {shallowest_m, 10});
  requireInRange("side_room_m", options.side_room_m, {0, 10});
  requireInRange("friction_angle_rad", options.friction_angle_rad, {0, std::numbers::pi / 3});
  requireInRange("plate_modulus", options.plate.modulus, {0, 1e12});
  requireInRange("plate_exponent", options.plate.exponent, {0.05, 5});
  const LabBox box = wheelBox(options);
  (void)particlesFor(conditions.soil, box.width_m * box.length_m * depthOf(options));
}

std::optional<WheelPoint::Resistive> resistiveWheel(const WheelOptions& options, const ToolParameters& tool,
                                                    const WheelSetting& setting, const ResistiveSoil& soil) {
  if (options.sinkage_m > 0) {
    return atSinkage(options, tool, setting, soil, options.sinkage_m);
  }
  constexpr int kHalvings = 25;
  double above_m = 0;
  double below_m = 2 * radiusOf(options);
  if (atSinkage(options, tool, setting, soil, below_m).vertical_n < setting.load_n) {
    return std::nullopt;
  }
  for (int i = 0; i < kHalvings; ++i) {
    const double middle_m = (above_m + below_m) / 2;
    (atSinkage(options, tool, setting, soil, middle_m).vertical_n < setting.load_n ? above_m : below_m) = middle_m;
  }
  return atSinkage(options, tool, setting, soil, below_m);
}

WheelResult wheelTest(const LabConditions& conditions, const WheelOptions& options) {
  validate(conditions, options);
  const LabBox box = wheelBox(options);
  const ToolParameters tool = wheelTool(options.wheel, conditions.soil);
  StagedProgress progress(conditions.progress);
  LabConditions staged = conditions;
  staged.progress = progress.inner();

  constexpr double kSettles = 0.15;  // fraction of the test's time
  progress.enter(0, kSettles);
  const std::size_t particles = particlesFor(conditions.soil, box.width_m * box.length_m * depthOf(options));
  std::vector<Vec3> centres;
  {
    LabBed bed(staged, box, looseSoil(conditions.soil, box, particles, 0, conditions.seed, {}, options.preparation));
    bed.settle(options.preparation);
    centres = bed.soilCentres();
  }

  WheelResult result;
  result.radius_m = radiusOf(options);
  result.particles = centres.size();
  result.trace.columns = {"slip",   "slip_angle_deg", "travel_m",  "drawbar_n",
                          "side_n", "vertical_n",     "torque_nm", "sinkage_m"};
  ResistiveSoil resistive;
  for (std::size_t i = 0; i < options.settings.size(); ++i) {
    const WheelSetting& setting = options.settings[i];
    const auto share = [&](double done) {
      return kSettles + (1 - kSettles) * (static_cast<double>(i) + done) / static_cast<double>(options.settings.size());
    };
    progress.enter(share(0), share(0.1));
    LabBed bed(staged, box, centres, {}, tool);
    constexpr double kFarAbove_m = 100;
    bed.placeTool({{0, 0, kFarAbove_m}, Quat::Identity()});
    bed.driveJoint(0);
    bed.settle(Preparation::kLoose);  // the springs of friction have to load again
    const double surface_m = bed.surfaceHeight(options.depth_from);
    if (i == 0) {
      result.bed_depth_m = surface_m;
      result.bulk_density_kg_m3 = bed.bulkDensity(0.2 * surface_m, 0.8 * surface_m);
      resistive.gravity_m_s2 = conditions.gravity_m_s2;
      resistive.density_kg_m3 = result.bulk_density_kg_m3;
      resistive.internal_friction = std::tan(options.friction_angle_rad);
    }
    progress.enter(share(0.1), share(1));
    const double along_m = 2 * lowestOf(options) * std::abs(std::cos(setting.slip_angle_rad)) +
                           options.wheel.width_m * std::abs(std::sin(setting.slip_angle_rad));
    WheelRun run = runFor(conditions, options, setting, box, along_m);
    run.tool = tool;
    run.surface_m = surface_m;
    const std::vector<WheelReading> readings = runWheel(bed, run);
    result.points.push_back(pointOf(options, setting, run, readings));
    if (options.friction_angle_rad > 0) {
      result.points.back().resistive = resistiveWheel(options, tool, setting, resistive);
    }
    result.points.back().bekker = bekkerWheel(options, setting);
    for (const WheelReading& reading : readings) {
      result.trace.rows.push_back({setting.slip, setting.slip_angle_rad * 180 / std::numbers::pi, reading.travel_m,
                                   reading.drawbar_n, reading.side_n, reading.vertical_n, reading.torque_nm,
                                   reading.sinkage_m});
    }
  }
  return result;
}

WheelComparison compareWheel(const std::vector<MeasuredWheel>& measured, const std::vector<WheelEstimate>& estimates) {
  if (measured.size() != estimates.size() || measured.empty()) {
    throw InvalidParameter("estimates", fmt::format("{}", estimates.size()), "one per measurement, one or more");
  }
  constexpr double kSlipping = 0.21;  // beyond 0.2, whatever its last digit
  constexpr double kSinkage = 0.35;
  WheelComparison comparison;
  comparison.points = measured.size();
  std::vector<double> drawbar;
  std::vector<double> side;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const MeasuredWheel& reference = measured[i];
    const WheelEstimate& estimate = estimates[i];
    drawbar.push_back(std::abs(estimate.drawbar_n - reference.drawbar_n) / reference.setting.load_n);
    side.push_back(std::abs(estimate.side_n - reference.side_n) / reference.setting.load_n);
    comparison.sinkage_within +=
        std::abs(estimate.sinkage_m - reference.sinkage_m) <= kSinkage * reference.sinkage_m ? 1 : 0;
    if (std::abs(reference.setting.slip) > kSlipping) {
      ++comparison.slipping;
      comparison.drawbar_sign += sameSign(estimate.drawbar_n, reference.drawbar_n) ? 1 : 0;
      comparison.side_sign += sameSign(estimate.side_n, reference.side_n) ? 1 : 0;
    }
  }
  comparison.drawbar_error = median(drawbar);
  comparison.side_error = median(side);
  comparison.sinkage_within /= static_cast<double>(measured.size());
  comparison.drawbar_sign /= static_cast<double>(comparison.slipping);
  comparison.side_sign /= static_cast<double>(comparison.slipping);
  return comparison;
}

void drawWheel(const OutputFile& file, const WheelResult& result, std::string_view title,
               const std::vector<MeasuredWheel>& measured) {
  constexpr std::array kColours{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#555555"};
  std::map<double, std::vector<const WheelPoint*>> by_angle;
  for (const WheelPoint& point : result.points) {
    by_angle[point.setting.slip_angle_rad].push_back(&point);
  }
  Figure figure(file, 1100, 800);
  const auto scaled = [&](double load_n, double drawbar_n, double side_n, double torque_nm, double sinkage_m) {
    return std::vector<double>{drawbar_n / load_n, side_n / load_n, torque_nm / load_n / result.radius_m,
                               sinkage_m / result.radius_m};
  };
  std::vector<std::string> names;
  std::size_t index = 0;
  std::vector<bool> has_theory;
  std::vector<bool> has_measured;
  for (const auto& [angle_rad, points] : by_angle) {
    std::vector<std::vector<double>> rows;
    std::vector<std::vector<double>> theory;
    std::vector<std::vector<double>> references;
    const auto row = [](double slip, std::vector<double> values) {
      values.insert(values.begin(), slip);
      return values;
    };
    for (const WheelPoint* point : points) {
      const double load_n = point->vertical_n.value;
      rows.push_back(row(point->setting.slip, scaled(load_n, point->drawbar_n.value, point->side_n.value,
                                                     point->torque_nm.value, point->sinkage_m.value)));
      if (const auto& rft = point->resistive) {
        theory.push_back(row(point->setting.slip,
                             scaled(rft->vertical_n, rft->drawbar_n, rft->side_n, rft->torque_nm, rft->sinkage_m)));
      }
    }
    for (const MeasuredWheel& reference : measured) {
      if (std::abs(reference.setting.slip_angle_rad - angle_rad) < 1e-6) {
        references.push_back({reference.setting.slip, reference.drawbar_n / reference.setting.load_n,
                              reference.side_n / reference.setting.load_n, std::nan(""),
                              reference.sinkage_m / result.radius_m});
      }
    }
    figure.data(fmt::format("wheel{}", index), rows);
    has_theory.push_back(!theory.empty());
    has_measured.push_back(!references.empty());
    if (!theory.empty()) {
      figure.data(fmt::format("theory{}", index), theory);
    }
    if (!references.empty()) {
      figure.data(fmt::format("measured{}", index), references);
    }
    names.push_back(fmt::format("{:.3g}°", angle_rad * 180 / std::numbers::pi));
    ++index;
  }
  figure.command(fmt::format("set multiplot layout 2,2 title {}", gnuplotQuoted(title)));
  constexpr std::array kQuantities{"drawbar pull / load", "side force / load", "torque / (load r)", "sinkage / r"};
  for (std::size_t quantity = 0; quantity < kQuantities.size(); ++quantity) {
    figure.command(fmt::format("set xlabel 'slip'; set ylabel '{}'; set key {}", kQuantities.at(quantity),
                               quantity == 0 ? "outside top center horizontal" : "off"));
    std::string plot = "plot ";
    for (std::size_t i = 0; i < names.size(); ++i) {
      const char* colour = kColours.at(i % kColours.size());
      plot += fmt::format("{}$wheel{} using 1:{} with linespoints pointtype 7 linewidth 2 linecolor rgb '{}' title {}",
                          i == 0 ? "" : ", ", i, quantity + 2, colour, gnuplotQuoted(names[i]));
      if (has_theory[i]) {
        plot += fmt::format(", $theory{} using 1:{} with lines dashtype (6,5) linecolor rgb '{}' title '{}'", i,
                            quantity + 2, colour, i == 0 ? "resistive force theory" : "");
      }
      if (has_measured[i] && quantity != 2) {
        plot += fmt::format(", $measured{} using 1:{} with points pointtype 6 linecolor rgb '{}' title '{}'", i,
                            quantity + 2, colour, i == 0 ? "measured" : "");
      }
    }
    figure.command(plot);
  }
  figure.command("unset multiplot");
  figure.save();
}

}  // namespace haptolith
