#include "haptolith/identify/movement_part.h"

#include <fmt/format.h>

#include <algorithm>

#include "haptolith/identify/training/digging.h"

namespace haptolith {

namespace {

ToolMovement between(const ToolMovement& movement, double from_s, double to_s) {
  std::vector<TimedPose> poses{{0, movement.at(from_s)}};
  for (const TimedPose& at : movement.poses()) {
    if (at.time_s > from_s && at.time_s < to_s) {
      poses.push_back({at.time_s - from_s, at.pose});
    }
  }
  poses.push_back({to_s - from_s, movement.at(to_s)});
  return ToolMovement(std::move(poses));
}

/// Returns the lowest position, as the name of a part without one.
std::string placeOf(const ToolMovement& movement, std::size_t number) {
  const auto lowest =
      std::ranges::min_element(movement.poses(), {}, [](const TimedPose& at) { return at.pose.position_m.z(); });
  const Vec3 mm = 1e3 * lowest->pose.position_m;
  return fmt::format("part {}, at {:.0f},{:.0f},{:.0f} mm", number, mm.x(), mm.y(), mm.z());
}

}  // namespace

std::vector<MovementPart> partsOf(const ToolMovement& movement, const ForceEmulator& emulator) {
  const auto windows = static_cast<std::size_t>(movement.duration() / kForceWindow_s);
  std::vector<std::size_t> begins{0};
  std::size_t free = emulator.windowOf(0);  // first window after the last force
  for (Eigen::Index number = 0; number < static_cast<Eigen::Index>(emulator.size()); ++number) {
    const std::size_t window = emulator.windowOf(number);
    if (window > free) {
      begins.push_back((free + window) / 2);
    }
    free = window + ForceEmulator::kBlock;
  }
  std::vector<MovementPart> parts;
  for (std::size_t i = 0; i < begins.size(); ++i) {
    const bool is_last = i + 1 == begins.size();
    const std::size_t end = is_last ? windows : begins[i + 1];
    const double from_s = static_cast<double>(begins[i]) * kForceWindow_s;
    const double to_s = is_last ? movement.duration() : static_cast<double>(end) * kForceWindow_s;
    parts.push_back({{}, begins[i], end - begins[i], between(movement, from_s, to_s)});
  }
  const std::span<const ProbePart> named = probeParts();
  const bool is_probe = parts.size() == named.size() && isSameMovement(movement, probeMovement({}));
  for (std::size_t i = 0; i < parts.size(); ++i) {
    parts[i].name = is_probe ? named[i].name : placeOf(parts[i].movement, i + 1);
  }
  return parts;
}

std::vector<Eigen::Index> numbersOf(const MovementPart& part, const ForceEmulator& emulator) {
  std::vector<Eigen::Index> numbers;
  for (Eigen::Index number = 0; number < static_cast<Eigen::Index>(emulator.size()); ++number) {
    const std::size_t window = emulator.windowOf(number);
    if (window >= part.first_window && window < part.first_window + part.windows) {
      numbers.push_back(number);
    }
  }
  return numbers;
}

}  // namespace haptolith
