#pragma once

#include <cstdint>

#include "haptolith/core/vec.h"
#include "haptolith/soil/soil_parameters.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// Soil of a training, with its conditions for the tool.
struct SoilSample {
  SoilParameters soil;
  double tool_friction = 0.36;  ///< tan(delta)
  double tool_adhesion_n = 0;   ///< adhesion of a contact, as ToolParameters::adhesion_n
  double surface_error_m = 0;   ///< actual height of the surface minus the assumed one
  double stone_size_m = 0;      ///< size of a stone in the probe's path (stonePlace()); 0: no stone
};

/// Returns the centre of the stone, in m from the centre of the surface.
[[nodiscard]] inline Vec3 stonePlace() {
  return {-0.06, 0.032, -0.02};
}

/// Ranges of uniform distributions that samples are drawn from; uniform in the logarithm where stated.
struct SampleRanges {
  Range contact_friction;    ///< 0.12 to 0.6 gives friction angles of about 20 to 48 degrees
  Range contact_cohesion_n;  ///< cohesion of contacts for R = 7 mm, logarithmic; one soil in seven has none
  Range tool_friction;
  Range adhesion_share;  ///< tool adhesion over the contacts' cohesion
  Range density_kg_m3;   ///< rho0
  Range radius_m;
  Range stiffness_n_m;  ///< for R = 7 mm, logarithmic
  Range size_spread;
  Range tangential_ratio;
  Range cohesion_range_ratio;
  Range surface_error_m;
  Range damping_ratio;
  Range gamma_times;  ///< factor of the contacts' stiffening, logarithmic
};

inline constexpr SampleRanges kNearRanges{.contact_friction{0.12, 0.6},
                                          .contact_cohesion_n{0.004, 0.6},
                                          .tool_friction{0.1, 0.7},
                                          .adhesion_share{0, 0.3},
                                          .density_kg_m3{1250, 1750},
                                          .radius_m{5e-3, 7e-3},
                                          .stiffness_n_m{2000, 8000},
                                          .size_spread{0.1, 0.3},
                                          .tangential_ratio{0.3, 0.8},
                                          .cohesion_range_ratio{0.2, 0.5},
                                          .surface_error_m{-1e-3, 1e-3},
                                          .damping_ratio{0.2, 0.2},
                                          .gamma_times{1, 1}};

inline constexpr SampleRanges kWideRanges{.contact_friction{0.15, 0.55},
                                          .contact_cohesion_n{0.006, 0.5},
                                          .tool_friction{0.1, 0.7},
                                          .adhesion_share{0, 0.5},
                                          .density_kg_m3{1200, 1800},
                                          .radius_m{4.5e-3, 7.5e-3},
                                          .stiffness_n_m{1500, 12'000},
                                          .size_spread{0.05, 0.3},
                                          .tangential_ratio{0.2, 1},
                                          .cohesion_range_ratio{0.15, 0.5},
                                          .surface_error_m{-1.5e-3, 1.5e-3},
                                          .damping_ratio{0.1, 0.4},
                                          .gamma_times{0.3, 3}};

/// Returns soil `number` of two unlimited sequences of soils with different strength and kind: size, spread and
/// stiffness of particles, stiffening and cohesion range of contacts, damping, density. From kWideNumbers the kinds are
/// more diverse, and every tenth soil has a stone. Equal on every machine.
[[nodiscard]] SoilSample soilSample(std::uint64_t number);
inline constexpr std::uint64_t kWideNumbers = 1'000'000;

/// Returns the number of a training's soil at `place`, from 1: first kNearSoils of the less diverse soils, then the odd
/// ones of the more diverse soils. hiddenNumber() returns that of a soil that is in no training.
inline constexpr std::uint64_t kNearSoils = 96;
[[nodiscard]] constexpr std::uint64_t trainingNumber(std::uint64_t place) noexcept {
  return place <= kNearSoils ? place : kWideNumbers + 2 * (place - kNearSoils) - 1;
}
[[nodiscard]] constexpr std::uint64_t hiddenNumber(std::uint64_t place) noexcept {
  return kWideNumbers + 2 * place;
}

}  // namespace haptolith
