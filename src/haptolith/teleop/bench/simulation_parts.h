#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "haptolith/bed/measure/surface_height.h"
#include "haptolith/teleop/bench/simulation.h"

namespace haptolith::simulation {

// Common parts of simulations of teleoperation with any feedback. Inside this folder alone.

inline constexpr double kInSoil_n = 0.2;  // more than this on the tool, and it is not in the air
inline constexpr std::uint64_t kLookEvery = 250;

/// A bed with its tool, and where its soil's surface is.
struct Site {
  explicit Site(const SceneFile& scene_file)
      : scene(scene_file.bed, scene_file.tool), surface_m(meanSurfaceHeight(scene.bed())) {
    requireOneTool(scene_file, "a robot");
  }

  /// Over the surface that it began with.
  [[nodiscard]] std::vector<double> heights(const HeightGrid& grid) const {
    constexpr std::size_t kRays = 4;
    std::vector<double> heights = surfaceHeights(seenSoil(scene.bed()), grid, kRays);
    for (double& height : heights) {
      height -= surface_m;
    }
    return heights;
  }

  Scene scene;
  double surface_m;
};

/// Energy given to the hand by the displayed forces, each held until the next.
class EnergyGiven {
 public:
  void tick(const Pose& hand, const Wrench& shown) noexcept {
    if (known_) {
      given_j_ += shown_.force_n.dot(hand.position_m - last_.position_m) +
                  shown_.torque_nm.dot(rotationBetween(last_.orientation, hand.orientation));
      most_j_ = std::max(most_j_, given_j_);
    }
    last_ = hand;
    shown_ = shown;
    known_ = true;
  }
  [[nodiscard]] double most() const noexcept { return most_j_; }

 private:
  bool known_ = false;
  Pose last_;
  Wrench shown_;
  double given_j_ = 0, most_j_ = 0;
};

/// The operator's tool poses in the last half minute, and the displayed forces.
class OperatorLog {
 public:
  /// @param unlimited  what the hand would feel of a device without limits.
  void add(std::uint64_t index, const HandState& tool, const Wrench& displayed, const Wrench& unlimited) {
    tools_[index % DisplayedForceTrack::kTicks] = tool.pose.position_m;
    displayed_.add(index, unlimited.force_n);
    energy_.tick(tool.pose, displayed);
  }
  [[nodiscard]] Vec3 toolAt(double index) const {
    const auto before = static_cast<std::uint64_t>(std::floor(index));
    const double share = index - std::floor(index);
    const Vec3& from = tools_[before % DisplayedForceTrack::kTicks];
    return share == 0 ? from : Vec3(from + share * (tools_[(before + 1) % DisplayedForceTrack::kTicks] - from));
  }
  [[nodiscard]] const DisplayedForceTrack& displayed() const noexcept { return displayed_; }
  [[nodiscard]] double mostGiven() const noexcept { return energy_.most(); }

 private:
  std::vector<Vec3> tools_ = std::vector<Vec3>(DisplayedForceTrack::kTicks, Vec3::Zero());
  DisplayedForceTrack displayed_;
  EnergyGiven energy_;
};

inline void enter(double distance_m, const Wrench& soil, TeleopResult& result) noexcept {
  double& largest_m = soil.force_n.norm() > kInSoil_n ? result.soil_m : result.free_m;
  largest_m = std::max(largest_m, distance_m);
}

/// Share of the time since something first happened.
class Share {
 public:
  void tick(bool happens) noexcept {
    begun_ = begun_ || happens;
    ticks_ += begun_ ? 1 : 0;
    happened_ += happens ? 1 : 0;
  }
  [[nodiscard]] double value() const noexcept { return ticks_ == 0 ? 0 : happened_ / ticks_; }

 private:
  bool begun_ = false;
  double ticks_ = 0, happened_ = 0;
};

class Mean {
 public:
  void tick(bool counts, double value) noexcept {
    sum_ += counts ? value : 0;
    count_ += counts ? 1 : 0;
  }
  [[nodiscard]] double mean() const noexcept { return count_ == 0 ? 0 : sum_ / count_; }

 private:
  double sum_ = 0, count_ = 0;
};

/// Ticks of a run, and who watches them.
class Course {
 public:
  Course(const TeleopSetup& setup, double period_s, const TeleopProgress& progress)
      : progress_(progress),
        tick_s_(setup.model.loop.tick_s),
        ticks_(static_cast<std::uint64_t>(std::llround(setup.duration_s / tick_s_))),
        period_(std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::llround(period_s / tick_s_)))) {}

  [[nodiscard]] std::uint64_t ticks() const noexcept { return ticks_; }
  [[nodiscard]] std::uint64_t period() const noexcept { return period_; }
  [[nodiscard]] double time(std::uint64_t tick) const noexcept { return static_cast<double>(tick) * tick_s_; }
  /// @throws Failure when the run is no longer needed.
  void look(std::uint64_t tick) const {
    if (progress_ && tick % kLookEvery == 0 && !progress_(static_cast<double>(tick) / static_cast<double>(ticks_))) {
      throw Failure("interrupted");
    }
  }

 private:
  const TeleopProgress& progress_;
  double tick_s_;
  std::uint64_t ticks_, period_;
};

/// The force that a robot was last heard to have met.
struct MetLast {
  double force_n = 0;
  std::uint64_t index = 0;
};

[[nodiscard]] TeleopResult simulateModel(const TeleopSetup& setup, const TeleopProgress& progress);
[[nodiscard]] TeleopResult simulateBilateral(const TeleopSetup& setup, const TeleopProgress& progress);

}  // namespace haptolith::simulation
