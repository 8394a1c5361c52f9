#include "haptolith/device/hand/hand_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>

#include "haptolith/core/assert.h"
#include "haptolith/core/math/portable_math.h"
#include "haptolith/core/turn.h"

namespace haptolith {

namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// A pose on the way, in the motion's own measures.
struct KeyPose {
  double share;      ///< fraction of the period
  double out;        ///< distance from the box's axis, in `reach_m`; along x at turn 0
  double turn;       ///< about the box's axis, in turns; the tool turns along
  double height;     ///< height of the tool's origin: 0 surface, 1 home, -1 `depth_m` below the surface
  double nose_deg;   ///< tilt of the tool's x axis: 90 points straight down
  double shake;      ///< share of kShakeAmplitude_m
  double aside = 0;  ///< along y, in `reach_m`
};

constexpr double kShakeAmplitude_m = 0.006;
constexpr double kShakeFrequency_hz = 5;

// Every table begins and ends at home. Heights are those of the tool's centre; the default shovel is 50 mm long, so
// with its nose down at 35 degrees its edge is 14 mm below that.
constexpr KeyPose kStillTable[] = {{0, 0, 0, 1, 0, 0}, {1, 0, 0, 1, 0, 0}};

constexpr KeyPose kPressTable[] = {
    {0.00, 0, 0, 1.0, 0, 0}, {0.20, 0, 0, 0.2, 0, 0},  // above the surface, level
    {0.45, 0, 0, -1., 0, 0}, {0.60, 0, 0, -1., 0, 0},  // press, hold
    {0.80, 0, 0, 0.2, 0, 0}, {1.00, 0, 0, 1.0, 0, 0},
};

constexpr KeyPose kStirTable[] = {
    {0.00, 0.0, 0.0, 1.0, 90, 0}, {0.10, 0.8, 0.0, 0.6, 90, 0},  // blade upright
    {0.20, 0.8, 0.0, 0.1, 90, 0}, {0.85, 0.8, 2.0, 0.1, 90, 0},  // in to half its length; two rounds
    {0.92, 0.8, 2.0, 0.6, 90, 0}, {1.00, 0.0, 2.0, 1.0, 90, 0},
};

constexpr KeyPose kScoopTable[] = {
    {0.00, 0.0, 0, 1.0, 0, 0},    {0.12, -1.0, 0, 0.4, 35, 0},  // behind, nose down
    {0.24, -0.7, 0, -0.3, 35, 0}, {0.42, 0.3, 0, -0.7, 10, 0},  // cut in and forward, levelling
    {0.52, 0.5, 0, -0.2, -12, 0}, {0.66, 0.4, 0, 1.0, -12, 0},  // nose up, lift the load
    {0.74, 0.4, 0, 1.0, -12, 0},  {0.84, 0.0, 0, 0.8, 100, 0},  // wait, tip it out
    {0.92, 0.0, 0, 0.8, 100, 0},  {1.00, 0.0, 0, 1.0, 0, 0},
};

constexpr KeyPose kCarryTable[] = {
    {0.00, 0.0, 0, 1.0, 0, 0},      {0.10, -1.0, 0, 0.4, 35, 0},     {0.20, -0.7, 0, -0.3, 35, 0},
    {0.32, 0.3, 0, -0.7, 10, 0},    {0.40, 0.5, 0, -0.2, -12, 0},    {0.50, 0.5, 0, 0.7, -12, 0},  // as scoop, sooner
    {0.62, 0.5, 0.25, 0.7, -12, 0}, {0.78, 0.5, -0.25, 0.7, -12, 0},  // to one side, to the other
    {0.86, 0.0, 0, 0.8, 100, 0},    {0.92, 0.0, 0, 0.8, 100, 0},     {1.00, 0.0, 0, 1.0, 0, 0},
};

constexpr KeyPose kShakeTable[] = {
    {0.00, 0.0, 0, 1.0, 0, 0},   {0.10, -1.0, 0, 0.4, 35, 0},  {0.20, -0.7, 0, -0.3, 35, 0},
    {0.32, 0.3, 0, -0.7, 10, 0}, {0.40, 0.5, 0, -0.2, -12, 0}, {0.50, 0.5, 0, 0.7, -12, 0},
    {0.55, 0.5, 0, 0.7, 0, 1},   {0.80, 0.5, 0, 0.7, 0, 1},  // shake until only what sticks is left
    {0.84, 0.5, 0, 0.7, 0, 0},   {0.90, 0.0, 0, 0.8, 100, 0},  {1.00, 0.0, 0, 1.0, 0, 0},
};

// Three straight cuts that cross at the centre, the blade leaning back by 20 degrees, its edge ahead.
constexpr KeyPose kCutTable[] = {
    {0.00, 0., 0.0 / 3, 1.0, 70, 0}, {0.05, -1, 0.0 / 3, 0.5, 70, 0}, {0.11, -1, 0.0 / 3, -1., 70, 0},
    {0.25, 1., 0.0 / 3, -1., 70, 0}, {0.31, 1., 0.0 / 3, 0.5, 70, 0},  // in, through, out
    {0.38, -1, 1.0 / 3, 0.5, 70, 0}, {0.44, -1, 1.0 / 3, -1., 70, 0}, {0.58, 1., 1.0 / 3, -1., 70, 0},
    {0.64, 1., 1.0 / 3, 0.5, 70, 0}, {0.70, -1, 2.0 / 3, 0.5, 70, 0}, {0.75, -1, 2.0 / 3, -1., 70, 0},
    {0.88, 1., 2.0 / 3, -1., 70, 0}, {0.93, 1., 2.0 / 3, 0.5, 70, 0}, {1.00, 0., 3.0 / 3, 1.0, 70, 0},
};

// Five parallel straight cuts, each in undisturbed soil, the blade as in a cut; they end in the
// middle of the further half, where the wall ahead has no effect yet.
constexpr KeyPose kFurrowsTable[] = {
    {0.00, 0, 0, 1.0, 70, 0, 0.0},     {0.048, -1, 0, 0.5, 70, 0, -1.4},  {0.072, -1, 0, -1., 70, 0, -1.4},
    {0.172, 0.5, 0, -1., 70, 0, -1.4}, {0.195, 0.5, 0, 0.5, 70, 0, -1.4}, {0.238, -1, 0, 0.5, 70, 0, -0.7},
    {0.262, -1, 0, -1., 70, 0, -0.7},  {0.362, 0.5, 0, -1., 70, 0, -0.7}, {0.385, 0.5, 0, 0.5, 70, 0, -0.7},
    {0.428, -1, 0, 0.5, 70, 0, 0.0},   {0.452, -1, 0, -1., 70, 0, 0.0},   {0.552, 0.5, 0, -1., 70, 0, 0.0},
    {0.575, 0.5, 0, 0.5, 70, 0, 0.0},  {0.618, -1, 0, 0.5, 70, 0, 0.7},   {0.642, -1, 0, -1., 70, 0, 0.7},
    {0.742, 0.5, 0, -1., 70, 0, 0.7},  {0.765, 0.5, 0, 0.5, 70, 0, 0.7},  {0.808, -1, 0, 0.5, 70, 0, 1.4},
    {0.832, -1, 0, -1., 70, 0, 1.4},   {0.932, 0.5, 0, -1., 70, 0, 1.4},  {0.955, 0.5, 0, 0.5, 70, 0, 1.4},
    {1.00, 0, 0, 1.0, 70, 0, 0.0},
};

std::span<const KeyPose> tableOf(HandMotion motion) {
  switch (motion) {
    case HandMotion::kPress: return kPressTable;
    case HandMotion::kStir: return kStirTable;
    case HandMotion::kScoop: return kScoopTable;
    case HandMotion::kCarry: return kCarryTable;
    case HandMotion::kShake: return kShakeTable;
    case HandMotion::kCut: return kCutTable;
    case HandMotion::kFurrows: return kFurrowsTable;
    case HandMotion::kStill:
    case HandMotion::kPoses: break;
  }
  return kStillTable;
}

/// When a gripper closes and opens, in shares of the period.
struct Grip {
  double closes, closed, opens, open;
};

std::optional<Grip> gripOf(HandMotion motion) {
  switch (motion) {
    case HandMotion::kScoop: return Grip{0.34, 0.44, 0.74, 0.84};
    case HandMotion::kCarry: return Grip{0.26, 0.34, 0.78, 0.86};
    case HandMotion::kShake: return Grip{0.26, 0.34, 0.84, 0.90};
    default: return {};
  }
}

/// Minimum-jerk course from 0 to 1.
double minimumJerk(double s) {
  return s * s * s * (10 - s * (15 - 6 * s));
}

/// Height of a key pose in m above the surface. Mixed in metres: in its own measure, whose unit changes at the surface,
/// a movement through the surface would change its speed there at once.
double heightOf(const KeyPose& key, const HandParameters& hand) {
  return key.height < 0 ? key.height * hand.depth_m : key.height * hand.home_m.z();
}

/// Pose of the motion at a fraction of its period; here `height` is in m above the surface.
KeyPose interpolate(std::span<const KeyPose> table, double share, const HandParameters& hand) {
  std::size_t next = 1;
  while (next + 1 < table.size() && share > table[next].share) {
    ++next;
  }
  const KeyPose& a = table[next - 1];
  const KeyPose& b = table[next];
  const double s = minimumJerk((share - a.share) / (b.share - a.share));
  const auto mix = [s](double from, double to) { return from + s * (to - from); };
  return {share,
          mix(a.out, b.out),
          mix(a.turn, b.turn),
          mix(heightOf(a, hand), heightOf(b, hand)),
          mix(a.nose_deg, b.nose_deg),
          mix(a.shake, b.shake),
          mix(a.aside, b.aside)};
}

/// Elapsed fraction of the period.
double shareOfPeriod(const HandParameters& hand, double time_s) {
  HAPTO_ASSERT(hand.period_s > 0);
  const double last_end_s = std::ceil(hand.active_s / hand.period_s) * hand.period_s;
  return time_s < last_end_s ? std::fmod(time_s, hand.period_s) / hand.period_s : 0;
}

}  // namespace

double handMotionOpening(const HandParameters& hand, double time_s) noexcept {
  const std::optional<Grip> grip = gripOf(hand.motion);
  if (!grip) {
    return 1;
  }
  const double share = shareOfPeriod(hand, time_s);
  const auto course = [share](double from, double to) {
    return minimumJerk(std::clamp((share - from) / (to - from), 0.0, 1.0));
  };
  return std::clamp(1 - course(grip->closes, grip->closed) + course(grip->opens, grip->open), 0.0, 1.0);
}

Pose handMotionPose(const HandParameters& hand, double time_s) noexcept {
  const KeyPose key = interpolate(tableOf(hand.motion), shareOfPeriod(hand, time_s), hand);

  const double angle = kTurn * key.turn;
  const double out_m = key.out * hand.reach_m;
  const double shake_m = key.shake * kShakeAmplitude_m * portable::sin(kTurn * kShakeFrequency_hz * time_s);

  // A stirring blade faces the way it goes; everything else looks outwards.
  const double yaw = hand.motion == HandMotion::kStir ? angle + kTurn / 4 : angle;
  const double nose = key.nose_deg * kTurn / 360;
  const Quat facing = turnAbout(Vec3::UnitZ(), yaw) * turnAbout(Vec3::UnitY(), nose);
  return {Vec3(hand.home_m.x() + out_m * portable::cos(angle),
               hand.home_m.y() + out_m * portable::sin(angle) + key.aside * hand.reach_m,
               hand.surface_m.value_or(0) + key.height + shake_m),
          hand.turn_rad.isZero(0) ? facing : facing * turnAboutXyz(hand.turn_rad)};
}

}  // namespace haptolith
