#include <Eigen/LU>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "haptolith/core/base64.h"
#include "haptolith/core/error.h"
#include "haptolith/core/files/input_file.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/core/process/stop_asked.h"
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
enum ComponentType : std::uint64_t {
  kSignedByte = 5120,
  kByte = 5121,
  kSignedShort = 5122,
  kShort = 5123,
  kInt = 5125,
  kFloat = 5126
};
std::size_t bytesOf(std::uint64_t component) {
  return component == kByte || component == kSignedByte ? 1 : component == kShort || component == kSignedShort ? 2 : 4;
}

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
                           fmt::format("the {} bytes that it says it has (was it cut off?)", said));
  }
  if (said < bytes.size()) {
    notes.push_back(fmt::format("{} bytes behind its end are left out", bytes.size() - said));
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
  [[nodiscard]] bool isTrue(const char* key) const { return has(key) && (*json_)[key] == true; }

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

/// Bytes of a data URI. @throws InvalidParameter for anything else; see withBuffersInside().
std::string embedded(const Value& uri) {
  const std::string& text = uri.text();
  const std::size_t comma = text.find(',');
  const std::string_view head = std::string_view(text).substr(0, comma);
  if (!head.starts_with("data:")) {
    uri.refuse(inQuotes(text),
               "data within the file: no other file is read here (export it as .glb, or as 'embedded')");
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
  const char* first = nullptr;
  std::size_t stride_bytes = 0;
  std::size_t count = 0;
  std::uint64_t component = kFloat;
  bool normalised = false;     ///< whole numbers stand for -1 to 1, or 0 to 1
  std::vector<char> own = {};  ///< where `first` is, of a sparse accessor

  /// A number as glTF 2.0, 3.11 and KHR_mesh_quantization have it.
  [[nodiscard]] double number(std::size_t element, std::size_t place) const {
    const char* at = first + element * stride_bytes + place * bytesOf(component);
    const auto read = [at](auto value) {
      std::memcpy(&value, at, sizeof value);
      return static_cast<double>(value);
    };
    const auto whole = [this](double value, double most) { return normalised ? std::max(value / most, -1.0) : value; };
    switch (component) {
      case kSignedByte: return whole(read(std::int8_t{}), 127);
      case kByte: return whole(read(std::uint8_t{}), 255);
      case kSignedShort: return whole(read(std::int16_t{}), 32767);
      case kShort: return whole(read(std::uint16_t{}), 65535);
      default: return read(float{});
    }
  }
};

class GltfReader {
 public:
  GltfReader(const Json& json, std::optional<std::string_view> binary, const std::string& name, MeshNotes& notes)
      : file_(json, name + ":"), binary_(binary), notes_(notes) {}

  TriangleMesh read() {
    requireKnown();
    loadBuffers();
    showScene();
    noteLeftOut();
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
        if (!isKnown(extension)) {
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

  /// Bytes of a view, and how far apart its elements are unless they follow each other.
  struct View {
    std::string_view bytes;
    std::uint64_t stride_bytes;
  };
  [[nodiscard]] View viewOf(const Value& named, std::uint64_t element_bytes) const {
    const Value view = named.namedIn(file_, "bufferViews");
    const Value buffer = view.at("buffer").namedIn(file_, "buffers");
    (void)buffer;
    const std::string_view bytes = buffers_[view.at("buffer").integer(buffers_.size())];
    const std::uint64_t view_offset = view.integerOr("byteOffset", 0);
    const std::uint64_t view_length = view.at("byteLength").integer(kMostMeshBytes);
    if (view_offset + view_length > bytes.size()) {
      view.refuse(fmt::format("bytes {} to {}", view_offset, view_offset + view_length),
                  fmt::format("within its buffer of {} bytes", bytes.size()));
    }
    return {bytes.substr(view_offset, view_length), view.integerOr("byteStride", element_bytes)};
  }

  /// `count` elements of a view. @param place  what names the view, for messages.
  [[nodiscard]] Elements elementsIn(const Value& place, std::uint64_t component, std::size_t components,
                                    std::uint64_t count) const {
    const std::size_t element_bytes = bytesOf(component) * components;
    const auto [bytes, stride] = viewOf(place.at("bufferView"), element_bytes);
    const std::uint64_t offset = place.integerOr("byteOffset", 0);
    if (count == 0 || stride < element_bytes ||
        offset + stride * (count - 1) + element_bytes > bytes.size()) {  // each below 2^28: no overflow
      place.refuse(fmt::format("{} values of {} bytes, {} apart, from byte {}", count, element_bytes, stride, offset),
                   fmt::format("at least one, within a view of {} bytes", bytes.size()));
    }
    return {.first = bytes.data() + offset, .stride_bytes = stride, .count = count, .component = component};
  }

  [[nodiscard]] Elements elementsOf(const Value& accessor, const char* type, std::size_t components) const {
    if (accessor.at("type").text() != type) {
      accessor.at("type").refuse(inQuotes(accessor.at("type").text()), fmt::format("'{}'", type));
    }
    const std::uint64_t component = accessor.at("componentType").integer(kFloat);
    const std::uint64_t count = accessor.at("count").integer(kMostMeshPoints);
    Elements elements{.component = component};
    if (accessor.has("bufferView")) {
      elements = elementsIn(accessor, component, components, count);
    } else if (!accessor.has("sparse")) {
      accessor.refuse("without values", "with 'bufferView' or 'sparse'");
    }
    if (accessor.has("sparse")) {
      replaceSome(elements, accessor.at("sparse"), components, count);
    }
    elements.normalised = accessor.isTrue("normalized");
    return elements;
  }

  /// Values of a sparse accessor: those of its view, or zeros, and others at some places (glTF 2.0, 3.6.2.3).
  void replaceSome(Elements& elements, const Value& sparse, std::size_t components, std::uint64_t count) const {
    const std::size_t element_bytes = bytesOf(elements.component) * components;
    std::vector<char> own(element_bytes * count);
    for (std::size_t i = 0; i < elements.count; ++i) {
      std::memcpy(own.data() + i * element_bytes, elements.first + i * elements.stride_bytes, element_bytes);
    }
    const std::uint64_t replaced = sparse.at("count").integer(count);
    const Value places = sparse.at("indices");
    const Elements indices = elementsIn(places, places.at("componentType").integer(kFloat), 1, replaced);
    requireIndices(indices, places);
    const Elements values = elementsIn(sparse.at("values"), elements.component, components, replaced);
    for (std::size_t i = 0; i < replaced; ++i) {
      const std::uint32_t place = indexAt(indices, i);
      if (place >= count) {
        places.refuse(fmt::format("{} in value {}", place, i),
                      fmt::format("less than {}, the number of values", count));
      }
      std::memcpy(own.data() + place * element_bytes, values.first + i * values.stride_bytes, element_bytes);
    }
    const char* const first = own.data();  // stays where it is when its vector moves
    elements = {.first = first,
                .stride_bytes = element_bytes,
                .count = count,
                .component = elements.component,
                .own = std::move(own)};
  }

  static void requireIndices(const Elements& indices, const Value& place) {
    if (indices.component != kByte && indices.component != kShort && indices.component != kInt) {
      place.at("componentType").refuse(fmt::format("{}", indices.component), "5121, 5123 or 5125 (whole numbers)");
    }
  }

  /// Index of the element's point in the primitive.
  static std::uint32_t indexAt(const Elements& indices, std::size_t i) {
    const char* place = indices.first + i * indices.stride_bytes;
    std::uint32_t index = 0;  // the low bytes come first
    std::memcpy(&index, place, bytesOf(indices.component));
    return index;
  }

  void showPrimitive(const Value& primitive, const Eigen::Affine3d& scene_T_mesh) {
    const std::uint64_t mode = primitive.integerOr("mode", kTriangles);
    if (mode < kTriangles) {
      has_lines_ = true;
      return;
    }
    if (mode > kFan) {
      primitive.at("mode").refuse(fmt::format("{}", mode), "0 to 6");
    }
    const Value position = primitive.at("attributes").at("POSITION").namedIn(file_, "accessors");
    const Elements points = elementsOf(position, "VEC3", 3);
    if (points.component != kFloat && bytesOf(points.component) == 4) {
      position.at("componentType")
          .refuse(fmt::format("{}", points.component), "5126 (floats), or 5120 to 5123 (KHR_mesh_quantization)");
    }
    has_morph_targets_ = has_morph_targets_ || primitive.has("targets");
    requireRoom(mesh_, points.count, 0, primitive.place());
    const std::size_t first = mesh_.points_m.size();
    for (std::size_t i = 0; i < points.count; ++i) {
      const Vec3 point_m = scene_T_mesh * Vec3(points.number(i, 0), points.number(i, 1), points.number(i, 2));
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
      requireIndices(indices, *accessor);
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
        has_skin_ = has_skin_ || node.has("skin");
        showMesh(node.at("mesh").namedIn(file_, "meshes"), scene_T_node);
      }
      for (const std::uint64_t child : childrenOf(node)) {
        waiting.push_back({child, scene_T_node});
      }
    }
  }

  void noteLeftOut() {
    if (has_skin_) {
      notes_.emplace_back("bones (skins) are left out: the mesh is as it was modelled, not as its skeleton holds it");
    }
    if (has_morph_targets_) {
      notes_.emplace_back("morph targets are left out: the mesh is as it is without them");
    }
    if (has_lines_) {
      notes_.emplace_back("points and lines are left out");
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
  MeshNotes& notes_;
  TriangleMesh mesh_;
  int shown_ = 0;
  bool has_skin_ = false, has_morph_targets_ = false, has_lines_ = false;
};

/// The name that a URI has escaped ("my%20tool.bin"). @throws InvalidParameter for one that leads out of the folder.
std::filesystem::path fileNamedBy(const Value& uri) {
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
  if (name.empty() || path.is_absolute() || leads_out || has_scheme || name.find('\0') != std::string::npos) {
    uri.refuse(inQuotes(text), "the name of a file in the folder of this one, or below it");
  }
  return path;
}

}  // namespace

TriangleMesh parseGltf(std::string_view bytes, const std::string& name, MeshNotes& notes) {
  const Chunks chunks = chunksOf(bytes, name, notes);
  const Json json = jsonOf(chunks.json, name);
  return GltfReader(json, chunks.binary, name, notes).read();
}

std::string withBuffersInside(std::string bytes, const std::filesystem::path& path) {
  const bool is_text = meshFormat(path) == MeshFormat::kGltf && (bytes.size() < 4 || wordAt(bytes, 0) != kGlbMagic);
  if (!is_text) {
    return bytes;
  }
  const std::string name = path.filename().string();
  Json json = jsonOf(withoutByteOrderMark(bytes), name);
  if (!json.contains("buffers") || !json["buffers"].is_array()) {
    return bytes;
  }
  bool changed = false;
  std::uintmax_t left = kMostMeshBytes;
  for (std::size_t i = 0; i < json["buffers"].size(); ++i) {
    const Value buffer = Value(json, name + ":").at("buffers").at(i);
    if (!buffer.has("uri") || buffer.at("uri").text().starts_with("data:")) {
      continue;
    }
    std::ifstream file = openInput(path.parent_path() / fileNamedBy(buffer.at("uri")), left);
    const std::string content{std::istreambuf_iterator<char>(file), {}};
    left -= std::min<std::uintmax_t>(left, content.size());
    json["buffers"][i]["uri"] = "data:application/octet-stream;base64," + base64(content);
    changed = true;
  }
  return changed ? json.dump() : bytes;
}

}  // namespace haptolith
