#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "haptolith/device/hand/hand_parameters.h"
#include "haptolith/scene_file/scene_words.h"
#include "haptolith/session/scene_change.h"
#include "haptolith/tool/tool_mesh.h"

namespace haptolith {

/// Quantities by which a client may colour particles, and whether they need contact forces.
inline constexpr std::array kColourWords{SceneWord{"plain", false}, SceneWord{"force", true}, SceneWord{"speed", false},
                                         SceneWord{"depth", false}, SceneWord{"sleep", false}};

/// Requests of a client of the view: docs/reference/web-protocol.md.
namespace command {

struct Hold {
  Pose scene_T_tool;
  std::optional<std::string> tool;  ///< its name; empty: the first
};
struct Release {
  std::optional<std::string> tool;
};
struct Play {
  HandMotion motion = HandMotion::kStill;
  std::optional<std::string> tool;
};
struct Change {
  SceneChange change;
};
/// A mesh that the client has uploaded as the tool.
struct ToolFile {
  std::uint64_t upload = 0;  ///< see WebServer::takeUpload()
  ToolMeshSource source;     ///< without its bytes
};
struct Reset {};
struct Level {};
struct Coarser {};
struct Undo {};
struct Pause {};
struct Resume {};
struct Step {
  int ticks = 1;
};
struct Speed {
  double factor = 1;
};
struct Record {
  bool on = false;
};
struct Colour {
  bool by_force = false;
};

}  // namespace command

using Command = std::variant<command::Hold, command::Release, command::Play, command::Change, command::ToolFile,
                             command::Reset, command::Level, command::Coarser, command::Undo, command::Pause,
                             command::Resume, command::Step, command::Speed, command::Record, command::Colour>;

/// A message of a client, taken apart as far as that went.
struct ClientMessage {
  bool wants_reply = false;
  std::optional<std::int64_t>
      id;  ///< id of the reply; empty: no reply is requested, or the id is the reason for the refusal
  std::optional<Command> command;  ///< empty: it is refused, or the guest's
  bool confirmed = false;          ///< it is known that a person feels what it changes
  bool for_guest = false;          ///< "do": "study": not the view's to understand
  std::string refused;             ///< why
};

/// Never throws for what a client may send, however wrong it is.
[[nodiscard]] ClientMessage parseClientMessage(std::string_view text);

}  // namespace haptolith
