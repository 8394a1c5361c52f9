#include "haptolith/session/soil_sliders.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <iterator>
#include <numbers>
#include <string>

#include "haptolith/core/error.h"
#include "haptolith/scenario/soil_file.h"
#include "haptolith/soil/strength.h"

namespace haptolith {

namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kMilli = 1e-3;

constexpr std::string_view kFrictionAngle = "friction_angle_deg";
constexpr std::string_view kCohesion = "cohesion_pa";
constexpr std::string_view kContactFriction = "contact_friction";
constexpr std::string_view kContactCohesion = "contact_cohesion_mn";

/// In mN. Contacts of P3 and its like hold together with some of those; stress at equal relative size goes with R^2.
double strongestCohesion(const SoilParameters& soil) {
  constexpr double kOfP3_mn = 10;
  constexpr double kRadiusOfP3_m = 7e-3;
  const double ratio = soil.radius_m / kRadiusOfP3_m;
  return std::max(kOfP3_mn * ratio * ratio, 2 * soil.contact_cohesion_n / kMilli);
}

/// The cohesion of (paper 18) if the law allows it, else none: it diverges for soil that cannot be compacted so far.
double paperCohesion(const SoilParameters& soil) {
  try {
    return cohesion(soil);
  } catch (const InvalidParameter&) {
    return 0;
  }
}

std::vector<SoilSlider> contactSliders(const SoilParameters& soil) {
  const double strongest = strongestCohesion(soil);
  return {
      {kContactFriction, "contact friction", "", soil.contact_friction, 0, 2, 0.01},
      {kContactCohesion, "contact cohesion", "mN", soil.contact_cohesion_n / kMilli, 0, strongest, strongest / 200}};
}

}  // namespace

SoilParameters withContactsOf(SoilParameters soil, const SoilParameters& other) {
  soil.contact_friction = other.contact_friction;
  soil.contact_cohesion_n = other.contact_cohesion_n;
  return soil;
}

std::optional<CalibratedStrength> calibrationOf(const Scenario& scenario) {
  const SoilParameters& soil = scenario.bed.soil;
  if (scenario.soil_name.empty() || soil.friction != FrictionModel::kContact) {
    return std::nullopt;
  }
  try {
    const SoilFile file = findSoil(scenario.soil_name);
    const SoilParameters calibrated = rescaled(file.soil, soil.radius_m);
    return withContactsOf(calibrated, soil) == soil ? std::optional(CalibratedStrength(calibrated, file.target))
                                                    : std::nullopt;
  } catch (const std::exception&) {  // a file that has gone: nothing is known of its soil
    return std::nullopt;
  }
}

std::vector<SoilSlider> slidersOf(const SoilParameters& soil, const std::optional<CalibratedStrength>& calibration) {
  if (soil.friction == FrictionModel::kContact && calibration) {
    const ShearStrength now = calibration->of(soil);
    const Range angles_deg = calibration->anglesFor(soil);
    const Range cohesions_pa = calibration->cohesionsFor(soil);
    return {{kFrictionAngle, "friction angle", "°", now.angle_deg, angles_deg.lowest, angles_deg.highest, 0.5},
            {kCohesion, "cohesion", "Pa", now.cohesion_pa, cohesions_pa.lowest, cohesions_pa.highest, 10}};
  }
  if (soil.friction == FrictionModel::kContact) {
    return contactSliders(soil);
  }
  const double angle_deg = frictionAngle(frictionCoefficient(soil.mu_hat)) / kDegree;
  std::vector<SoilSlider> sliders{{kFrictionAngle, "friction angle", "°", angle_deg, 1, 70, 0.5}};
  if (const double now_pa = paperCohesion(soil); now_pa > 0) {
    sliders.push_back({kCohesion, "cohesion", "Pa", now_pa, 10, std::max(3000.0, 2 * now_pa), 10});
  }
  return sliders;
}

SoilParameters withSlider(SoilParameters soil, std::string_view key, double value,
                          const std::optional<CalibratedStrength>& calibration) {
  std::vector<SoilSlider> sliders = slidersOf(soil, calibration);
  if (soil.friction == FrictionModel::kContact && calibration) {
    std::ranges::copy(contactSliders(soil), std::back_inserter(sliders));
  }
  const auto slider = std::ranges::find(sliders, key, &SoilSlider::key);
  if (slider == sliders.end()) {
    std::vector<std::string_view> keys;
    std::ranges::transform(sliders, std::back_inserter(keys), &SoilSlider::key);
    throw InvalidParameter("sliders", std::string(key), fmt::format("{}", fmt::join(keys, " or ")));
  }
  requireInRange(key, value, {slider->low, slider->high});
  if (soil.friction == FrictionModel::kContact && (key == kFrictionAngle || key == kCohesion)) {
    ShearStrength wanted = calibration->of(soil);
    (key == kFrictionAngle ? wanted.angle_deg : wanted.cohesion_pa) = value;
    soil = calibration->with(soil, wanted);
  } else if (key == kFrictionAngle) {
    // (paper 18) has friction in it: cohesion is kept as it was.
    const double kept_pa = paperCohesion(soil);
    soil.mu_hat = modelFriction(std::tan(value * kDegree));
    soil.gamma_nm *= kept_pa > 0 ? kept_pa / paperCohesion(soil) : 1;
  } else if (key == kCohesion) {
    soil.gamma_nm *= value / paperCohesion(soil);
  } else if (key == kContactFriction) {
    soil.contact_friction = value;
  } else if (key == kContactCohesion) {
    soil.contact_cohesion_n = value * kMilli;
  } else {
    throw InvalidParameter("sliders", std::string(key), "a slider that this function knows how to set");
  }
  return soil;
}

}  // namespace haptolith
