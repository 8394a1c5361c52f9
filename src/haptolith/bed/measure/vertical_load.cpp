#include "haptolith/bed/measure/vertical_load.h"

#include <cstddef>
#include <cstdint>

#include "haptolith/bed/measure/apart.h"
#include "haptolith/core/assert.h"
#include "haptolith/soil/contact_law.h"

namespace haptolith {

VerticalLoad verticalLoad(const Bed& bed, double height_m) {
  HAPTO_ASSERT(grainClasses(bed.parameters()) == 1);
  const BedParameters& parameters = bed.parameters();
  const SoilParameters& soil = parameters.soil;
  const ContactLaw law = makeContactLaw(soil);
  const double tangential_n_m = soil.tangential_ratio * soil.stiffness_n_m;
  const BedState& state = bed.state();
  const ContactLists& lists = state.contacts;
  // Slip of i against j. A contact with a sleeping group is kept by the other side.
  const auto slipped = [&](std::size_t i, std::size_t j, std::uint32_t s) -> double {
    if (!state.asleep(i / kGroup)) {
      return lists.slip(i, s).z;
    }
    const std::uint32_t back = j < state.particles() ? lists.find(j, static_cast<std::int32_t>(i)) : lists.count(j);
    return back < lists.count(j) ? -static_cast<double>(lists.slip(j, back).z) : lists.slip(i, s).z;
  };
  VerticalLoad load;
  std::size_t above = 0;
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    if (state.position[i].z < height_m) {
      continue;
    }
    ++above;
    for (std::uint32_t s = 0; s < lists.count(i); ++s) {
      const auto j = static_cast<std::size_t>(lists.neighbour(i, s));
      if (state.position[j].z >= height_m) {
        continue;
      }
      const Vec3 apart_m = apart(parameters, state.position[i], state.position[j]);
      const double distance_m = apart_m.norm();
      const double force_n = contactForce(law, distance_m - state.position[i].w - state.position[j].w);
      load.carried_n += force_n * apart_m.z() / distance_m - tangential_n_m * slipped(i, j, s);
    }
  }
  load.weight_n = static_cast<double>(above) * macroparticleMass(soil) * -parameters.gravity_m_s2.z();
  return load;
}

}  // namespace haptolith
