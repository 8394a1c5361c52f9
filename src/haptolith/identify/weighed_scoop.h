#pragma once

#include <optional>
#include <span>

#include "haptolith/core/error.h"
#include "haptolith/identify/belief_sample.h"
#include "haptolith/identify/measured_movement.h"

namespace haptolith {

/// Number with the standard deviation of its error.
struct Uncertain {
  double value = 0, error = 0;
};

inline constexpr Range kScoopVolume_m3{1e-7, 1};

/// Periods in which a scoop was held at rest in the air, on the time axis of the samples.
struct ScoopWeighing {
  Range empty_s, full_s;
  std::optional<Range> empty_again_s;  ///< period after it was emptied
  double drift_n_s = 0;                ///< SD of the sensor's zero drift per second
};

/// Mass in a scoop.
struct ScoopMass {
  Uncertain mass_kg;
  double freedom = 0;  ///< degrees of freedom of its error
};

/// Returns the mass in a scoop, from the mean vertical force of the soil on it:
///
///     m = (F_z(empty) - F_z(full)) / g
///
/// F_z(empty) is interpolated to the time of F_z(full) between both empty periods. With only one it is that value, with
/// the drift as its error. Noise may be correlated between readings. So the error of a mean is that of the means of ten
/// equal parts of its period (batch means: Law and Kelton, Simulation Modeling and Analysis). This holds if each part
/// is longer than the correlation.
/// @throws InvalidParameter if the scoop was held for less than half a second, with fewer than a hundred samples, or
/// moved by 1 mm or 1 degree meanwhile; also for periods without samples, or full and empty periods that overlap.
[[nodiscard]] ScoopMass weighScoop(std::span<const MeasuredSample> samples, const ScoopWeighing& weighing,
                                   double gravity_m_s2);

/// Returns the 90 % interval of the mass, in kg.
[[nodiscard]] SoilEstimate massOf(const ScoopMass& scoop);

/// @throws Failure if that interval includes 0 or less, because the scoop may be empty.
void requireMeasurable(const ScoopMass& scoop);

/// Returns the density of soil that fills a volume, in kg/m^3, with its 90 % interval: all rho for which m - rho V does
/// not differ significantly from 0 (Fieller, J. R. Stat. Soc. B 16, 1954).
/// @throws InvalidParameter for a volume outside kScoopVolume_m3, or with a relative error above 0.5; Failure as
/// requireMeasurable().
[[nodiscard]] SoilEstimate densityOf(const ScoopMass& scoop, const Uncertain& volume_m3);

}  // namespace haptolith
