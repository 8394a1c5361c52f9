#include "haptolith/tool/tool_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <mutex>
#include <utility>

#include "haptolith/core/files/input_file.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/core/turn.h"
#include "haptolith/mesh/shown_surface.h"

namespace haptolith {

namespace {

/// Widths of distance fields, in m: equal for many soils, so that a soil can be changed without a wait.
constexpr std::array kBands_m{5e-3, 10e-3, 15e-3, 20e-3, kFieldBand_m.highest};

constexpr std::size_t kMostShownTriangles = 100'000;

double bandFor(double reach_m) {
  for (const double band_m : kBands_m) {
    if (reach_m + kFieldMargin_m <= band_m) {
      return band_m;
    }
  }
  throw InvalidParameter("radius_m", fmt::format("with a reach of {:.3g} m", reach_m),
                         fmt::format("small enough that particles touch a mesh from at most {:g} m", kMostMeshReach_m));
}

/// Runs a step of the construction; its errors name the file.
template <class Step>
auto ofFile(const std::string& name, Step step) {
  try {
    return step();
  } catch (const InvalidParameter& error) {
    throw InvalidParameter(name + ": " + error.key(), error.value(), error.valid());
  }
}

std::shared_ptr<const ToolMesh> make(const ToolMeshSource& source, double band_m) {
  validate(source);
  std::vector<std::string> report;
  TriangleMesh mesh = parseMesh(*source.bytes, source.name, source.format, {.unit_m = source.unit_m}, &report);
  const MeshCorners corners = cornersOf(mesh);
  const Vec3 origin_m = source.origin_m.value_or((corners.low_m + corners.high_m) / 2);
  const Eigen::Matrix3d turn = turnAboutXyz(source.turn_rad).toRotationMatrix();
  for (Vec3& point_m : mesh.points_m) {
    point_m = turn * (point_m - origin_m);
  }
  MendedMesh mended =
      ofFile(source.name, [&] { return mend(std::move(mesh), {.sheet_thickness_m = source.sheet_thickness_m}); });
  DistanceField field = ofFile(source.name, [&] { return makeDistanceField(mended, {.band_m = band_m}); });
  report.insert(report.end(), mended.report.begin(), mended.report.end());
  report.insert(report.end(), field.report().begin(), field.report().end());
  return std::make_shared<const ToolMesh>(ToolMesh{
      .surface = shownSurface(mended, kMostShownTriangles), .field = std::move(field), .report = std::move(report)});
}

/// A mesh that was made, and of what.
struct Kept {
  ToolMeshSource source;
  double band_m;
  std::shared_ptr<const ToolMesh> mesh;
};

std::mutex keeping;
std::vector<Kept>& kept() {
  static std::vector<Kept> all;
  return all;
}

std::shared_ptr<const ToolMesh> find(const ToolMeshSource& source, double band_m) {
  const auto same = [&](const Kept& one) { return one.band_m == band_m && one.source == source; };
  const auto one = std::ranges::find_if(kept(), same);
  return one == kept().end() ? nullptr : one->mesh;
}

}  // namespace

bool ToolMeshSource::operator==(const ToolMeshSource& other) const {
  const bool same_bytes = bytes == other.bytes || (bytes && other.bytes && *bytes == *other.bytes);
  return same_bytes && format == other.format && unit_m == other.unit_m &&
         sheet_thickness_m == other.sheet_thickness_m && origin_m == other.origin_m && turn_rad == other.turn_rad;
}

void validate(const ToolMeshSource& source) {
  requireInRange("mesh_unit_m", source.unit_m, kMeshUnit_m);
  requireInRange("sheet_thickness_m", source.sheet_thickness_m, kSheetThickness_m);
  for (int axis = 0; axis < 3; ++axis) {
    requireInRange("mesh_origin_m", source.origin_m.value_or(Vec3::Zero())[axis], ToolMeshRanges::origin_m);
    requireInRange("mesh_turn_rad", source.turn_rad[axis], ToolMeshRanges::turn_rad);
  }
}

MeshFormat requireMeshFormat(const std::filesystem::path& path) {
  const std::optional<MeshFormat> format = meshFormat(path);
  if (!format) {
    throw InvalidParameter("mesh", inQuotes(path.string()), "a file whose name ends in .stl, .obj, .glb or .gltf");
  }
  return *format;
}

void readInto(ToolMeshSource& source, const std::filesystem::path& path) {
  const MeshFormat format = requireMeshFormat(path);
  std::ifstream file = openInput(path, kMostMeshBytes);
  std::string bytes = withBuffersInside({std::istreambuf_iterator<char>(file), {}}, path);
  source.name = shortened(path.filename().string());
  source.bytes = std::make_shared<const std::string>(std::move(bytes));
  source.format = format;
}

std::shared_ptr<const ToolMesh> toolMesh(const ToolMeshSource& source, double reach_m) {
  const double band_m = bandFor(reach_m);
  {
    const std::lock_guard lock(keeping);
    if (auto mesh = find(source, band_m)) {
      return mesh;
    }
  }
  std::shared_ptr<const ToolMesh> mesh = make(source, band_m);
  const std::lock_guard lock(keeping);
  if (auto other = find(source, band_m)) {  // made meanwhile
    return other;
  }
  std::erase_if(kept(), [](const Kept& one) { return one.mesh.use_count() == 1; });
  kept().push_back({source, band_m, mesh});
  return mesh;
}

}  // namespace haptolith
