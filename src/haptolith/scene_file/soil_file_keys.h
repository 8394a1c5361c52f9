#pragma once

#include <span>

#include "haptolith/scene_file/scene_file_keys.h"
#include "haptolith/scene_file/soil_file.h"
#include "haptolith/scene_file/toml/file_keys.h"

namespace haptolith {

using SoilFileKey = FileKey<SoilFile>;

/// Every key of a soil file but those of [soil], in the order in which they are written.
[[nodiscard]] std::span<const SoilFileKey> soilFileKeys();

/// The keys of a soil file's [soil]: those of a scene's that are numbers of the soil itself.
[[nodiscard]] std::span<const SceneFileKey> soilKeys();

}  // namespace haptolith
