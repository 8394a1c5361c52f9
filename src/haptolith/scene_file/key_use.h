#pragma once

#include <span>
#include <string_view>

#include "haptolith/scene_file/scene_file.h"

namespace haptolith {

/// A key of scene files that has an effect in some scenes only.
struct KeyUse {
  std::string_view table, name;
  bool (*counts)(const SceneFile&);  ///< whether it has an effect in this scene
  std::string_view needs;            ///< requirement: "[tool] shape = sphere or plate"
  bool may_count_later;              ///< whether the command line or the page can make it count after the file is read
};

/// All of them; a key that is not among them counts in every scene.
[[nodiscard]] std::span<const KeyUse> keyUses();

}  // namespace haptolith
