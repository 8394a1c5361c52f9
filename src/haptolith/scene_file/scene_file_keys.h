#pragma once

#include <span>

#include "haptolith/scene_file/scene_file.h"
#include "haptolith/scene_file/toml/file_keys.h"

namespace haptolith {

using SceneFileKey = FileKey<SceneFile>;

/// Every key there is, in the order in which they are applied: what a key builds on stands before it.
[[nodiscard]] std::span<const SceneFileKey> sceneFileKeys();

}  // namespace haptolith
