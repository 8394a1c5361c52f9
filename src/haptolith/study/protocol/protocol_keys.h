#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/scene_file/toml/file_keys.h"
#include "haptolith/study/protocol/protocol.h"

namespace haptolith {

/// What the top of a protocol says, before it is made sense of.
struct ProtocolDraft {
  StudyProtocol protocol = {};
  std::filesystem::path scene_file = {};  ///< empty: the paper's scene
  bool task_load_index = false;
};

/// What a [[block]] says, before it is made sense of.
struct BlockDraft {
  StudyBlock block = {};
  std::string varies = {};
  std::vector<TextOrNumber> levels = {}, values = {}, reference = {};
  std::vector<TextOrNumber> practice_levels = {}, catch_levels = {};
  std::optional<double> reference_value = {};
  TeleopWork teleop = {};
  bool task_load_index = false;
};

/// What a [[groups]] says, before it is made sense of.
struct GroupDraft {
  ParticipantGroup group = {};
  std::optional<std::vector<std::string>> blocks = {};  ///< names; none: all blocks
};

using ProtocolKey = FileKey<ProtocolDraft>;
using GroupKey = FileKey<GroupDraft>;
using BlockKey = FileKey<BlockDraft>;
using ItemKey = FileKey<FormItem>;

/// The keys of a protocol: at its top and in [assignment], in a [[groups]], in a [[block]], and in an item of a form.
/// docs/reference/protocol-keys.md and protocol-tables.md list them.
[[nodiscard]] std::span<const ProtocolKey> protocolKeys();
[[nodiscard]] std::span<const GroupKey> groupKeys();
[[nodiscard]] std::span<const BlockKey> blockKeys();
[[nodiscard]] std::span<const ItemKey> itemKeys();

/// "none", "model" or "learning".
[[nodiscard]] std::string_view teleopForceWord(TeleopForce force);

/// A number of the scene, other than the soil's, that a block may set or vary.
struct SceneNumber {
  std::string_view key, axis_label;
  double unit;  ///< of the key, in SI
  std::optional<double> SceneChange::*member;
  Range valid;  ///< in SI
  std::string_view meaning;
};
[[nodiscard]] std::span<const SceneNumber> sceneNumbers();

}  // namespace haptolith
