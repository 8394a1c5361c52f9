#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/core/vec.h"
#include "haptolith/recording/recording_reader.h"
#include "haptolith/recording/replay.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/stone/stone_shape.h"

namespace haptolith {

/// A tool at the end of a tick, and soil wrench on it; scene frame.
struct PicturedTool {
  Pose pose;              ///< scene_T_tool, as its joint has turned it
  double opening_m = 0;   ///< between jaws; 0 for another tool
  Wrench soil;            ///< soil wrench, about the tool's origin (its hub's, if it has a joint), scene frame
  Pose hub = pose;        ///< scene_T_hub, which the hand holds; the pose without a joint
  JointState joint = {};  ///< zero without one
};

/// A stone where it is at the end of a tick.
struct PicturedStone {
  Pose scene_T_stone;
  std::shared_ptr<const StoneShape> shape;
};

/// The scene at the time of one of a recording's pictures; scene's frame. A particle has the same index in all.
struct ScenePicture {
  double time_s = 0;
  std::uint64_t tick = 0;
  std::vector<std::array<float, 3>> position_m;
  std::vector<std::array<float, 3>> velocity_m_s;  ///< NaN where the recording could not be replayed
  std::vector<float> radius_m;                     ///< NaN if the scene had been changed before
  std::vector<float> contact_force_n;              ///< contactLoads(); NaN as radius_m
  std::vector<PicturedTool> tools;                 ///< none when the tick is missing or the scene was changed
  std::vector<PicturedStone> stones;               ///< none where the recording could not be replayed
};

/// Goes through the pictures of a recording, with what it does not hold itself but what follows from it: radii, contact
/// forces and the tool from the recorded scene and ticks, velocities and stones by running it again. Not for the tick.
class RecordedPictures {
 public:
  struct Options {
    bool replay = true;                          ///< false: velocities are not wanted
    SettleProgress settling;                     ///< while the bed of a replay settles
    std::function<bool(double time_s)> reached;  ///< called for each tick; false gives up
  };

  /// Makes the scene for the replay, where the recording can be replayed.
  /// @throws Failure when the recording is damaged, or `settling` gives up.
  RecordedPictures(const RecordingReader& recording, Options options);

  /// Those that hold particles.
  [[nodiscard]] std::size_t count() const noexcept { return rows_.size(); }
  /// The scene at the recording's beginning; none when this program cannot read it.
  [[nodiscard]] const std::optional<SceneFile>& sceneFile() const noexcept { return scene_file_; }
  [[nodiscard]] const RecordingHeader& header() const noexcept { return recording_.header(); }
  /// Whether velocities are looked for at all; else ScenePicture has none.
  [[nodiscard]] bool replays() const noexcept { return replay_.has_value(); }

  /// Gives each picture, once and in order, to `take`.
  /// @throws Failure when the recording is damaged, "interrupted" when `reached` gives up, and what `take` throws.
  void forEach(const std::function<void(const ScenePicture&)>& take);

  /// After forEach(): number of pictures with velocities, and the reason why others have none; empty if none were
  /// requested.
  [[nodiscard]] std::size_t replayed() const noexcept { return replayed_; }
  [[nodiscard]] const std::string& whyNotReplayed() const noexcept { return why_not_replayed_; }

 private:
  using Take = std::function<void(const ScenePicture&)>;

  void prepareReplay();
  [[nodiscard]] std::uint64_t numberOf(double time_s) const noexcept;
  void takeReplayed(const Take& take);
  void takeRecorded(const Take& take);
  [[nodiscard]] ScenePicture replayedPicture(const FrameRow& row, bool has_tick);
  [[nodiscard]] ScenePicture recordedPicture(const FrameRow& row, std::span<const TickRecord> of_tools,
                                             bool scene_known);
  [[nodiscard]] PicturedTool picturedTool(std::size_t number, const TickRecord& tick);
  [[nodiscard]] const std::vector<float>& radiusExcesses(const std::vector<std::array<float, 3>>& position_m);
  void goOn(double time_s) const;

  const RecordingReader& recording_;
  Options options_;
  std::vector<FrameRow> rows_;
  std::optional<SceneFile> scene_file_;
  std::optional<Replay> replay_;
  std::optional<std::vector<float>> radius_excess_m_;  ///< excess of each particle's radius over the mean, once needed
  std::size_t next_ = 0, replayed_ = 0;
  std::string why_not_replayed_;
};

}  // namespace haptolith
