#include "haptolith/study/perception/exploration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <random>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/math/random.h"
#include "haptolith/core/statistics.h"
#include "haptolith/core/stop_asked.h"
#include "haptolith/device/hand/hand_motion.h"
#include "haptolith/device/hand/virtual_hand.h"
#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/scene_file/scene_words.h"
#include "haptolith/study/results/tick_summary.h"
#include "haptolith/tool/tool_shape.h"

namespace haptolith {

namespace {

constexpr double kPlace_m = 0.005;  // at larger offsets a particle jams between the tool and a wall
constexpr double kTempo = 0.1, kDepth = 0.1, kArm = 0.2;

constexpr int kMostRounds = 1000;
constexpr int kTicksPerLook = 20;  ///< ticks between two measurements of the soil on the tool

void validate(const ExplorationOptions& options) {
  if (options.motion == HandMotion::kPoses) {
    throw InvalidParameter("motion", "poses", "a built-in motion: still, press, stir, scoop ...");
  }
  requireInRange("rounds", options.rounds, {1, kMostRounds});
  requireInRange("variation", options.variation, {0, 2});
}

/// Turns (and mirrors) soil and stones, for a hand that comes from another side.
LyingSoil turned(LyingSoil lying, const ExploringHand& from) {
  for (Float4& p : lying.grains) {
    p.y = from.mirrored ? -p.y : p.y;
    for (int turn = 0; turn < from.quarter_turns; ++turn) {
      p = {-p.y, p.x, p.z, p.w};
    }
  }
  const Quat turn(Eigen::AngleAxisd(from.quarter_turns * std::numbers::pi / 2, Vec3::UnitZ()));
  for (Pose& pose : lying.stones) {
    pose.position_m = turn * pose.position_m;
    pose.orientation = turn * pose.orientation;
  }
  return lying;
}

std::vector<Vec3> centresOf(const std::vector<Float4>& grains) {
  std::vector<Vec3> centres_m;
  centres_m.reserve(grains.size());
  for (const Float4& p : grains) {
    centres_m.emplace_back(p.x, p.y, p.z);
  }
  return centres_m;
}

/// Surface of the soil from above: the highest particle of each cell, which is as wide as a particle. Particles above
/// `ceiling_m` cling to the tool or fly; they are left out.
class Surface {
 public:
  Surface(const std::vector<Vec3>& centres_m, const BedParameters& bed,
          double ceiling_m = std::numeric_limits<double>::infinity())
      : cell_m_(2 * bed.soil.radius_m),
        columns_(cells(bed.width_m)),
        rows_(cells(bed.length_m)),
        low_m_(-bed.width_m / 2, -bed.length_m / 2),
        highest_(columns_ * rows_, kNone) {
    for (std::size_t i = 0; i < centres_m.size(); ++i) {
      if (centres_m[i].z() > ceiling_m) {
        continue;
      }
      std::size_t& highest = highest_[cellOf(centres_m[i])];
      highest = highest == kNone || centres_m[i].z() > centres_m[highest].z() ? i : highest;
    }
  }

  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  /// Returns the highest particle of each cell; kNone for an empty cell.
  [[nodiscard]] const std::vector<std::size_t>& highest() const { return highest_; }

 private:
  [[nodiscard]] std::size_t cells(double length_m) const {
    return std::max(std::size_t{1}, static_cast<std::size_t>(length_m / cell_m_));
  }
  [[nodiscard]] std::size_t cellOf(const Vec3& p_m) const {
    const auto along = [this](double from_m, std::size_t count) {
      return std::min(count - 1, static_cast<std::size_t>(std::max(0.0, from_m / cell_m_)));
    };
    return along(p_m.y() - low_m_.y(), rows_) * columns_ + along(p_m.x() - low_m_.x(), columns_);
  }

  double cell_m_;
  std::size_t columns_, rows_;
  Eigen::Vector2d low_m_;
  std::vector<std::size_t> highest_;
};

/// Whether the tool holds soil up: its nose is up and it is near its highest position, where it is almost at rest.
bool carries(const Pose& scene_T_tool, const HandParameters& hand) {
  constexpr double kNoseUp = 0.1;  // sine of 6 degrees
  const Vec3 nose = scene_T_tool.orientation * Vec3::UnitX();
  return nose.z() > kNoseUp && scene_T_tool.position_m.z() - hand.surface_m.value_or(0) > 0.9 * hand.home_m.z();
}

/// Returns the mass of the soil in or above the tool, up to the maximum height of a heap on it, in kg.
double massAbove(const Scene& scene) {
  const ToolCorners corners = cornersOf(scene.tool());
  const double reach_m = corners.high_m.x() - corners.low_m.x();
  const double radius_m = scene.bed().parameters().soil.radius_m;
  double mass_kg = 0;
  for (std::size_t i = 0; i < scene.bed().particles(); ++i) {
    const Float4& p = scene.bed().state().position[i];
    const Vec3 there_m = scene.toolPose().toBody(Vec3(p.x, p.y, p.z));
    const auto beside = [&](int axis) {
      return there_m[axis] < corners.low_m[axis] - radius_m || there_m[axis] > corners.high_m[axis] + radius_m;
    };
    const bool within = !beside(0) && !beside(1) && there_m.z() > corners.low_m.z() && there_m.z() < reach_m;
    mass_kg += within ? scene.bed().mass() : 0;
  }
  return mass_kg;
}

/// Largest height with a soil force, for each entry of the tool into the soil.
class TouchHeight {
 public:
  void add(double height_m, double force_n) {
    constexpr double kTouch_n = 0.1;   // well above the detection threshold
    constexpr double kClear_m = 0.01;  // the tool has left the soil at this height above the last contact
    if (force_n >= kTouch_n) {
      if (clear_) {
        highest_m_.push_back(height_m);
      }
      highest_m_.back() = std::max(highest_m_.back(), height_m);
      clear_ = false;
    } else {
      clear_ = clear_ || height_m > highest_m_.back() + kClear_m;
    }
  }
  /// Returns the mean over all entries; NaN if there was none.
  [[nodiscard]] double mean() const { return haptolith::mean(highest_m_); }

 private:
  std::vector<double> highest_m_;
  bool clear_ = true;
};

/// Mean that is NaN without values.
class Mean {
 public:
  void add(double value) {
    sum_ += value;
    ++count_;
  }
  [[nodiscard]] double value() const { return sum_ / count_; }

 private:
  double sum_ = 0;
  int count_ = 0;
};

}  // namespace

Picture pictureOf(const std::vector<Vec3>& before_m, const std::vector<Vec3>& after_m, const BedParameters& bed) {
  const auto height = [](const Vec3& a, const Vec3& b) { return a.z() < b.z(); };
  const double ceiling_m = std::ranges::max_element(before_m, height)->z() + 4 * bed.soil.radius_m;
  const std::vector<std::size_t> at_first = Surface(before_m, bed).highest();
  const std::vector<std::size_t> in_the_end = Surface(after_m, bed, ceiling_m).highest();
  Picture seen;
  Mean height_m, moved_m;
  for (std::size_t cell = 0; cell < at_first.size(); ++cell) {
    const std::size_t top = at_first[cell];
    if (top == Surface::kNone) {
      continue;
    }
    height_m.add(before_m[top].z() + bed.soil.radius_m);
    if (after_m[top].z() <= ceiling_m) {
      moved_m.add((after_m[top] - before_m[top]).norm());
    }
    const double now_m = in_the_end[cell] == Surface::kNone ? -bed.soil.radius_m : after_m[in_the_end[cell]].z();
    seen.heave_m = std::max(seen.heave_m, now_m - before_m[top].z());
    seen.hollow_m = std::max(seen.hollow_m, before_m[top].z() - now_m);
  }
  seen.height_m = height_m.value();
  seen.moved_m = moved_m.value();
  return seen;
}

LevelBed levelBed(const SceneFile& scene_file, const SettleProgress& progress) {
  requireOneTool(scene_file, "simulated explorations");
  const Scene scene(scene_file.bed, scene_file.tool, progress);
  return {.lying = scene.bed().lying(), .surface_m = scene.bed().surfaceHeight()};
}

ExploringHand exploringHand(const SceneFile& scene_file, const ExplorationOptions& options) {
  validate(options);
  std::mt19937_64 random(options.seed);
  const auto about = [&](double share) { return 1 + options.variation * share * uniformSigned(random); };
  ExploringHand exploring{.hand = scene_file.hand};
  HandParameters& hand = exploring.hand;
  hand.motion = options.motion;
  hand.home_m.x() += options.variation * kPlace_m * uniformSigned(random);
  hand.home_m.y() += options.variation * kPlace_m * uniformSigned(random);
  hand.period_s *= about(kTempo);
  hand.depth_m *= about(kDepth);
  const double arm = about(kArm);
  hand.mass_kg *= arm;
  hand.damping_n_s_m *= arm;
  hand.stiffness_n_m *= arm;
  if (options.variation > 0) {
    const bool square = scene_file.bed.width_m == scene_file.bed.length_m;
    exploring.quarter_turns = square ? static_cast<int>(random() % 4) : 2 * static_cast<int>(random() % 2);
    exploring.mirrored = random() % 2 == 1 && !scene_file.bed.stones.any();
  }
  return exploring;
}

void requireReach(const SceneFile& scene_file, HandMotion motion) {
  HandParameters hand = scene_file.hand;
  hand.motion = motion;
  hand.surface_m = 0;
  const ToolCorners corners = cornersOf(scene_file.tool);
  constexpr int kPlaces = 200;  // sampled poses of a motion
  double lowest_m = std::numeric_limits<double>::infinity();
  for (int place = 0; place < kPlaces; ++place) {
    const Pose scene_T_tool = handMotionPose(hand, hand.period_s * place / kPlaces);
    for (int corner = 0; corner < 8; ++corner) {
      const auto along = [&](int axis) {
        return ((corner >> axis) & 1) == 0 ? corners.low_m[axis] : corners.high_m[axis];
      };
      lowest_m = std::min(lowest_m, scene_T_tool.fromBody(Vec3(along(0), along(1), along(2))).z());
    }
  }
  const double radius_m = scene_file.bed.soil.radius_m;
  if (-lowest_m < radius_m) {
    throw InvalidParameter("motion",
                           fmt::format("{}, which moves the tool {:.1f} mm below the surface",
                                       wordFor(kHandMotionWords, motion), 1e3 * std::max(0.0, -lowest_m)),
                           fmt::format("a motion that reaches at least one particle radius, {:g} mm", 1e3 * radius_m));
  }
}

Exploration explore(const SceneFile& scene_file, const LevelBed& bed, const ExplorationOptions& options) {
  return explore(scene_file, bed, exploringHand(scene_file, options), options.rounds);
}

Exploration explore(const SceneFile& scene_file, const LevelBed& bed, const ExploringHand& exploring, int rounds) {
  SceneFile explored = scene_file;
  explored.device.kind = DeviceKind::kVirtualHand;
  explored.loop.real_time = false;
  explored.hand = exploring.hand;
  explored.hand.surface_m = scene_file.hand.surface_m.value_or(bed.surface_m);
  const LyingSoil before = turned(bed.lying, exploring);
  Scene scene(explored.bed, explored.tool, before);
  VirtualHand hand(explored.hand, explored.bed.tick_s);
  HapticLoop loop(scene, hand, explored.loop, true, handlingOf(explored, *explored.hand.surface_m));

  TickSummary summed;
  Mean carried_n, carried_kg;
  TouchHeight touch_height;
  double lowest_m = std::numeric_limits<double>::infinity();
  std::vector<TickRecord> records;
  const auto ticks = std::llround(rounds * explored.hand.period_s / explored.loop.tick_s);
  for (long long tick = 0; tick < ticks; ++tick) {
    throwIfStopped();
    if (const LoopEnd end = loop.tick(); end != LoopEnd::kRunning) {
      throw Failure(fmt::format("the exploration ended after {:g} s: {}", loop.time(), text(end)));
    }
    records.clear();
    loop.takeRecords(records);
    summed.add(records.back());
    lowest_m = std::min(lowest_m, scene.toolPose().position_m.z());
    touch_height.add(scene.toolPose().position_m.z(), records.back().sent.wrench.force_n.norm());
    if (carries(scene.toolPose(), explored.hand)) {
      carried_n.add(-records.back().sent.wrench.force_n.z());
      if (tick % kTicksPerLook == 0) {
        carried_kg.add(massAbove(scene));
      }
    }
  }
  Exploration done{.summary = summed.summary()};
  done.drag_n = done.summary.work_j / done.summary.path_m;
  done.carried_n = carried_n.value();
  done.carried_kg = carried_kg.value();
  done.seen = pictureOf(centresOf(before.grains), centresOf(scene.bed().lying().grains), explored.bed);
  done.seen.reached_m = bed.surface_m - lowest_m;
  done.seen.load_m = std::cbrt(done.carried_kg / explored.bed.soil.rho0_kg_m3);
  done.touched_up_to_m = touch_height.mean();
  return done;
}

Exploration explore(const SceneFile& scene_file, const ExplorationOptions& options) {
  return explore(scene_file, levelBed(scene_file), options);
}

}  // namespace haptolith
