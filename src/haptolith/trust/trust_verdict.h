#pragma once

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/trust/trust_force.h"
#include "haptolith/trust/trust_plan.h"

namespace haptolith {

/// A relative number with its standard error.
struct TrustShift {
  double value = 0;  ///< 0.1: 10 % more
  double error = 0;
};

/// Effect of a change on the force: mean over specimens of the force with it over the force without, minus 1.
struct TrustEffect {
  TrustChange change = TrustChange::kNone;
  double radius_ratio = 1;
  TrustShift mean{}, peak{};
  std::size_t specimens = 0;  ///< 0: not simulated
  std::string why_not;        ///< why not
};

/// The forces of one change, specimen by specimen.
struct TrustForces {
  TrustChange change = TrustChange::kNone;
  double radius_ratio = 1;
  std::vector<std::optional<TrustForce>> specimens;  ///< by number; empty: no result
  std::string why_not;
};

/// Room in the box as lengths over those that rules of soil mechanics ask for; at least 1 is enough.
struct TrustRoom {
  double floor = 1;   ///< soil below the tool over the depth that it disturbs
  double wall_x = 1;  ///< distance from the walls over the length of a passive wedge
  double wall_y = 1;
  double grains = 1;  ///< tool's second largest edge over 8 particle diameters
};

/// Extent to which the force of a scene's movement can be believed.
struct TrustVerdict {
  double mean_n = 0, peak_n = 0;          ///< over specimens
  TrustShift scatter_mean, scatter_peak;  ///< value: SD of one specimen over the mean
  std::vector<TrustEffect> effects;
  TrustRoom room;
  TrustReach reach;
  std::optional<TrustStrength> strength;
  std::optional<TrustShift> stress_ratio;   ///< TrustForce::stress_ratio: mean of the specimens, and its error
  double within_mean = 0, within_peak = 0;  ///< relative bounds: see bound()
  double expected_mean = 0;                 ///< expected change of the mean force by a larger box and half the radius
  std::vector<std::string> complaints;      ///< "the box is too narrow along y"
  std::vector<std::string> close;           ///< "the floor": closer than rules allow, but not felt
  std::string sentence;
};

/// The bound of a relative deviation at 90 %: what the changes did, beyond their own errors, and the scatter of one
/// specimen and of the mean that it is compared with,
///
///     b = sqrt(sum max(0, d_i^2 - e_i^2)) + t sqrt(s^2 (1 + 1/n) + sum e_i^2 over the changes of box and radius),
///
/// with Student's t for n - 1 degrees of freedom (one-sided 95 %). The effect of another radius counts as that of
/// particles half as large, by a straight line in R.
/// @param peak  of the peak instead of the mean force.
[[nodiscard]] double bound(const TrustVerdict& verdict, std::size_t specimens, bool peak);

/// Judges the forces; the first are those of the scene itself, with at least 2 specimens.
/// @throws InvalidParameter for fewer.
[[nodiscard]] TrustVerdict judgeTrust(const SceneFile& scene, const std::vector<TrustForces>& forces,
                                      const std::optional<TrustStrength>& strength = {});

/// The table of a verdict, and the sentence above it.
[[nodiscard]] std::string trustText(const TrustVerdict& verdict);
[[nodiscard]] nlohmann::ordered_json trustJson(const TrustVerdict& verdict);

/// Draws the effects with their errors, mean and peak. @throws as Figure.
void drawTrust(const OutputFile& file, const TrustVerdict& verdict, std::string_view title);

}  // namespace haptolith
