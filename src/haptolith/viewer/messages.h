#pragma once

#include <nlohmann/json_fwd.hpp>

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/session/session.h"
#include "haptolith/stone/stone_shape.h"
#include "haptolith/viewer/board.h"
#include "haptolith/viewer/frame.h"

namespace haptolith {

/// The JSON messages of docs/reference/web-messages.md. The nameless ones name no soil, world, preset or file.

/// "$client" in it is replaced by the number of the receiving client: see Board.
[[nodiscard]] Board::Texts helloMessages(std::string_view version, bool read_only, bool takes_uploads);

/// Shape of a stone: its mesh, or its spheres without one.
[[nodiscard]] nlohmann::ordered_json stoneJson(const StoneShape& stone);

/// A scene in a viewer.
struct SceneLookedAt {
  const SceneFile& scene_file;  ///< as it is wanted
  const SoilParameters& soil;   ///< as it is shown
  std::uint32_t scene = 1;      ///< see FrameEncoder
  std::vector<Bed::GrainRun> grains;
  double surface_m = 0;
  HandMotion motion = HandMotion::kStill;
  Vec3 low_m, high_m;  ///< range of the tool
  std::vector<std::shared_ptr<const StoneShape>> stones = {};
};
/// Whether messages and frames have every tool, with its joint: elsewhere the first is enough, and they have it alone.
[[nodiscard]] bool showsEveryTool(const SceneFile& scene_file);

[[nodiscard]] Board::Texts sceneMessages(const SceneLookedAt& shown, const FrameSpace& space);
[[nodiscard]] Board::Texts sceneMessages(const Session& session, const FrameSpace& space);

/// The space around a bed that pictures show: thrown particles fly so high before they are shown at the border.
[[nodiscard]] FrameSpace shownSpace(const BedParameters& bed, double surface_m);

/// A robot far away that follows the tool.
struct RobotShown {
  std::string state;                ///< "following"
  std::string reason;               ///< why it stopped; empty: it has not
  bool heard = false;               ///< lately
  std::uint64_t behind = 0;         ///< ticks since its last reported command
  double round_trip_s = 0;          ///< round trip of a packet
  Pose scene_T_tool;                ///< pose of its tool then, as if its soil's surface were this one's
  Vec3 displayed_n = Vec3::Zero();  ///< at the newest command with both forces known,
  Vec3 met_n = Vec3::Zero();        ///< and the remote force there
  /// Learned soil; each value with the lower end of 90 %, the centre, the upper end.
  struct Learned {
    std::array<double, 3> friction_angle_deg{}, cohesion_pa{}, tool_friction_angle_deg{};
  };
  std::optional<Learned> learned;  ///< empty: nothing yet
  /// Its view of the site: heights over the site's first surface, row by row along x, in m; NaN: not known.
  struct Site {
    double x_m = 0, y_m = 0;  ///< corner of the first cell
    double cell_m = 0;
    std::size_t columns = 0, rows = 0;
    std::vector<double> height_m;
  };
  std::optional<Site> site;  ///< none: it has shown nothing
};

/// Status in addition to the session's own.
struct StatusBeside {
  double rate_hz = 0;  ///< ticks a second, lately
  std::size_t clients = 0;
  std::optional<std::uint32_t> held_by = {};  ///< a client's number
  std::string_view recording = {};            ///< a file's name; empty: none
  std::filesystem::path recorded = {};        ///< the last file that is finished, and its folder; empty: none
  const RobotShown* robot = nullptr;          ///< null: none follows
};
[[nodiscard]] Board::Texts statusMessages(const Session& session, const StatusBeside& beside);

/// @param id  null in the reply when no id can be repeated.
/// @param refused  reason of the refusal; empty: accepted.
[[nodiscard]] std::string replyMessage(std::optional<std::int64_t> id, std::string_view refused);

}  // namespace haptolith
