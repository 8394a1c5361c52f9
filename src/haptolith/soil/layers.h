#pragma once

#include <span>
#include <vector>

#include "haptolith/soil/soil_parameters.h"

namespace haptolith {

/// One layer of close-packed macroparticles at rest under the weight of the layers above (paper, Fig. 1).
struct Layer {
  int layer = 0;             ///< n, the number of layers above
  double depth_m = 0;        ///< d(n), depth of the centres (paper 12)
  double spacing_m = 0;      ///< b(n), height of the centres of layer n-1 above these (paper 6); b(0) (paper 3)
  double density_kg_m3 = 0;  ///< rho(n) (paper 11)
  double top_m = 0;          ///< the layer's share of the depth: halfway to the layer above; 0 for the first
  double bottom_m = 0;       ///< and halfway to the layer below
};

/// Vertical distance b(n) between a layer and the one above it, in m.
///
///     (b/a) F(a) = n m g / 3,   a = sqrt(b^2 + 4 R^2/3)      (paper 5, 6)
///     b(0) = 2 sqrt(2/3) R                                    (paper 3)
///
/// F is contactForce() (paper 7), k finite or infinite. The equation is solved as it stands with a bracketed root
/// finder, not through the paper's quartic (10), which squares it and so has false roots.
/// @param soil          any valid soil; its stiffness may be infinite.
/// @param gravity_m_s2  g, 0 to 1000.
/// @param layer         n, 0 or more.
/// @throws InvalidParameter for nonsense; Failure when k is so small that the lattice cannot carry the load at all.
[[nodiscard]] double layerSpacing(const SoilParameters& soil, double gravity_m_s2, int layer);

/// The layers from the surface down to `depth_m`: the last one's bottom_m is at that depth or just below it.
///
///     rho(n) = 4 sqrt(2) R rho0 / (sqrt(3) (b(n) + b(n+1)))  (paper 11)
///     d(n)   = b(0)/2 + sum_{i=1}^{n} b(i)                    (paper 12)
///
/// @param depth_m  in m, above 0; at most a million layers.
/// @throws as layerSpacing().
[[nodiscard]] std::vector<Layer> layersToDepth(const SoilParameters& soil, double gravity_m_s2, double depth_m);

/// Layers with the linear contact F = k (2R - a), which the paper shows in Fig. 2 as inadequate. Uses R, rho0 and k of
/// the soil, which must be finite here.
/// @throws as layersToDepth().
[[nodiscard]] std::vector<Layer> linearLayersToDepth(const SoilParameters& soil, double gravity_m_s2, double depth_m);

/// Mean density of a band of depth, in kg/m^3: each layer counts with the height of its share of the band, so this is
/// the mass in the band over the band's height.
/// @param layers         from layersToDepth(), reaching down to `bottom_m`.
/// @param top_m, bottom_m  0 <= top < bottom.
/// @throws InvalidParameter when the band is empty or not covered by the layers.
[[nodiscard]] double bandMeanDensity(std::span<const Layer> layers, double top_m, double bottom_m);

}  // namespace haptolith
