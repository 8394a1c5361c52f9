#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "haptolith/recording/recorded_pictures.h"

namespace haptolith {

// Common part of the exports for VTK and XDMF: meshes, and the names of their fields.

/// Points and cells of as many of these each, in m, scene's frame.
struct PictureMesh {
  std::vector<std::array<float, 3>> point_m;
  std::vector<std::int32_t> cells;  ///< numbers of points
  std::uint64_t points_per_cell = 1;
};

/// Numbers of the tool at the time of a picture; the orientation is w, x, y, z.
struct NamedNumbers {
  const char* name;
  std::vector<double> values;
};
[[nodiscard]] std::vector<NamedNumbers> numbersOf(const PicturedTool& at, const ToolParameters& tool);

/// Names of the files of each tool: "tool" for the only one, else "tool-left".
[[nodiscard]] std::vector<std::string> toolFileNames(const RecordedPictures& pictures);

/// The tool's surface as triangles.
[[nodiscard]] PictureMesh toolMesh(const ToolParameters& tool, const PicturedTool& at);

/// Shapes of all stones, as triangles.
[[nodiscard]] PictureMesh stonesMesh(const std::vector<PicturedStone>& stones);

/// The edges of the bed's box, whose walls end nowhere: as high as the soil of the pictures that it was shown.
class BoxMesh {
 public:
  void show(const ScenePicture& picture);
  [[nodiscard]] PictureMesh of(const BedParameters& bed) const;

 private:
  float highest_m_ = 0;
};

inline constexpr const char* kVelocity = "velocity_m_s";
inline constexpr const char* kRadius = "radius_m";
inline constexpr const char* kContactForce = "contact_force_n";
inline constexpr const char* kId = "id";

/// 0 to count - 1.
[[nodiscard]] std::vector<std::int32_t> numbered(std::size_t count);

/// A time as it is meant: 0.208, not 0.20800000000000002.
[[nodiscard]] std::string timeText(double time_s);

}  // namespace haptolith
