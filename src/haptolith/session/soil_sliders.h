#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "haptolith/scene_file/scene_file.h"
#include "haptolith/soil/contact_strength.h"
#include "haptolith/soil/soil_parameters.h"

namespace haptolith {

/// A number of the soil that can be changed without a new bed.
struct SoilSlider {
  std::string_view key, label, unit;
  double value = 0, low = 0, high = 1, step = 0.01;
};

/// The soil with contact friction and cohesion of another.
[[nodiscard]] SoilParameters withContactsOf(SoilParameters soil, const SoilParameters& other);

/// Change of the soil's strength with its contacts; empty when it has no name, was calibrated for another
/// model of friction, or differs from the calibrated soil in more than contact friction and cohesion.
[[nodiscard]] std::optional<CalibratedStrength> calibrationOf(const SceneFile& scene_file);

/// Numbers of this soil that can be changed: friction angle and cohesion, with ICRA 2021 friction those that (paper
/// 17, 18) give, with contact friction those of its calibration; without one, friction and cohesion of a contact.
[[nodiscard]] std::vector<SoilSlider> slidersOf(const SoilParameters& soil,
                                                const std::optional<CalibratedStrength>& calibration = {});

/// The soil with one slider moved; those of a contact can also be moved where slidersOf() shows angle and cohesion.
/// @throws InvalidParameter for a key that this soil has not, or a value out of range.
[[nodiscard]] SoilParameters withSlider(SoilParameters soil, std::string_view key, double value,
                                        const std::optional<CalibratedStrength>& calibration = {});

}  // namespace haptolith
