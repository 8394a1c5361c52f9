#include "haptolith/exchange/lammps_law.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/soil/contact_law.h"

namespace haptolith {

namespace {

using std::numbers::pi;

void requireExportable(const BedParameters& bed) {
  if (bed.soil.friction != FrictionModel::kContact) {
    throw InvalidParameter("soil.friction", "paper",
                           "contact: the paper's friction brakes against absolute space, and no other engine has it");
  }
  if (grainClasses(bed) > 1) {
    throw InvalidParameter("bed.fine_radius_mm", fmt::format("{:g}", 1e3 * bed.grading.fine_radius_m),
                           "0: grains of several classes have a law for each pair of them, which is not exported");
  }
  if (bed.stones.any()) {
    throw InvalidParameter("stones",
                           fmt::format("{}", bed.stones.count + static_cast<int>(bed.stones.placed.size())),
                           "none: stones turn, and nothing that turns is exported");
  }
}

bool isLine(const SoilParameters& soil) {
  constexpr double kRounding = 1e-3;  // somebody's three digits
  return std::abs(soil.gamma_nm / linearGamma(soil) - 1) < kRounding;
}

/// How far two grains overlap, and with what force.
struct Touch {
  double overlap_m, force_n;
};

/// Contacts of the bed, some thousand of them where there are more.
std::vector<Touch> touchesOf(const Bed& bed) {
  constexpr std::size_t kMost = 4000;
  const auto& state = bed.state();
  const double diameter_m = 2 * bed.parameters().soil.radius_m;
  const std::size_t every = std::max<std::size_t>(1, bed.particles() * 4 / kMost);
  std::vector<Touch> touches;
  for (std::size_t i = 0; i < bed.particles(); i += every) {
    for (std::uint32_t s = 0; s < state.contacts.count(i); ++s) {
      const Float4 &a = state.position[i], &b = state.position[static_cast<std::size_t>(state.contacts.neighbour(i, s))];
      const double overlap_m =
          diameter_m + (a.w + b.w) - std::hypot(double{a.x} - b.x, double{a.y} - b.y, double{a.z} - b.z);
      if (overlap_m > 0 && overlap_m < diameter_m / 2) {  // not the ghosts that fill up lists, nor beyond a period
        touches.push_back({overlap_m, contactForce(bed.law(), diameter_m - overlap_m)});
      }
    }
  }
  return touches;
}

struct Fit {
  double stiffness, begins_m, spread;
};

/// RMS of how far forces are from those of a law, over their own RMS.
template <class Law>
double spreadOf(const std::vector<Touch>& touches, const Law& law) {
  double apart = 0, all = 0;
  for (const Touch& touch : touches) {
    apart += std::pow(touch.force_n - law(touch.overlap_m), 2);
    all += touch.force_n * touch.force_n;
  }
  return std::sqrt(apart / all);
}

/// The line F = k (delta - begins) through the contacts' forces.
Fit lineOf(const std::vector<Touch>& touches, double stiffest_n_m) {
  double overlap = 0, force = 0;
  for (const Touch& touch : touches) {
    overlap += touch.overlap_m / static_cast<double>(touches.size());
    force += touch.force_n / static_cast<double>(touches.size());
  }
  double both = 0, squares = 0;
  for (const Touch& touch : touches) {
    both += (touch.overlap_m - overlap) * (touch.force_n - force);
    squares += (touch.overlap_m - overlap) * (touch.overlap_m - overlap);
  }
  const double stiffness = std::clamp(both / squares, 1e-3 * stiffest_n_m, stiffest_n_m);
  const double begins_m = overlap - force / stiffness;
  return {stiffness, begins_m, spreadOf(touches, [=](double delta) { return std::max(0.0, stiffness * (delta - begins_m)); })};
}

/// The lowest of a function that falls, and then rises, between two numbers.
template <class Function>
double lowestOf(double low, double high, const Function& value) {
  constexpr double kGolden = 0.6180339887498949;
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
  double at_a = value(a), at_b = value(b);
  for (int i = 0; i < 30; ++i) {
    if (at_a < at_b) {
      high = b;
      b = a;
      at_b = at_a;
      a = high - kGolden * (high - low);
      at_a = value(a);
    } else {
      low = a;
      a = b;
      at_a = at_b;
      b = low + kGolden * (high - low);
      at_b = value(b);
    }
  }
  return (low + high) / 2;
}

/// E of jkr, and from where on the overlap counts, nearest to the contacts' forces.
Fit jkrOf(const std::vector<Touch>& touches, const SoilParameters& soil, double pull_n) {
  const double effective_m = soil.radius_m / 2;
  const auto law = [=](double modulus_pa, double begins_m) {
    return [=](double delta) {
      return delta > begins_m ? jkrForce(delta - begins_m, modulus_pa, pull_n, effective_m) : 0;
    };
  };
  // No stiffer than k is at a twentieth of R, for steps are made for k.
  const double stiffest_pa = soil.stiffness_n_m / (2 * std::sqrt(effective_m * 0.05 * soil.radius_m));
  const auto stiffnessFor = [&](double begins_m) {
    return std::exp(lowestOf(std::log(1e-4 * stiffest_pa), std::log(stiffest_pa), [&](double log_pa) {
      return spreadOf(touches, law(std::exp(log_pa), begins_m));
    }));
  };
  constexpr int kTries = 24;
  Fit best{stiffest_pa, 0, 1e9};
  for (int i = 0; i <= kTries; ++i) {
    const double begins_m = soil.radius_m * (-0.1 + 0.4 * i / kTries);
    const double modulus_pa = stiffnessFor(begins_m);
    const double spread = spreadOf(touches, law(modulus_pa, begins_m));
    best = spread < best.spread ? Fit{modulus_pa, begins_m, spread} : best;
  }
  return best;
}

}  // namespace

double jkrForce(double overlap_m, double modulus_pa, double pull_n, double effective_m) {
  const double gamma = pull_n / (3 * pi * effective_m);
  // From beyond the root: delta(a) is convex and rises there, so Newton's steps come down to it.
  double a = std::sqrt(overlap_m * effective_m) + std::cbrt(4 * pi * gamma * effective_m * effective_m / modulus_pa);
  for (int i = 0; i < 20; ++i) {
    const double root = std::sqrt(pi * gamma / modulus_pa);
    const double off = a * a / effective_m - 2 * root * std::sqrt(a) - overlap_m;
    const double step = off / (2 * a / effective_m - root / std::sqrt(a));
    a -= step;
    if (std::abs(step) < 1e-12 * a) {
      break;
    }
  }
  return 4 * modulus_pa * a * a * a / (3 * effective_m) - 2 * pi * a * a * std::sqrt(4 * gamma * modulus_pa / (pi * a));
}

std::string GranularContact::text() const {
  // LAMMPS makes 1 / E of two of 2 (1 - nu^2) / Young's modulus; nu = 0 here.
  const std::string normal =
      coheres ? fmt::format("jkr {:.10g} {:.10g} 0 {:.10g} damping tsuji", 2 * stiffness, restitution,
                            pull_n / (3 * pi * effective_m))
              : fmt::format("hooke {:.10g} {:.10g} damping velocity", stiffness, damping_n_s_m);
  return fmt::format("{} tangential linear_history {:.10g} {:.10g} {:.10g}{}", normal, across_n_m, across_damping,
                     friction, coheres ? "" : " limit_damping");  // what coheres is damped while it pulls, too
}

double restitutionOf(double damping_ratio) {
  const double wanted = 2 * damping_ratio * std::sqrt(1.5);
  const auto alpha = [](double e) {
    return 1.2728 - e * (4.2783 - e * (11.087 - e * (22.348 - e * (27.467 - e * (18.022 - e * 4.8218)))));
  };
  double low = 0, high = 1;  // alpha falls from 1.27 to 0
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (alpha(middle) > wanted ? low : high) = middle;
  }
  return high;
}

GranularLaw granularLaw(const Bed& bed) {
  const BedParameters& parameters = bed.parameters();
  const SoilParameters& soil = parameters.soil;
  requireExportable(parameters);
  GranularLaw law;
  law.exact = isLine(soil) && soil.contact_cohesion_n == 0;
  GranularContact& grains = law.grains;
  grains.stiffness = soil.stiffness_n_m;
  grains.friction = soil.contact_friction;
  grains.effective_m = soil.radius_m / 2;
  grains.coheres = soil.contact_cohesion_n > 0;
  grains.pull_n = soil.contact_cohesion_n / 2;
  grains.restitution = restitutionOf(soil.damping_ratio);
  const std::vector<Touch> touches = law.exact ? std::vector<Touch>{} : touchesOf(bed);
  constexpr std::size_t kEnough = 20;
  if (touches.size() >= kEnough) {
    const Fit fit = grains.coheres ? jkrOf(touches, soil, grains.pull_n) : lineOf(touches, soil.stiffness_n_m);
    grains.stiffness = fit.stiffness;
    law.smaller_m = fit.begins_m / 2;
    law.spread_of_fit = fit.spread;
  } else if (grains.coheres) {
    grains.stiffness = soil.stiffness_n_m / (2 * std::sqrt(grains.effective_m * 0.05 * soil.radius_m));
  }
  grains.across_n_m = soil.tangential_ratio * soil.stiffness_n_m;
  grains.damping_n_s_m = soil.damping_ratio * std::sqrt(2 * bed.mass() * (grains.coheres ? 0 : grains.stiffness));
  grains.across_damping = std::sqrt(soil.tangential_ratio);
  // A wall at distance d does what a grain at distance 2 d would: twice as stiff, and as strong. Its effective radius
  // is the grain's own, and what is damped comes twice as fast.
  law.wall = grains;
  law.wall.stiffness = 2 * grains.stiffness;
  law.wall.effective_m = soil.radius_m;
  law.wall.damping_n_s_m = 2 * grains.damping_n_s_m;
  law.wall.across_damping = grains.across_damping / 2;
  return law;
}

GranularContact granularContact(const ToolParameters& tool, const SoilParameters& soil, double dt_s) {
  GranularContact contact;
  contact.stiffness = tool.stiffness_n_m;
  contact.damping_n_s_m = tool.damping_factor * dt_s * tool.stiffness_n_m / 2;
  contact.across_n_m = soil.tangential_ratio * tool.stiffness_n_m;
  contact.across_damping = soil.tangential_ratio;  // c_t / k_t is the same time as c / k
  contact.friction = tool.friction;
  return contact;
}

}  // namespace haptolith
