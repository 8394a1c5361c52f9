#include "haptolith/teleop/operator/site_probe.h"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "haptolith/bed/measure/surface_height.h"
#include "haptolith/core/error.h"
#include "haptolith/identify/measured_movement.h"

namespace haptolith {

namespace {

constexpr std::uint32_t kProbeConnection = 1;
constexpr std::uint64_t kAnotherPlace = 1000;  ///< seed offset of the site: another realisation
constexpr std::uint64_t kKeyEvery = 20;        ///< ticks
constexpr std::uint64_t kLookEvery = 250;

BedParameters untouched(const SceneFile& site) {
  const DiggingField field;
  BedParameters bed = site.bed;
  bed.width_m = field.width_m;
  bed.length_m = field.length_m;
  bed.depth_m = field.depth_m;
  bed.start = BedStart::kSettled;
  bed.seed += kAnotherPlace;
  // Only what the tool stirs is worked on: see BedParameters::sleep.
  bed.sleep_speed_m_s = 0.01;
  bed.sleep_distance_m = bed.soil.radius_m / 100;
  return bed;
}

/// Commands that the operator's program would send: the movement, once it has begun.
class ProbeCommands {
 public:
  ProbeCommands(const ToolMovement& movement, double tick_s) : movement_(movement), tick_s_(tick_s) {}

  void begin(std::uint64_t index) {
    begin_ = begun_ ? begin_ : index;
    begun_ = true;
  }
  /// Time of the movement at a command; before its beginning, below 0.
  [[nodiscard]] double time(double index) const {
    return begun_ ? (index - static_cast<double>(begin_)) * tick_s_ : -1;
  }
  [[nodiscard]] Keyframe key(std::uint64_t index) const {
    const double time_s = time(static_cast<double>(index));
    const Pose before = movement_.at(time_s - tick_s_), after = movement_.at(time_s + tick_s_);
    Keyframe key{index, {}};
    key.hand.pose = movement_.at(time_s);
    key.hand.twist = {(after.position_m - before.position_m) / (2 * tick_s_),
                      rotationBetween(before.orientation, after.orientation) / (2 * tick_s_)};
    return key;
  }

 private:
  const ToolMovement& movement_;
  double tick_s_;
  bool begun_ = false;
  std::uint64_t begin_ = 0;
};

}  // namespace

ProbedSoil probeSite(const SceneFile& site, const RobotParameters& parameters, const Training& training,
                     const LabProgress& progress) {
  const ToolMovement& movement = training.movement;
  const double tick_s = site.loop.tick_s;
  Scene scene(untouched(site), site.tool);
  Robot robot(parameters, scene, meanSurfaceHeight(scene.bed()), movement.at(0));
  ProbeCommands commands(movement, tick_s);
  std::vector<MeasuredSample> samples;
  constexpr double kPatience_s = 30;  // to tare and to go there
  constexpr std::uint64_t kAhead = 500;
  const auto most = static_cast<std::uint64_t>((movement.duration() + kPatience_s) / tick_s);
  for (std::uint64_t tick = 0; tick < most && commands.time(robot.index()) < movement.duration(); ++tick) {
    if (progress && tick % kLookEvery == 0 &&
        !progress("the robot probes", static_cast<double>(tick) / static_cast<double>(most))) {
      throw Failure("interrupted");
    }
    if (robot.state() == RobotState::kFollowing) {
      commands.begin(tick + kAhead);
    }
    if (tick % kKeyEvery == 0) {
      const std::array keyframes{commands.key(tick + 1)};
      robot.take(kProbeConnection, true, keyframes);
    }
    robot.tick();
    const double time_s = commands.time(robot.index());
    if (robot.state() == RobotState::kFollowing && (samples.empty() || time_s > samples.back().time_s)) {
      samples.push_back({time_s, robot.tool().pose, robot.met().force_n});
    }
  }
  const MatchedForces matched = matchForces(movement, samples, Vec3::Zero());
  if (matched.windows == 0) {
    throw Failure("the robot's tool did not follow the probe");
  }
  const SoilIdentifier identifier(training);
  return {identifier.identify(matched.forces, site.bed.gravity_m_s2.norm()), matched.windows, matched.forces.size()};
}

SceneFile withBelievedSoil(SceneFile model, const SoilBelief& belief, const StrengthMap& strengths) {
  if (model.bed.soil.friction != FrictionModel::kContact) {
    throw InvalidParameter("model: soil.friction_model", "icra2021",
                           "contact: the strength of 'icra2021' friction cannot be estimated from digging");
  }
  model.bed.soil = strengths.with(model.bed.soil, {belief.friction_angle_deg.middle, belief.cohesion_pa.middle});
  model.tool.friction = std::tan(belief.tool_friction_angle_deg.middle * std::numbers::pi / 180);
  model.preset.clear();
  model.soil_name.clear();
  return model;
}

}  // namespace haptolith
