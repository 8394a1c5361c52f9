#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "haptolith/mesh/triangle_mesh.h"

namespace haptolith {

/// Parts of a surface within which each edge has one or two triangles, all turned to look the same way.
struct Patches {
  std::vector<std::int32_t> of;  ///< of each triangle
  std::vector<bool> as_in_file;  ///< of each patch: none of its triangles was turned
  std::size_t turned = 0;        ///< triangles
  bool one_sided = false;        ///< there is one that has no two sides, such as a Moebius strip
};

/// Turns triangles to look the same way as most of their patch.
Patches turnNeighbours(TriangleMesh& mesh);

/// Closed parts: patches, or several that meet in edges of more than two triangles and are closed together.
struct Shells {
  std::vector<std::int32_t> of;  ///< of each triangle
  std::vector<bool> as_in_file;
  bool closed = true;
};

[[nodiscard]] Shells shellsOf(const TriangleMesh& mesh, const Patches& patches);

/// Result of turnOutwards().
struct Turned {
  std::size_t parts = 0;
  std::size_t cavities = 0;
};

/// Turns closed parts to look outwards, and cavities inwards.
/// @throws Failure when stopAsked().
Turned turnOutwards(TriangleMesh& mesh, const Shells& shells);

}  // namespace haptolith
