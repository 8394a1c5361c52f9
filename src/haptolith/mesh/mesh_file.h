#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/mesh/triangle_mesh.h"

namespace haptolith {

/// Size limit of a mesh file.
inline constexpr std::uintmax_t kMostMeshBytes = std::uintmax_t{256} << 20;
inline constexpr std::size_t kMostTriangles = 2'000'000;
inline constexpr std::size_t kMostMeshPoints = 3 * kMostTriangles;

/// Largest edge of the box around a mesh that a hand can hold, in m.
inline constexpr Range kHandSize_m{2e-3, 2};
/// Distance of every point from the origin, in m: farther away a float does not resolve micrometres.
inline constexpr Range kMeshReach_m{0, 10};
inline constexpr Range kMeshUnit_m{1e-6, 1};

struct MeshFileOptions {
  double unit_m =
      1e-3;  ///< unit of STL and OBJ files, which declare none, in m, 1e-6 to 1; glTF is in metres by its specification
};

enum class MeshFormat { kStl, kObj, kGltf };

/// The format that a file's name says (.stl, .obj, .glb, .gltf, in any case of letters).
[[nodiscard]] std::optional<MeshFormat> meshFormat(const std::filesystem::path& path);

/// Reads a mesh, z up, in m: the triangles that the file holds, not yet repaired (mend.h).
///
/// STL is binary or text; polygons of OBJ are cut into triangles (polygon.h); of glTF 2.0 the triangles of the default
/// scene are taken, with the transforms of their nodes, and y up becomes z up: (x, y, z) -> (x, -z, y). Materials,
/// normals, bones, morph targets and animations are left out. A .gltf file may have its data in files next to it
/// (withBuffersInside()). Not for the tick.
/// @throws InvalidParameter with the file, the place in it and what is valid: for anything that is not a mesh of this
/// form, for numbers that are not finite, for a mesh outside kHandSize_m or kMeshReach_m (with the unit that would be
/// plausible); Failure when the file cannot be read.
[[nodiscard]] TriangleMesh readMesh(const std::filesystem::path& path, const MeshFileOptions& options = {});

/// A .gltf file whose buffers stand in other files, with them inside; any other bytes as they are. The files lie in the
/// folder of `path` or below it; their names are escaped as URIs are ("my%20tool.bin").
/// @throws InvalidParameter for a buffer elsewhere, or one that is missing or too large; Failure when it cannot be
/// read.
[[nodiscard]] std::string withBuffersInside(std::string bytes, const std::filesystem::path& path);

/// As above from bytes in memory, which name no other files. @param name  for messages.
/// @param notes  receives omissions and unusual content, a sentence each; may be null.
[[nodiscard]] TriangleMesh parseMesh(std::string_view bytes, const std::string& name, MeshFormat format,
                                     const MeshFileOptions& options = {}, std::vector<std::string>* notes = nullptr);

}  // namespace haptolith
