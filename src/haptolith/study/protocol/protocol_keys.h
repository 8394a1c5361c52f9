#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/scene_file/toml/file_keys.h"
#include "haptolith/study/protocol/protocol.h"

namespace haptolith {

/// Top level of a protocol file, as read.
struct ProtocolDraft {
  StudyProtocol protocol = {};
  std::filesystem::path scene_file = {};  ///< empty: the scene of icra2021
  bool task_load_index = false;
};

/// Table [[block]], as read.
struct BlockDraft {
  StudyBlock block = {};
  std::string varies = {};
  std::vector<TextOrNumber> levels = {}, values = {}, reference = {};
  std::vector<TextOrNumber> practice_levels = {}, catch_levels = {};
  std::optional<double> reference_value = {};
  TeleopWork teleop = {};
  bool task_load_index = false;
};

/// Table [[groups]], as read.
struct GroupDraft {
  ParticipantGroup group = {};
  std::optional<std::vector<std::string>> blocks = {};  ///< names; none: all blocks
};

using ProtocolKey = FileKey<ProtocolDraft>;
using GroupKey = FileKey<GroupDraft>;
using BlockKey = FileKey<BlockDraft>;
using ItemKey = FileKey<FormItem>;

// Keys of a protocol: at top level and in [assignment], in [[groups]], in [[block]], and in an item of a form.
// docs/reference/protocol-keys.md and protocol-tables.md list them.
[[nodiscard]] std::span<const ProtocolKey> protocolKeys();
[[nodiscard]] std::span<const GroupKey> groupKeys();
[[nodiscard]] std::span<const BlockKey> blockKeys();
[[nodiscard]] std::span<const ItemKey> itemKeys();

/// Returns "none", "model" or "learning".
[[nodiscard]] std::string_view teleopForceWord(TeleopForce force);

/// Number of the scene outside the soil that a block may set or vary.
struct SceneNumber {
  std::string_view key, axis_label;
  double unit;  ///< unit of the key, in SI
  std::optional<double> SceneChange::*member;
  Range valid;  ///< valid range in SI
  std::string_view meaning;
};
[[nodiscard]] std::span<const SceneNumber> sceneNumbers();

}  // namespace haptolith
