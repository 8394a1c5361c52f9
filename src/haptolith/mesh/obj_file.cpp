#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/mesh/mesh_formats.h"
#include "haptolith/mesh/polygon.h"

namespace haptolith {

namespace {

/// The point that "7", "7/1/3" or "-1//2" names.
std::int32_t pointOf(std::string_view word, std::size_t points, const MeshText& text) {
  const std::string_view digits = word.substr(0, word.find('/'));
  const auto known = static_cast<std::int64_t>(points);
  std::int64_t index = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
  const bool read = error == std::errc() && end == digits.data() + digits.size();
  if (!read || index == 0 || index > known || index < -known) {
    throw InvalidParameter(text.place("face"), inQuotes(word),
                           known == 0 ? "the number of a point; there are no points before it"
                                      : fmt::format("the number of a point before it: 1 to {}, or -{} to -1 counted "
                                                    "from the last",
                                                    known, known));
  }
  return static_cast<std::int32_t>(index > 0 ? index - 1 : known + index);
}

}  // namespace

TriangleMesh parseObj(std::string_view bytes, const std::string& name) {
  MeshText text(bytes, name);
  TriangleMesh mesh;
  PolygonCutter cutter;
  std::vector<std::int32_t> corners;
  std::vector<Vec3> places;
  std::vector<std::array<std::size_t, 3>> triangles;
  do {
    const std::string_view word = text.wordOfLine();
    if (word == "v") {
      requireRoom(mesh, 1, 0, text.place("v"));
      Vec3 point;
      for (double& coordinate : point) {
        coordinate = text.number(text.wordOfLine(), "v");
      }
      mesh.points_m.push_back(point);  // a weight or a colour may follow
    } else if (word == "f") {
      corners.clear();
      for (std::string_view corner = text.wordOfLine(); !corner.empty(); corner = text.wordOfLine()) {
        if (corner.starts_with('#')) {
          break;
        }
        corners.push_back(pointOf(corner, mesh.points_m.size(), text));
      }
      if (corners.size() < 3) {
        throw InvalidParameter(text.place("face"), fmt::format("{} points", corners.size()), "at least 3 points");
      }
      requireRoom(mesh, 0, corners.size() - 2, text.place("face"));
      places.clear();
      for (const std::int32_t corner : corners) {
        places.push_back(mesh.points_m[static_cast<std::size_t>(corner)]);
      }
      if (!cutter.cut(places, triangles)) {
        throw InvalidParameter(text.place("face"), fmt::format("{} points", corners.size()),
                               "fewer corners in faces with dents: export the mesh as triangles");
      }
      for (const auto& [a, b, c] : triangles) {
        mesh.triangles.push_back({corners[a], corners[b], corners[c]});
      }
    }
  } while (text.nextLine());
  return mesh;
}

}  // namespace haptolith
