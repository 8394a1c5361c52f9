#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "haptolith/recording/export_pictures.h"
#include "haptolith/recording/hdf5_handle.h"
#include "haptolith/recording/picture_meshes.h"
#include "haptolith/recording/recording_types.h"

namespace haptolith {

namespace {

using namespace hdf5;

constexpr const char* kDataFile = "pictures.h5";

/// Layout of a value type in the file and in memory, and its name in XDMF.
struct ValueType {
  hid_t in_file, in_memory;
  const char* xdmf;
  int bytes;
};
ValueType typeOf(float) {
  return {H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, "Float", 4};
}
ValueType typeOf(double) {
  return {H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, "Float", 8};
}
ValueType typeOf(std::int32_t) {
  return {H5T_STD_I32LE, H5T_NATIVE_INT32, "Int", 4};
}
ValueType typeOf(std::uint64_t) {
  return {H5T_STD_U64LE, H5T_NATIVE_UINT64, "UInt", 8};
}

/// An HDF5 file of plain datasets, in the oldest format, which every program reads.
class DataFile {
 public:
  /// @param shown  the path as a message names it. @throws Failure, as all functions.
  DataFile(const std::filesystem::path& path, const std::filesystem::path& shown)
      : writing_(fmt::format("write {}", shown.string())) {
    prepareThread();
    file_ = handle(H5Fcreate(path.string().c_str(), H5F_ACC_EXCL, H5P_DEFAULT, H5P_DEFAULT), writing_.c_str());
  }

  /// Writes a dataset of one dimension, or of rows of `columns` values each when that is not 0.
  /// @return what an XDMF file says of it.
  template <class Value>
  std::string write(const std::string& path, const std::vector<Value>& values, std::uint64_t columns) {
    return write(path, values.data(), values.size(), columns, typeOf(Value{}));
  }
  std::string write(const std::string& path, const std::vector<std::array<float, 3>>& vectors) {
    return write(path, vectors.data(), 3 * vectors.size(), 3, typeOf(float{}));
  }

  /// An attribute of the file's root.
  void writeText(const char* name, std::string text) {
    text.resize(std::max<std::size_t>(text.size(), 1));  // none may be empty
    const Handle type = textType(text.size());
    const Handle space = made(H5Screate(H5S_SCALAR));
    const Handle attribute = made(H5Acreate2(file_.id(), name, type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT));
    done(H5Awrite(attribute.id(), type.id(), text.data()), writing_.c_str());
  }

  void close() {
    done(H5Fflush(file_.id(), H5F_SCOPE_GLOBAL), writing_.c_str());
    if (!file_.close()) {
      fail(writing_.c_str());
    }
  }

 private:
  [[nodiscard]] Handle made(hid_t id) const { return handle(id, writing_.c_str()); }

  std::string write(const std::string& path, const void* values, std::uint64_t count, std::uint64_t columns,
                    const ValueType& type) {
    const std::uint64_t rows = columns == 0 ? count : count / columns;
    const std::array<hsize_t, 2> extent{rows, columns};
    const Handle space = made(H5Screate_simple(columns == 0 ? 1 : 2, extent.data(), nullptr));
    const Handle links = made(H5Pcreate(H5P_LINK_CREATE));
    done(H5Pset_create_intermediate_group(links.id(), 1), writing_.c_str());
    Handle dataset =
        made(H5Dcreate2(file_.id(), path.c_str(), type.in_file, space.id(), links.id(), H5P_DEFAULT, H5P_DEFAULT));
    done(H5Dwrite(dataset.id(), type.in_memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), writing_.c_str());
    if (!dataset.close()) {
      fail(writing_.c_str());
    }
    return fmt::format(R"(<DataItem Dimensions="{}{}" Format="HDF" NumberType="{}" Precision="{}">{}:{}</DataItem>)",
                       rows, columns == 0 ? "" : fmt::format(" {}", columns), type.xdmf, type.bytes, kDataFile, path);
  }

  std::string writing_;
  Handle file_;
};

std::string document(const std::string& grids) {
  return "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n<Domain>\n" + grids + "</Domain>\n</Xdmf>\n";
}

std::string overTime(const char* name, const std::string& grids) {
  return document(
      fmt::format("<Grid Name=\"{}\" GridType=\"Collection\" CollectionType=\"Temporal\">\n{}</Grid>\n", name, grids));
}

std::string topology(const char* type, std::uint64_t points_per_cell, std::uint64_t cells, const std::string& item) {
  return fmt::format("<Topology TopologyType=\"{}\" NodesPerElement=\"{}\" NumberOfElements=\"{}\">{}</Topology>\n",
                     type, points_per_cell, cells, item);
}

std::string attribute(const char* name, const char* type, const char* centre, const std::string& item) {
  return fmt::format("<Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"{}\">{}</Attribute>\n", name, type, centre,
                     item);
}

std::string grid(const char* name, const std::string& time, const std::string& content) {
  return fmt::format("<Grid Name=\"{}\" GridType=\"Uniform\">\n{}{}</Grid>\n", name, time, content);
}

std::string timeElement(double time_s) {
  return fmt::format("<Time Value=\"{}\"/>\n", timeText(time_s));
}

std::string geometry(const std::string& item) {
  return "<Geometry GeometryType=\"XYZ\">" + item + "</Geometry>\n";
}

std::string attributeOf(const NamedNumbers& numbers) {
  const std::size_t count = numbers.values.size();
  return attribute(numbers.name,
                   count == 1   ? "Scalar"
                   : count == 3 ? "Vector"
                                : "Matrix",
                   "Grid",
                   fmt::format("<DataItem Dimensions=\"1 {}\" Format=\"XML\" NumberType=\"Float\" "
                               "Precision=\"8\">{:.12g}</DataItem>",
                               count, fmt::join(numbers.values, " ")));
}

/// All pictures on their way into the files.
class XdmfFolder {
 public:
  XdmfFolder(RecordedPictures& pictures, const AtomicFolder& folder)
      : pictures_(pictures), folder_(folder), data_(folder.makingPath() / kDataFile, folder.path() / kDataFile) {
    data_.writeText("schema", "haptolith pictures");
    data_.writeText("title", pictures.header().title);
    data_.writeText("scenario", pictures.header().scene_file);
    const std::vector<std::string> names = toolFileNames(pictures);
    for (std::size_t i = 0; i < names.size(); ++i) {
      tools_.push_back({names[i], toolSet(*pictures.sceneFile()).all()[i]});
    }
  }

  void add(const ScenePicture& picture) {
    addParticles(picture);
    for (std::size_t i = 0; i < picture.tools.size(); ++i) {
      addTool(picture, i);
    }
    if (!picture.stones.empty()) {
      addStones(picture);
    }
    box_.show(picture);
    times_s_.push_back(picture.time_s);
    ticks_.push_back(picture.tick);
  }

  void finish() {
    data_.write("/time_s", times_s_, 0);
    data_.write("/tick", ticks_, 0);
    folder_.write("particles.xdmf", overTime("particles", particles_));
    for (const Tool& tool : tools_) {
      if (!tool.grids.empty()) {
        folder_.write(tool.name + ".xdmf", overTime(tool.name.c_str(), tool.grids));
      }
    }
    if (!stones_.empty()) {
      folder_.write("stones.xdmf", overTime("stones", stones_));
    }
    if (pictures_.sceneFile()) {
      const PictureMesh box = box_.of(pictures_.sceneFile()->bed);
      const std::string edges = data_.write("/box/edges", box.cells, 2);
      folder_.write("box.xdmf", document(grid("box", "",
                                              topology("Polyline", 2, box.cells.size() / 2, edges) +
                                                  geometry(data_.write("/box/points_m", box.point_m)))));
    }
    data_.close();
  }

 private:
  void addParticles(const ScenePicture& picture) {
    const std::size_t count = picture.position_m.size();
    const std::string group = fmt::format("/particles/{:06}/", times_s_.size());
    const Numbering& numbering = numberingOf(count);
    const auto scalars = [&](const char* name, const std::vector<float>& values) {
      return attribute(name, "Scalar", "Node", data_.write(group + name, values, 0));
    };
    std::string content = topology("Polyvertex", 1, count, numbering.vertices) +
                          geometry(data_.write(group + "position_m", picture.position_m)) +
                          attribute(kId, "Scalar", "Node", numbering.id) + scalars(kRadius, picture.radius_m) +
                          scalars(kContactForce, picture.contact_force_n);
    if (!picture.velocity_m_s.empty()) {
      content += attribute(kVelocity, "Vector", "Node", data_.write(group + kVelocity, picture.velocity_m_s));
    }
    particles_ += grid("particles", timeElement(picture.time_s), content);
  }

  void addTool(const ScenePicture& picture, std::size_t number) {
    const PicturedTool& at = picture.tools[number];
    Tool& tool = tools_.at(number);
    const PictureMesh mesh = toolMesh(tool.parameters, at);
    if (tool.triangles.empty()) {
      tool.triangles = topology("Triangle", 3, mesh.cells.size() / 3,
                                data_.write(fmt::format("/{}/triangles", tool.name), mesh.cells, 3));
    }
    std::string content =
        tool.triangles +
        geometry(data_.write(fmt::format("/{}/{:06}/points_m", tool.name, times_s_.size()), mesh.point_m));
    for (const NamedNumbers& numbers : numbersOf(at, tool.parameters)) {
      content += attributeOf(numbers);
    }
    tool.grids += grid(tool.name.c_str(), timeElement(picture.time_s), content);
  }

  void addStones(const ScenePicture& picture) {
    const PictureMesh stones = stonesMesh(picture.stones);
    if (stone_triangles_.empty()) {
      stone_triangles_ =
          topology("Triangle", 3, stones.cells.size() / 3, data_.write("/stones/triangles", stones.cells, 3));
    }
    stones_ += grid("stones", timeElement(picture.time_s),
                    stone_triangles_ +
                        geometry(data_.write(fmt::format("/stones/{:06}/points_m", times_s_.size()), stones.point_m)));
  }

  /// Numbering of the particles: written once for all pictures with that number.
  struct Numbering {
    std::string id, vertices;
  };
  const Numbering& numberingOf(std::size_t count) {
    Numbering& numbering = numberings_[count];
    if (numbering.id.empty()) {
      const std::vector<std::int32_t> numbers = numbered(count);
      numbering.id = data_.write(fmt::format("/particles/id_{}", count), numbers, 0);
      numbering.vertices = data_.write(fmt::format("/particles/vertices_{}", count), numbers, 1);
    }
    return numbering;
  }

  RecordedPictures& pictures_;
  const AtomicFolder& folder_;
  DataFile data_;
  std::map<std::size_t, Numbering> numberings_;
  struct Tool {
    std::string name;
    ToolParameters parameters;
    std::string triangles = {}, grids = {};
  };
  std::vector<Tool> tools_;
  std::string stone_triangles_, particles_, stones_;
  BoxMesh box_;
  std::vector<double> times_s_;
  std::vector<std::uint64_t> ticks_;
};

}  // namespace

void exportXdmf(RecordedPictures& pictures, const AtomicFolder& folder) {
  XdmfFolder files(pictures, folder);
  pictures.forEach([&](const ScenePicture& picture) { files.add(picture); });
  files.finish();
}

}  // namespace haptolith
