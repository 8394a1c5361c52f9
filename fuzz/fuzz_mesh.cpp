// Mesh from an untrusted source: it is read or refused, and so are its repair and its distance field. The first byte
// selects the format.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/mesh/distance_field.h"
#include "haptolith/mesh/mend.h"
#include "haptolith/mesh/mesh_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace haptolith;
  if (size == 0) {
    return 0;
  }
  constexpr MeshFormat kFormats[]{MeshFormat::kStl, MeshFormat::kObj, MeshFormat::kGltf};
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    TriangleMesh mesh = parseMesh(bytes, "mesh", kFormats[data[0] % 3]);
    constexpr std::size_t kSome = 2000;
    if (mesh.triangles.size() > kSome) {
      return 0;
    }
    const MendedMesh mended = mend(std::move(mesh), {.sheet_thickness_m = data[0] % 2 == 0 ? 0 : 0.002});
    const DistanceField field =
        makeDistanceField(mended, {.spacing_m = 1e-3, .band_m = 1e-3, .threads = 1, .most_bytes = 1 << 20});
    const Vec3 middle_m = (field.corners().low_m + field.corners().high_m) / 2;
    if (!(field.at(middle_m).distance_m <= field.band())) {
      std::abort();
    }
  } catch (const InvalidParameter&) {
  } catch (const Failure&) {
  }
  return 0;
}
