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

/// "$client" in it stands for the number of the client it goes to: see Board.
[[nodiscard]] Board::Texts helloMessages(std::string_view version, bool read_only, bool takes_uploads);

/// What a stone looks like: its mesh, or its spheres where it has none.
[[nodiscard]] nlohmann::ordered_json stoneJson(const StoneShape& stone);

/// A scene that somebody looks at.
struct SceneLookedAt {
  const SceneFile& scene_file;  ///< as it is wanted
  const SoilParameters& soil;   ///< as it is shown
  std::uint32_t scene = 1;      ///< see FrameEncoder
  std::vector<Bed::GrainRun> grains;
  double surface_m = 0;
  Manoeuvre manoeuvre = Manoeuvre::kStill;
  Vec3 low_m, high_m;  ///< where the tool may be
  std::vector<std::shared_ptr<const StoneShape>> stones = {};
};
[[nodiscard]] Board::Texts sceneMessages(const SceneLookedAt& shown, const FrameSpace& space);
[[nodiscard]] Board::Texts sceneMessages(const Session& session, const FrameSpace& space);

/// The space around a bed that pictures show: thrown particles fly so high before they are shown at the border.
[[nodiscard]] FrameSpace shownSpace(const BedParameters& bed, double surface_m);

/// A robot far away that follows the tool.
struct RobotShown {
  std::string state;                ///< "following"
  std::string reason;               ///< why it stopped; empty: it has not
  bool heard = false;               ///< lately
  std::uint64_t behind = 0;         ///< ticks since the command that it was last heard to have come to
  double round_trip_s = 0;          ///< of a packet
  Pose scene_T_tool;                ///< of its tool then, as if its soil's surface were this one's
  Vec3 displayed_n = Vec3::Zero();  ///< at the newest commands of which both are known,
  Vec3 met_n = Vec3::Zero();        ///< and what the robot met there
  /// What the soil has learned to be like; each the lower end of 90 %, the middle, the upper end.
  struct Learned {
    std::array<double, 3> friction_angle_deg{}, cohesion_pa{}, tool_friction_angle_deg{};
  };
  std::optional<Learned> learned;  ///< none: nothing yet
  /// What it sees of its site: heights over the site's first surface, row by row along x, in m; NaN: not known.
  struct Site {
    double x_m = 0, y_m = 0;  ///< corner of the first cell
    double cell_m = 0;
    std::size_t columns = 0, rows = 0;
    std::vector<double> height_m;
  };
  std::optional<Site> site;  ///< none: it has shown nothing
};

/// What a session does not know about itself.
struct StatusBeside {
  double rate_hz = 0;  ///< ticks a second, lately
  std::size_t clients = 0;
  std::optional<std::uint32_t> held_by = {};  ///< a client's number
  std::string_view recording = {};            ///< a file's name; empty: none
  std::filesystem::path recorded = {};        ///< the last file that is finished, and its folder; empty: none
  const RobotShown* robot = nullptr;          ///< null: none follows
};
[[nodiscard]] Board::Texts statusMessages(const Session& session, const StatusBeside& beside);

/// @param id  null in the reply when there is none that can be repeated.
/// @param refused  why it was not done; empty: it was.
[[nodiscard]] std::string replyMessage(std::optional<std::int64_t> id, std::string_view refused);

}  // namespace haptolith
