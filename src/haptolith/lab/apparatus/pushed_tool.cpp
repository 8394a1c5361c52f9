#include "haptolith/lab/apparatus/pushed_tool.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "haptolith/core/error.h"
#include "haptolith/lab/staged_progress.h"

namespace haptolith {

namespace {

constexpr Range kAboveZero{0, 10, Ends::kOpenBelow};

void validate(const Push& push) {
  requireInRange("depth_m", push.depth_m, kAboveZero);
  requireInRange("speed_m_s", push.speed_m_s, kAboveZero);
  requireInRange("sample_m", push.sample_m, {0, push.depth_m, Ends::kOpenBelow});
  requireInRange("window_m", push.window_m, {0, push.depth_m, Ends::kOpenBelow});
  requireInRange("bed_width_m", push.bed_width_m, {push.tool.diameter_m, 10, Ends::kOpenBelow});
  const double reached = push.depth_m + push.zero_m - push.lowest_m;
  requireInRange("bed_depth_m", push.bed_depth_m, {reached, 10, Ends::kOpenBelow});
  requireInRange("loose_top_m", push.loose_top_m, {0, push.bed_depth_m});
}

/// Returns means over push.window_m around every push.sample_m; `raw` is sorted by depth.
std::vector<PushReading> resampled(const std::vector<PushReading>& raw, const Push& push) {
  std::vector<PushReading> readings;
  const auto samples = static_cast<int>(std::floor(push.depth_m / push.sample_m + 1e-9));
  for (int i = 0; i <= samples; ++i) {
    const double depth = i * push.sample_m;
    const auto above = [](const PushReading& reading, double limit) { return reading.depth_m < limit; };
    const auto first = std::lower_bound(raw.begin(), raw.end(), depth - push.window_m / 2, above);
    const auto last = std::lower_bound(first, raw.end(), depth + push.window_m / 2, above);
    double sum = 0;
    for (auto reading = first; reading != last; ++reading) {
      sum += reading->force_n;
    }
    readings.push_back({depth, sum / static_cast<double>(std::max<std::ptrdiff_t>(last - first, 1))});
  }
  return readings;
}

/// Returns the depth at which contact begins, on the depth scale of `raw`.
double firstContact(const std::vector<PushReading>& raw, double contact_n) {
  const auto touching =
      std::ranges::find_if(raw, [&](const PushReading& reading) { return reading.force_n > contact_n; });
  if (touching == raw.end()) {
    throw Failure(fmt::format("the tool was pushed in, but its force stayed below {:.3g} N", contact_n));
  }
  return touching->depth_m;
}

/// Returns the soil in the box before it settles for the last time. A loose top is poured onto settled soil.
std::vector<Vec3> soilFor(const LabConditions& conditions, const Push& push, const LabBox& box) {
  const auto fill = [&](double depth_m, double bottom_m, std::uint64_t seed, Preparation preparation) {
    const std::size_t particles = particlesFor(conditions.soil, box.width_m * box.length_m * depth_m);
    return looseSoil(conditions.soil, box, particles, bottom_m, seed, {}, preparation);
  };
  std::vector<Vec3> all = fill(push.bed_depth_m - push.loose_top_m, 0, conditions.seed, push.preparation);
  if (push.loose_top_m > 0) {
    LabBed below(conditions, box, all);
    below.settle(push.preparation);
    all = below.soilCentres();
    const std::vector<Vec3> top =
        fill(push.loose_top_m, below.bed().surfaceHeight(), conditions.seed + 1, Preparation::kLoose);
    all.insert(all.end(), top.begin(), top.end());
  }
  return all;
}

}  // namespace

PushCurve pushIntoBed(const LabConditions& conditions, const Push& push) {
  validate(push);
  const SoilParameters& soil = conditions.soil;
  const LabBox box{.width_m = push.bed_width_m, .length_m = push.bed_width_m};
  constexpr double kPushed = 0.4;  // fraction of the test's time before the push
  StagedProgress progress(conditions.progress);
  progress.enter(0, kPushed);
  LabConditions staged = conditions;
  staged.progress = progress.inner();
  LabBed bed(staged, box, soilFor(staged, push, box), {}, push.tool);
  constexpr double kFarAbove_m = 100;
  bed.placeTool({{0, 0, kFarAbove_m}, push.scene_R_tool});
  bed.settle(push.loose_top_m > 0 ? Preparation::kLoose : push.preparation);

  PushCurve curve;
  curve.particles = bed.soil();
  curve.bed_depth_m = bed.surfaceHeight(push.depth_from);
  curve.bulk_density_kg_m3 = bed.bulkDensity(0.2 * curve.bed_depth_m, 0.8 * curve.bed_depth_m);

  const double highest = bed.bed().surfaceHeight();
  bed.placeTool({{0, 0, highest - push.lowest_m}, push.scene_R_tool});
  bed.moveTool({{0, 0, -push.speed_m_s}, Vec3::Zero()});
  std::vector<PushReading> raw;
  const double roughness = highest - curve.bed_depth_m + 3 * soil.radius_m;  // distance until contact is certain
  const double travel = roughness + push.zero_m - push.lowest_m + push.depth_m + push.window_m;
  progress.enter(kPushed, 1);
  bed.run(travel / push.speed_m_s, push.what, [&] {
    const double height = bed.toolPose().position_m.z() + push.zero_m;
    raw.push_back({curve.bed_depth_m - height, bed.toolWrench().force_n.z()});
  });
  if (push.zero == DepthZero::kFirstContact && push.depth_from == DepthFrom::kTips) {
    const double contact = firstContact(raw, push.contact_n);
    for (PushReading& reading : raw) {
      reading.depth_m -= contact;
    }
  }
  curve.readings = resampled(raw, push);
  return curve;
}

double forceAt(const std::vector<PushReading>& readings, double depth_m) {
  if (readings.empty()) {
    throw InvalidParameter("readings", "none", "one or more");
  }
  requireInRange("depth_m", depth_m, {readings.front().depth_m, readings.back().depth_m});
  const auto deeper =
      std::ranges::find_if(readings, [&](const PushReading& reading) { return reading.depth_m >= depth_m; });
  if (deeper == readings.begin() || deeper->depth_m == depth_m) {
    return deeper->force_n;
  }
  const auto before = deeper - 1;
  const double share = (depth_m - before->depth_m) / (deeper->depth_m - before->depth_m);
  return before->force_n + share * (deeper->force_n - before->force_n);
}

}  // namespace haptolith
