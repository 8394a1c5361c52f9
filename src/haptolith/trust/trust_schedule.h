#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/trust/trust_force.h"
#include "haptolith/trust/trust_plan.h"
#include "haptolith/trust/trust_verdict.h"

namespace haptolith {

/// Extent of an examination.
struct TrustExtent {
  static constexpr Range kSpecimens{2, 100};
  static constexpr Range kMinutes{0.1, 1e4};
  static constexpr Range kDuration_s{0.25, 3600};

  double duration_s = 4;  ///< length of the movement
  int specimens = 5;      ///< number for each comparison; 3 where there is no time for more
  double minutes = 30;    ///< time; comparisons that do not fit are left out
  int threads = 1;
  std::vector<std::string> only;  ///< names of changes, "bits", "strength"; empty: all

  [[nodiscard]] bool wants(std::string_view what) const;
};

/// One motion of the scene's hand, or 2 s of a still one.
[[nodiscard]] double usualDuration(const SceneFile& scene);

/// A simulation of the schedule.
struct TrustScheduled {
  std::size_t row = 0;
  TrustRun run;
  double length_s = 0;  ///< approximate, on one thread
};

/// All simulations of an examination. Its rows, the scene's own first, take their results.
struct TrustSchedule {
  std::vector<TrustForces> rows;
  std::vector<TrustScheduled> runs;
};

/// The first run, and a second with another seed, if the soil has one: how long they take decides what fits.
/// @throws Failure for a scene that cannot be examined.
[[nodiscard]] std::vector<TrustRun> firstRuns(const SceneFile& scene);

/// Returns the comparisons that fit into the time, most important first.
/// @param first  results of firstRuns().
[[nodiscard]] TrustSchedule scheduled(const SceneFile& scene, const TrustExtent& extent,
                                      const std::vector<TrustForce>& first);

/// Puts a result in its row.
void take(TrustSchedule& schedule, const TrustScheduled& run, const std::optional<TrustForce>& force,
          const std::string& why_not);

/// The strength that the scene's soil was made for; empty where none is known.
[[nodiscard]] std::optional<SoilTarget> strengthAskedFor(const SceneFile& scene);
/// Whether there is time for its shear test.
[[nodiscard]] bool fitsStrength(const TrustExtent& extent);

/// The whole examination of a scene; the force is that on its first tool. @throws InvalidParameter for an extent or a
/// scene that is not valid; Failure when the scene cannot be simulated, or is cancelled. Not for the tick.
[[nodiscard]] TrustVerdict examined(const SceneFile& scene, const TrustExtent& extent,
                                    const TrustProgress& progress = {});

}  // namespace haptolith
