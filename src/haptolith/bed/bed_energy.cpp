#include <cmath>
#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/bed/start/bed_tile.h"
#include "haptolith/soil/contact_law.h"

namespace haptolith {

double Bed::energy() const {
  double energy = 0;
  const std::size_t n = particles();
  const auto at = [this](std::size_t i) {
    const Float4& p = state_.position[i];
    return Vec3(p.x, p.y, p.z);
  };
  const auto cohering = [this](ContactLaw law, double ratio) {
    law.cohesion_n *= (friction_on_ ? 1 : 0) * ratio;
    return law;
  };
  const int classes = this->classes().count();
  const auto index = [classes](int a, int b) {
    return static_cast<std::size_t>(classes) * static_cast<std::size_t>(a) + static_cast<std::size_t>(b);
  };
  std::vector<ContactLaw> pairs;
  for (int k = 0; k < classes * classes; ++k) {
    const ContactLaw law =
        classes == 1 ? laws_.pair : makeContactLaw(soilBetween(parameters_.soil, k / classes, k % classes));
    pairs.push_back(cohering(law, 1));
  }
  const auto law_between = [&](int a, int b) -> const ContactFrictionLaw& {
    return laws_.graded.between[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)];
  };
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 x = at(i);
    const Float4& v = state_.velocity[i];
    const int own = classOf(i);
    const double mass_kg = laws_.mass_kg * GrainClasses::scale(3 * own);
    energy += mass_kg / 2 * Vec3(v.x, v.y, v.z).squaredNorm() - mass_kg * parameters_.gravity_m_s2.dot(x);
    // Half of a pair's: the mirror image moves as far as the particle.
    const double radius_m = GrainClasses::scale(own) * parameters_.soil.radius_m;
    const ContactLaw floor = wallLaw(pairs[index(own, own)], radius_m);
    ContactLaw side_wall = floor;
    side_wall.cohesion_n *= wallRatio(parameters_);
    const double excess = state_.position[i].w;
    const double diameter_deficit = law_between(own, own).diameter_deficit;
    const auto to_walls = [&](double across_m, double from_middle_m) {
      return contactEnergy(side_wall, across_m - 2 * (std::abs(from_middle_m) + excess) - diameter_deficit) / 2;
    };
    energy += contactEnergy(floor, 2 * (x.z() - excess) - diameter_deficit) / 2;
    energy += parameters_.periodic_x ? 0 : to_walls(parameters_.width_m + 2 * heldWidth(parameters_), x.x());
    energy += parameters_.periodic_y ? 0 : to_walls(parameters_.length_m + 2 * heldWidth(parameters_), x.y());
    for (std::uint32_t s = 0; s < state_.contacts.count(i); ++s) {
      const auto j = static_cast<std::size_t>(state_.contacts.neighbour(i, s));
      if (j > i) {
        Vec3 apart = x - at(j);
        apart.x() -= box_.periods.width * std::round(apart.x() * box_.periods.per_width);
        apart.y() -= box_.periods.length * std::round(apart.y() * box_.periods.per_length);
        const int other = classOf(j);
        const ContactFrictionLaw& law = law_between(own, other);
        energy += contactEnergy(pairs[index(own, other)],
                                apart.norm() - excess - state_.position[j].w - law.diameter_deficit);
        if (hasContactFriction()) {  // stored with the side that is awake
          const ContactLists& lists = state_.contacts;
          const bool other_side = state_.asleep(i / kGroup);
          const std::uint32_t back = other_side ? lists.find(j, static_cast<std::int32_t>(i)) : 0;
          if (!other_side || back < lists.count(j)) {
            const Slip slip = other_side ? lists.slip(j, back) : lists.slip(i, s);
            energy += law.stiffness / 2 * Vec3(slip.x, slip.y, slip.z).squaredNorm();
          }
        }
      }
    }
    if (hasContactFriction()) {
      const WallSlips& slips = state_.wall_slip[i / kGroup];
      for (const auto* slip :
           {&slips.floor_x, &slips.floor_y, &slips.x_wall_y, &slips.x_wall_z, &slips.y_wall_x, &slips.y_wall_z}) {
        const float slid = (*slip)[i % kGroup];
        energy += law_between(own, own).stiffness / 2 * slid * slid;
      }
    }
  }
  return energy + stones_.energy(state_, parameters_.gravity_m_s2);
}

}  // namespace haptolith
