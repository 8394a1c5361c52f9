#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "haptolith/core/vec.h"
#include "haptolith/haptics/loop/shown_scene.h"

namespace haptolith {

/// A space that holds the bed; what leaves it is shown at its border.
struct FrameSpace {
  Vec3 low_m, high_m;
};

/// Data of a tool in addition to a snapshot.
struct BesideTool {
  std::optional<Pose> wanted = {};  ///< its target
  std::uint32_t held_by = 0;        ///< number of the client that holds it; 0: none
};

/// Data in addition to a snapshot.
struct BesideSnapshot {
  std::optional<Pose> wanted = {};  ///< target of the first tool
  bool held = false;
  std::span<const float> load_n = {};      ///< contact force of each particle; empty: unknown
  std::span<const BesideTool> tools = {};  ///< one per tool; empty: pictures have the first alone
};

/// Pictures of the bed as bytes: docs/reference/web-messages.md. Positions are quantised, and only particles whose
/// bytes have changed since a client's last frame are in its next; stones and tools are in all. Not thread-safe.
class FrameEncoder {
 public:
  /// @param scene  number of the scene, counted up when the particles are others.
  /// @param after  number of the last picture of the scene before: a client that has seen no later one gets everything.
  FrameEncoder(std::uint32_t scene, std::size_t particles, const FrameSpace& space, std::uint32_t after = 0);

  /// Takes a newer snapshot of this scene.
  void take(const SceneSnapshot& snapshot, const BesideSnapshot& beside);

  /// Number of the picture that was taken last; that of the scene before until there is one.
  [[nodiscard]] std::uint32_t number() const noexcept { return number_; }
  [[nodiscard]] bool hasPicture() const noexcept { return number_ != after_; }

  /// The newest picture for a client that has seen picture number `seen`; complete for a new one (0).
  /// Clients in the same state share one buffer.
  [[nodiscard]] std::shared_ptr<const std::string> frameSince(std::uint32_t seen);

  [[nodiscard]] const FrameSpace& space() const noexcept { return space_; }

 private:
  struct Record {
    std::uint16_t x, y, z;
    std::uint8_t speed, force;
    [[nodiscard]] bool operator==(const Record&) const = default;
  };
  static_assert(sizeof(Record) == 8);
  struct Head;
  struct Tool {
    ShownTool shown;
    Pose wanted;
    std::uint32_t held_by = 0;
  };
  struct Kept {
    std::uint32_t seen;
    std::shared_ptr<const std::string> frame;
  };

  [[nodiscard]] std::string headFor(std::uint32_t runs, std::uint32_t records) const;

  std::uint32_t scene_;
  FrameSpace space_;
  std::uint32_t after_, number_;
  std::vector<Record> records_;
  std::vector<std::uint32_t> changed_;  ///< number of the picture in which a group's records changed last
  std::vector<Float4> before_;          ///< positions in the snapshot before, m
  double before_s_ = 0;

  // Values of the last snapshot.
  Pose tool_, wanted_;
  Wrench shown_wrench_;  ///< device wrench in scene axes
  std::vector<Pose> stones_;
  std::vector<Tool> tools_;                       ///< none where frames have the first alone
  std::vector<std::optional<ForceRange>> bands_;  ///< one per tool; empty where none is known
  double time_s_ = 0, tick_us_ = 0, opening_m_ = 0;
  std::uint32_t misses_ = 0, awake_ = 0;
  bool paused_ = false, held_ = false, loads_known_ = false;
  std::vector<Kept> kept_;  ///< frames of the last snapshot
};

}  // namespace haptolith
