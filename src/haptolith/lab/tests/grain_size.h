#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/lab/laboratory.h"

namespace haptolith {

/// Valid ranges.
struct GrainSizeRanges {
  static constexpr Range specimens{1, 1000};
};

/// Options of a test of force roughness: a blade is drawn steadily through beds that differ only in particle size.
struct GrainSizeOptions {
  std::vector<double> radii_m{7e-3, 3.5e-3, 2e-3, 1.75e-3};  ///< R of beds with particles of one size
  bool graded = true;  ///< adds a bed of the soil's particles, with finer ones down to fine_radius_m at the blade
  double fine_radius_m = 1.75e-3;
  double width_m = 0.05;   ///< width of the blade
  double depth_m = 0.015;  ///< depth of its lower edge below the surface
  double speed_m_s = 0.05;
  double level_m = 0.02;  ///< travel from which the force is evaluated
  double travel_m = 0.055;
  double filter_cutoff_hz = 30;  ///< cutoff of the first-order low-pass filter of the rendered force
  int specimens = 3;             ///< number of beds of each size, each with a separate seed
};

/// One-sided power of the detrended force at one frequency.
struct GrainSpectrumPoint {
  double frequency_hz = 0;
  double power_n2_per_hz = 0;
};

/// Result for one particle size.
struct GrainSizeResult {
  std::string name;     ///< "7 mm", "graded 7 to 1.75 mm"
  double radius_m = 0;  ///< R of the finest particles
  std::size_t particles = 0;
  double draft_n = 0;     ///< mean over all specimens
  double draft_sd_n = 0;  ///< SD of the specimens' means; 0 for one
  /// Coefficient of variation about a straight line, of the filtered and of the unfiltered force.
  double variation = 0, unfiltered_variation = 0;
  std::vector<GrainSpectrumPoint> spectrum;  ///< spectrum of the unfiltered force, mean over the specimens
  std::vector<std::vector<double>> trace;    ///< trace of the first specimen: travel_m, draft_n, filtered_n
};

/// Runs the test. @throws InvalidParameter for values out of range; Failure as LabBed::run().
[[nodiscard]] std::vector<GrainSizeResult> grainSizeTest(const LabConditions& conditions,
                                                         const GrainSizeOptions& options = {});

/// Draws force over travel and its spectra. @throws as Figure.
void drawGrainSize(const OutputFile& file, const std::vector<GrainSizeResult>& results, std::string_view title);

/// Weber fraction of force: just noticeable difference over the force (Jones 1989 and others: 5 to 10 %).
inline constexpr double kForceJnd = 0.07;

}  // namespace haptolith
