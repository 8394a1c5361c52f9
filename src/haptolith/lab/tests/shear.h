#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <list>
#include <mutex>
#include <optional>
#include <string_view>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/lab/laboratory.h"
#include "haptolith/lab/theory/mohr_coulomb.h"

namespace haptolith {

/// Options of a direct shear test. Lengths in mean particle diameters.
struct ShearOptions {
  std::vector<double> normal_stresses_pa{300, 600, 1000, 2000, 3000};  ///< at least 3 different stresses, each above 0
  double width_diameters = 14;                                         ///< width along the movement, >= 6
  double length_diameters = 10;                                        ///< length across it, >= 6
  double height_diameters = 10;  ///< height of the soil between the plates before loading, >= 5
  /// Number of mixed particle sizes with equal volume each: the soil's radius and its successive halves, 1 to 4.
  int grain_classes = 1;
  /// Displacement of the upper plate over the soil's height. Dense soil dilates until about 1.5, then it is residual.
  double strain = 6;
  double residual_from = 2;  ///< strain from which stresses count as residual
  double peak_until = 99;    ///< strain until which stresses count for the peak
  /// Shear rate as the inertial number I = rate d sqrt(rho / sigma) at the smallest stress; up to 0.02 the strength
  /// barely depends on it.
  double inertial_number = 0.02;

  [[nodiscard]] bool operator==(const ShearOptions&) const = default;
};

/// Result of one specimen under one normal stress.
struct ShearPointResult {
  double normal_pa = 0;    ///< mean normal stress in the residual state
  double peak_pa = 0;      ///< max. shear stress, mean over 5 % strain
  double residual_pa = 0;  ///< mean shear stress in the residual state
  double modulus_pa = 0;   ///< shear modulus G: secant to half the peak; see shearTest()
  double compression = 0;  ///< largest decrease of the specimen's height until the peak, over the initial height
  double dilation = 0;     ///< increase of the specimen's height until the residual state, over the initial height
  LabTrace trace;          ///< displacement_m, shear_pa, normal_pa, height_m
};

struct ShearResult {
  std::vector<ShearPointResult> points;
  MohrCoulomb peak, residual;
  double bulk_density_kg_m3 = 0;  ///< density of the specimen under the smallest stress, before shearing
};

/// Simulates direct shear between two rough plates; the upper one is loaded and drawn sideways. All four sides are
/// periodic, so there are no effects of walls and corners as in a shear box. The soil has settled densely under its
/// weight. Gravity is off during shearing, so that stress is uniform over the height.
///
/// Stresses are the upper plate's forces over its area. One Mohr-Coulomb line is fitted to the peaks and one to the
/// residual stresses. Each stress level has a separate specimen, as in a soil laboratory.
///
/// G is half the peak stress over the strain at which the mean stress over 1 % strain first reaches it.
/// @throws InvalidParameter for values out of range; Failure as LabBed::run(), and when a specimen does not carry the
/// plate. With a shear memory an equal test is simulated once.
[[nodiscard]] ShearResult shearTest(const LabConditions& conditions, const ShearOptions& options = {});

/// Simulates one specimen of shearTest() under one normal stress; `options.normal_stresses_pa` is not used.
/// @throws as shearTest(). Not for the tick.
[[nodiscard]] ShearPointResult shearUnder(const LabConditions& conditions, ShearOptions options, double normal_pa);

/// Results of shear tests, each simulated once for all tests that ask for it. Thread-safe. Not for the tick.
class ShearMemory {
 public:
  /// Returns the known result, or waits for another thread that simulates it, or simulates it. @throws as `simulate`,
  /// which a waiting thread then repeats.
  [[nodiscard]] ShearResult get(const LabConditions& conditions, const ShearOptions& options,
                                const std::function<ShearResult()>& simulate);

 private:
  struct Entry {
    SoilParameters soil;
    double gravity_m_s2;
    std::uint64_t seed;
    ShearOptions options;
    std::optional<ShearResult> result;  ///< empty: being simulated
  };
  std::mutex mutex_;
  std::condition_variable changed_;
  std::list<Entry> entries_;
};

/// Returns tan(phi) of the line through the origin, for the peaks or the residual stresses. For soil without cohesion
/// between its particles, where the cohesion of a fitted line is scatter.
[[nodiscard]] double frictionWithoutCohesion(const std::vector<ShearPointResult>& points,
                                             double ShearPointResult::*shear_pa) noexcept;

/// @throws InvalidParameter with the key, the value and the valid range.
void validate(const ShearOptions& options);

/// Draws the strength lines and the traces. @throws as Figure.
void drawShear(const OutputFile& path, const ShearResult& result, std::string_view title);

}  // namespace haptolith
