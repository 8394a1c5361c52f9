#include "haptolith/lab/report/findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "haptolith/soil/bodies.h"
#include "haptolith/soil/lunar_density.h"

namespace haptolith {

namespace {

constexpr double kOneMm_m = 1e-3;
constexpr double kDensityTolerance = 0.05;  // fraction of the soil's target

double degreesFound(double radians) {
  return radians * 180 / std::numbers::pi;
}

/// Returns the range `wanted` +- `tolerance`.
Range near(double wanted, double tolerance) {
  return {wanted - tolerance, wanted + tolerance};
}

Finding angleOf(std::string measured, double angle_deg) {
  return {std::move(measured), "", angle_deg, "°", 1};
}

Finding cohesionOf(std::string measured, double cohesion_pa) {
  return {std::move(measured), "", cohesion_pa, " Pa"};
}

/// Sets target and tolerance from the measured strength of the soil.
void judge(Finding& angle, Finding& cohesion, const SoilTarget& target) {
  const double wanted_deg = target.friction_angle_deg;
  const double wanted_pa = target.cohesion_pa;
  const double tolerance_pa = std::max(50.0, 0.2 * wanted_pa);
  angle.target = fmt::format("{:g} ± 2°", wanted_deg);
  angle.accepted = near(wanted_deg, 2);
  cohesion.target = fmt::format("{:g} ± {:g} Pa", wanted_pa, tolerance_pa);
  cohesion.accepted = near(wanted_pa, tolerance_pa);
}

/// Sets target and tolerance from the measured density of the soil.
void judge(Finding& density, const SoilTarget& target) {
  const double wanted = target.bulk_density_kg_m3;
  density.target = fmt::format("{:g} kg/m³ ± {:.0f} %", wanted, 100 * kDensityTolerance);
  density.accepted = near(wanted, kDensityTolerance * wanted);
}

/// Returns the range of depth over which a target's density is the mean.
const MeasuredBand& upperBand() {
  return measuredBands().front();
}

}  // namespace

bool isLunar(double gravity_m_s2, const std::optional<SoilTarget>& target) {
  const bool on_the_moon = std::abs(gravity_m_s2 / findBody("Moon").gravity_m_s2 - 1) < 0.01;
  const MeasuredBand& upper = upperBand();
  return on_the_moon &&
         (!target || std::abs(target->bulk_density_kg_m3 - upper.density_kg_m3) <= upper.tolerance_kg_m3);
}

std::vector<Finding> findings(const SettleResult& result, double gravity_m_s2,
                              const std::optional<SoilTarget>& target) {
  const bool lunar = isLunar(gravity_m_s2, target);
  std::vector<Finding> found;
  for (const SettledBand& band : result.bands) {
    const auto measured = std::ranges::find_if(
        measuredBands(), [&](const MeasuredBand& m) { return m.top_m == band.top_m && m.bottom_m == band.bottom_m; });
    std::string what = fmt::format("density {:.0f} - {:.0f} cm", band.top_m * 100, band.bottom_m * 100);
    Finding finding{std::move(what), "", band.density_kg_m3, " kg/m³"};
    if (lunar && measured != measuredBands().end()) {
      finding.target =
          fmt::format("{:.0f} ± {:.0f} kg/m³ (Lunar Sourcebook)", measured->density_kg_m3, measured->tolerance_kg_m3);
      finding.accepted = near(measured->density_kg_m3, measured->tolerance_kg_m3);
    } else if (target && band.top_m == upperBand().top_m && band.bottom_m == upperBand().bottom_m) {
      judge(finding, *target);
    }
    found.push_back(std::move(finding));
  }
  return found;
}

std::vector<Finding> findings(const ShearResult& result, const std::optional<SoilTarget>& target) {
  std::vector<Finding> found{angleOf("residual friction angle", degreesFound(result.residual.friction_angle_rad)),
                             cohesionOf("residual cohesion", result.residual.cohesion_pa),
                             angleOf("peak friction angle", degreesFound(result.peak.friction_angle_rad)),
                             cohesionOf("peak cohesion", result.peak.cohesion_pa)};
  if (target) {
    const std::size_t first = target->strength == SoilStrength::kPeak ? 2 : 0;
    judge(found[first], found[first + 1], *target);
  }
  return found;
}

std::vector<Finding> findings(const SoilReached& reached, const SoilTarget& target) {
  const std::string strength = target.strength == SoilStrength::kPeak ? "peak" : "residual";
  std::vector<Finding> found{angleOf(strength + " friction angle", reached.friction_angle_deg),
                             cohesionOf(strength + " cohesion", reached.cohesion_pa),
                             {"density of the upper 15 cm", "", reached.bulk_density_kg_m3, " kg/m³"}};
  judge(found[0], found[1], target);
  judge(found[2], target);
  return found;
}

std::vector<Finding> findings(const ReposeResult& result, const std::optional<SoilTarget>& target) {
  Finding angle{"angle of repose, without cohesion", "", degreesFound(result.angle_rad), "°", 1};
  // A cohesive soil without its cohesion is a different soil, for which no target exists.
  if (target && target->cohesion_pa == 0) {
    angle.measured = "angle of repose";
    angle.target = fmt::format("residual friction angle {:g} ± 3°", target->friction_angle_deg);
    angle.accepted = near(target->friction_angle_deg, 3);
  }
  return {angle};
}

std::vector<Finding> findings(const VerticalCutResult& result, double height_m,
                              const std::optional<SoilTarget>& target) {
  const bool cohesive = target && target->cohesion_pa >= 100;
  const double standing = 100 * kStandingCut;
  Finding kept{fmt::format("vertical cut of {:.0f} mm: height that is left", height_m / kOneMm_m),
               cohesive ? fmt::format("{:.0f} % or more: it stands, as the astronauts' trenches did", standing)
                        : fmt::format("less than {:.0f} %: it falls, without cohesion", standing),
               100 * result.height_kept, " %"};
  if (target) {
    kept.accepted = cohesive ? Range{.lowest = standing} : Range{.highest = standing, .ends = Ends::kOpen};
  }
  return {kept};
}

std::vector<Finding> findings(const PlateResult& result, double diameter_m) {
  return {{fmt::format("pressure of a {:.0f} mm plate, p = k z^n: k", diameter_m / kOneMm_m), "",
           result.fit.modulus / 1e3, " kPa/m^n", 1},
          {"and n", "", result.fit.exponent, "", 2}};
}

std::vector<Finding> findings(const ConeResult& result) {
  return {{"cone index", "", result.cone_index_pa / 1e3, " kPa", 2},
          {"increase of the cone's resistance with depth", "", result.gradient_pa_m / 1e3, " kPa/m", 1}};
}

std::vector<Finding> findings(const BladeResult& result, const std::optional<SoilTarget>& target) {
  // Its depth is measured, so that it differs between specimens, whose findings have to have equal names.
  Finding draft{fmt::format("draft of a blade {:.0f} mm wide", result.width_m / kOneMm_m), "", result.draft_n, " N", 2};
  const BladeEquations& heaped = result.expected_heaped.undisturbed;
  const double with_heap_n = heaped.wedge ? heaped.wedge->draft_n : heaped.earthmoving.draft_n;
  Finding ratio{fmt::format("draft on its front over that of {}, under the heap before it",
                            heaped.wedge ? "a wedge with crescents" : "the earthmoving equation"),
                "1 ± 40 %", result.front_draft_n / with_heap_n, "", 2};
  if (target) {
    ratio.accepted = near(1, 0.4);
  }
  std::vector<Finding> all{draft, ratio};
  all.push_back({"draft over that of the earthmoving equation", "",
                 result.draft_n / result.expected.undisturbed.earthmoving.draft_n, "", 2});
  const auto over_wedges = [&](const BladeEquations& equations, std::string_view strength) {
    if (equations.upright_wedge) {
      all.push_back({fmt::format("draft over that of a wedge between upright sides{}", strength), "",
                     result.draft_n / equations.upright_wedge->draft_n, "", 2});
    }
    if (equations.wedge) {
      all.push_back({fmt::format("draft over that of a wedge with crescents{}", strength), "",
                     result.draft_n / equations.wedge->draft_n, "", 2});
    }
  };
  over_wedges(result.expected.undisturbed, "");
  if (result.expected.residual) {
    over_wedges(*result.expected.residual, ", residual strength");
  }
  return all;
}

std::vector<Finding> findings(const HopperResult& result) {
  double widest_clogged = 0;
  double narrowest_running = std::numeric_limits<double>::infinity();
  for (const HopperPoint& point : result.points) {
    const double diameters = point.opening_m / result.particle_diameter_m;
    if (point.clogged) {
      widest_clogged = std::max(widest_clogged, diameters);
    } else {
      narrowest_running = std::min(narrowest_running, diameters);
    }
  }
  const auto or_none = [](double number) {
    return number > 0 && std::isfinite(number) ? number : std::numeric_limits<double>::quiet_NaN();
  };
  return {{"discharge exponent", "2.5 ± 0.3 (Beverloo 1961)", or_none(result.fit.exponent), "", 2, near(2.5, 0.3)},
          {"widest opening that clogs", "there is one, not above 8 particle diameters", or_none(widest_clogged),
           " diameters", 1, Range{.highest = 8}},
          {"narrowest opening that does not clog", "there is one, not below 3 particle diameters",
           or_none(narrowest_running), " diameters", 1, Range{.lowest = 3}}};
}

std::vector<Finding> findings(const PayloadResult& result) {
  return {{"weight felt over weight", "1 ± 3 % (Newton)", result.weight_ratio, "", 3, near(1, 0.03)},
          {"drag felt over weight, 0.1 m/s", "below 3 % (Newton)", result.drag_ratio, "", 3, near(0, 0.03)}};
}

std::vector<Finding> findings(const FreeFallResult& result) {
  return {{"acceleration of a falling clump over g", "1 ± 0.1 % (Newton)", result.acceleration_ratio, "", 5,
           near(1, 0.001)}};
}

}  // namespace haptolith
