#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "haptolith/haptics/loop/shown_scene.h"
#include "haptolith/recording/recording_reader.h"
#include "haptolith/scene/scene.h"

namespace haptolith {

/// A recorded frame, and the particles of a replay at its time.
struct ComparedFrame {
  std::uint64_t tick = 0;  ///< number in the run, from 1
  double time_s = 0;
  std::size_t different = 0;  ///< particles whose positions are not bit-identical
  std::size_t particle = 0;   ///< the first of them
  double distance_m = 0;      ///< from its recorded to its replayed position
};

/// Compares the particles of a replay with the recorded frames, bit by bit. Not for the tick.
class FrameCheck {
 public:
  explicit FrameCheck(const RecordingReader& recording);

  /// After tick `number`, and with 0 before the first: a frame of a large bed holds the particles of several ticks.
  void afterTick(std::uint64_t number, const Scene& scene);
  /// @param resumed  whether the run was paused before this tick.
  /// @return the frame of the tick before, where there is one to compare.
  [[nodiscard]] std::optional<ComparedFrame> beforeTick(std::uint64_t number, bool resumed, const Scene& scene);
  /// As beforeTick(), after the last one.
  [[nodiscard]] std::optional<ComparedFrame> atEnd(const Scene& scene) { return beforeTick(last_ + 1, false, scene); }

  [[nodiscard]] std::uint64_t compared() const noexcept { return compared_; }

 private:
  void compare(const Scene& scene, std::size_t first_group, std::size_t last_group, ComparedFrame& result) const;

  const RecordingReader& recording_;
  std::vector<FrameRow> rows_;
  std::size_t next_ = 0;                  ///< row that is compared next
  std::optional<ParticleFrame> frame_;    ///< particles of the next frame, once needed
  ComparedFrame by_parts_;                ///< result for the next frame
  std::uint64_t last_ = 0;                ///< tick
  std::optional<std::uint64_t> resumed_;  ///< last tick before which the run was paused
  std::uint64_t compared_ = 0;
};

}  // namespace haptolith
