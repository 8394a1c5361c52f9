#include "haptolith/soil/soil_parameters.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "haptolith/core/error.h"
#include "haptolith/core/math/portable_math.h"

namespace haptolith {

std::vector<SoilNumber> soilNumbersBy(int SoilNumber::*place) {
  std::vector<SoilNumber> numbers;
  std::ranges::copy_if(kSoilNumbers, std::back_inserter(numbers), [&](const SoilNumber& n) { return n.*place > 0; });
  std::ranges::sort(numbers, {}, place);
  return numbers;
}

void validate(const SoilParameters& soil) {
  for (const SoilNumber& number : kSoilNumbers) {
    Range valid = number.valid;
    if (number.member == &SoilParameters::rho_max_kg_m3) {
      // Any rho_max above rho0 puts a_min (paper 8) between 2R/sqrt(3) and 2R, which is a valid law.
      valid.lowest = soil.rho0_kg_m3;
    }
    const double value = soil.*number.member;
    const bool unlimited = number.member == &SoilParameters::stiffness_n_m && std::isinf(value) && value > 0;
    if (!unlimited) {
      requireInRange(number.key, value, valid);
    }
  }
}

double macroparticleMass(const SoilParameters& soil) {
  return 4 * std::sqrt(2.0) * soil.rho0_kg_m3 * portable::cube(soil.radius_m);
}

SoilParameters rescaled(SoilParameters soil, double radius_m) {
  const double scale = radius_m / soil.radius_m;
  for (const SoilNumber& number : kSoilNumbers) {
    double factor = 1;
    for (int i = 0; i < number.radius_power; ++i) {
      factor *= scale;
    }
    soil.*number.member *= factor;
  }
  soil.radius_m = radius_m;
  return soil;
}

}  // namespace haptolith
