#include "haptolith/soil/layers.h"

#include <boost/math/tools/roots.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "haptolith/core/error.h"
#include "haptolith/core/math/portable_math.h"
#include "haptolith/soil/contact_law.h"

namespace haptolith {

namespace {

constexpr int kMostLayers = 1'000'000;

/// The close packing: layers of touching spheres, each sphere on three of the layer below.
struct Lattice {
  ContactLaw law;
  double radius_m = 0;
  double rho0_kg_m3 = 0;
  double weight_n = 0;  ///< weight of one particle, m g

  /// Square of the horizontal distance between neighbours of adjacent layers (paper 5).
  double offsetSquared() const { return 4 * radius_m * radius_m / 3; }
  /// b of (paper 5), solved for b.
  double spacingAt(double a) const { return std::sqrt(a * a - offsetSquared()); }
  double unloadedSpacing() const { return 2 * std::sqrt(2.0 / 3) * radius_m; }  // (paper 3)
  /// What one of three contacts carries when the centres are `a` apart: left side of (paper 6).
  double carriedAt(double a) const { return spacingAt(a) / a * contactForce(law, a); }
};

Lattice makeLattice(const SoilParameters& soil, const ContactLaw& law, double gravity_m_s2) {
  requireInRange("gravity_m_s2", gravity_m_s2, {0, 1000});
  return {law, soil.radius_m, soil.rho0_kg_m3, macroparticleMass(soil) * gravity_m_s2};
}

/// F = k (2R - a): the contact law with no hyperbola and its line beginning at 2R.
ContactLaw linearLaw(const SoilParameters& soil) {
  validate(soil);
  requireInRange("stiffness_n_m", soil.stiffness_n_m, {0, Range{}.highest, Ends::kOpen});
  ContactLaw law;
  law.stiffness_n_m = soil.stiffness_n_m;
  law.a_thr_m = law.cutoff_m = 2 * soil.radius_m;
  return law;
}

/// Lower bound of the centre distance, where a contact surely carries `load_n` if it can at all.
double closestDistance(const Lattice& lattice, double load_n) {
  const ContactLaw& law = lattice.law;
  if (law.stiffness_n_m == 0) {
    // k infinite: no load closes the gap to a_min, because (paper 6) asks for at most F = load * 2R / b_min.
    const double widest_force = load_n * 2 * lattice.radius_m / lattice.spacingAt(law.a_min_m);
    const double gap = law.gamma_nm / (widest_force + law.h_n) / 2;
    return std::max(law.a_min_m + gap, std::nextafter(law.a_min_m, 1.0));
  }
  // k finite: flattening the lattice turns the contacts sideways faster than the spring stiffens, so what they carry
  // has a maximum. On the line F = c - k a it is where d/db (b (c/a - k)) = 0, that is a^3 = c 4R^2/(3k).
  const double c = contactForce(law, law.a_thr_m) + law.stiffness_n_m * law.a_thr_m;
  return portable::cbrt(c * lattice.offsetSquared() / law.stiffness_n_m);
}

/// The root of (paper 6) for the layer under `layer` others.
double solveSpacing(const Lattice& lattice, int layer) {
  const double load_n = layer * lattice.weight_n / 3;
  if (load_n == 0) {
    return lattice.unloadedSpacing();
  }
  const double closest = closestDistance(lattice, load_n);
  const auto surplus = [&](double a) { return lattice.carriedAt(a) - load_n; };
  if (surplus(closest) < 0) {
    if (lattice.law.stiffness_n_m == 0) {
      return lattice.spacingAt(closest);  // nearer to a_min than a double resolves
    }
    throw Failure(
        fmt::format("the soil collapses at layer {}: its contacts carry at most {:.4g} N there, the load is "
                    "{:.4g} N; a larger stiffness_n_m is needed",
                    layer, lattice.carriedAt(closest), load_n));
  }
  std::uintmax_t iterations = 200;
  const auto [low, high] = boost::math::tools::toms748_solve(surplus, closest, 2 * lattice.radius_m,
                                                             boost::math::tools::eps_tolerance<double>(), iterations);
  return lattice.spacingAt((low + high) / 2);
}

std::vector<Layer> stackLayers(const Lattice& lattice, double depth_m) {
  requireInRange("depth_m", depth_m, {0, kMostLayers * lattice.unloadedSpacing() / 4, Ends::kOpenBelow});
  const double density_times_height =
      4 * std::sqrt(2.0) * lattice.radius_m * lattice.rho0_kg_m3 / std::sqrt(3.0);  // (paper 11)

  std::vector<Layer> layers;
  double spacing = lattice.unloadedSpacing();
  double depth = spacing / 2;
  double top = 0;
  for (int n = 0; top < depth_m; ++n) {
    if (n == kMostLayers) {
      throw Failure(fmt::format("{} m of this soil has more than {} layers", depth_m, kMostLayers));
    }
    const double next_spacing = solveSpacing(lattice, n + 1);
    const double bottom = depth + next_spacing / 2;
    layers.push_back({.layer = n,
                      .depth_m = depth,
                      .spacing_m = spacing,
                      .density_kg_m3 = density_times_height / (spacing + next_spacing),
                      .top_m = top,
                      .bottom_m = bottom});
    spacing = next_spacing;
    depth += spacing;
    top = bottom;
  }
  return layers;
}

}  // namespace

double layerSpacing(const SoilParameters& soil, double gravity_m_s2, int layer) {
  requireInRange("layer", layer, {0, Range{}.highest});
  return solveSpacing(makeLattice(soil, makeContactLaw(soil), gravity_m_s2), layer);
}

std::vector<Layer> layersToDepth(const SoilParameters& soil, double gravity_m_s2, double depth_m) {
  return stackLayers(makeLattice(soil, makeContactLaw(soil), gravity_m_s2), depth_m);
}

std::vector<Layer> linearLayersToDepth(const SoilParameters& soil, double gravity_m_s2, double depth_m) {
  return stackLayers(makeLattice(soil, linearLaw(soil), gravity_m_s2), depth_m);
}

double bandMeanDensity(std::span<const Layer> layers, double top_m, double bottom_m) {
  const double covered = layers.empty() ? 0 : layers.back().bottom_m;
  requireInRange("top_m", top_m, {0, covered});
  requireInRange("bottom_m", bottom_m, {top_m, covered, Ends::kOpenBelow});
  double mass_per_area = 0;
  for (const Layer& layer : layers) {
    const double height = std::min(layer.bottom_m, bottom_m) - std::max(layer.top_m, top_m);
    mass_per_area += std::max(height, 0.0) * layer.density_kg_m3;
  }
  return mass_per_area / (bottom_m - top_m);
}

}  // namespace haptolith
