#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "haptolith/recording/export_pictures.h"
#include "haptolith/recording/picture_meshes.h"

namespace haptolith {

namespace {

static_assert(std::endian::native == std::endian::little, "the files say so");

/// VTK's numbers for kinds of cells.
enum class VtkCell : std::uint8_t { kVertex = 1, kLine = 3, kTriangle = 5 };

VtkCell cellOf(const PictureMesh& mesh) {
  return mesh.points_per_cell == 1 ? VtkCell::kVertex : mesh.points_per_cell == 2 ? VtkCell::kLine : VtkCell::kTriangle;
}

/// A file of VTK's XML format for unstructured grids, with the arrays as they are behind the description: first their
/// size in bytes, then their values.
class VtuFile {
 public:
  explicit VtuFile(const PictureMesh& mesh) {
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

  void addTime(double time_s) { addNumbers({"TimeValue", {time_s}}); }

  void addNumbers(const NamedNumbers& numbers) {
    numbers_ += fmt::format(
        "<DataArray type=\"Float64\" Name=\"{}\" NumberOfComponents=\"{}\" NumberOfTuples=\"1\" "
        "format=\"ascii\">{:.12g}"
        "</DataArray>\n",
        numbers.name, numbers.values.size(), fmt::join(numbers.values, " "));
  }

  template <class Value>
  void addPointData(const char* name, const std::vector<Value>& values) {
    point_data_ += array(name, values);
  }

  [[nodiscard]] std::string text() const {
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

 private:
  template <class Value>
  std::string array(const char* name, const std::vector<Value>& values) {
    const std::uint64_t offset = bytes_.size();
    const std::uint64_t size = values.size() * sizeof(Value);
    bytes_.append(reinterpret_cast<const char*>(&size), sizeof(size));
    bytes_.append(reinterpret_cast<const char*>(values.data()), size);
    constexpr bool kVector = std::is_same_v<Value, std::array<float, 3>>;
    const char* type = std::is_same_v<Value, std::int32_t>   ? "Int32"
                       : std::is_same_v<Value, std::uint8_t> ? "UInt8"
                                                             : "Float32";
    return fmt::format(R"(<DataArray type="{}" Name="{}" NumberOfComponents="{}" format="appended" offset="{}"/>)"
                       "\n",
                       type, name, kVector ? 3 : 1, offset);
  }

  std::string numbers_, mesh_, point_data_, bytes_;
};

VtuFile particlesFile(const ScenePicture& picture) {
  const std::vector<std::int32_t> id = numbered(picture.position_m.size());
  VtuFile file({.point_m = picture.position_m, .cells = id, .points_per_cell = 1});
  file.addTime(picture.time_s);
  file.addPointData(kId, id);
  file.addPointData(kRadius, picture.radius_m);
  file.addPointData(kContactForce, picture.contact_force_n);
  if (!picture.velocity_m_s.empty()) {
    file.addPointData(kVelocity, picture.velocity_m_s);
  }
  return file;
}

/// Files with their times: what ParaView opens as one.
class Collection {
 public:
  void add(double time_s, const std::string& file) {
    sets_ += fmt::format("<DataSet timestep=\"{}\" file=\"{}\"/>\n", timeText(time_s), file);
  }
  [[nodiscard]] bool empty() const { return sets_.empty(); }
  [[nodiscard]] std::string text() const {
    return "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\"><Collection>\n" + sets_ +
           "</Collection></VTKFile>\n";
  }

 private:
  std::string sets_;
};

}  // namespace

void exportVtk(RecordedPictures& pictures, const AtomicFolder& folder) {
  Collection particles, tools, stones;
  BoxMesh box;
  std::size_t number = 0;
  pictures.forEach([&](const ScenePicture& picture) {
    const std::string name = fmt::format("particles-{:06}.vtu", number);
    folder.write(name, particlesFile(picture).text());
    particles.add(picture.time_s, name);
    if (picture.tool) {
      VtuFile tool(toolMesh(pictures.scenario()->tool, *picture.tool));
      tool.addTime(picture.time_s);
      for (const NamedNumbers& numbers : numbersOf(*picture.tool)) {
        tool.addNumbers(numbers);
      }
      const std::string tool_name = fmt::format("tool-{:06}.vtu", number);
      folder.write(tool_name, tool.text());
      tools.add(picture.time_s, tool_name);
    }
    if (!picture.stones.empty()) {
      VtuFile stones_file(stonesMesh(picture.stones));
      stones_file.addTime(picture.time_s);
      const std::string stones_name = fmt::format("stones-{:06}.vtu", number);
      folder.write(stones_name, stones_file.text());
      stones.add(picture.time_s, stones_name);
    }
    box.show(picture);
    ++number;
  });
  folder.write("particles.pvd", particles.text());
  if (!tools.empty()) {
    folder.write("tool.pvd", tools.text());
  }
  if (!stones.empty()) {
    folder.write("stones.pvd", stones.text());
  }
  if (pictures.scenario()) {
    folder.write("box.vtu", VtuFile(box.of(pictures.scenario()->bed)).text());
  }
}

}  // namespace haptolith
