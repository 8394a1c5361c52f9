#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/files/json_reader.h"

/// Numbers in the buffers of glTF 2.0 files: https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html, 3.6
namespace haptolith::gltf {

/// Numbers of the format.
enum ComponentType : std::uint64_t {
  kSignedByte = 5120,
  kByte = 5121,
  kSignedShort = 5122,
  kShort = 5123,
  kInt = 5125,
  kFloat = 5126
};
[[nodiscard]] std::size_t bytesOf(std::uint64_t component);

/// The index into a list of the file that `index` holds, such as the mesh of a node.
[[nodiscard]] std::size_t indexNamed(const JsonValue& index, const JsonValue& file, const char* list);
[[nodiscard]] JsonValue valueNamed(const JsonValue& index, const JsonValue& file, const char* list);

/// The whole number at a key, of bytes or of the format; `otherwise` without the key.
[[nodiscard]] std::uint64_t wholeOr(const JsonValue& value, const char* key, std::uint64_t otherwise);

/// Elements of a buffer as an accessor names them: all of them lie in it.
struct Elements {
  const char* first = nullptr;
  std::size_t stride_bytes = 0;
  std::size_t count = 0;
  std::uint64_t component = kFloat;
  bool normalised = false;     ///< integers represent -1 to 1, or 0 to 1
  std::vector<char> own = {};  ///< storage of `first` for a sparse accessor

  /// A number as glTF 2.0, 3.11 and KHR_mesh_quantization have it.
  [[nodiscard]] double number(std::size_t element, std::size_t place) const;
};

void requireIndices(const Elements& indices, const JsonValue& place);
/// Index of the element's point in the primitive.
[[nodiscard]] std::uint32_t indexAt(const Elements& indices, std::size_t i);

/// The buffers of a file, and their content.
class Buffers {
 public:
  /// @param binary  the binary part of a .glb
  Buffers(JsonValue file, std::optional<std::string_view> binary);
  Buffers(const Buffers&) = delete;
  Buffers& operator=(const Buffers&) = delete;

  [[nodiscard]] Elements elementsOf(const JsonValue& accessor, const char* type, std::size_t components) const;

 private:
  /// Bytes of a view, and how far apart its elements are unless they follow each other.
  struct View {
    std::string_view bytes;
    std::uint64_t stride_bytes;
  };
  [[nodiscard]] View viewOf(const JsonValue& named, std::uint64_t element_bytes) const;
  [[nodiscard]] Elements elementsIn(const JsonValue& place, std::uint64_t component, std::size_t components,
                                    std::uint64_t count) const;
  void replaceSome(Elements& elements, const JsonValue& sparse, std::size_t components, std::uint64_t count) const;

  JsonValue file_;
  std::vector<std::string> own_;
  std::vector<std::string_view> buffers_;
};

}  // namespace haptolith::gltf
