#include "haptolith/mesh/gltf_accessor.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <utility>

#include "haptolith/core/base64.h"
#include "haptolith/mesh/mesh_file.h"
#include "haptolith/mesh/mesh_formats.h"

namespace haptolith::gltf {

namespace {

static_assert(std::endian::native == std::endian::little, "glTF is little-endian");

/// Bytes of a data URI. @throws InvalidParameter for anything else; see withBuffersInside().
std::string embedded(const JsonValue& uri) {
  const std::string& text = uri.text();
  const std::size_t comma = text.find(',');
  const std::string_view head = std::string_view(text).substr(0, comma);
  if (!head.starts_with("data:")) {
    uri.refuse(uri.given(), "data inside the file: other files are not read (export as .glb, or as 'embedded')");
  }
  if (comma == std::string::npos || !head.ends_with(";base64")) {
    uri.refuse(uri.given(), "'data:...;base64,' and the data");
  }
  std::optional<std::string> bytes = fromBase64(std::string_view(text).substr(comma + 1));
  if (!bytes) {
    uri.refuse("data that is not base64", "complete base64 data");
  }
  return *std::move(bytes);
}

}  // namespace

std::size_t bytesOf(std::uint64_t component) {
  return component == kByte || component == kSignedByte ? 1 : component == kShort || component == kSignedShort ? 2 : 4;
}

std::size_t indexNamed(const JsonValue& index, const JsonValue& file, const char* list) {
  const std::size_t length = file.has(list) ? file.at(list).size() : 0;
  const std::uint64_t named = index.whole(std::numeric_limits<std::int32_t>::max());
  if (named >= length) {
    index.refuse(index.given(), fmt::format("less than {}, the number of {}", length, list));
  }
  return named;
}

JsonValue valueNamed(const JsonValue& index, const JsonValue& file, const char* list) {
  return file.at(list).at(indexNamed(index, file, list));
}

std::uint64_t wholeOr(const JsonValue& value, const char* key, std::uint64_t otherwise) {
  return value.has(key) ? value.at(key).whole(kMostMeshBytes) : otherwise;
}

double Elements::number(std::size_t element, std::size_t place) const {
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

Buffers::Buffers(JsonValue file, std::optional<std::string_view> binary) : file_(std::move(file)) {
  if (!file_.has("buffers")) {
    return;
  }
  const std::vector<JsonValue> list = file_.at("buffers").list();
  own_.reserve(list.size());
  for (const JsonValue& buffer : list) {
    std::string_view bytes;
    if (buffer.has("uri")) {
      bytes = own_.emplace_back(embedded(buffer.at("uri")));
    } else if (buffers_.empty() && binary) {
      bytes = *binary;
    } else {
      buffer.refuse("without data", "with data: 'uri', or the binary part of a .glb");
    }
    const std::uint64_t length = buffer.at("byteLength").whole(kMostMeshBytes);
    if (length > bytes.size()) {
      buffer.refuse(fmt::format("{} bytes", bytes.size()), fmt::format("as long as stated: {} bytes", length));
    }
    buffers_.push_back(bytes.substr(0, length));
  }
}

Buffers::View Buffers::viewOf(const JsonValue& named, std::uint64_t element_bytes) const {
  const JsonValue view = valueNamed(named, file_, "bufferViews");
  const std::string_view bytes = buffers_[indexNamed(view.at("buffer"), file_, "buffers")];
  const std::uint64_t view_offset = wholeOr(view, "byteOffset", 0);
  const std::uint64_t view_length = view.at("byteLength").whole(kMostMeshBytes);
  if (view_offset + view_length > bytes.size()) {
    view.refuse(fmt::format("bytes {} to {}", view_offset, view_offset + view_length),
                fmt::format("within its buffer of {} bytes", bytes.size()));
  }
  return {bytes.substr(view_offset, view_length), wholeOr(view, "byteStride", element_bytes)};
}

/// `count` elements of a view. @param place  what names the view, for messages.
Elements Buffers::elementsIn(const JsonValue& place, std::uint64_t component, std::size_t components,
                             std::uint64_t count) const {
  const std::size_t element_bytes = bytesOf(component) * components;
  const auto [bytes, stride] = viewOf(place.at("bufferView"), element_bytes);
  const std::uint64_t offset = wholeOr(place, "byteOffset", 0);
  if (count == 0 || stride < element_bytes ||
      offset + stride * (count - 1) + element_bytes > bytes.size()) {  // each below 2^28: no overflow
    place.refuse(fmt::format("{} values of {} bytes, {} apart, from byte {}", count, element_bytes, stride, offset),
                 fmt::format("at least one, within a view of {} bytes", bytes.size()));
  }
  return {.first = bytes.data() + offset, .stride_bytes = stride, .count = count, .component = component};
}

Elements Buffers::elementsOf(const JsonValue& accessor, const char* type, std::size_t components) const {
  if (accessor.at("type").text() != type) {
    accessor.at("type").refuse(accessor.at("type").given(), fmt::format("'{}'", type));
  }
  const std::uint64_t component = accessor.at("componentType").whole(kFloat);
  const std::uint64_t count = accessor.at("count").whole(kMostMeshPoints);
  Elements elements{.component = component};
  if (accessor.has("bufferView")) {
    elements = elementsIn(accessor, component, components, count);
  } else if (!accessor.has("sparse")) {
    accessor.refuse("without values", "with 'bufferView' or 'sparse'");
  }
  if (accessor.has("sparse")) {
    replaceSome(elements, accessor.at("sparse"), components, count);
  }
  elements.normalised = accessor.has("normalized") && accessor.at("normalized").flag();
  return elements;
}

/// Values of a sparse accessor: those of its view, or zeros, and others at some places (glTF 2.0, 3.6.2.3).
void Buffers::replaceSome(Elements& elements, const JsonValue& sparse, std::size_t components,
                          std::uint64_t count) const {
  const std::size_t element_bytes = bytesOf(elements.component) * components;
  std::vector<char> own(element_bytes * count);
  for (std::size_t i = 0; i < elements.count; ++i) {
    std::memcpy(own.data() + i * element_bytes, elements.first + i * elements.stride_bytes, element_bytes);
  }
  const std::uint64_t replaced = sparse.at("count").whole(count);
  const JsonValue places = sparse.at("indices");
  const Elements indices = elementsIn(places, places.at("componentType").whole(kFloat), 1, replaced);
  requireIndices(indices, places);
  const Elements values = elementsIn(sparse.at("values"), elements.component, components, replaced);
  for (std::size_t i = 0; i < replaced; ++i) {
    const std::uint32_t place = indexAt(indices, i);
    if (place >= count) {
      places.refuse(fmt::format("{} in value {}", place, i), fmt::format("less than {}, the number of values", count));
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

void requireIndices(const Elements& indices, const JsonValue& place) {
  if (indices.component != kByte && indices.component != kShort && indices.component != kInt) {
    place.at("componentType").refuse(fmt::format("{}", indices.component), "5121, 5123 or 5125 (whole numbers)");
  }
}

std::uint32_t indexAt(const Elements& indices, std::size_t i) {
  const char* place = indices.first + i * indices.stride_bytes;
  std::uint32_t index = 0;  // the low bytes come first
  std::memcpy(&index, place, bytesOf(indices.component));
  return index;
}

}  // namespace haptolith::gltf
