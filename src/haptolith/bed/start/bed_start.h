#pragma once

#include <vector>

#include "haptolith/bed/bed_parameters.h"
#include "haptolith/bed/bed_state.h"

namespace haptolith {

/// Centres of the particles of a bed that is about to start, in m, lowest layer first.
///
/// kPacked: close packing, layers spaced as the analysis (paper 6) puts them under their own weight. kCount: the same
/// with exactly `particles` in `layers` layers; where the undeformed packing has fewer places, it is squeezed sideways
/// as little as possible, and places left over are taken from the rim of the top layer. kRain: loosely above the floor,
/// to be settled. None for kSettled, which bed_tile.h makes, and kGiven.
/// @throws InvalidParameter when the particles do not fit.
[[nodiscard]] std::vector<Vec3> startingCentres(const BedParameters& bed);

/// Excess of the largest particle's radius over the mean, in m, in the coarsest class.
[[nodiscard]] double largestExcess(const SoilParameters& soil);

/// Centres with sizes as the seed deals them out.
[[nodiscard]] std::vector<Float4> withSizes(const BedParameters& bed, const std::vector<Vec3>& centres_m);

/// Height of the highest centre above the floor, in m; 0 without any.
[[nodiscard]] double highestCentre(const std::vector<Float4>& grains);

/// Returns the bed as a packed sandbox for about that number of particles: half as deep as wide, but no deeper than a
/// hand reaches.
[[nodiscard]] BedParameters withRoomFor(int particles, BedParameters bed);

/// With contact friction only contacts damp; soil that falls, or slides to the walls when it is laid, settles
/// sooner in a viscous medium: a drag that stops free movement within about 0.2 s and lets soil fall at
/// g / 5 s. Soil at rest does not feel it.
inline constexpr float kSettlingDrag_per_s = 5;

/// Simulated time, in s, after which soil that has fallen and still moves is given up.
inline constexpr double kLongestSettling_s = 60;

/// Soil that falls by `fall_m` at the speed that the drag leaves it has to be there in time, and to calm down.
/// @throws InvalidParameter with the least gravity for one that is weaker, and above 0.
void requireGravityToSettle(const BedParameters& bed, double fall_m);

}  // namespace haptolith
