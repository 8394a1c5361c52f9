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

/// What is to be different about a scene while it is shown; what is left out stays as it is.
struct SceneChange {
  std::optional<std::string> preset = {}, soil = {}, body = {};  ///< not both of preset and soil
  std::optional<FrictionModel> friction = {};
  std::vector<std::pair<std::string, double>> sliders = {};  ///< see slidersOf()
  std::optional<ToolShape> tool_shape = {};
  std::optional<ToolMeshSource> tool_mesh = {};
  std::optional<Vec3> tool_size_m = {};
  std::optional<double> tool_diameter_m = {}, tool_thickness_m = {}, tool_opening_m = {}, tool_length_m = {};
  std::optional<double> soil_depth_m = {};                      ///< of a bed that is filled up to a depth
  std::optional<double> stone_size_m = {}, stone_depth_m = {};  ///< of each stone that was put somewhere
  std::optional<double> gravity_m_s2 = {};                      ///< keeps its direction

  /// Whether it asks for other soil, of which a bed has to be made, or only for what a bed can go on with.
  [[nodiscard]] bool wantsNewBed() const noexcept {
    return preset || soil || friction || soil_depth_m || stone_size_m || stone_depth_m;
  }
};

/// How long, wide or thick a tool may become while a scene is shown, in m: as the box at most. One that is larger
/// leaves the soil no place, which pushes the hand away with all the force there is, and makes the bed collapse.
[[nodiscard]] Range toolLengths(const BedParameters& bed);

/// Refuses a mesh that is wider than `lengths_m` in more than one of its directions: a handle may be longer.
/// @throws InvalidParameter.
void requireFitting(const MeshCorners& mesh, const std::string& name, const Range& lengths_m);

/// The scene with the change made. @throws InvalidParameter naming what cannot be; Failure when a soil file cannot be
/// read.
[[nodiscard]] SceneFile changed(SceneFile scene_file, const SceneChange& change);

}  // namespace haptolith
