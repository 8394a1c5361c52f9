#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "haptolith/scene/force_band.h"
#include "haptolith/trust/trust_force.h"

namespace haptolith {

/// One window of 0.25 s in a trial of the band (forceRange()).
struct BandWindow {
  MeanForce mean;          ///< one specimen
  double reference_n = 0;  ///< mean force of two others with particles half as large
  double particle_n = 0;   ///< weight and cohesion of a particle of the specimen
  ForceRange band;         ///< for the specimen
  [[nodiscard]] bool holds() const noexcept { return reference_n >= band.low_n && reference_n <= band.high_n; }
};

/// A bed, tool and movement of random numbers: one of the named soils with R = 4 mm, on the Moon, Mars or Earth, and a
/// sphere, plate or blade 4 to 10 R wide that presses, stirs, cuts, scoops, shakes or draws furrows for 1.5 to 3 s. The
/// same on every machine. Beds of numbers within the same 150 differ in soil only, others also in their seed.
[[nodiscard]] SceneFile bandScene(std::uint64_t number);

/// Name of the soil and movement of a trial's scene: "toyoura, cut".
[[nodiscard]] std::string bandSceneName(const SceneFile& scene);

/// Windows of a trial in which the specimen or the others meet more than half of the force of one particle. Takes 2 to
/// 600 s of one core, mostly for settling; that is cached. Not for the tick. @throws Failure when it is cancelled.
[[nodiscard]] std::vector<BandWindow> bandTrial(const SceneFile& scene, int threads,
                                                const TrustProgress& progress = {});

}  // namespace haptolith
