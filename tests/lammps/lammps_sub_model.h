#pragma once

#include <array>
#include <vector>

namespace haptolith {

/// Two grains, or a grain and a wall, as LAMMPS hands them to a sub-model.
struct SubModelContact {
  bool wall = false;
  double radii_m = 0;                ///< both together; of a wall the grain's
  double distance_m = 0;             ///< distance of the centres, or from the wall; along x
  double parting_m_s = 0;            ///< speed apart
  std::array<double, 3> slip_m_s{};  ///< across x
  double dt_s = 0;
};

struct SubModelForce {
  bool touches = false;
  double normal_n = 0;
  std::array<double, 3> across_n{};
};

/// Evaluates extras/lammps for a contact with LAMMPS' headers. @param stretch  memory of the contact, updated.
[[nodiscard]] SubModelForce subModelForce(const std::vector<double>& normal, const std::vector<double>& across,
                                          const SubModelContact& contact, std::array<double, 3>& stretch);

}  // namespace haptolith
