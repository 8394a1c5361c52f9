#include "haptolith/lammps/lammps_law.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/soil/contact_law.h"

namespace haptolith {

namespace {

void requireExportable(const BedParameters& bed) {
  if (bed.soil.friction != FrictionModel::kContact) {
    throw InvalidParameter("soil.friction_model", "icra2021",
                           "contact: ICRA 2021 friction brakes against absolute space, and no other engine has it");
  }
  if (grainClasses(bed) > 1) {
    throw InvalidParameter("bed.fine_radius_mm", fmt::format("{:g}", 1e3 * bed.grading.fine_radius_m),
                           "0: grains of several classes have a law for each pair of them, which is not exported");
  }
  if (bed.stones.any()) {
    throw InvalidParameter("stones", fmt::format("{}", bed.stones.count + static_cast<int>(bed.stones.placed.size())),
                           "none: stones turn, and nothing that turns is exported");
  }
}

bool isLine(const SoilParameters& soil) {
  constexpr double kRounding = 1e-3;  // three digits in a user's file
  return std::abs(soil.gamma_nm / linearGamma(soil) - 1) < kRounding;
}

/// As bed/kernel/kernel_law.cpp has it.
OwnContact ownContact(const Bed& bed) {
  const SoilParameters& soil = bed.parameters().soil;
  OwnContact own;
  own.law = bed.law();
  own.damping_n_s = soil.damping_ratio * std::sqrt(2 * bed.mass() * own.law.gamma_nm);
  own.across_n_m = soil.tangential_ratio * soil.stiffness_n_m;
  own.lag_s = soil.damping_ratio * std::sqrt(2 * bed.mass() / own.across_n_m);
  own.friction = soil.contact_friction;
  own.reach_m = own.law.cutoff_m - own.law.diameter_m;
  return own;
}

/// Overlap of two particles (less than 0: the gap), their repulsion, and the limit of their friction, over mu.
struct Touch {
  double overlap_m, push_n, limit_n;
};

/// Contacts of the bed, some thousand of them where there are more.
std::vector<Touch> touchesOf(const Bed& bed) {
  constexpr std::size_t kMost = 4000;
  const auto& state = bed.state();
  const ContactLaw& law = bed.law();
  const std::size_t every = std::max<std::size_t>(1, bed.particles() * 4 / kMost);
  std::vector<Touch> touches;
  for (std::size_t i = 0; i < bed.particles(); i += every) {
    for (std::uint32_t s = 0; s < state.contacts.count(i); ++s) {
      const Float4 &a = state.position[i],
                   &b = state.position[static_cast<std::size_t>(state.contacts.neighbour(i, s))];
      const double distance_m =
          std::hypot(double{a.x} - b.x, double{a.y} - b.y, double{a.z} - b.z) - (double{a.w} + b.w);
      if (distance_m < law.cutoff_m && distance_m > law.diameter_m / 2) {  // no ghosts, nor beyond a period
        const double gap_m = distance_m - law.diameter_m;
        const double push_n = gap_m < 0 ? contactForce(law, distance_m) : 0;
        const double near = std::clamp(1 - 2 * gap_m / law.cohesion_range_m, 0.0, 1.0);  // u of cohesionAcross()
        touches.push_back({-gap_m, push_n, push_n + law.cohesion_n * near * near});
      }
    }
  }
  return touches;
}

/// A law with its stiffness, and how much it begins before grains touch.
struct Fit {
  double stiffness, before_m, spread;
};

double hertzShape(double overlap_m, double effective_m) {
  return overlap_m > 0 ? std::sqrt(effective_m) * std::pow(overlap_m, 1.5) : 0;
}

/// Effective radius of two grains alike.
double effectiveOf(double both_radii_m) {
  return both_radii_m / 4;
}

/// The line F = k (delta + before) through how contacts repel: what a wall is made of.
Fit lineOf(const std::vector<Touch>& touches, double stiffest_n_m) {
  double overlap = 0, force = 0, count = 0;
  for (const Touch& touch : touches) {
    if (touch.overlap_m > 0) {
      overlap += touch.overlap_m;
      force += touch.push_n;
      ++count;
    }
  }
  overlap /= count;
  force /= count;
  double both = 0, squares = 0;
  for (const Touch& touch : touches) {
    if (touch.overlap_m > 0) {
      both += (touch.overlap_m - overlap) * (touch.push_n - force);
      squares += (touch.overlap_m - overlap) * (touch.overlap_m - overlap);
    }
  }
  // Contacts that are all pressed alike have no slope.
  const double stiffness = squares > 0 ? std::clamp(both / squares, 1e-3 * stiffest_n_m, stiffest_n_m) : stiffest_n_m;
  return {stiffness, force / stiffness - overlap, 0};
}

/// Hertz' law nearest to what limits friction: in the least squares' sense, each square over the root of the limit, so
/// that contacts that are pressed little, which are most, count as well. (Chosen between no weight and the limit
/// itself, with which dry sand comes out a sixth too strong and too weak in shear.)
Fit hertzOf(const std::vector<Touch>& touches, const ContactLaw& law) {
  constexpr int kTries = 100;
  const double earliest_m = law.cohesion_n > 0 ? law.cohesion_range_m / 2 : 0;  // begin of its effect on friction
  const double latest_m = -0.16 * law.diameter_m;
  Fit best{0, 0, 1e9};
  for (int i = 0; i <= kTries; ++i) {
    const double before_m = latest_m + (earliest_m - latest_m) * i / kTries;
    const double effective_m = effectiveOf(law.diameter_m + before_m);
    double both = 0, shapes = 0, limits = 0;
    for (const Touch& touch : touches) {
      const double shape = hertzShape(touch.overlap_m + before_m, effective_m);
      if (touch.limit_n > 0) {
        const double weight = 1 / std::sqrt(touch.limit_n);
        both += weight * shape * touch.limit_n;
        shapes += weight * shape * shape;
        limits += weight * touch.limit_n * touch.limit_n;
      }
    }
    const double spread = shapes > 0 ? std::sqrt(std::max(0.0, 1 - both * both / (shapes * limits))) : 1e9;
    best = spread < best.spread ? Fit{both / shapes, before_m, spread} : best;
  }
  return best;
}

}  // namespace

std::string GranularContact::text() const {
  return fmt::format(
      "{} {:.10g} {:.10g} damping velocity tangential linear_history {:.10g} {:.10g} {:.10g} limit_damping",
      hertz ? "hertz" : "hooke", stiffness, damping_n_s_m, across_n_m, across_damping, friction);
}

std::string OwnContact::text(double ratio) const {
  return fmt::format(
      "haptolith {:.10g} {:.10g} {:.10g} {:.10g} {:.10g} {:.10g} {:.10g} {:.10g} damping velocity tangential "
      "haptolith {:.10g} {:.10g} {:.10g}",
      law.diameter_m, law.a_min_m, law.gamma_nm, law.stiffness_n_m, ratio * law.cohesion_n, reach_m, damping_n_s,
      reach_m, across_n_m, lag_s, ratio * friction);
}

std::string GranularLaw::betweenGrains() const {
  return own ? own->text() : grains.text();
}

std::string GranularLaw::atWall(double ratio) const {
  GranularContact its = wall;
  its.friction *= ratio;
  return own ? own->text(ratio) : its.text();
}

double restForce(const GranularLaw& law, const ContactLaw& contact, double more_m, double distance_m) {
  const double radii_m = contact.diameter_m + more_m + 2 * law.larger_m;
  return contactForce(contact, distance_m - more_m) -
         law.grains.stiffness * hertzShape(radii_m - distance_m, effectiveOf(radii_m));
}

GranularLaw granularLaw(const Bed& bed, LammpsLaw whose) {
  const BedParameters& parameters = bed.parameters();
  const SoilParameters& soil = parameters.soil;
  requireExportable(parameters);
  GranularLaw law;
  if (whose == LammpsLaw::kHaptolith) {
    law.own = ownContact(bed);
    law.larger_m = law.own->reach_m / 2;
    return law;
  }
  law.exact = isLine(soil) && soil.contact_cohesion_n == 0;
  GranularContact& grains = law.grains;
  grains.stiffness = soil.stiffness_n_m;
  grains.friction = soil.contact_friction;
  grains.across_n_m = soil.tangential_ratio * soil.stiffness_n_m;
  double damped_n_m = soil.stiffness_n_m;  // the stiffness that the damper is made for
  Fit line{soil.stiffness_n_m, 0, 0};
  if (!law.exact) {
    grains.hertz = true;
    std::vector<Touch> touches = touchesOf(bed);
    constexpr auto kEnough = 20;
    const auto pressed = std::ranges::count_if(touches, [](const Touch& touch) { return touch.push_n > 0; });
    if (pressed < kEnough) {  // nothing lies yet: as if pressed by some of R
      touches.clear();
      for (const double overlap : {-0.1, 0.0, 0.02, 0.05, 0.1, 0.15}) {
        const double overlap_m = overlap * soil.radius_m;
        const double push_n = overlap > 0 ? contactForce(bed.law(), bed.law().diameter_m - overlap_m) : 0;
        touches.push_back({overlap_m, push_n, push_n + (overlap < 0 ? 0.25 : 1) * soil.contact_cohesion_n});
      }
    }
    const Fit hertz = hertzOf(touches, bed.law());
    grains.stiffness = hertz.stiffness;
    law.larger_m = hertz.before_m / 2;
    law.spread_of_fit = hertz.spread;
    line = lineOf(touches, soil.stiffness_n_m);
    law.wall_behind_m = law.larger_m - line.before_m / 2;
    damped_n_m = line.stiffness;
  }
  grains.damping_n_s_m = soil.damping_ratio * std::sqrt(2 * bed.mass() * damped_n_m);
  grains.across_damping = std::sqrt(grains.across_n_m / damped_n_m);
  // A wall at distance d does what a grain at distance 2 d would: twice as stiff, and damped twice, for what is damped
  // comes twice as fast.
  law.wall = grains;
  law.wall.hertz = false;
  law.wall.stiffness = 2 * line.stiffness;
  law.wall.damping_n_s_m = 2 * grains.damping_n_s_m;
  law.wall.across_damping = grains.across_damping / 2;
  return law;
}

GranularContact granularContact(const ToolParameters& tool, const SoilParameters& soil, double dt_s,
                                const SpheresUnderAGrain& spheres) {
  const double softer = spheres.pressed_m / spheres.depth_m;
  GranularContact contact;
  contact.stiffness = softer * tool.stiffness_n_m;
  contact.damping_n_s_m = tool.damping_factor * dt_s * contact.stiffness / 2;
  contact.across_n_m = soil.tangential_ratio * tool.stiffness_n_m / spheres.count;
  contact.across_damping = contact.across_n_m / contact.stiffness;  // c_t / k_t is the same time as c / k
  contact.friction = tool.friction;
  return contact;
}

}  // namespace haptolith
