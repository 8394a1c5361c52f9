#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cstdint>
#include <cstring>

#include "haptolith/core/error.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/core/stop_asked.h"
#include "haptolith/mesh/mesh_file.h"
#include "haptolith/mesh/mesh_formats.h"

namespace haptolith {

namespace {

static_assert(std::endian::native == std::endian::little, "binary STL is little-endian");

constexpr std::size_t kHeaderBytes = 80;
constexpr std::size_t kCountBytes = 4;
constexpr std::size_t kFacetBytes = 50;  ///< normal, three corners, a number of no meaning

bool is(std::string_view word, std::string_view lower_case) {
  return std::ranges::equal(word, lower_case,
                            [](unsigned char given, char wanted) { return std::tolower(given) == wanted; });
}

/// The number of triangles that a binary file says it has.
std::uint32_t countOf(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + kHeaderBytes, kCountBytes);
  return count;
}

/// The size that a binary file says it has.
std::uint64_t sizeOf(std::string_view bytes) {
  return kHeaderBytes + kCountBytes + std::uint64_t{kFacetBytes} * countOf(bytes);
}

bool isBinaryOfItsCount(std::string_view bytes) {
  return bytes.size() >= kHeaderBytes + kCountBytes && bytes.size() == sizeOf(bytes);
}

/// Many binary files also begin with "solid": the size decides, and text has no zero bytes.
bool isText(std::string_view bytes) {
  constexpr std::size_t kEnough = 4096;
  const std::string_view start = withoutByteOrderMark(bytes).substr(0, kEnough);
  const std::size_t blanks = std::min(start.find_first_not_of(" \t\r\n"), start.size());
  using namespace std::string_view_literals;
  if (bytes.starts_with("\xFF\xFEs\0"sv) || bytes.starts_with("\xFE\xFF\0s"sv)) {
    return true;  // in UTF-16, which MeshText refuses
  }
  return !isBinaryOfItsCount(bytes) && is(start.substr(blanks, 5), "solid") &&
         start.find('\0') == std::string_view::npos;
}

/// Text without what some programs and disks put behind its end: zeros, and the end mark of DOS.
std::string_view withoutPadding(std::string_view text) {
  constexpr std::string_view kPadding("\0\x1A", 2);
  return text.substr(0, text.find_last_not_of(kPadding) + 1);
}

TriangleMesh parseBinary(std::string_view bytes, const std::string& name, MeshNotes& notes) {
  if (bytes.size() < kHeaderBytes + kCountBytes) {
    throw InvalidParameter(name, fmt::format("{} bytes", bytes.size()),
                           "an STL file: text that begins with 'solid', or at least 84 bytes");
  }
  const std::uint32_t count = countOf(bytes);
  if (bytes.size() < sizeOf(bytes)) {
    throw InvalidParameter(
        name, fmt::format("{} bytes", bytes.size()),
        fmt::format("the {} bytes of the {} triangles that its header states (is the binary STL file truncated?)",
                    sizeOf(bytes), count));
  }
  if (bytes.size() > sizeOf(bytes)) {
    notes.push_back(fmt::format("{} bytes after the {} triangles that its header states are ignored",
                                bytes.size() - sizeOf(bytes), count));
  }
  TriangleMesh mesh;
  requireRoom(mesh, std::size_t{3} * count, count, fmt::format("{}: triangle {}", name, count));
  mesh.points_m.reserve(std::size_t{3} * count);
  mesh.triangles.reserve(count);
  const char* facet = bytes.data() + kHeaderBytes + kCountBytes;
  for (std::uint32_t i = 0; i < count; ++i, facet += kFacetBytes) {
    std::array<float, 12> numbers{};
    std::memcpy(numbers.data(), facet, sizeof numbers);
    for (std::size_t corner = 1; corner <= 3; ++corner) {
      const Vec3 point(numbers[3 * corner], numbers[3 * corner + 1], numbers[3 * corner + 2]);
      if (!point.allFinite()) {
        throw InvalidParameter(fmt::format("{}: triangle {}: corner {}", name, i + 1, corner),
                               fmt::format("{} {} {}", point.x(), point.y(), point.z()), "three finite numbers");
      }
      mesh.points_m.push_back(point);
    }
    const auto first = static_cast<std::int32_t>(3 * i);
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

TriangleMesh parseText(std::string_view bytes, const std::string& name) {
  MeshText text(bytes, name);
  TriangleMesh mesh;
  const auto expect = [&](std::string_view wanted) {
    const std::string_view given = text.word();
    if (!is(given, wanted)) {
      throw InvalidParameter(text.place("word"), given.empty() ? "missing" : inQuotes(given),
                             fmt::format("'{}'", wanted));
    }
  };
  bool in_solid = false;
  for (std::string_view word = text.word(); !word.empty(); word = text.word()) {
    if (is(word, in_solid ? "endsolid" : "solid")) {
      in_solid = !in_solid;
      if (!text.nextLine()) {  // the rest is a name: any text
        break;
      }
      continue;
    }
    if (!in_solid || !is(word, "facet")) {
      throw InvalidParameter(text.place("word"), inQuotes(word), in_solid ? "'facet' or 'endsolid'" : "'solid'");
    }
    requireRoom(mesh, 3, 1, text.place("facet"));
    expect("normal");
    for (int axis = 0; axis < 3; ++axis) {
      (void)text.word();  // the corners give it more accurately, and some programs write NaN
    }
    expect("outer");
    expect("loop");
    const auto first = static_cast<std::int32_t>(mesh.points_m.size());
    for (int corner = 0; corner < 3; ++corner) {
      expect("vertex");
      Vec3 point;
      for (double& coordinate : point) {
        coordinate = text.number(text.word(), "vertex");
      }
      mesh.points_m.push_back(point);
    }
    expect("endloop");
    expect("endfacet");
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  if (in_solid) {
    throw InvalidParameter(text.place("end of the file"), "within a solid",
                           "after 'endsolid' (is the file truncated?)");
  }
  return mesh;
}

}  // namespace

TriangleMesh parseStl(std::string_view bytes, const std::string& name, MeshNotes& notes) {
  const std::string_view text = withoutPadding(bytes);
  return isText(text) ? parseText(text, name) : parseBinary(bytes, name, notes);
}

}  // namespace haptolith
