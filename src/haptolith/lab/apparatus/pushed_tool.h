#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "haptolith/lab/apparatus/lab_bed.h"
#include "haptolith/lab/laboratory.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// Where depth 0 is.
enum class DepthZero {
  kFirstContact,  ///< where the force first exceeds Push::contact_n, unless Push::depth_from says kSurface
  kSurface,       ///< at LabBed::surfaceHeight(Push::depth_from) of the bed before
};

/// A tool that is pushed straight down into the middle of a square box of soil, at constant speed.
struct Push {
  std::string_view what;  ///< in words, for the conditions' progress
  ToolParameters tool;
  Quat scene_R_tool = Quat::Identity();
  double zero_m = 0;    ///< height of the tool's point that depth is counted from, over its origin
  double lowest_m = 0;  ///< height of its lowest point over its origin; negative for plates
  DepthZero zero = DepthZero::kFirstContact;
  double contact_n = 0;  ///< force that counts as contact
  double depth_m = 0;    ///< to push, of the point at `zero_m`
  double speed_m_s = 0;
  double sample_m = 0;  ///< depth from one reading to the next
  double window_m = 0;  ///< depth over which a reading is the mean force
  double bed_width_m = 0;
  double bed_depth_m = 0;  ///< as filled; the settled one is PushCurve::bed_depth_m
  Preparation preparation = Preparation::kDense;
  DepthFrom depth_from = DepthFrom::kTips;
  double loose_top_m = 0;  ///< of bed_depth_m, poured onto the rest when that has settled
};

struct PushReading {
  double depth_m = 0;
  double force_n = 0;  ///< upwards, of the soil on the tool; mean over the window
};

struct PushCurve {
  std::vector<PushReading> readings;  ///< from depth 0 to Push::depth_m, every sample_m
  double bed_depth_m = 0;             ///< the surface before the push
  double bulk_density_kg_m3 = 0;      ///< before the push, away from floor and surface
  std::size_t particles = 0;
};

/// Fills a box, lets the soil settle and pushes the tool in: what plates and cones have in common.
/// @throws InvalidParameter as LabBed and where lengths or the speed are not above 0; Failure as LabBed::run(), and
/// when the tool never touches the soil. Not for the tick.
[[nodiscard]] PushCurve pushIntoBed(const LabConditions& conditions, const Push& push);

/// Force at a depth between the first and the last reading, in N: linear between readings.
/// @throws InvalidParameter outside them.
[[nodiscard]] double forceAt(const std::vector<PushReading>& readings, double depth_m);

}  // namespace haptolith
