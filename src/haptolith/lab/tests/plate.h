#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/lab/apparatus/pushed_tool.h"
#include "haptolith/lab/laboratory.h"
#include "haptolith/lab/theory/pressure_sinkage.h"

namespace haptolith {

/// A round plate and the box it is tested in.
struct PlateOptions {
  double diameter_m = 0.06;          ///< D; at least 4 particle diameters
  double max_sinkage_m = 0.03;       ///< above 0
  double speed_m_s = 0.02;           ///< slow: v^2/(g D) should be far below 1
  double friction = 0.36;            ///< of plate against soil
  double bed_width_diameters = 3.5;  ///< of the square box, in D; at least 2
  double bed_depth_diameters = 2.5;  ///< of the soil as filled, in D; the floor is rough
  Preparation preparation = Preparation::kDense;
  DepthFrom depth_from = DepthFrom::kTips;
  double loose_top_m = 0;  ///< of the bed's depth, poured onto the rest; two grains less than all, at most
  double window_m = 1e-3;  ///< of sinkage over which a point of the curve is the mean
  int points = 60;         ///< of the curve behind its zero; 3 or more
};

/// @throws InvalidParameter where plateTest() would. Not for the tick.
void validate(const LabConditions& conditions, const PlateOptions& options);

struct PlateResult {
  std::vector<PushReading> curve;  ///< force against sinkage, evenly sampled
  PressureSinkage fit;             ///< of the whole curve
  double area_m2 = 0;
  double bulk_density_kg_m3 = 0;
  double bed_depth_m = 0;
  std::size_t particles = 0;
  LabTrace trace;
};

/// Pushes a flat round plate into a settled bed at constant speed, and fits p = k z^n to the force it needs.
///
/// Sinkage is counted from first contact: from where the force exceeds 5 % of rho0 g D times the plate's area. Before
/// that the plate only meets the tips of single particles. The box's sides are smooth walls: they take no vertical
/// force, but they keep soil from giving way sideways, and the floor keeps it from giving way downwards. Both make the
/// soil look stronger; docs/reports/accuracy.md compares two depths of bed.
/// @throws InvalidParameter outside the ranges above; Failure as LabBed::run() and fitPressureSinkage(). Not for the
/// tick.
[[nodiscard]] PlateResult plateTest(const LabConditions& conditions, const PlateOptions& options = {});

/// A curve somebody measured, to be drawn along.
struct MeasuredPlate {
  std::string title;
  std::vector<PushReading> points;
};

/// Draws force against sinkage, the fit and measured curves into an .svg or .png file. @throws as Figure.
void drawPlate(const OutputFile& file, const PlateResult& result, std::string_view title,
               const std::vector<MeasuredPlate>& measured = {});

}  // namespace haptolith
