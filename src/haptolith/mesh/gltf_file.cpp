#include <Eigen/LU>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "haptolith/core/base64.h"
#include "haptolith/core/error.h"
#include "haptolith/core/files/input_file.h"
#include "haptolith/core/files/json_reader.h"
#include "haptolith/core/stop_asked.h"
#include "haptolith/mesh/gltf_accessor.h"
#include "haptolith/mesh/mesh_file.h"
#include "haptolith/mesh/mesh_formats.h"

// glTF 2.0: https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html

namespace haptolith {

namespace {

using gltf::indexNamed;
using gltf::valueNamed;

constexpr JsonLimits kJsonLimits{.depth = 32, .values = 1'000'000};
constexpr Range kNumbers{-1e9, 1e9};
/// Meshes that nodes show, counted as often as they are shown.
constexpr int kMostShown = 100'000;

constexpr std::uint32_t kGlbMagic = 0x46546C67;   // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t kBinChunk = 0x004E4942;   // "BIN\0"

/// Extensions without which a file cannot be read, and which change no shape or are known.
bool isKnown(std::string_view extension) {
  return extension.starts_with("KHR_materials_") || extension.starts_with("KHR_texture_") ||
         extension == "KHR_mesh_quantization";
}
enum PrimitiveMode : std::uint64_t { kTriangles = 4, kStrip = 5, kFan = 6 };

std::uint32_t wordAt(std::string_view bytes, std::size_t place) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + place, sizeof word);
  return word;
}

/// The text and the binary part of a file.
struct Chunks {
  std::string_view json;
  std::optional<std::string_view> binary;
};

Chunks chunksOf(std::string_view bytes, const std::string& name, MeshNotes& notes) {
  constexpr std::size_t kHeader = 12;
  constexpr std::size_t kChunkHeader = 8;
  if (bytes.size() < kHeader || wordAt(bytes, 0) != kGlbMagic) {
    return {withoutByteOrderMark(bytes), std::nullopt};  // .gltf
  }
  if (wordAt(bytes, 4) != 2) {
    throw InvalidParameter(name + ": version", fmt::format("{}", wordAt(bytes, 4)), "2 (glTF 2.0)");
  }
  const std::size_t said = wordAt(bytes, 8);
  if (said > bytes.size()) {
    throw InvalidParameter(name, fmt::format("{} bytes", bytes.size()),
                           fmt::format("the {} bytes that its header states (is it truncated?)", said));
  }
  if (said < bytes.size()) {
    notes.push_back(fmt::format("{} bytes after its end are ignored", bytes.size() - said));
    bytes = bytes.substr(0, said);
  }
  Chunks chunks;
  for (std::size_t place = kHeader; place < bytes.size();) {
    const std::size_t left = bytes.size() - place;
    const std::size_t length = left < kChunkHeader ? 0 : wordAt(bytes, place);
    if (left < kChunkHeader || length > left - kChunkHeader) {
      throw InvalidParameter(fmt::format("{}: part at byte {}", name, place), fmt::format("{} bytes", length),
                             fmt::format("at most the {} bytes that follow", left));
    }
    const std::string_view content = bytes.substr(place + kChunkHeader, length);
    const std::uint32_t kind = wordAt(bytes, place + 4);
    if (kind == kJsonChunk && place == kHeader) {
      chunks.json = content;
    } else if (kind == kBinChunk && !chunks.binary) {
      chunks.binary = content;
    }
    place += kChunkHeader + length;
  }
  return chunks;
}

template <std::size_t kCount>
std::array<double, kCount> numbersOr(const JsonValue& value, const char* key,
                                     const std::array<double, kCount>& otherwise) {
  return value.has(key) ? value.at(key).numbers<kCount>(kNumbers) : otherwise;
}

class GltfReader {
 public:
  GltfReader(const JsonValue& file, std::optional<std::string_view> binary, MeshNotes& notes)
      : file_(file), binary_(binary), notes_(notes) {}

  TriangleMesh read() {
    requireKnown();
    buffers_.emplace(file_, binary_);
    showScene();
    noteLeftOut();
    return std::move(mesh_);
  }

 private:
  void requireKnown() const {
    const JsonValue version = file_.at("asset").at("version");
    if (!version.text().starts_with("2.")) {
      version.refuse(version.given(), "2.0");
    }
    if (file_.has("extensionsRequired")) {
      for (const JsonValue& extension : file_.at("extensionsRequired").list()) {
        if (!isKnown(extension.text())) {
          extension.refuse(extension.given(), "no extension that changes the shape: export without compression");
        }
      }
    }
  }

  void showPrimitive(const JsonValue& primitive, const Eigen::Affine3d& scene_T_mesh) {
    const std::uint64_t mode = gltf::wholeOr(primitive, "mode", kTriangles);
    if (mode < kTriangles) {
      has_lines_ = true;
      return;
    }
    if (mode > kFan) {
      primitive.at("mode").refuse(fmt::format("{}", mode), "0 to 6");
    }
    const JsonValue position = valueNamed(primitive.at("attributes").at("POSITION"), file_, "accessors");
    const gltf::Elements points = buffers_->elementsOf(position, "VEC3", 3);
    if (points.component != gltf::kFloat && gltf::bytesOf(points.component) == 4) {
      position.at("componentType")
          .refuse(fmt::format("{}", points.component), "5126 (floats), or 5120 to 5123 (KHR_mesh_quantization)");
    }
    has_morph_targets_ = has_morph_targets_ || primitive.has("targets");
    requireRoom(mesh_, points.count, 0, primitive.path());
    const std::size_t first = mesh_.points_m.size();
    for (std::size_t i = 0; i < points.count; ++i) {
      const Vec3 point_m = scene_T_mesh * Vec3(points.number(i, 0), points.number(i, 1), points.number(i, 2));
      if (!point_m.allFinite()) {
        position.refuse(fmt::format("no finite number in value {}", i), "finite numbers");
      }
      mesh_.points_m.emplace_back(point_m.x(), -point_m.z(), point_m.y());  // y up becomes z up
    }
    std::optional<JsonValue> accessor;
    gltf::Elements indices{};
    std::size_t count = points.count;
    if (primitive.has("indices")) {
      accessor = valueNamed(primitive.at("indices"), file_, "accessors");
      indices = buffers_->elementsOf(*accessor, "SCALAR", 1);
      gltf::requireIndices(indices, *accessor);
      count = indices.count;
    }
    if (count < 3 || (mode == kTriangles && count % 3 != 0)) {
      primitive.refuse(fmt::format("{} corners", count), mode == kTriangles ? "a multiple of 3" : "at least 3");
    }
    const std::size_t triangles = mode == kTriangles ? count / 3 : count - 2;
    requireRoom(mesh_, 0, triangles, primitive.path());
    const auto corner = [&](std::size_t i) {
      const std::size_t index = accessor ? gltf::indexAt(indices, i) : i;
      if (index >= points.count) {
        accessor->refuse(fmt::format("{} in value {}", index, i),
                         fmt::format("less than {}, the number of points", points.count));
      }
      return static_cast<std::int32_t>(first + index);
    };
    const bool mirrored = scene_T_mesh.linear().determinant() < 0;
    for (std::size_t i = 0; i < triangles; ++i) {
      std::array<std::size_t, 3> at{3 * i, 3 * i + 1, 3 * i + 2};
      if (mode == kStrip) {
        at = {i, i + 1 + i % 2, i + 2 - i % 2};
      } else if (mode == kFan) {
        at = {i + 1, i + 2, 0};
      }
      if (mirrored) {
        std::swap(at[1], at[2]);
      }
      mesh_.triangles.push_back({corner(at[0]), corner(at[1]), corner(at[2])});
    }
  }

  void showMesh(const JsonValue& mesh, const Eigen::Affine3d& scene_T_mesh) {
    for (const JsonValue& primitive : mesh.at("primitives").list()) {
      if (++shown_ > kMostShown) {
        mesh.refuse("one too many", fmt::format("among at most {} shown", kMostShown));
      }
      throwIfStopped();
      showPrimitive(primitive, scene_T_mesh);
    }
  }

  static Eigen::Affine3d transformOf(const JsonValue& node) {
    if (node.has("matrix")) {
      const std::array<double, 16> columns = node.at("matrix").numbers<16>(kNumbers);
      Eigen::Affine3d transform;
      transform.matrix() = Eigen::Map<const Eigen::Matrix4d>(columns.data());
      if (transform.matrix().row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
        node.at("matrix").refuse("a projection", "a matrix with the last row 0 0 0 1");
      }
      return transform;
    }
    const auto [x, y, z] = numbersOr<3>(node, "translation", {0, 0, 0});
    const auto [qx, qy, qz, qw] = numbersOr<4>(node, "rotation", {0, 0, 0, 1});
    const auto [sx, sy, sz] = numbersOr<3>(node, "scale", {1, 1, 1});
    const Quat rotation(qw, qx, qy, qz);
    if (!isUnit(rotation)) {
      node.at("rotation").refuse(fmt::format("a quaternion of length {}", rotation.norm()), "a quaternion of length 1");
    }
    return Eigen::Translation3d(x, y, z) * rotation.normalized() * Eigen::Scaling(sx, sy, sz);
  }

  /// The nodes of the default scene; without scenes, those that are no other's child; without nodes, all meshes.
  void showScene() {
    if (!file_.has("nodes")) {
      if (file_.has("meshes")) {
        for (const JsonValue& mesh : file_.at("meshes").list()) {
          showMesh(mesh, Eigen::Affine3d::Identity());
        }
      }
      return;
    }
    const JsonValue nodes = file_.at("nodes");
    struct Waiting {
      std::size_t node;
      Eigen::Affine3d scene_T_parent;
    };
    std::vector<Waiting> waiting;
    if (file_.has("scenes")) {
      const JsonValue scene =
          file_.has("scene") ? valueNamed(file_.at("scene"), file_, "scenes") : file_.at("scenes").at(0);
      for (const std::size_t root : indicesAt(scene, "nodes")) {
        waiting.push_back({root, Eigen::Affine3d::Identity()});
      }
    } else {
      std::vector<bool> is_child(nodes.size());
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        for (const std::size_t child : indicesAt(nodes.at(i), "children")) {
          is_child[child] = true;
        }
      }
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (!is_child[i]) {
          waiting.push_back({i, Eigen::Affine3d::Identity()});
        }
      }
    }
    std::vector<bool> visited(nodes.size());
    while (!waiting.empty()) {
      const Waiting next = waiting.back();
      waiting.pop_back();
      const JsonValue node = nodes.at(next.node);
      if (visited[next.node]) {
        node.refuse("reached twice", "the child of one other node at most");
      }
      visited[next.node] = true;
      const Eigen::Affine3d scene_T_node = next.scene_T_parent * transformOf(node);
      if (node.has("mesh")) {
        has_skin_ = has_skin_ || node.has("skin");
        showMesh(valueNamed(node.at("mesh"), file_, "meshes"), scene_T_node);
      }
      for (const std::size_t child : indicesAt(node, "children")) {
        waiting.push_back({child, scene_T_node});
      }
    }
  }

  void noteLeftOut() {
    if (has_skin_) {
      notes_.emplace_back("bones (skins) are ignored: the mesh has its modelled shape");
    }
    if (has_morph_targets_) {
      notes_.emplace_back("morph targets are ignored: the mesh has its base shape");
    }
    if (has_lines_) {
      notes_.emplace_back("points and lines are ignored");
    }
  }

  /// Nodes that a list of `value` names; none without the list.
  [[nodiscard]] std::vector<std::size_t> indicesAt(const JsonValue& value, const char* list) const {
    std::vector<std::size_t> indices;
    if (value.has(list)) {
      for (const JsonValue& index : value.at(list).list()) {
        indices.push_back(indexNamed(index, file_, "nodes"));
      }
    }
    return indices;
  }

  JsonValue file_;
  std::optional<std::string_view> binary_;
  std::optional<gltf::Buffers> buffers_;
  MeshNotes& notes_;
  TriangleMesh mesh_;
  int shown_ = 0;
  bool has_skin_ = false, has_morph_targets_ = false, has_lines_ = false;
};

/// The name that a URI has escaped ("my%20tool.bin"). @throws InvalidParameter for one that leads out of the folder.
std::filesystem::path fileNamedBy(const JsonValue& uri) {
  const std::string& text = uri.text();
  std::string name;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned byte = 0;
    const char* const digits = text.data() + i + 1;
    if (text[i] == '%' && text.size() - i > 2 && std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2) {
      name += static_cast<char>(byte);
      i += 2;
    } else {
      name += text[i];
    }
  }
  std::filesystem::path path = name;
  const bool leads_out = std::ranges::any_of(path, [](const auto& part) { return part == ".."; });
  const bool has_scheme = text.find(':') != std::string::npos;
  if (name.empty() || path.has_root_path() || leads_out || has_scheme || name.find('\0') != std::string::npos) {
    uri.refuse(uri.given(), "the name of a file in the folder of this file, or below it");
  }
  return path;
}

}  // namespace

TriangleMesh parseGltf(std::string_view bytes, const std::string& name, MeshNotes& notes) {
  const Chunks chunks = chunksOf(bytes, name, notes);
  return GltfReader(parseJson(chunks.json, name, "glTF 2.0", kJsonLimits), chunks.binary, notes).read();
}

std::string withBuffersInside(std::string bytes, const std::filesystem::path& path) {
  const bool is_text = meshFormat(path) == MeshFormat::kGltf && (bytes.size() < 4 || wordAt(bytes, 0) != kGlbMagic);
  if (!is_text) {
    return bytes;
  }
  const JsonValue file = parseJson(withoutByteOrderMark(bytes), path.filename().string(), "glTF 2.0", kJsonLimits);
  if (!file.has("buffers")) {
    return bytes;
  }
  nlohmann::json inside;  // a copy when the first is read
  std::uintmax_t left = kMostMeshBytes;
  const std::vector<JsonValue> buffers = file.at("buffers").list();
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    if (!buffers[i].has("uri") || buffers[i].at("uri").text().starts_with("data:")) {
      continue;
    }
    std::ifstream beside = openInput(path.parent_path() / fileNamedBy(buffers[i].at("uri")), left);
    const std::string content{std::istreambuf_iterator<char>(beside), {}};
    left -= std::min<std::uintmax_t>(left, content.size());
    if (inside.is_null()) {
      inside = file.json();
    }
    inside["buffers"][i]["uri"] = "data:application/octet-stream;base64," + base64(content);
  }
  return inside.is_null() ? bytes : inside.dump();
}

}  // namespace haptolith
