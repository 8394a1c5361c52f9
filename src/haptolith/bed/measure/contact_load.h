#pragma once

#include <span>
#include <vector>

#include "haptolith/bed/bed_parameters.h"
#include "haptolith/bed/bed_state.h"

namespace haptolith {

/// Load of each particle by its neighbours: the sum of the normal forces of its contacts, attraction left
/// out, in N; one per particle. A picture of force chains; the sum of vectors would be no more than a particle's
/// weight. Not for the tick.
/// @param positions  m; w is by how much a particle's radius exceeds the mean, as in BedState.
[[nodiscard]] std::vector<float> contactLoads(const BedParameters& bed, std::span<const Float4> positions);

}  // namespace haptolith
