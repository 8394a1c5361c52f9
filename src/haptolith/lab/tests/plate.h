#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/lab/apparatus/pushed_tool.h"
#include "haptolith/lab/laboratory.h"
#include "haptolith/lab/theory/pressure_sinkage.h"

namespace haptolith {

/// Round plate and the box of the test.
struct PlateOptions {
  double diameter_m = 0.06;          ///< D; at least 4 particle diameters
  double max_sinkage_m = 0.03;       ///< above 0
  std::optional<double> speed_m_s;   ///< v; v^2/(g D) should be far below 1; empty: it is 0.004
  double friction = 0.36;            ///< friction of plate against soil
  double bed_width_diameters = 3.5;  ///< width of the square box, in D; at least 2
  double bed_depth_diameters = 2.5;  ///< depth of the soil as filled, in D; the floor is rough
  Preparation preparation = Preparation::kDense;
  DepthFrom depth_from = DepthFrom::kTips;
  double loose_top_m = 0;  ///< part of the bed's depth poured onto the settled rest; at most all but two particles
  double window_m = 1e-3;  ///< range of sinkage that a point of the curve is averaged over
  int points = 60;         ///< number of points of the curve without its zero; 3 or more
};

/// @throws InvalidParameter as plateTest(). Not for the tick.
void validate(const LabConditions& conditions, const PlateOptions& options);

struct PlateResult {
  std::vector<PushReading> curve;  ///< force against sinkage, evenly sampled
  PressureSinkage fit;             ///< fit to the entire curve; NaN: it is no power law
  double area_m2 = 0;
  double bulk_density_kg_m3 = 0;
  double bed_depth_m = 0;
  std::size_t particles = 0;
  LabTrace trace;
};

/// Pushes a flat round plate into a settled bed at constant speed, and fits p = k z^n to the force.
///
/// Sinkage is counted from first contact, at a force of 5 % of rho0 g D times the plate's area. Before that the plate
/// only touches the tips of single particles. The box has smooth side walls, which take no vertical force but prevent
/// sideways movement of the soil, and a floor, which prevents downward movement. Both make the soil appear stronger;
/// docs/reports/accuracy.md compares two depths of bed.
/// @throws InvalidParameter outside the ranges above; Failure as LabBed::run(). Not for the tick.
[[nodiscard]] PlateResult plateTest(const LabConditions& conditions, const PlateOptions& options = {});

/// Measured curve to draw as a reference.
struct MeasuredPlate {
  std::string title;
  std::vector<PushReading> points;
};

/// Draws force against sinkage, the fit and measured curves into an .svg or .png file. @throws as Figure.
void drawPlate(const OutputFile& file, const PlateResult& result, std::string_view title,
               const std::vector<MeasuredPlate>& measured = {});

}  // namespace haptolith
