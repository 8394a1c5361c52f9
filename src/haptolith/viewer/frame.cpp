#include "haptolith/viewer/frame.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <iterator>

namespace haptolith {

namespace {

static_assert(std::endian::native == std::endian::little, "frames are little-endian");

constexpr std::uint8_t kFrameKind = 1;
constexpr std::uint8_t kFrameVersion = 1;
constexpr std::uint16_t kPaused = 1;
constexpr std::uint16_t kHeld = 2;
constexpr std::uint16_t kWhole = 4;
constexpr std::uint16_t kLoadsKnown = 8;
constexpr std::uint16_t kHasStones = 16;
constexpr std::uint16_t kHasTools = 32;
constexpr std::uint16_t kHasBands = 64;

/// A number between 10^lowest and 10^(lowest + decades) as 1 to 255, on a logarithmic scale.
std::uint8_t onLogScale(double value, double lowest_exponent, double decades) {
  constexpr double kSteps = 254;
  const double share = (std::log10(std::max(value, 1e-30)) - lowest_exponent) / decades;
  return static_cast<std::uint8_t>(1 + std::lround(kSteps * std::clamp(share, 0.0, 1.0)));
}

std::uint8_t speedByte(double speed_m_s) {
  return onLogScale(speed_m_s, -4, 4);
}
std::uint8_t forceByte(double force_n) {
  constexpr double kLeast = 1e-5;
  return force_n < kLeast ? 0 : onLogScale(force_n, -5, 6);
}

std::uint16_t quantised(double value, double low, double high) {
  constexpr double kLargest = 65535;
  return static_cast<std::uint16_t>(std::lround(kLargest * std::clamp((value - low) / (high - low), 0.0, 1.0)));
}

template <class Number>
void put(std::string& bytes, Number value) {
  std::array<char, sizeof(Number)> raw;
  std::memcpy(raw.data(), &value, sizeof(Number));
  bytes.append(raw.data(), raw.size());
}

void putVector(std::string& bytes, const Vec3& v) {
  for (const double value : v) {
    put(bytes, static_cast<float>(value));
  }
}

void putPose(std::string& bytes, const Pose& pose) {
  putVector(bytes, pose.position_m);
  for (const double value : {pose.orientation.w(), pose.orientation.x(), pose.orientation.y(), pose.orientation.z()}) {
    put(bytes, static_cast<float>(value));
  }
}

void putWrench(std::string& bytes, const Wrench& wrench) {
  putVector(bytes, wrench.force_n);
  putVector(bytes, wrench.torque_nm);
}

}  // namespace

FrameEncoder::FrameEncoder(std::uint32_t scene, std::size_t particles, const FrameSpace& space, std::uint32_t after)
    : scene_(scene),
      space_(space),
      after_(after),
      number_(after),
      records_(particles),
      changed_(particles / kGroup + 1) {}

void FrameEncoder::take(const SceneSnapshot& snapshot, const BesideSnapshot& beside) {
  const bool first = !hasPicture();
  ++number_;
  kept_.clear();
  const double elapsed_s = snapshot.time_s - before_s_;
  const bool speeds_known = before_.size() == snapshot.position.size() && elapsed_s > 0;
  const bool stands_still = !before_.empty() && elapsed_s == 0;  // paused: speeds are as they were
  loads_known_ = beside.load_n.size() == records_.size();
  for (std::size_t i = 0; i < records_.size(); ++i) {
    const Float4& p = snapshot.position[i];
    const bool asleep = snapshot.asleep[i / kGroup] != 0;
    double speed_m_s = 0;
    if (speeds_known && !asleep) {
      const Float4& q = before_[i];
      speed_m_s = std::hypot(p.x - q.x, p.y - q.y, p.z - q.z) / elapsed_s;
    }
    const Record now{quantised(p.x, space_.low_m.x(), space_.high_m.x()),
                     quantised(p.y, space_.low_m.y(), space_.high_m.y()),
                     quantised(p.z, space_.low_m.z(), space_.high_m.z()),
                     asleep         ? std::uint8_t{0}
                     : stands_still ? records_[i].speed
                                    : speedByte(speed_m_s),
                     loads_known_ ? forceByte(beside.load_n[i]) : std::uint8_t{0}};
    if (!(now == records_[i]) || first) {
      records_[i] = now;
      changed_[i / kGroup] = number_;
    }
  }
  if (elapsed_s > 0 || before_.empty()) {
    before_ = snapshot.position;
    before_s_ = snapshot.time_s;
  }
  tool_ = snapshot.scene_T_tool;
  stones_ = snapshot.stones;
  tools_.clear();
  for (std::size_t i = 0; i < std::min(snapshot.tools.size(), beside.tools.size()); ++i) {
    const ShownTool& shown = snapshot.tools[i];
    tools_.push_back({shown, beside.tools[i].wanted.value_or(shown.scene_T_tool), beside.tools[i].held_by});
  }
  bands_.clear();
  if (std::ranges::any_of(snapshot.tools, [](const ShownTool& tool) { return tool.force_band.has_value(); })) {
    std::ranges::transform(snapshot.tools, std::back_inserter(bands_), &ShownTool::force_band);
  }
  wanted_ = beside.wanted.value_or(tool_);
  held_ = beside.held;
  shown_wrench_ = snapshot.device_wrench_in_scene;
  opening_m_ = snapshot.opening_m;
  time_s_ = snapshot.time_s;
  tick_us_ = snapshot.tick_us_lately;
  misses_ = static_cast<std::uint32_t>(snapshot.deadline_misses);
  awake_ = static_cast<std::uint32_t>(snapshot.awake);
  paused_ = snapshot.paused;
}

std::shared_ptr<const std::string> FrameEncoder::frameSince(std::uint32_t seen) {
  for (const Kept& kept : kept_) {
    if (kept.seen == seen) {
      return kept.frame;
    }
  }
  struct Run {
    std::uint32_t first, count;
  };
  std::vector<Run> runs;
  std::uint32_t count = 0;
  for (std::size_t group = 0; group * kGroup < records_.size(); ++group) {
    if (changed_[group] <= seen) {
      continue;
    }
    const auto first = static_cast<std::uint32_t>(group * kGroup);
    const auto size = static_cast<std::uint32_t>(std::min(kGroup, records_.size() - first));
    if (!runs.empty() && runs.back().first + runs.back().count == first) {
      runs.back().count += size;
    } else {
      runs.push_back({first, size});
    }
    count += size;
  }
  std::string bytes = headFor(static_cast<std::uint32_t>(runs.size()), count);
  bytes.reserve(bytes.size() + runs.size() * sizeof(Run) + count * sizeof(Record));
  for (const Run& run : runs) {
    put(bytes, run);
  }
  for (const Run& run : runs) {
    bytes.append(reinterpret_cast<const char*>(&records_[run.first]), run.count * sizeof(Record));
  }
  if (!stones_.empty()) {
    put(bytes, static_cast<std::uint32_t>(stones_.size()));
    for (const Pose& stone : stones_) {
      putPose(bytes, stone);
    }
  }
  if (!tools_.empty()) {
    put(bytes, static_cast<std::uint32_t>(tools_.size()));
    for (const Tool& tool : tools_) {
      putPose(bytes, tool.shown.turned);
      putPose(bytes, tool.shown.scene_T_tool);
      putWrench(bytes, tool.shown.device_wrench_in_scene);
      putPose(bytes, tool.wanted);
      put(bytes, static_cast<float>(tool.shown.opening_m));
      put(bytes, tool.held_by);
    }
  }
  if (!bands_.empty()) {
    put(bytes, static_cast<std::uint32_t>(bands_.size()));
    for (const std::optional<ForceRange>& band : bands_) {
      put(bytes, static_cast<float>(band ? band->low_n : 0));
      put(bytes, static_cast<float>(band ? band->high_n : -1));
    }
  }
  kept_.push_back({seen, std::make_shared<const std::string>(std::move(bytes))});
  return kept_.back().frame;
}

std::string FrameEncoder::headFor(std::uint32_t runs, std::uint32_t records) const {
  const auto flag = [](bool set, std::uint16_t bit) { return set ? bit : std::uint16_t{0}; };
  std::string bytes;
  put(bytes, kFrameKind);
  put(bytes, kFrameVersion);
  put(bytes, static_cast<std::uint16_t>(flag(paused_, kPaused) | flag(held_, kHeld) |
                                        flag(records == records_.size(), kWhole) | flag(loads_known_, kLoadsKnown) |
                                        flag(!stones_.empty(), kHasStones) | flag(!tools_.empty(), kHasTools) |
                                        flag(!bands_.empty(), kHasBands)));
  put(bytes, scene_);
  put(bytes, time_s_);
  putPose(bytes, tool_);
  putWrench(bytes, shown_wrench_);
  putPose(bytes, wanted_);
  put(bytes, static_cast<float>(tick_us_));
  put(bytes, misses_);
  put(bytes, awake_);
  put(bytes, static_cast<std::uint32_t>(records_.size()));
  put(bytes, runs);
  put(bytes, records);
  put(bytes, number_);
  put(bytes, static_cast<float>(opening_m_));
  return bytes;
}

}  // namespace haptolith
