#pragma once

#include <array>
#include <span>
#include <string>

#include "haptolith/scene_file/scene_file.h"
#include "haptolith/scene_file/toml/file_keys.h"
#include "haptolith/scene_file/toml/toml_reader.h"
#include "haptolith/stone/stone_parameters.h"

namespace haptolith {

using StoneKey = FileKey<PlacedStone>;

/// Every key of a [[stone]], in the order of the document.
[[nodiscard]] std::span<const StoneKey> stoneKeys();

/// The stones of a scene file that are each put somewhere; those of `scene` stay where the file has none.
/// @throws TomlError.
void readPlacedStones(const TomlReader& reader, SceneFile& scene);

/// As [[stone]] tables. Empty without any.
[[nodiscard]] std::string placedStonesText(const SceneFile& scene);

}  // namespace haptolith
