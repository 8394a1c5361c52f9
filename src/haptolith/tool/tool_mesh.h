#pragma once

#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/vec.h"
#include "haptolith/mesh/distance_field.h"
#include "haptolith/mesh/mend.h"
#include "haptolith/mesh/mesh_file.h"
#include "haptolith/mesh/triangle_mesh.h"

namespace haptolith {

/// A user's mesh, and its pose in the hand. A point p of the file becomes
///
///     Rz Ry Rx (unit p - origin)     in the tool's frame; turned about x first, then y, then z
struct ToolMeshSource {
  std::string name;                          ///< name of the file, for messages; ignored by comparisons
  std::shared_ptr<const std::string> bytes;  ///< content of the file; null: there is no mesh
  MeshFormat format = MeshFormat::kStl;
  double unit_m = 1e-3;            ///< unit of STL and OBJ: see MeshFileOptions
  double sheet_thickness_m = 0;    ///< thickness of a surface that is not closed: see MendOptions
  std::optional<Vec3> origin_m{};  ///< point of the mesh that the hand holds; default: centre of the box around it
  Vec3 turn_rad = Vec3::Zero();

  [[nodiscard]] bool operator==(const ToolMeshSource& other) const;
};

/// Valid ranges of a ToolMeshSource, in addition to kMeshUnit_m and kSheetThickness_m; read by validate() and scene
/// files alike.
struct ToolMeshRanges {
  static constexpr double kFullTurn_rad = 2 * std::numbers::pi;
  static constexpr Range origin_m{-kMeshReach_m.highest, kMeshReach_m.highest};  ///< along each axis
  static constexpr Range turn_rad{-kFullTurn_rad, kFullTurn_rad};
};

/// @throws InvalidParameter with the key, the value and the valid range.
void validate(const ToolMeshSource& source);

/// Data of a mesh for the tick, in the tool frame, and for pictures.
struct ToolMesh {
  TriangleMesh surface;  ///< for pictures: see shownSurface()
  DistanceField field;
  std::vector<std::string> report;  ///< repairs of the mesh: sentences
};

/// Margin of the field for the grid: limits the distance of a touching sphere's centre from a mesh's surface, in m.
inline constexpr double kFieldMargin_m = 0.5e-3;
inline constexpr double kMostMeshReach_m = kFieldBand_m.highest - kFieldMargin_m;

/// The format that a file's name says. @throws InvalidParameter for a name that is no mesh's.
[[nodiscard]] MeshFormat requireMeshFormat(const std::filesystem::path& path);

/// Reads a mesh file whole. @throws InvalidParameter for a name that is no mesh's, or a file that is too large; Failure
/// when it cannot be read.
void readInto(ToolMeshSource& source, const std::filesystem::path& path);

/// The mesh as a tool: read, repaired, placed, and measured as far as `reach_m` from its surface, the distance from
/// which a particle's centre may feel it. Takes seconds where there are many triangles; the same again is there at
/// once, and is the same object. It lives until it is unused and another one is made: the tick never frees one.
/// @throws InvalidParameter, Failure: as parseMesh(), mend() and makeDistanceField(); InvalidParameter for a reach that
/// no field has.
[[nodiscard]] std::shared_ptr<const ToolMesh> toolMesh(const ToolMeshSource& source, double reach_m);

}  // namespace haptolith
