#include <Eigen/LU>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "haptolith/core/base64.h"
#include "haptolith/core/error.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/core/stop_asked.h"
#include "haptolith/mesh/mesh_file.h"
#include "haptolith/mesh/mesh_formats.h"

// glTF 2.0: https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html

namespace haptolith {

namespace {

using Json = nlohmann::json;

static_assert(std::endian::native == std::endian::little, "glTF is little-endian");

constexpr int kDeepestJson = 32;
constexpr std::size_t kMostJsonValues = 1'000'000;
/// Meshes that nodes show, counted as often as they are shown.
constexpr int kMostShown = 100'000;

constexpr std::uint32_t kGlbMagic = 0x46546C67;   // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t kBinChunk = 0x004E4942;   // "BIN\0"

/// Numbers of the format.
enum ComponentType : std::uint64_t { kByte = 5121, kShort = 5123, kInt = 5125, kFloat = 5126 };
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

Chunks chunksOf(std::string_view bytes, const std::string& name) {
  constexpr std::size_t kHeader = 12;
  constexpr std::size_t kChunkHeader = 8;
  if (bytes.size() < kHeader || wordAt(bytes, 0) != kGlbMagic) {
    return {bytes, std::nullopt};  // .gltf
  }
  if (wordAt(bytes, 4) != 2) {
    throw InvalidParameter(name + ": version", fmt::format("{}", wordAt(bytes, 4)), "2 (glTF 2.0)");
  }
  if (wordAt(bytes, 8) != bytes.size()) {
    throw InvalidParameter(name, fmt::format("{} bytes", bytes.size()),
                           fmt::format("the {} bytes that it says it has (was it cut off?)", wordAt(bytes, 8)));
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

Json jsonOf(std::string_view text, const std::string& name) {
  std::size_t values = 0;
  const auto bounded = [&](int depth, Json::parse_event_t event, Json& /*parsed*/) {
    values += event != Json::parse_event_t::array_end && event != Json::parse_event_t::object_end ? 1 : 0;
    if (depth > kDeepestJson || values > kMostJsonValues) {
      throw InvalidParameter(name, depth > kDeepestJson ? "too many brackets" : "too many values",
                             fmt::format("JSON of at most {} values, {} brackets deep", kMostJsonValues, kDeepestJson));
    }
    return true;
  };
  try {
    Json json = Json::parse(text, bounded);
    if (json.is_object()) {
      return json;
    }
  } catch (const Json::parse_error& error) {
    throw InvalidParameter(fmt::format("{}: JSON at byte {}", name, error.byte), "not readable", "glTF 2.0");
  }
  throw InvalidParameter(name, "JSON without an object", "glTF 2.0");
}

/// A value of the file's JSON that knows where it stands: "hand.glb: meshes[2].primitives[0]".
class Value {
 public:
  Value(const Json& json, std::string place) : json_(&json), place_(std::move(place)) {}

  [[nodiscard]] const std::string& place() const { return place_; }
  [[nodiscard]] bool has(const char* key) const { return json_->is_object() && json_->contains(key); }
  [[nodiscard]] std::size_t size() const { return json_->size(); }

  /// @throws InvalidParameter when it is missing.
  [[nodiscard]] Value at(const char* key) const {
    if (!has(key)) {
      refuse("missing", fmt::format("with '{}'", key));
    }
    return {(*json_)[key], fmt::format("{}{}{}", place_, place_.ends_with(':') ? " " : ".", key)};
  }
  /// Of a list.
  [[nodiscard]] Value at(std::uint64_t index) const {
    requireList();
    if (index >= json_->size()) {
      refuse(fmt::format("without {}", index), fmt::format("a list of more than {} values", index));
    }
    return {(*json_)[index], fmt::format("{}[{}]", place_, index)};
  }
  /// The value of a list of the file that this number names, such as the mesh of a node.
  [[nodiscard]] Value namedIn(const Value& file, const char* list) const {
    const std::uint64_t index = integer(std::numeric_limits<std::int32_t>::max());
    const std::size_t length = file.has(list) && (*file.json_)[list].is_array() ? (*file.json_)[list].size() : 0;
    if (index >= length) {
      refuse(fmt::format("{}", index), fmt::format("less than {}, the number of {}", length, list));
    }
    return file.at(list).at(index);
  }
  void requireList() const {
    if (!json_->is_array()) {
      refuse("no list", "a list");
    }
  }
  [[nodiscard]] std::uint64_t integer(std::uint64_t most) const {
    if (!json_->is_number_unsigned() || json_->get<std::uint64_t>() > most) {
      refuse(json_->is_number() ? json_->dump() : "no number", fmt::format("a whole number from 0 to {}", most));
    }
    return json_->get<std::uint64_t>();
  }
  [[nodiscard]] std::uint64_t integerOr(const char* key, std::uint64_t otherwise) const {
    return has(key) ? at(key).integer(kMostMeshBytes) : otherwise;
  }
  [[nodiscard]] double number() const {
    constexpr double kMost = 1e9;
    if (!json_->is_number() || !(std::abs(json_->get<double>()) <= kMost)) {
      refuse(json_->is_number() ? json_->dump() : "no number",
             fmt::format("a number from -{:g} to {:g}", kMost, kMost));
    }
    return json_->get<double>();
  }
  [[nodiscard]] const std::string& text() const {
    if (!json_->is_string()) {
      refuse("no text", "text");
    }
    return json_->get_ref<const std::string&>();
  }
  template <std::size_t kCount>
  [[nodiscard]] std::array<double, kCount> numbersOr(const char* key, std::array<double, kCount> numbers) const {
    if (has(key)) {
      const Value list = at(key);
      list.requireList();
      if (list.size() != kCount) {
        list.refuse(fmt::format("{} values", list.size()), fmt::format("{} numbers", kCount));
      }
      for (std::size_t i = 0; i < kCount; ++i) {
        numbers[i] = list.at(i).number();
      }
    }
    return numbers;
  }

  [[noreturn]] void refuse(const std::string& given, const std::string& valid) const {
    throw InvalidParameter(place_, given, valid);
  }

 private:
  const Json* json_;
  std::string place_;
};

/// Bytes of a data URI. @throws InvalidParameter for anything else: a mesh names no other files.
std::string embedded(const Value& uri) {
  const std::string& text = uri.text();
  const std::size_t comma = text.find(',');
  const std::string_view head = std::string_view(text).substr(0, comma);
  if (!head.starts_with("data:")) {
    uri.refuse(inQuotes(text), "data within the file: no other file is read (export it as .glb, or as 'embedded')");
  }
  if (comma == std::string::npos || !head.ends_with(";base64")) {
    uri.refuse(inQuotes(text), "'data:...;base64,' and the data");
  }
  std::optional<std::string> bytes = fromBase64(std::string_view(text).substr(comma + 1));
  if (!bytes) {
    uri.refuse("data that is no base64", "whole and in letters of base64");
  }
  return *std::move(bytes);
}

/// Elements of a buffer as an accessor names them: all of them lie in it.
struct Elements {
  const char* first;
  std::size_t stride_bytes;
  std::size_t count;
  std::uint64_t component;
};

class GltfReader {
 public:
  GltfReader(const Json& json, std::optional<std::string_view> binary, const std::string& name)
      : file_(json, name + ":"), binary_(binary) {}

  TriangleMesh read() {
    requireKnown();
    loadBuffers();
    showScene();
    return std::move(mesh_);
  }

 private:
  void requireKnown() const {
    const std::string& version = file_.at("asset").at("version").text();
    if (!version.starts_with("2.")) {
      file_.at("asset").at("version").refuse(inQuotes(version), "2.0");
    }
    if (file_.has("extensionsRequired")) {
      const Value list = file_.at("extensionsRequired");
      list.requireList();
      for (std::size_t i = 0; i < list.size(); ++i) {
        const std::string& extension = list.at(i).text();
        if (!extension.starts_with("KHR_materials_") && !extension.starts_with("KHR_texture_")) {
          list.at(i).refuse(inQuotes(extension), "nothing that changes the shape: export without compression");
        }
      }
    }
  }

  void loadBuffers() {
    if (!file_.has("buffers")) {
      return;
    }
    const Value list = file_.at("buffers");
    list.requireList();
    own_.reserve(list.size());
    for (std::size_t i = 0; i < list.size(); ++i) {
      const Value buffer = list.at(i);
      std::string_view bytes;
      if (buffer.has("uri")) {
        bytes = own_.emplace_back(embedded(buffer.at("uri")));
      } else if (i == 0 && binary_) {
        bytes = *binary_;
      } else {
        buffer.refuse("without data", "with data: 'uri', or the binary part of a .glb");
      }
      const std::uint64_t length = buffer.at("byteLength").integer(kMostMeshBytes);
      if (length > bytes.size()) {
        buffer.refuse(fmt::format("{} bytes", bytes.size()), fmt::format("as long as it says: {} bytes", length));
      }
      buffers_.push_back(bytes.substr(0, length));
    }
  }

  [[nodiscard]] Elements elementsOf(const Value& accessor, const char* type, std::size_t components) const {
    if (accessor.has("sparse") || !accessor.has("bufferView")) {
      accessor.refuse("sparse", "with all its values in a buffer");
    }
    if (accessor.at("type").text() != type) {
      accessor.at("type").refuse(inQuotes(accessor.at("type").text()), fmt::format("'{}'", type));
    }
    const std::uint64_t component = accessor.at("componentType").integer(kFloat);
    const std::size_t component_bytes = component == kByte ? 1 : component == kShort ? 2 : 4;
    const std::size_t element_bytes = component_bytes * components;
    const Value view = accessor.at("bufferView").namedIn(file_, "bufferViews");
    const Value buffer = view.at("buffer").namedIn(file_, "buffers");
    (void)buffer;
    const std::string_view bytes = buffers_[view.at("buffer").integer(buffers_.size())];
    const std::uint64_t view_offset = view.integerOr("byteOffset", 0);
    const std::uint64_t view_length = view.at("byteLength").integer(kMostMeshBytes);
    if (view_offset + view_length > bytes.size()) {
      view.refuse(fmt::format("bytes {} to {}", view_offset, view_offset + view_length),
                  fmt::format("within its buffer of {} bytes", bytes.size()));
    }
    const std::uint64_t offset = accessor.integerOr("byteOffset", 0);
    const std::uint64_t stride = view.integerOr("byteStride", element_bytes);
    const std::uint64_t count = accessor.at("count").integer(kMostMeshPoints);
    if (count == 0 || stride < element_bytes ||
        offset + stride * (count - 1) + element_bytes > view_length) {  // each below 2^28: no overflow
      accessor.refuse(
          fmt::format("{} values of {} bytes, {} apart, from byte {}", count, element_bytes, stride, offset),
          fmt::format("at least one, within a view of {} bytes", view_length));
    }
    return {bytes.data() + view_offset + offset, stride, count, component};
  }

  /// Index of the element's point in the primitive.
  static std::uint32_t indexAt(const Elements& indices, std::size_t i) {
    const char* place = indices.first + i * indices.stride_bytes;
    std::uint32_t index = 0;  // the low bytes come first
    std::memcpy(&index, place, indices.component == kByte ? 1 : indices.component == kShort ? 2 : 4);
    return index;
  }

  void showPrimitive(const Value& primitive, const Eigen::Affine3d& scene_T_mesh) {
    const std::uint64_t mode = primitive.integerOr("mode", kTriangles);
    if (mode < kTriangles) {
      return;  // points and lines
    }
    if (mode > kFan) {
      primitive.at("mode").refuse(fmt::format("{}", mode), "0 to 6");
    }
    const Value position = primitive.at("attributes").at("POSITION").namedIn(file_, "accessors");
    const Elements points = elementsOf(position, "VEC3", 3);
    if (points.component != kFloat) {
      position.at("componentType").refuse(fmt::format("{}", points.component), "5126 (floats)");
    }
    requireRoom(mesh_, points.count, 0, primitive.place());
    const std::size_t first = mesh_.points_m.size();
    for (std::size_t i = 0; i < points.count; ++i) {
      std::array<float, 3> coordinates{};
      std::memcpy(coordinates.data(), points.first + i * points.stride_bytes, sizeof coordinates);
      const Vec3 point_m = scene_T_mesh * Vec3(coordinates[0], coordinates[1], coordinates[2]);
      if (!point_m.allFinite()) {
        position.refuse(fmt::format("no finite number in value {}", i), "finite numbers");
      }
      mesh_.points_m.emplace_back(point_m.x(), -point_m.z(), point_m.y());  // y up becomes z up
    }
    std::optional<Value> accessor;
    Elements indices{};
    std::size_t count = points.count;
    if (primitive.has("indices")) {
      accessor = primitive.at("indices").namedIn(file_, "accessors");
      indices = elementsOf(*accessor, "SCALAR", 1);
      if (indices.component != kByte && indices.component != kShort && indices.component != kInt) {
        accessor->at("componentType")
            .refuse(fmt::format("{}", indices.component), "5121, 5123 or 5125 (whole numbers)");
      }
      count = indices.count;
    }
    if (count < 3 || (mode == kTriangles && count % 3 != 0)) {
      primitive.refuse(fmt::format("{} corners", count), mode == kTriangles ? "a multiple of 3" : "at least 3");
    }
    const std::size_t triangles = mode == kTriangles ? count / 3 : count - 2;
    requireRoom(mesh_, 0, triangles, primitive.place());
    const auto corner = [&](std::size_t i) {
      const std::size_t index = accessor ? indexAt(indices, i) : i;
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

  void showMesh(const Value& mesh, const Eigen::Affine3d& scene_T_mesh) {
    const Value primitives = mesh.at("primitives");
    primitives.requireList();
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      if (++shown_ > kMostShown) {
        mesh.refuse("one too many", fmt::format("among at most {} shown", kMostShown));
      }
      if (stopAsked()) {
        throw Failure("interrupted");
      }
      showPrimitive(primitives.at(i), scene_T_mesh);
    }
  }

  static Eigen::Affine3d transformOf(const Value& node) {
    if (node.has("matrix")) {
      const std::array<double, 16> columns = node.numbersOr<16>("matrix", {});
      Eigen::Affine3d transform;
      transform.matrix() = Eigen::Map<const Eigen::Matrix4d>(columns.data());
      if (transform.matrix().row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
        node.at("matrix").refuse("a projection", "of a last row of 0 0 0 1");
      }
      return transform;
    }
    const auto [x, y, z] = node.numbersOr<3>("translation", {0, 0, 0});
    const auto [qx, qy, qz, qw] = node.numbersOr<4>("rotation", {0, 0, 0, 1});
    const auto [sx, sy, sz] = node.numbersOr<3>("scale", {1, 1, 1});
    const Quat rotation(qw, qx, qy, qz);
    if (!isUnit(rotation)) {
      node.at("rotation").refuse(fmt::format("of length {}", rotation.norm()), "of length 1");
    }
    return Eigen::Translation3d(x, y, z) * rotation.normalized() * Eigen::Scaling(sx, sy, sz);
  }

  /// The nodes of the default scene; without scenes, those that are no other's child; without nodes, all meshes.
  void showScene() {
    if (!file_.has("nodes")) {
      if (file_.has("meshes")) {
        const Value meshes = file_.at("meshes");
        meshes.requireList();
        for (std::size_t i = 0; i < meshes.size(); ++i) {
          showMesh(meshes.at(i), Eigen::Affine3d::Identity());
        }
      }
      return;
    }
    const Value nodes = file_.at("nodes");
    nodes.requireList();
    struct Waiting {
      std::uint64_t node;
      Eigen::Affine3d scene_T_parent;
    };
    std::vector<Waiting> waiting;
    if (file_.has("scenes")) {
      const Value scenes = file_.at("scenes");
      const Value scene = file_.has("scene") ? file_.at("scene").namedIn(file_, "scenes") : scenes.at(std::uint64_t{0});
      if (scene.has("nodes")) {
        const Value roots = scene.at("nodes");
        roots.requireList();
        for (std::size_t i = 0; i < roots.size(); ++i) {
          (void)roots.at(i).namedIn(file_, "nodes");
          waiting.push_back({roots.at(i).integer(nodes.size()), Eigen::Affine3d::Identity()});
        }
      }
    } else {
      std::vector<bool> is_child(nodes.size());
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        for (const std::uint64_t child : childrenOf(nodes.at(i))) {
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
      const Value node = nodes.at(next.node);
      if (visited[next.node]) {
        node.refuse("reached twice", "the child of one other node at most");
      }
      visited[next.node] = true;
      const Eigen::Affine3d scene_T_node = next.scene_T_parent * transformOf(node);
      if (node.has("mesh")) {
        showMesh(node.at("mesh").namedIn(file_, "meshes"), scene_T_node);
      }
      for (const std::uint64_t child : childrenOf(node)) {
        waiting.push_back({child, scene_T_node});
      }
    }
  }

  [[nodiscard]] std::vector<std::uint64_t> childrenOf(const Value& node) const {
    std::vector<std::uint64_t> children;
    if (node.has("children")) {
      const Value list = node.at("children");
      list.requireList();
      for (std::size_t i = 0; i < list.size(); ++i) {
        (void)list.at(i).namedIn(file_, "nodes");
        children.push_back(list.at(i).integer(kMostJsonValues));
      }
    }
    return children;
  }

  Value file_;
  std::optional<std::string_view> binary_;
  std::vector<std::string> own_;
  std::vector<std::string_view> buffers_;
  TriangleMesh mesh_;
  int shown_ = 0;
};

}  // namespace

TriangleMesh parseGltf(std::string_view bytes, const std::string& name) {
  const Chunks chunks = chunksOf(bytes, name);
  const Json json = jsonOf(chunks.json, name);
  return GltfReader(json, chunks.binary, name).read();
}

}  // namespace haptolith
