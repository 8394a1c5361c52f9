#pragma once

#include <string_view>
#include <vector>

#include "haptolith/soil/soil_parameters.h"

namespace haptolith {

/// A number of the soil that can be changed while the soil lies there.
struct SoilSlider {
  std::string_view key, label, unit;
  double value = 0, low = 0, high = 1, step = 0.01;
};

/// What can be changed of this soil: with the paper's friction the friction angle and cohesion that (paper 17, 18)
/// give, with pairwise friction those of a contact.
[[nodiscard]] std::vector<SoilSlider> slidersOf(const SoilParameters& soil);

/// The soil with one slider moved. @throws InvalidParameter for a key that this soil has not, or a value out of range.
[[nodiscard]] SoilParameters withSlider(SoilParameters soil, std::string_view key, double value);

}  // namespace haptolith
