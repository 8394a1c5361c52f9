#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>

#include "haptolith/bed/start/ready_tile.h"
#include "haptolith/haptics/loop_parameters.h"
#include "haptolith/scene/scene.h"

namespace haptolith {

/// Limit of the 99th percentile of ticks in a trial, in us of a thousand. The rest is for a browser that shares caches
/// and cores, for long stirring, and for a host that takes the processor away. On two virtual cores of a shared Zen 3,
/// 0.05 to 0.7 % of ticks took too long uninterrupted with R = 4 mm, which trials put at 549 to 720 us, and at most
/// 0.07 % with R = 4.4 mm (490 to 550 us).
inline constexpr double kFinestTick_us = 520;

/// Measured cost of particles of one size.
struct GrainTrial {
  double radius_m = 0;
  std::size_t grains = 0;  ///< approximate number
  int substeps = 0;        ///< per tick
  int threads = 1;         ///< that shared a tick
  double tick_us_p99 = 0;  ///< predicted; infinite where no machine could do it
};

/// Result of a search among particle sizes.
struct FinestGrain {
  GrainTrial chosen;                   ///< the finest within kFinestTick_us, or the coarsest when none is
  std::optional<GrainTrial> too_slow;  ///< the coarsest that was tried and is not
  [[nodiscard]] bool holds() const noexcept { return chosen.tick_us_p99 <= kFinestTick_us; }
};

/// The finest of `radii_m`, coarse to fine, whose trial stays within kFinestTick_us, where a finer one costs more:
/// found by halves. @throws what `trial` throws.
[[nodiscard]] FinestGrain finestOf(std::span<const double> radii_m,
                                   const std::function<GrainTrial(double radius_m)>& trial);

/// The finest particles of kGrainRadii_m that this machine holds in the box of `bed`: the tool stirs a close packing of
/// each size that is tried, all of it awake, for a quarter of a second on a thread set up as the loop's, in step with
/// the clock. Each number of threads is tried; the fewest that hold the finest particles are chosen. Takes about a
/// second for one number of threads. Not for the tick.
/// @param threads  numbers of threads to choose from, ascending; one at least.
/// @throws InvalidParameter when the bed can be made of no such grains; Failure when `stop` becomes true.
[[nodiscard]] FinestGrain finestGrain(const BedParameters& bed, const ToolParameters& tool, const LoopParameters& loop,
                                      std::span<const int> threads, const std::atomic<bool>& stop);

}  // namespace haptolith
