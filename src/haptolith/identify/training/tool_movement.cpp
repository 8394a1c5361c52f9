#include "haptolith/identify/training/tool_movement.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "haptolith/core/error.h"
#include "haptolith/core/interpolate.h"

namespace haptolith {

namespace {

constexpr double kAir_m_s = 0.15;  // between positions
constexpr double kCut_m_s = 0.03;  // v^2 / (g d) is 0.03 on the Moon, 20 mm deep
constexpr double kPress_m_s = 0.015;
constexpr double kClear_m = 0.04;  // height of the tool's lowest point above the soil between positions
constexpr double kHold_s = 0.3;
constexpr double kTravel_m = 0.07;  // length of a cut

constexpr double kUpright = std::numbers::pi / 2, kLeaning = std::numbers::pi / 3;
constexpr std::array kParts{ProbePart{"press 8 mm", 0.08, -0.06, 0.008, 0},
                            ProbePart{"press 14 mm", 0.08, 0.06, 0.014, 0},
                            ProbePart{"cut 20 mm, upright", -0.1, -0.096, 0.02, kUpright},
                            ProbePart{"cut 35 mm, upright", -0.1, 0.032, 0.035, kUpright},
                            ProbePart{"cut 20 mm, leaning", -0.1, 0.096, 0.02, kLeaning},
                            ProbePart{"cut 35 mm, leaning", -0.1, -0.032, 0.035, kLeaning}};

/// Builder of a movement. Heights are those of the shovel's lowest point.
class Making {
 public:
  explicit Making(const ToolParameters& shovel) : shovel_(shovel) {}

  /// @param rake_rad  angle of the blade over the horizontal ahead; 0: flat.
  void goTo(double x_m, double y_m, double lowest_m, double rake_rad, double speed_m_s) {
    const Vec3& size = shovel_.size_m;
    const Quat turn(Eigen::AngleAxisd(rake_rad, Vec3::UnitY()));
    const double half_m = (size.x() * std::abs(std::sin(rake_rad)) + size.z() * std::abs(std::cos(rake_rad))) / 2;
    const Pose pose{{x_m, y_m, lowest_m + half_m}, turn};
    double duration_s = 0;
    if (!poses_.empty()) {
      const Pose& before = poses_.back().pose;
      constexpr double kTurn_rad_s = 3;
      duration_s = poses_.back().time_s + std::max((pose.position_m - before.position_m).norm() / speed_m_s,
                                                   before.orientation.angularDistance(turn) / kTurn_rad_s);
    }
    poses_.push_back({duration_s, pose});
  }
  void wait(double duration_s) { poses_.push_back({poses_.back().time_s + duration_s, poses_.back().pose}); }

  void press(double x_m, double y_m, double depth_m) {
    goTo(x_m, y_m, kClear_m, 0, kAir_m_s);
    goTo(x_m, y_m, 0.005, 0, kAir_m_s);
    goTo(x_m, y_m, -depth_m, 0, kPress_m_s);
    wait(kHold_s);
    goTo(x_m, y_m, 0.01, 0, kCut_m_s);
    goTo(x_m, y_m, kClear_m, 0, kAir_m_s);
  }

  void cut(double x_m, double y_m, double depth_m, double rake_rad) {
    goTo(x_m, y_m, kClear_m, rake_rad, kAir_m_s);
    goTo(x_m, y_m, 0.005, rake_rad, kAir_m_s);
    goTo(x_m, y_m, -depth_m, rake_rad, kCut_m_s);
    goTo(x_m + kTravel_m, y_m, -depth_m, rake_rad, kCut_m_s);
    goTo(x_m + kTravel_m, y_m, 0.01, rake_rad, 2 * kCut_m_s);
    goTo(x_m + kTravel_m, y_m, kClear_m, rake_rad, kAir_m_s);
  }

  [[nodiscard]] std::vector<TimedPose> poses() && { return std::move(poses_); }

 private:
  const ToolParameters& shovel_;
  std::vector<TimedPose> poses_;
};

}  // namespace

ToolMovement::ToolMovement(std::vector<TimedPose> poses) : poses_(std::move(poses)) {
  if (poses_.size() < 2 || poses_.front().time_s != 0) {
    throw InvalidParameter("poses", fmt::format("{}", poses_.size()), "two or more, the first at 0 s");
  }
  for (std::size_t i = 1; i < poses_.size(); ++i) {
    if (!(poses_[i].time_s > poses_[i - 1].time_s)) {
      throw InvalidParameter(fmt::format("poses[{}].time_s", i), fmt::format("{:g}", poses_[i].time_s),
                             fmt::format("more than {:g}", poses_[i - 1].time_s));
    }
  }
}

Pose ToolMovement::at(double time_s) const noexcept {
  const auto after = std::ranges::upper_bound(poses_, time_s, {}, &TimedPose::time_s);
  if (after == poses_.begin()) {
    return poses_.front().pose;
  }
  if (after == poses_.end()) {
    return poses_.back().pose;
  }
  const TimedPose& from = *(after - 1);
  return interpolate(from.pose, after->pose, (time_s - from.time_s) / (after->time_s - from.time_s));
}

bool isSameMovement(const ToolMovement& one, const ToolMovement& other) {
  return std::ranges::equal(one.poses(), other.poses(), [](const TimedPose& a, const TimedPose& b) {
    return std::abs(a.time_s - b.time_s) < 1e-3 && (a.pose.position_m - b.pose.position_m).norm() < 1e-5;
  });
}

std::span<const ProbePart> probeParts() {
  return kParts;
}

ToolMovement probeMovement(const ToolParameters& shovel) {
  if (shovel.shape != ToolShape::kBox) {
    throw InvalidParameter("tool.shape", "another", "box: the probe is a shovel's");
  }
  requireInRange("tool.size_m.x", shovel.size_m.x(), {0.03, 0.06});
  requireInRange("tool.size_m.y", shovel.size_m.y(), {0.03, 0.05});
  Making making(shovel);
  for (const ProbePart& part : kParts) {
    if (part.rake_rad > 0) {
      making.cut(part.x_m, part.y_m, part.depth_m, part.rake_rad);
    } else {
      making.press(part.x_m, part.y_m, part.depth_m);
    }
  }
  return ToolMovement(std::move(making).poses());
}

}  // namespace haptolith
