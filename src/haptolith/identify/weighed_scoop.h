#pragma once

#include <optional>
#include <span>

#include "haptolith/core/error.h"
#include "haptolith/identify/belief_sample.h"
#include "haptolith/identify/measured_movement.h"

namespace haptolith {

/// A number with the standard deviation of its error.
struct Uncertain {
  double value = 0, error = 0;
};

inline constexpr Range kScoopVolume_m3{1e-7, 1};

/// When a scoop was held still in the air, by the times of the samples.
struct ScoopWeighing {
  Range empty_s, full_s;
  std::optional<Range> empty_again_s;  ///< after it was emptied
  double drift_n_s = 0;                ///< standard deviation of what the sensor's zero wanders in a second
};

/// What a scoop holds.
struct ScoopMass {
  Uncertain mass_kg;
  double freedom = 0;  ///< degrees of freedom of its error
};

/// The mass that is in a scoop, from the mean vertical force of the soil on it:
///
///     m = (F_z(empty) - F_z(full)) / g
///
/// F_z(empty) at the time of F_z(full): between both times when it was empty evenly, else that of the only one, off by
/// the drift. Noise may be alike from reading to reading: a mean's error is that of the means of ten equal parts of its
/// time (batch means: Law and Kelton, Simulation Modeling and Analysis), as long as each is longer than that.
/// @throws InvalidParameter where the scoop was held for less than half a second, or measured less than a hundred
/// times, or moved by 1 mm or 1 degree meanwhile, and for times that were not measured, or of full and empty at once.
[[nodiscard]] ScoopMass weighScoop(std::span<const MeasuredSample> samples, const ScoopWeighing& weighing,
                                   double gravity_m_s2);

/// An interval of 90 % for the mass, in kg.
[[nodiscard]] SoilEstimate massOf(const ScoopMass& scoop);

/// @throws Failure where that interval reaches 0 or less: the scoop may be as full as it was empty.
void requireMeasurable(const ScoopMass& scoop);

/// Density of what fills a volume, in kg/m^3: all rho for which m - rho V is not further from 0 than chance takes it
/// nine times in ten (Fieller, J. R. Stat. Soc. B 16, 1954).
/// @throws InvalidParameter for a volume outside kScoopVolume_m3, or not known to half of itself; Failure as
/// requireMeasurable().
[[nodiscard]] SoilEstimate densityOf(const ScoopMass& scoop, const Uncertain& volume_m3);

}  // namespace haptolith
