#include "haptolith/recording/frame_check.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>

#include "haptolith/haptics/loop/loop_telemetry.h"

namespace haptolith {

namespace {

bool same(const std::array<float, 3>& was, const Float4& is) noexcept {
  using Bits = std::array<std::uint32_t, 3>;
  return std::bit_cast<Bits>(was) == std::bit_cast<Bits>(std::array{is.x, is.y, is.z});
}

}  // namespace

FrameCheck::FrameCheck(const RecordingReader& recording)
    : recording_(recording), rows_(recording.readFrameRows(0, recording.frames())) {}

/// Compares the particles of `first_group` to `last_group` - 1 with those of the frame.
void FrameCheck::compare(const Scene& scene, std::size_t first_group, std::size_t last_group,
                         ComparedFrame& result) const {
  const std::vector<Float4>& is = scene.bed().state().position;
  for (std::size_t i = first_group * kGroup; i < std::min(last_group * kGroup, scene.bed().particles()); ++i) {
    const bool recorded = i < frame_->position_m.size();
    if (recorded && same(frame_->position_m[i], is[i])) {
      continue;
    }
    if (result.different++ == 0) {
      const Vec3 was = recorded ? Vec3(frame_->position_m[i][0], frame_->position_m[i][1], frame_->position_m[i][2])
                                : Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
      result.particle = i;
      result.distance_m = (Vec3(is[i].x, is[i].y, is[i].z) - was).norm();
    }
  }
}

void FrameCheck::afterTick(std::uint64_t number, const Scene& scene) {
  last_ = number;
  while (next_ < rows_.size() && rows_[next_].tick < number) {  // not reached
    ++next_;
    frame_.reset();
  }
  if (next_ == rows_.size() || rows_[next_].tick - number >= kTicksPerSnapshot) {
    return;
  }
  if (!frame_) {
    frame_ = recording_.readFrame(rows_[next_]);
    by_parts_ = {.tick = rows_[next_].tick, .time_s = rows_[next_].time_s};
  }
  if (!LoopTelemetry::copiesInParts(scene.bed())) {
    return;
  }
  const std::size_t part = kTicksPerSnapshot - 1 - (rows_[next_].tick - number);
  const std::size_t first_part = number == 0 ? 0 : part;  // the parts before are as the bed was made
  const std::size_t groups = scene.bed().state().rested.size();
  compare(scene, groups * first_part / kTicksPerSnapshot, groups * (part + 1) / kTicksPerSnapshot, by_parts_);
}

std::optional<ComparedFrame> FrameCheck::beforeTick(std::uint64_t number, bool resumed, const Scene& scene) {
  resumed_ = resumed ? number : resumed_;
  if (next_ == rows_.size() || rows_[next_].tick + 1 != number || !frame_) {
    return {};
  }
  // A snapshot at the end of a run or in a pause is of one tick.
  ComparedFrame whole{.tick = rows_[next_].tick, .time_s = rows_[next_].time_s};
  compare(scene, 0, scene.bed().state().rested.size(), whole);
  const bool in_parts = LoopTelemetry::copiesInParts(scene.bed());
  const bool unknown = in_parts && resumed_ && *resumed_ + kTicksPerSnapshot > number;  // which tick each part is from
  const bool by_parts = in_parts && whole.different > 0;
  ++next_;
  frame_.reset();
  if (unknown && by_parts) {
    return {};
  }
  ++compared_;
  return by_parts ? by_parts_ : whole;
}

}  // namespace haptolith
