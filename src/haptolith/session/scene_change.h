#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/vec.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/tool/tool_mesh.h"

namespace haptolith {

/// Changes of a running scene; absent values stay unchanged.
struct SceneChange {
  std::optional<std::string> preset = {}, soil = {}, body = {};  ///< not both of preset and soil
  std::optional<FrictionModel> friction = {};
  std::vector<std::pair<std::string, double>> sliders = {};  ///< see slidersOf()
  std::optional<ToolShape> tool_shape = {};
  std::optional<ToolMeshSource> tool_mesh = {};
  std::optional<Vec3> tool_size_m = {};
  std::optional<double> tool_diameter_m = {}, tool_thickness_m = {}, tool_opening_m = {}, tool_length_m = {};
  std::optional<double> soil_depth_m = {};                      ///< depth of a filled bed
  std::optional<double> stone_size_m = {}, stone_depth_m = {};  ///< for each placed stone
  std::optional<double> gravity_m_s2 = {};                      ///< magnitude; the direction is unchanged

  /// Whether it needs a new bed of another soil, or only changes that the bed can continue with.
  [[nodiscard]] bool wantsNewBed() const noexcept {
    return preset || soil || friction || soil_depth_m || stone_size_m || stone_depth_m;
  }
};

/// Limit of a tool's length, width or thickness while a scene runs, in m: as the box at most. One that is larger
/// leaves the soil no place, which pushes the hand away with all the force there is, and makes the bed collapse.
[[nodiscard]] Range toolLengths(const BedParameters& bed);

/// Refuses a mesh that is wider than `lengths_m` in more than one of its directions: a handle may be longer.
/// @throws InvalidParameter.
void requireFitting(const MeshCorners& mesh, const std::string& name, const Range& lengths_m);

/// The scene with the change made. @throws InvalidParameter naming what cannot be; Failure when a soil file cannot be
/// read.
[[nodiscard]] SceneFile changed(SceneFile scene_file, const SceneChange& change);

}  // namespace haptolith
