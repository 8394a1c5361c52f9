#include "haptolith/recording/vtu_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace haptolith {

namespace {

/// VTK's numbers for kinds of cells.
enum class VtkCell : std::uint8_t { kVertex = 1, kLine = 3, kTriangle = 5 };

VtkCell cellOf(const PictureMesh& mesh) {
  return mesh.points_per_cell == 1 ? VtkCell::kVertex : mesh.points_per_cell == 2 ? VtkCell::kLine : VtkCell::kTriangle;
}

}  // namespace

VtuFile::VtuFile(const PictureMesh& mesh) {
  const std::uint64_t cells = mesh.cells.size() / mesh.points_per_cell;
  std::vector<std::int32_t> ends(cells);
  for (std::uint64_t cell = 0; cell < cells; ++cell) {
    ends[cell] = static_cast<std::int32_t>((cell + 1) * mesh.points_per_cell);
  }
  const std::vector<std::uint8_t> types(cells, static_cast<std::uint8_t>(cellOf(mesh)));
  mesh_ = fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<Points>\n", mesh.point_m.size(), cells);
  mesh_ += array("Points", mesh.point_m);
  mesh_ += "</Points>\n<Cells>\n";
  mesh_ += array("connectivity", mesh.cells);
  mesh_ += array("offsets", ends);
  mesh_ += array("types", types);
  mesh_ += "</Cells>\n";
}

void VtuFile::addNumbers(const NamedNumbers& numbers) {
  numbers_ += fmt::format(
      "<DataArray type=\"Float64\" Name=\"{}\" NumberOfComponents=\"{}\" NumberOfTuples=\"1\" "
      "format=\"ascii\">{:.12g}"
      "</DataArray>\n",
      numbers.name, numbers.values.size(), fmt::join(numbers.values, " "));
}

std::string VtuFile::text() const {
  return fmt::format(R"(<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<UnstructuredGrid>
{}{}{}</Piece>
</UnstructuredGrid>
<AppendedData encoding="raw">
_{}
</AppendedData>
</VTKFile>
)",
                     numbers_.empty() ? "" : "<FieldData>\n" + numbers_ + "</FieldData>\n", mesh_,
                     point_data_.empty() ? "" : "<PointData>\n" + point_data_ + "</PointData>\n", bytes_);
}

void VtkCollection::add(double time_s, const std::string& file) {
  sets_ += fmt::format("<DataSet timestep=\"{}\" file=\"{}\"/>\n", timeText(time_s), file);
}

std::string VtkCollection::text() const {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\"><Collection>\n" + sets_ +
         "</Collection></VTKFile>\n";
}

}  // namespace haptolith
