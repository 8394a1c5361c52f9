#pragma once

#include <span>

#include "haptolith/scene_file/scene_file.h"
#include "haptolith/scene_file/toml/file_keys.h"

namespace haptolith {

using SceneFileKey = FileKey<SceneFile>;

/// Every key there is, in the order in which they are applied: what a key builds on stands before it.
[[nodiscard]] std::span<const SceneFileKey> sceneFileKeys();

/// Whether the keys of a table belong to a tool, of which a scene may have several.
[[nodiscard]] bool isToolTable(std::string_view table);
[[nodiscard]] bool isOfTool(const SceneFileKey& key);

/// Those of the keys that belong to a tool; "tool" itself comes first.
[[nodiscard]] std::span<const SceneFileKey> keysOfTools();

}  // namespace haptolith
