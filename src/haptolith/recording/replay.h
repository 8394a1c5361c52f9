#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "haptolith/device/replay_device.h"
#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/recording/frame_check.h"
#include "haptolith/recording/recording_reader.h"
#include "haptolith/scene_file/scene_file.h"

namespace haptolith {

/// First difference of a replay from its recording.
struct ReplayDifference {
  std::uint64_t tick = 0;  ///< its row in /ticks, from 0
  double time_s = 0;
  /// "state_hash", "tool pose", "soil wrench", "joint", "rendered force", "device wrench", "injected energy", "trip",
  /// "end", "flags", "particles"; after the name of a further tool: "left: tool pose"
  std::string what;
  /// Particles of the first frame at or after the tick; empty when no frame of the next second could be compared.
  std::optional<ComparedFrame> frame = {};
};

/// Missing ticks in a recording: later ticks cannot be replayed.
struct ReplayGap {
  std::uint64_t ticks = 0;  ///< number of missing ticks
  double time_s = 0;        ///< time of the last tick before them
};

struct ReplayResult {
  std::uint64_t ticks = 0;   ///< replayed
  std::uint64_t hashes = 0;  ///< compared
  std::uint64_t frames = 0;  ///< compared
  std::optional<ReplayDifference> difference;
  std::optional<ReplayGap> gap;
  std::string end;          ///< failure of both the recorded run and the replay in the last tick; empty without one
  std::string ended_early;  ///< why the rest of the recording could not be replayed; empty when all was
};

/// Runs a recording again: the recorded scene with the recorded readings of the device.
class Replay {
 public:
  /// Makes the recorded scene again.
  /// @param threads  that share a tick; empty: as recorded. The result must not depend on it.
  /// @throws Failure when the recording began in the middle of a run or its scene cannot be read; InvalidParameter,
  /// Failure as Scene.
  Replay(const RecordingReader& recording, std::optional<int> threads, const SettleProgress& progress = {});

  /// Goes through all ticks up to the first that is missing, and compares them bit by bit, to the first difference:
  /// hashes of the bed, the tool's pose, the wrenches, energy, trip, flags, and the particles of frames. The recorded
  /// readings of the device are fed in; times of work and whether a tick was late are not compared. After a difference
  /// it continues to the next frame, to find the particles that differ.
  /// @param go_on  called after each equal tick with the first tool's record and the replayed one; false ends it.
  /// @param until_s  later ticks are left out.
  [[nodiscard]] ReplayResult run(const std::function<bool(const TickRecord& was, const TickRecord& is)>& go_on,
                                 double until_s = std::numeric_limits<double>::infinity());

  [[nodiscard]] const SceneFile& sceneFile() const noexcept { return scene_file_; }
  [[nodiscard]] HapticLoop& loop() noexcept { return *loop_; }

 private:
  [[nodiscard]] std::string prepare(std::span<const TickRecord> was);
  [[nodiscard]] std::string differenceOf(std::span<const TickRecord> was, std::span<const TickRecord> is) const;

  const RecordingReader& recording_;
  SceneFile scene_file_;
  std::unique_ptr<Scene> scene_;
  std::deque<ReplayDevice> devices_;  ///< one per tool
  std::unique_ptr<HapticLoop> loop_;
  bool late_ = false;  ///< the last tick, as recorded
  // That are still to come:
  std::deque<SoilAdjustment> adjustments_;
  std::deque<GrainMove> grain_moves_;
};

}  // namespace haptolith
