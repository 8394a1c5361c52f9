#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/lab/laboratory.h"

namespace haptolith {

/// What is valid.
struct GrainRanges {
  static constexpr Range specimens{1, 1000};
};

/// How a hand would feel the grain: a blade is drawn steadily through beds that differ in nothing but the size of their
/// grains.
struct GrainOptions {
  std::vector<double> radii_m{7e-3, 3.5e-3, 2e-3, 1.75e-3};  ///< of beds with grains all alike
  bool graded = true;  ///< and a bed with the soil's own grains, and finer ones down to fine_radius_m at the blade
  double fine_radius_m = 1.75e-3;
  double width_m = 0.05;   ///< of the blade
  double depth_m = 0.015;  ///< of its lower edge below the surface
  double speed_m_s = 0.05;
  double level_m = 0.02;  ///< travel from which on the force counts
  double travel_m = 0.055;
  double filter_cutoff_hz = 30;  ///< of the low-pass of first order through which a hand feels it
  int specimens = 3;             ///< beds of each size, each with a seed of its own
};

/// Power of the force about its trend at one frequency of a grain's passing, one-sided.
struct GrainSpectrumPoint {
  double frequency_hz = 0;
  double power_n2_per_hz = 0;
};

/// One size of grain.
struct GrainResult {
  std::string name;     ///< "7 mm", "graded 7 to 1.75 mm"
  double radius_m = 0;  ///< of the finest grains
  std::size_t particles = 0;
  double draft_n = 0;     ///< mean, of all specimens
  double draft_sd_n = 0;  ///< of the specimens' means; 0 for one
  /// Standard deviation about a straight line, over the mean, of what comes through the filter; and without it.
  double variation = 0, unfiltered_variation = 0;
  std::vector<GrainSpectrumPoint> spectrum;  ///< before the filter, mean of the specimens
  std::vector<std::vector<double>> trace;    ///< of the first specimen: travel_m, draft_n, filtered_n
};

/// @throws InvalidParameter for nonsense; Failure as LabBed::run().
[[nodiscard]] std::vector<GrainResult> grainTest(const LabConditions& conditions, const GrainOptions& options = {});

/// Force over travel and its spectra. @throws as Figure.
void drawGrain(const OutputFile& file, const std::vector<GrainResult>& results, std::string_view title);

/// By how much a force must differ to be felt as another, in shares (Jones 1989 and others: 5 to 10 %).
inline constexpr double kForceJnd = 0.07;

}  // namespace haptolith
