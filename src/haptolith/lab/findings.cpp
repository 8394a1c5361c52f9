#include "haptolith/lab/findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "haptolith/soil/bodies.h"
#include "haptolith/soil/lunar_density.h"

namespace haptolith {

namespace {

constexpr double kMm = 1e-3;
constexpr double kDensityTolerance = 0.05;  // of the soil's own target

double degrees(double radians) {
  return radians * 180 / std::numbers::pi;
}

Verdict verdict(bool passes) {
  return passes ? Verdict::kPass : Verdict::kFail;
}

/// A finding that should be `wanted` within `tolerance`.
Finding near(std::string measured, std::string target, std::string value, double difference, double tolerance) {
  return {std::move(measured), std::move(target), std::move(value), verdict(std::abs(difference) <= tolerance)};
}

/// Down to which depth a target's density is the mean.
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
    std::string value = fmt::format("{:.0f} kg/m³", band.density_kg_m3);
    if (lunar && measured != measuredBands().end()) {
      found.push_back(near(
          std::move(what),
          fmt::format("{:.0f} ± {:.0f} kg/m³ (Lunar Sourcebook)", measured->density_kg_m3, measured->tolerance_kg_m3),
          std::move(value), band.density_kg_m3 - measured->density_kg_m3, measured->tolerance_kg_m3));
    } else if (target && band.top_m == upperBand().top_m && band.bottom_m == upperBand().bottom_m) {
      const double wanted = target->bulk_density_kg_m3;
      found.push_back(near(std::move(what), fmt::format("{:g} kg/m³ ± {:.0f} %", wanted, 100 * kDensityTolerance),
                           std::move(value), band.density_kg_m3 / wanted - 1, kDensityTolerance));
    } else {
      found.push_back({std::move(what), "", std::move(value)});
    }
  }
  return found;
}

std::vector<Finding> findings(const ShearResult& result, const std::optional<SoilTarget>& target) {
  const auto angle = [](const MohrCoulomb& fit) { return fmt::format("{:.1f}°", degrees(fit.friction_angle_rad)); };
  const auto cohesion = [](const MohrCoulomb& fit) { return fmt::format("{:.0f} Pa", fit.cohesion_pa); };
  std::vector<Finding> found{{"residual friction angle", "", angle(result.residual)},
                             {"residual cohesion", "", cohesion(result.residual)},
                             {"peak friction angle", "", angle(result.peak)},
                             {"peak cohesion", "", cohesion(result.peak)}};
  if (target) {
    const std::size_t first = target->strength == SoilStrength::kPeak ? 2 : 0;
    const MohrCoulomb& fit = first == 2 ? result.peak : result.residual;
    const double wanted = target->friction_angle_deg;
    const double wanted_pa = target->cohesion_pa;
    const double tolerance = std::max(50.0, 0.2 * wanted_pa);
    found[first].target = fmt::format("{:g} ± 2°", wanted);
    found[first].verdict = verdict(std::abs(degrees(fit.friction_angle_rad) - wanted) <= 2);
    found[first + 1].target = fmt::format("{:g} ± {:g} Pa", wanted_pa, tolerance);
    found[first + 1].verdict = verdict(std::abs(fit.cohesion_pa - wanted_pa) <= tolerance);
  }
  return found;
}

std::vector<Finding> findings(const ReposeResult& result, const std::optional<SoilTarget>& target) {
  std::string value = fmt::format("{:.1f}°", degrees(result.angle_rad));
  // A soil that has cohesion is another one without it: nobody knows what it should show.
  if (!target || target->cohesion_pa != 0) {
    return {{"angle of repose, without cohesion", "", std::move(value)}};
  }
  const double wanted = target->friction_angle_deg;
  return {near("angle of repose", fmt::format("residual friction angle {:g} ± 3°", wanted), std::move(value),
               degrees(result.angle_rad) - wanted, 3)};
}

std::vector<Finding> findings(const CutResult& result, double height_m, const std::optional<SoilTarget>& target) {
  const bool cohesive = target && target->cohesion_pa >= 100;
  return {{fmt::format("vertical cut of {:.0f} mm", height_m / kMm),
           cohesive ? "stands, as the astronauts' trenches did" : "falls, without cohesion",
           result.stands ? "stands" : fmt::format("{:.0f} % of the height is left", 100 * result.height_kept),
           target ? verdict(result.stands == cohesive) : Verdict::kInfo}};
}

std::vector<Finding> findings(const PlateResult& result, double diameter_m) {
  return {{fmt::format("pressure of a {:.0f} mm plate, p = k z^n", diameter_m / kMm), "",
           fmt::format("k = {:.3g} Pa/m^n, n = {:.2f}", result.fit.modulus, result.fit.exponent)}};
}

std::vector<Finding> findings(const ConeResult& result) {
  return {{"cone index", "",
           fmt::format("{:.3g} kPa, {:.3g} kPa/m", result.cone_index_pa / 1e3, result.gradient_pa_m / 1e3)}};
}

std::vector<Finding> findings(const BladeResult& result, const std::optional<SoilTarget>& target) {
  const double ratio = result.draft_n / result.earthmoving_draft_n;
  Finding draft =
      near(fmt::format("draft of a blade {:.0f} mm wide, {:.0f} mm deep", result.width_m / kMm, result.depth_m / kMm),
           fmt::format("{:.3g} N ± 40 % (earthmoving equation)", result.earthmoving_draft_n),
           fmt::format("{:.3g} N ({:.2f} of it)", result.draft_n, ratio), ratio - 1, 0.4);
  if (!target) {
    draft.verdict = Verdict::kInfo;
  }
  return {draft};
}

std::vector<Finding> findings(const FunnelResult& result) {
  double widest_clogged = 0;
  double narrowest_running = 1e9;
  for (const FunnelPoint& point : result.points) {
    const double diameters = point.opening_m / result.particle_diameter_m;
    if (point.clogged) {
      widest_clogged = std::max(widest_clogged, diameters);
    } else {
      narrowest_running = std::min(narrowest_running, diameters);
    }
  }
  return {near("discharge exponent", "2.5 ± 0.3 (Beverloo 1961)", fmt::format("{:.2f}", result.fit.exponent),
               result.fit.exponent - 2.5, 0.3),
          {"clogs", "below about 4 particle diameters, not above 8",
           widest_clogged > 0 ? fmt::format("up to {:.1f} diameters", widest_clogged) : "never",
           verdict(widest_clogged > 0 && widest_clogged <= 8 && narrowest_running >= 3)}};
}

std::vector<Finding> findings(const CarryResult& result) {
  return {near("weight felt over weight", "1 ± 3 % (Newton)", fmt::format("{:.3f}", result.weight_ratio),
               result.weight_ratio - 1, 0.03),
          near("drag felt over weight, 0.1 m/s", "below 3 % (Newton)", fmt::format("{:.3f}", result.drag_ratio),
               result.drag_ratio, 0.03)};
}

std::vector<Finding> findings(const FallResult& result) {
  return {near("acceleration of a falling clump over g", "1 ± 0.1 % (Newton)",
               fmt::format("{:.5f}", result.acceleration_ratio), result.acceleration_ratio - 1, 0.001)};
}

}  // namespace haptolith
