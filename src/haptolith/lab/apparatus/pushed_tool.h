#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "haptolith/lab/apparatus/lab_bed.h"
#include "haptolith/lab/laboratory.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// Zero of depth.
enum class DepthZero {
  kFirstContact,  ///< depth at which the force first exceeds Push::contact_n, unless Push::depth_from is kSurface
  kSurface,       ///< LabBed::surfaceHeight(Push::depth_from) of the undisturbed bed
};

/// Tool that is pushed straight down into the centre of a square box of soil, at constant speed.
struct Push {
  std::string_view what;  ///< description for the conditions' progress
  ToolParameters tool;
  Quat scene_R_tool = Quat::Identity();
  double zero_m = 0;    ///< height of the tool's reference point for depth, over its origin
  double lowest_m = 0;  ///< height of the tool's lowest point over its origin; negative for plates
  DepthZero zero = DepthZero::kFirstContact;
  double contact_n = 0;  ///< force that counts as contact
  double depth_m = 0;    ///< final depth of the reference point
  double speed_m_s = 0;
  double sample_m = 0;  ///< depth between readings
  double window_m = 0;  ///< depth over which the force of a reading is averaged
  double bed_width_m = 0;
  double bed_depth_m = 0;  ///< depth as filled; the settled depth is PushCurve::bed_depth_m
  Preparation preparation = Preparation::kDense;
  DepthFrom depth_from = DepthFrom::kTips;
  double loose_top_m = 0;  ///< part of bed_depth_m that is poured onto the settled rest
};

struct PushReading {
  double depth_m = 0;
  double force_n = 0;  ///< upward force of the soil on the tool; mean over the window
};

struct PushCurve {
  std::vector<PushReading> readings;  ///< readings from depth 0 to Push::depth_m, every sample_m
  double bed_depth_m = 0;             ///< depth of the settled bed before the push
  double bulk_density_kg_m3 = 0;      ///< density before the push, away from floor and surface
  std::size_t particles = 0;
};

/// Fills a box, lets the soil settle and pushes the tool in: the common part of the plate and cone tests.
/// @throws InvalidParameter as LabBed and for lengths or a speed not above 0; Failure as LabBed::run(), and when the
/// tool does not touch the soil. Not for the tick.
[[nodiscard]] PushCurve pushIntoBed(const LabConditions& conditions, const Push& push);

/// Returns the force at a depth in N, linear between readings.
/// @throws InvalidParameter for a depth outside the readings.
[[nodiscard]] double forceAt(const std::vector<PushReading>& readings, double depth_m);

}  // namespace haptolith
