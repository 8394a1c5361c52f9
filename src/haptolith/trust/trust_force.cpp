#include "haptolith/trust/trust_force.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <numeric>
#include <vector>

#include "haptolith/bed/measure/double_step.h"
#include "haptolith/bed/measure/vertical_load.h"
#include "haptolith/core/error.h"
#include "haptolith/core/platform/clock.h"
#include "haptolith/lab/tests/shear.h"
#include "haptolith/tool/tool_shape.h"
#include "haptolith/trust/moving_scene.h"

namespace haptolith {

namespace {

/// The reach so far, with the tool where it is now.
void extend(TrustReach& reach, const Scene& scene, double surface_m) {
  const ToolCorners box = cornersOf(scene.tool());
  const Pose pose = scene.turnedToolPose();
  const BedParameters& bed = scene.bed().parameters();
  for (int corner = 0; corner < 8; ++corner) {
    const auto end = [&](int axis) { return (corner >> axis & 1) == 0 ? box.low_m[axis] : box.high_m[axis]; };
    const Vec3 at = pose.position_m + pose.orientation * Vec3(end(0), end(1), end(2));
    reach.to_floor_m = std::min(reach.to_floor_m, at.z());
    if (at.z() < surface_m) {
      reach.depth_m = std::max(reach.depth_m, surface_m - at.z());
      reach.to_wall_x_m = std::min(reach.to_wall_x_m, bed.width_m / 2 - std::abs(at.x()));
      reach.to_wall_y_m = std::min(reach.to_wall_y_m, bed.length_m / 2 - std::abs(at.y()));
    }
  }
}

/// Mean and peak of the magnitudes, one for each tick.
void summarise(const std::vector<double>& force_n, double tick_s, TrustForce& force) {
  if (force_n.empty()) {
    return;
  }
  force.mean_n = std::accumulate(force_n.begin(), force_n.end(), 0.0) / static_cast<double>(force_n.size());
  const auto peak = std::min(static_cast<std::size_t>(std::lround(TrustForce::kPeak_s / tick_s)), force_n.size());
  double sum = 0;
  for (std::size_t i = 0; i < force_n.size(); ++i) {
    sum += force_n[i] - (i >= peak ? force_n[i - peak] : 0);
    if (i + 1 >= peak) {
      force.peak_n = std::max(force.peak_n, sum / static_cast<double>(peak));
    }
  }
}

void requireGoingOn(const TrustProgress& progress, std::string_view what, double fraction) {
  if (progress && !progress(what, fraction)) {
    throw Failure("interrupted");
  }
}

std::optional<double> stressRatio(const Bed& bed, double surface_m) {
  const BedParameters& parameters = bed.parameters();
  const Vec3& gravity = parameters.gravity_m_s2;
  if (parameters.soil.friction != FrictionModel::kContact || grainClasses(parameters) > 1 || parameters.stones.any() ||
      gravity.x() != 0 || gravity.y() != 0 || gravity.z() >= 0) {
    return std::nullopt;
  }
  double sum = 0;
  constexpr int kLevels = 5;
  for (int level = 1; level <= kLevels; ++level) {
    const VerticalLoad load = verticalLoad(bed, surface_m * level / (kLevels + 1));
    if (load.weight_n <= 0) {
      return std::nullopt;
    }
    sum += load.carried_n / load.weight_n;
  }
  return sum / kLevels;
}

std::size_t ticksFor(const SceneFile& scene, double duration_s) {
  return static_cast<std::size_t>(std::lround(duration_s / scene.bed.tick_s));
}

}  // namespace

TrustForce measureForce(const TrustRun& run, double duration_s, int threads, const TrustProgress& progress) {
  const std::int64_t began_ns = monotonicNs();
  MovingScene movement(run, threads, progress);
  Scene& scene = movement.scene();
  TrustForce force;
  force.surface_m = movement.surface();
  force.particles = scene.bed().particles();
  force.substeps = scene.substeps();
  const std::int64_t settled_ns = monotonicNs();
  force.stress_ratio = stressRatio(scene.bed(), force.surface_m);
  const double energy_before_j = scene.bed().energy();
  constexpr double kFar_m = std::numeric_limits<double>::max();
  force.reach = {.depth_m = 0, .to_floor_m = kFar_m, .to_wall_x_m = kFar_m, .to_wall_y_m = kFar_m};

  const std::size_t ticks = ticksFor(run.scene, duration_s);
  std::vector<double> force_n;
  force_n.reserve(ticks);
  constexpr std::size_t kTicksPerLook = 20;
  std::vector<Pose> before(scene.tools());
  bool going_on = true;
  while (going_on && force_n.size() < ticks) {
    going_on = movement.tick();
    force_n.push_back(scene.soilWrench().force_n.norm());
    for (std::size_t tool = 0; tool < before.size(); ++tool) {
      const Pose& now = scene.toolPose(tool);
      if (force_n.size() > 1) {  // in the first tick it is placed
        const Wrench& soil = scene.soilWrench(tool);
        force.work_j -= soil.force_n.dot(now.position_m - before[tool].position_m) +
                        soil.torque_nm.dot(rotationBetween(before[tool].orientation, now.orientation));
      }
      before[tool] = now;
    }
    if (force_n.size() % kTicksPerLook == 0) {
      extend(force.reach, scene, force.surface_m);
      requireGoingOn(progress, "the tool moves",
                     0.5 + 0.5 * static_cast<double>(force_n.size()) / static_cast<double>(ticks));
    }
  }
  summarise(force_n, run.scene.bed.tick_s, force);
  force.energy_gain_j = scene.bed().energy() - energy_before_j;
  force.hash = scene.hash();
  force.settling_s = 1e-9 * static_cast<double>(settled_ns - began_ns);
  force.movement_s = 1e-9 * static_cast<double>(monotonicNs() - settled_ns);
  return force;
}

TrustBits checkBits(const TrustRun& run, double duration_s, const TrustProgress& progress) {
  MovingScene moving(run, 1, progress);
  const SceneFile& file = moving.file();
  Scene& one = moving.scene();
  BedParameters on_two = file.bed;
  on_two.threads = 2;
  Scene two(on_two, toolSet(file));
  std::unique_ptr<Scene> continued;

  // The soil does not move the hand here: all scenes get one movement.
  const std::vector<HandState> begun = moving.nextMovements();
  for (std::size_t tool = 0; tool < begun.size(); ++tool) {
    one.placeTool({{begun[tool].pose, {}}, 1}, tool);
    two.placeTool({{begun[tool].pose, {}}, 1}, tool);
  }
  const std::size_t ticks = ticksFor(run.scene, duration_s);
  TrustBits bits;
  for (std::size_t tick = 0; tick < ticks; ++tick) {
    if (hasDoubleStep(one.bed()) && ticks >= 4 && tick > 0 && tick % (ticks / 4) == 0) {
      const StepError error = compareWithDouble(one.bed(), file.bed.tick_s / one.substeps());
      bits.rounding = std::max(bits.rounding.value_or(0), error.force_n > 0 ? error.error_n / error.force_n : 0);
    }
    if (tick % 100 == 0) {
      requireGoingOn(progress, "bits are compared", static_cast<double>(tick) / static_cast<double>(ticks));
    }
    if (tick == ticks / 2) {
      continued = std::make_unique<Scene>(file.bed, toolSet(file), one.save());
    }
    const std::vector<HandState> movements = moving.nextMovements();
    for (Scene* scene : {&one, &two, continued.get()}) {
      if (scene != nullptr && scene->tickAll(movements) != StepStatus::kOk) {
        throw Failure("the movement could not be rendered");
      }
    }
  }
  bits.threads = one.hash() == two.hash();
  bits.restart = continued && one.hash() == continued->hash();
  return bits;
}

TrustStrength measureStrength(const SoilParameters& soil, const SoilTarget& target, double gravity_m_s2, int threads,
                              const TrustProgress& progress) {
  const ShearResult sheared =
      shearTest({.soil = soil, .gravity_m_s2 = gravity_m_s2, .seed = 1, .threads = threads, .progress = progress});
  const MohrCoulomb& line = target.strength == SoilStrength::kPeak ? sheared.peak : sheared.residual;
  constexpr double kDegrees = 180 / std::numbers::pi;
  return {.asked_deg = target.friction_angle_deg,
          .shown_deg = kDegrees * line.friction_angle_rad,
          .error_deg = kDegrees * line.friction_angle_se_rad,
          .asked_pa = target.cohesion_pa,
          .shown_pa = line.cohesion_pa,
          .error_pa = line.cohesion_se_pa};
}

}  // namespace haptolith
