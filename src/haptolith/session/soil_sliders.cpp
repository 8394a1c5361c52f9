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
#include "haptolith/core/math/portable_math.h"
#include "haptolith/scene_file/soil_file.h"
#include "haptolith/soil/strength.h"

namespace haptolith {

namespace {

constexpr double kDegree = std::numbers::pi / 180;

constexpr std::string_view kFrictionAngle = "friction_angle_deg";
constexpr std::string_view kCohesion = "cohesion_pa";

/// The cohesion of (paper 18) if the law allows it, else none: it diverges for soil that cannot be compacted so far.
double icra2021Cohesion(const SoilParameters& soil) {
  try {
    return cohesion(soil);
  } catch (const InvalidParameter&) {
    return 0;
  }
}

/// A number that depends on the radius scales with it, and leaves room above its present value.
double highestOf(const SoilNumber& number, const SoilParameters& soil) {
  constexpr double kRadiusOfControls_m = 7e-3;
  double highest = number.control.highest;
  for (int i = 0; i < number.radius_power; ++i) {
    highest *= soil.radius_m / kRadiusOfControls_m;
  }
  const bool scales = number.radius_power != 0;
  return scales ? std::max(highest, 2 * soil.*number.member / number.control.unit_si) : highest;
}

std::vector<SoilSlider> numberSliders(const SoilParameters& soil) {
  std::vector<SoilSlider> sliders;
  for (const SoilNumber& number : kSoilNumbers) {
    const SoilControl& control = number.control;
    if (!control.key.empty() && number.isUsedBy(soil.friction)) {
      const double highest = highestOf(number, soil);
      sliders.push_back(
          {control.key, control.label, control.unit, soil.*number.member / control.unit_si, 0, highest, highest / 200});
    }
  }
  return sliders;
}

}  // namespace

SoilParameters withContactsOf(SoilParameters soil, const SoilParameters& other) {
  for (const SoilNumber& number : kSoilNumbers) {
    if (!number.control.key.empty()) {
      soil.*number.member = other.*number.member;
    }
  }
  return soil;
}

std::optional<CalibratedStrength> calibrationOf(const SceneFile& scene_file) {
  const SoilParameters& soil = scene_file.bed.soil;
  if (scene_file.soil_name.empty() || soil.friction != FrictionModel::kContact) {
    return std::nullopt;
  }
  try {
    const SoilFile file = findSoil(scene_file.soil_name);
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
    return numberSliders(soil);
  }
  const double angle_deg = frictionAngle(frictionCoefficient(soil.mu_hat)) / kDegree;
  std::vector<SoilSlider> sliders{{kFrictionAngle, "friction angle", "°", angle_deg, 1, 70, 0.5}};
  if (const double now_pa = icra2021Cohesion(soil); now_pa > 0) {
    sliders.push_back({kCohesion, "cohesion", "Pa", now_pa, 10, std::max(3000.0, 2 * now_pa), 10});
  }
  return sliders;
}

SoilParameters withSlider(SoilParameters soil, std::string_view key, double value,
                          const std::optional<CalibratedStrength>& calibration) {
  std::vector<SoilSlider> sliders = slidersOf(soil, calibration);
  if (soil.friction == FrictionModel::kContact && calibration) {
    std::ranges::copy(numberSliders(soil), std::back_inserter(sliders));
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
    const double kept_pa = icra2021Cohesion(soil);
    soil.mu_hat = modelFriction(portable::tan(value * kDegree));
    soil.gamma_nm *= kept_pa > 0 ? kept_pa / icra2021Cohesion(soil) : 1;
  } else if (key == kCohesion) {
    soil.gamma_nm *= value / icra2021Cohesion(soil);
  } else {
    const auto is_key = [&](const SoilNumber& number) { return number.control.key == key; };
    const SoilNumber& number = *std::ranges::find_if(kSoilNumbers, is_key);
    soil.*number.member = value * number.control.unit_si;
  }
  return soil;
}

}  // namespace haptolith
