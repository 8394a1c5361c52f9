#pragma once

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "haptolith/session/session.h"
#include "haptolith/stone/stone_shape.h"
#include "haptolith/viewer/board.h"
#include "haptolith/viewer/frame.h"

namespace haptolith {

/// The JSON messages of docs/protocol.md. The nameless ones name no soil, world, preset or file.

/// "$client" in it stands for the number of the client it goes to: see Board.
[[nodiscard]] Board::Texts helloMessages(std::string_view version, bool read_only, bool takes_uploads);

/// What a stone looks like: its mesh, or its spheres where it has none.
[[nodiscard]] nlohmann::ordered_json stoneJson(const StoneShape& stone);

[[nodiscard]] Board::Texts sceneMessages(const Session& session, const FrameEncoder::Space& space);

/// What a session does not know about itself.
struct StatusBeside {
  double rate_hz = 0;  ///< ticks a second, lately
  std::size_t clients = 0;
  std::optional<std::uint32_t> held_by = {};  ///< a client's number
  std::string_view recording = {};            ///< a file's name; empty: none
  std::filesystem::path recorded = {};        ///< the last file that is finished, and its folder; empty: none
};
[[nodiscard]] Board::Texts statusMessages(const Session& session, const StatusBeside& beside);

/// @param id  null in the reply when there is none that can be repeated.
/// @param refused  why it was not done; empty: it was.
[[nodiscard]] std::string replyMessage(std::optional<std::int64_t> id, std::string_view refused);

}  // namespace haptolith
