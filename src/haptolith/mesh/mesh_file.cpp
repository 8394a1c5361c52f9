#include "haptolith/mesh/mesh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <utility>

#include "haptolith/core/files/input_file.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/core/stop_asked.h"
#include "haptolith/mesh/mesh_formats.h"

namespace haptolith {

namespace {

struct NamedUnit {
  std::string_view name;
  double unit_m;
};
/// In the order in which they are proposed.
constexpr std::array kUnits{NamedUnit{"1 mm", 1e-3}, NamedUnit{"1 m", 1}, NamedUnit{"1 cm", 1e-2},
                            NamedUnit{"1 inch", 0.0254}, NamedUnit{"1 um", 1e-6}};

std::string lengthText(double length_m) {
  return length_m < 1 ? fmt::format("{:.3g} mm", 1e3 * length_m) : fmt::format("{:.3g} m", length_m);
}

/// "; with a unit of 1 mm (0.001 m) it would be 50 mm": nothing when no unit helps.
std::string proposedUnit(double size_m, double unit_m, MeshFormat format) {
  for (const NamedUnit& other : kUnits) {
    const double then_m = size_m / unit_m * other.unit_m;
    if (kHandSize_m.contains(then_m) && other.unit_m != unit_m) {
      return format == MeshFormat::kGltf
                 ? fmt::format("; glTF is in metres: export a model in units of {} at a scale of {}", other.name,
                               other.unit_m)
                 : fmt::format("; with a unit of {} ({} m) it would be {}", other.name, other.unit_m,
                               lengthText(then_m));
    }
  }
  return "";
}

void requireHandSize(const TriangleMesh& mesh, const std::string& name, double unit_m, MeshFormat format) {
  const MeshCorners corners = cornersOf(mesh);
  const double size_m = corners.largestEdge();
  if (!kHandSize_m.contains(size_m)) {
    throw InvalidParameter(name + ": largest edge of the box around it", lengthText(size_m),
                           fmt::format("2 mm to 2 m{}", proposedUnit(size_m, unit_m, format)));
  }
  const double reach_m = corners.low_m.cwiseAbs().cwiseMax(corners.high_m.cwiseAbs()).maxCoeff();
  if (!kMeshReach_m.contains(reach_m)) {
    throw InvalidParameter(name + ": farthest coordinate", lengthText(reach_m),
                           fmt::format("at most {:g} m from the origin", kMeshReach_m.highest));
  }
}

}  // namespace

std::string_view withoutByteOrderMark(std::string_view bytes) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  return bytes.starts_with(kMark) ? bytes.substr(kMark.size()) : bytes;
}

MeshText::MeshText(std::string_view text, const std::string& name) : rest_(withoutByteOrderMark(text)), name_(name) {
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
    throw InvalidParameter(name, "text in UTF-16", "text in UTF-8 or ASCII: save it in this encoding");
  }
}

void MeshText::skipBlanks() {
  for (;;) {
    const std::size_t blanks = std::min(rest_.find_first_not_of(" \t\v\f"), rest_.size());
    rest_.remove_prefix(blanks);
    const bool joined = rest_.starts_with("\\\n") || rest_.starts_with("\\\r");
    if (!joined) {
      return;
    }
    rest_.remove_prefix(1);
    removeLineEnd();
  }
}

void MeshText::removeLineEnd() {
  rest_.remove_prefix(rest_.starts_with("\r\n") ? 2 : 1);
  ++line_;
}

std::string_view MeshText::wordOfLine() {
  skipBlanks();
  const std::size_t length = std::min(rest_.find_first_of(" \t\r\v\f\n"), rest_.size());
  const std::string_view word = rest_.substr(0, length);
  rest_.remove_prefix(length);
  return word;
}

std::string_view MeshText::word() {
  std::string_view found = wordOfLine();
  while (found.empty() && nextLine()) {
    found = wordOfLine();
  }
  return found;
}

bool MeshText::nextLine() {
  constexpr int kLinesBetweenLooks = 1 << 14;
  if (line_ % kLinesBetweenLooks == 0 && stopAsked()) {
    throw Failure("interrupted");
  }
  const std::size_t end = rest_.find_first_of("\r\n");
  if (end == std::string_view::npos) {
    rest_ = {};
    return false;
  }
  rest_.remove_prefix(end);
  removeLineEnd();
  return true;
}

std::string MeshText::place(std::string_view what) const {
  return fmt::format("{}:{}: {}", name_, line_, what);
}

double MeshText::number(std::string_view word, std::string_view what) const {
  double value = 0;
  const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool tiny = error == std::errc::result_out_of_range && digits.find_first_of("eE") != std::string_view::npos &&
                    digits.find('-', 1) != std::string_view::npos;
  if (end != digits.data() + digits.size() || (error != std::errc() && !tiny) || !std::isfinite(value)) {
    throw InvalidParameter(place(what), word.empty() ? "missing" : inQuotes(word), "a finite number");
  }
  return tiny ? 0 : value;
}

void requireRoom(const TriangleMesh& mesh, std::size_t points, std::size_t triangles, const std::string& place) {
  if (points > kMostMeshPoints - mesh.points_m.size() || triangles > kMostTriangles - mesh.triangles.size()) {
    throw InvalidParameter(
        place, "one too many",
        fmt::format("a mesh of at most {} triangles and {} points; simplify it", kMostTriangles, kMostMeshPoints));
  }
}

std::optional<MeshFormat> meshFormat(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".stl") {
    return MeshFormat::kStl;
  }
  if (ending == ".obj") {
    return MeshFormat::kObj;
  }
  return ending == ".glb" || ending == ".gltf" ? std::optional(MeshFormat::kGltf) : std::nullopt;
}

TriangleMesh parseMesh(std::string_view bytes, const std::string& name, MeshFormat format,
                       const MeshFileOptions& options, std::vector<std::string>* notes) {
  requireInRange("unit_m", options.unit_m, kMeshUnit_m);
  TriangleMesh mesh;
  MeshNotes found;
  double unit_m = options.unit_m;
  switch (format) {
    case MeshFormat::kStl: mesh = parseStl(bytes, name, found); break;
    case MeshFormat::kObj: mesh = parseObj(bytes, name); break;
    case MeshFormat::kGltf:
      mesh = parseGltf(bytes, name, found);
      unit_m = 1;
      break;
  }
  if (mesh.triangles.empty()) {
    throw InvalidParameter(name, "without a triangle", "a mesh of triangles");
  }
  // Points that no triangle has say nothing about its size.
  TriangleMesh used;
  std::vector<std::int32_t> place(mesh.points_m.size(), -1);
  for (std::array<std::int32_t, 3>& triangle : mesh.triangles) {
    for (std::int32_t& point : triangle) {
      std::int32_t& now = place[static_cast<std::size_t>(point)];
      if (now < 0) {
        now = static_cast<std::int32_t>(used.points_m.size());
        used.points_m.emplace_back(mesh.points_m[static_cast<std::size_t>(point)] * unit_m);
      }
      point = now;
    }
  }
  used.triangles = std::move(mesh.triangles);
  requireHandSize(used, name, unit_m, format);
  if (notes != nullptr) {
    *notes = std::move(found);
  }
  return used;
}

TriangleMesh readMesh(const std::filesystem::path& path, const MeshFileOptions& options) {
  const std::optional<MeshFormat> format = meshFormat(path);
  if (!format) {
    throw InvalidParameter(path.string(), inQuotes(path.extension().string()),
                           "a file whose name ends in .stl, .obj, .glb or .gltf");
  }
  std::ifstream file = openInput(path, kMostMeshBytes);
  std::error_code unknown;
  const std::uintmax_t size = std::min(std::filesystem::file_size(path, unknown), kMostMeshBytes);
  std::string bytes(unknown ? 0 : size, '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (file.bad() || static_cast<std::size_t>(file.gcount()) != bytes.size()) {
    throw Failure(fmt::format("cannot read {}: the file changed while it was read", path.string()));
  }
  return parseMesh(withBuffersInside(std::move(bytes), path), path.string(), *format, options);
}

}  // namespace haptolith
