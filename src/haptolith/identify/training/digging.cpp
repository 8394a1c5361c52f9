#include "haptolith/identify/training/digging.h"

#include <cmath>

#include "haptolith/bed/measure/surface_height.h"
#include "haptolith/core/error.h"
#include "haptolith/scene/scene.h"

namespace haptolith {

namespace {

BedParameters bedFor(const SoilSample& sample, const DiggingField& field) {
  BedParameters bed;
  bed.soil = sample.soil;
  bed.gravity_m_s2 = {0, 0, -field.gravity_m_s2};
  bed.width_m = field.width_m;
  bed.length_m = field.length_m;
  bed.depth_m = field.depth_m;
  bed.start = BedStart::kSettled;
  bed.seed = field.seed;
  // As needed for beds that are dug in: see BedParameters::sleep.
  bed.sleep_speed_m_s = 0.01;
  bed.sleep_distance_m = sample.soil.radius_m / 100;
  if (sample.stone_size_m > 0) {
    bed.stones.placed.push_back({.size_m = sample.stone_size_m,
                                 .seed = field.seed,
                                 .x_m = stonePlace().x(),
                                 .y_m = stonePlace().y(),
                                 .depth_m = -stonePlace().z()});
  }
  return bed;
}

ToolParameters toolIn(const SoilSample& sample, ToolParameters tool) {
  tool.friction = sample.tool_friction;
  tool.adhesion_n = sample.tool_adhesion_n;
  return tool;
}

}  // namespace

WindowForces digAlong(const ToolMovement& movement, const ToolParameters& tool, const SoilSample& sample,
                      const DiggingField& field, const LabProgress& progress) {
  const auto tell = [&](std::string_view what, double share) {
    if (progress && !progress(what, share)) {
      throw Failure("interrupted");
    }
    return true;
  };
  Scene scene(bedFor(sample, field), toolIn(sample, tool), [&](double, double) { return tell("soil settles", 0); });
  const double zero_m = meanSurfaceHeight(scene.bed()) - sample.surface_error_m;
  const auto hand_at = [&](double time_s) {
    HandState hand;
    hand.pose = movement.at(time_s);
    hand.pose.position_m.z() += zero_m;
    return hand;
  };
  const double tick_s = scene.bed().parameters().tick_s;
  const auto per_window = static_cast<int>(std::llround(kForceWindow_s / tick_s));
  const auto windows = static_cast<std::size_t>(movement.duration() / kForceWindow_s);
  scene.placeTool(hand_at(0));
  WindowForces forces;
  double time_s = 0;
  while (forces.size() < windows) {
    tell("the tool digs", static_cast<double>(forces.size()) / static_cast<double>(windows));
    Vec3 sum_n = Vec3::Zero();
    for (int i = 0; i < per_window; ++i) {
      time_s += tick_s;
      const HandState before = hand_at(time_s - tick_s);
      HandState hand = hand_at(time_s);
      hand.twist = {(hand.pose.position_m - before.pose.position_m) / tick_s,
                    rotationBetween(before.pose.orientation, hand.pose.orientation) / tick_s};
      if (scene.tick(hand) != StepStatus::kOk) {
        throw Failure("the bed is no longer sound");
      }
      sum_n += scene.soilWrench().force_n;
    }
    forces.emplace_back(sum_n / per_window);
  }
  return forces;
}

}  // namespace haptolith
