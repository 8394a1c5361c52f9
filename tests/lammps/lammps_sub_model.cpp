// Includes LAMMPS' headers and none of haptolith's. Only the bases of the granular sub-models are linked from LAMMPS:
// what else they would call is never reached.

#include "lammps_sub_model.h"

#include <algorithm>
#include <cstddef>
#include <memory>

#include "gran_sub_mod_haptolith.h"
#include "granular_model.h"

namespace haptolith {

namespace {

using namespace LAMMPS_NS;
using namespace LAMMPS_NS::Granular_NS;

/// An object of LAMMPS without construction, all zeros: its constructor would need all of LAMMPS.
template <class Thing>
class Unmade {
 public:
  [[nodiscard]] Thing* get() { return reinterpret_cast<Thing*>(bytes_); }

 private:
  alignas(Thing) std::byte bytes_[sizeof(Thing)] = {};
};

}  // namespace

SubModelForce subModelForce(const std::vector<double>& normal, const std::vector<double>& across,
                            const SubModelContact& contact, std::array<double, 3>& stretch) {
  const auto lammps = std::make_unique<Unmade<LAMMPS>>();
  const auto unmade = std::make_unique<Unmade<GranularModel>>();
  GranularModel& model = *unmade->get();
  model.contact_type = contact.wall ? WALL : PAIR;
  model.dt = contact.dt_s;
  model.history = stretch.data();
  model.history_update = 1;
  model.radsum = contact.radii_m;
  model.r = contact.distance_m;
  model.rsq = contact.distance_m * contact.distance_m;
  model.delta = contact.radii_m - contact.distance_m;
  model.nx[0] = 1;
  model.vnnr = contact.parting_m_s;
  std::ranges::copy(contact.slip_m_s, model.vtr);

  GranSubModNormalHaptolith along(&model, lammps->get());
  along.allocate_coeffs();
  std::ranges::copy(normal, along.coeffs);
  along.coeffs_to_local();
  GranSubModTangentialHaptolith aside(&model, lammps->get());
  aside.allocate_coeffs();
  std::ranges::copy(across, aside.coeffs);
  aside.coeffs_to_local();
  model.normal_model = &along;

  SubModelForce force;
  force.touches = along.touch();
  force.normal_n = along.calculate_forces();
  along.set_fncrit();
  aside.calculate_forces();
  std::ranges::copy(model.fs, force.across_n.begin());
  return force;
}

}  // namespace haptolith
