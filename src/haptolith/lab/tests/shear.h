#pragma once

#include <string_view>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/lab/laboratory.h"
#include "haptolith/lab/theory/mohr_coulomb.h"

namespace haptolith {

/// How a direct shear test is done. Lengths in mean particle diameters.
struct ShearOptions {
  std::vector<double> normal_stresses_pa{300, 600, 1000, 2000, 3000};  ///< at least 3 different ones, each above 0
  double width_diameters = 14;                                         ///< along the movement, >= 6
  double length_diameters = 10;                                        ///< across it, >= 6
  double height_diameters = 10;  ///< of the soil between the plates before it is loaded, >= 5
  /// Sizes of grain that are mixed, a like volume of each: the soil's radius and its halves, 1 to 4.
  int grain_classes = 1;
  /// How far the upper plate goes over the soil's height. Dense soil dilates until about 1.5; what follows is residual.
  double strain = 6;
  double residual_from = 2;  ///< strain from which on stresses count as residual
  /// Shear rate as the inertial number I = rate d sqrt(rho / sigma) at the smallest stress; up to 0.02 the strength
  /// hardly depends on it.
  double inertial_number = 0.02;
};

/// One specimen under one normal stress.
struct ShearPointResult {
  double normal_pa = 0;    ///< as measured in the residual state
  double peak_pa = 0;      ///< largest shear stress, mean over 5 % strain
  double residual_pa = 0;  ///< mean shear stress in the residual state
  double dilation = 0;     ///< by how much the specimen's height grew until the residual state, over that height
  LabTrace trace;          ///< displacement_m, shear_pa, normal_pa, height_m
};

struct ShearResult {
  std::vector<ShearPointResult> points;
  MohrCoulomb peak, residual;
  double bulk_density_kg_m3 = 0;  ///< of the specimen under the smallest stress, before it is sheared
};

/// Direct shear between two rough plates, the upper one loaded and drawn sideways, periodic on all four sides so that
/// neither walls nor corners take part: what a shear box measures, without the box. The soil has settled densely under
/// its own weight; while it is sheared gravity is off, so that stress is the same at every height.
///
/// Stresses are the upper plate's forces over its area. A Mohr-Coulomb line is fitted through the peaks and through the
/// residual stresses. A stress level has a specimen of its own, as in a soil laboratory.
/// @throws InvalidParameter for nonsense; Failure as LabBed::run(), and when a specimen does not hold the plate.
[[nodiscard]] ShearResult shearTest(const LabConditions& conditions, const ShearOptions& options = {});

/// tan(phi) of the line through all points that meets no cohesion, of their peaks or of their residual stresses: for
/// soil without cohesion between its particles, where a fitted line's cohesion is scatter.
[[nodiscard]] double frictionWithoutCohesion(const std::vector<ShearPointResult>& points,
                                             double ShearPointResult::*shear_pa) noexcept;

/// @throws InvalidParameter with the key, the value and the valid range.
void validate(const ShearOptions& options);

/// The lines and what happened on the way, as a figure. @throws as Figure.
void drawShear(const OutputFile& path, const ShearResult& result, std::string_view title);

}  // namespace haptolith
