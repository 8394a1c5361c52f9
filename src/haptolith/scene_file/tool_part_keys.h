#pragma once

#include <span>

#include "haptolith/scene_file/scene_file.h"
#include "haptolith/scene_file/toml/file_keys.h"
#include "haptolith/scene_file/toml/toml_reader.h"
#include "haptolith/tool/tool_part.h"

namespace haptolith {

using ToolPartKey = FileKey<ToolPart>;

/// Every key of a [[tool_part]], in the order of the document.
[[nodiscard]] std::span<const ToolPartKey> toolPartKeys();

/// The tool of a scene file that is put together of parts, as a mesh; that of `scene` stays where the file has none.
/// @throws TomlError.
void readToolParts(const TomlReader& reader, SceneFile& scene);

}  // namespace haptolith
