#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "haptolith/core/atomic_file.h"
#include "haptolith/core/atomic_folder.h"
#include "haptolith/core/error.h"
#include "haptolith/recording/recording_reader.h"

#include "commands.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/overwrite.h"
#include "shared/saved.h"
#include "shared/stop_on_signal.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;

constexpr const char* kExamples = R"(Examples:
  haptolith export run.h5 --format csv                  run.csv: a row for every tick, for spreadsheets and R
  haptolith export run.h5 --format xdmf                 run.xdmf: the particles for ParaView, taken from run.h5
  haptolith export run.h5 --format vtk --out frames     frames/: a .vtp for every picture, and frames.pvd with their times)";

constexpr std::uint64_t kBlock = 4096;  // rows that are read at a time

struct ExportOptions {
  std::string file, format, out;
  Overwrite overwrite;
};

/// Tells how far it is; ends the work when somebody asks for that.
class Progress {
 public:
  explicit Progress(std::string_view of) : of_(of) {}

  void show(std::uint64_t done, std::uint64_t all) {
    if (stopAsked()) {
      throw Failure("interrupted");
    }
    if (status_.visible()) {
      status_.update(fmt::format("{} {} of {}", of_, done, all));
    }
  }

  void end() { status_.clear(); }

 private:
  const StopOnSignal stop_on_signal_;
  StatusLine status_;
  std::string of_;
};

/// Where to, when nobody says: run.csv for run.h5. Never the recording's own name.
fs::path outFor(const ExportOptions& options, const char* extension) {
  if (!options.out.empty()) {
    return options.out;
  }
  const fs::path file = options.file;
  return file.extension() == ".h5" ? fs::path(file).replace_extension(extension)
                                   : fs::path(file.string() + (*extension == '\0' ? ".vtk" : extension));
}

void tellOf(const fs::path& out, std::uint64_t count, std::string_view what) {
  printText(savedText(out, fmt::format("{} {}", count, what)));
}

void requireFrames(const RecordingReader& recording, const ExportOptions& options) {
  if (recording.frames() == 0) {
    throw Failure(fmt::format("{} holds no pictures of the particles: --format csv exports its ticks", options.file));
  }
}

/// Every tick as a row, every number so that it reads back as the same.
void exportCsv(const RecordingReader& recording, const ExportOptions& options) {
  const fs::path out = outFor(options, ".csv");
  AtomicFile file(options.overwrite(out.string()));
  Progress progress("tick");
  std::string text = csvHeader();
  for (std::uint64_t first = 0; first < recording.ticks(); first += kBlock) {
    progress.show(first, recording.ticks());
    for (const TickRecord& tick : recording.readTicks(first, kBlock)) {
      appendCsv(text, tick);
    }
    file.write(text);
    text.clear();
  }
  file.write(text);
  file.commit();
  progress.end();
  tellOf(out, recording.ticks(), "ticks");
}

std::string escaped(std::string_view text) {
  std::string xml;
  for (const char letter : text) {
    switch (letter) {
      case '&': xml += "&amp;"; break;
      case '<': xml += "&lt;"; break;
      case '>': xml += "&gt;"; break;
      default: xml += letter;
    }
  }
  return xml;
}

/// All rows of the frames that hold particles.
std::vector<FrameRow> framesOf(const RecordingReader& recording) {
  std::vector<FrameRow> frames;
  for (std::uint64_t first = 0; first < recording.frames(); first += kBlock) {
    for (const FrameRow& row : recording.readFrameRows(first, kBlock)) {
      if (row.count > 0) {
        frames.push_back(row);
      }
    }
  }
  return frames;
}

/// A description of the recording for ParaView: its particles stay where they are.
void exportXdmf(const RecordingReader& recording, const ExportOptions& options) {
  requireFrames(recording, options);
  if (!recording.finished()) {
    throw Failure(
        fmt::format("{} was not finished, and ParaView would not open it: `h5clear -s {}` (of the package "
                    "hdf5-tools) marks it as finished, or --format vtk needs no HDF5",
                    options.file, options.file));
  }
  const fs::path out = outFor(options, ".xdmf");
  AtomicFile file(options.overwrite(out.string()));
  const std::string data = escaped(fs::proximate(options.file, fs::absolute(out).parent_path()).string());
  const std::vector<FrameRow> frames = framesOf(recording);
  std::uint64_t rows = 0;
  for (const FrameRow& frame : frames) {
    rows = std::max(rows, frame.first + frame.count);
  }
  file.write(R"(<?xml version="1.0"?>
<Xdmf Version="2.0">
<Domain>
<Grid Name="particles" GridType="Collection" CollectionType="Temporal">
)");
  for (const FrameRow& frame : frames) {
    file.write(fmt::format(R"(<Grid Name="particles" GridType="Uniform">
<Time Value="{}"/>
<Topology TopologyType="Polyvertex" NumberOfElements="{}" NodesPerElement="1"/>
<Geometry GeometryType="XYZ">
<DataItem ItemType="HyperSlab" Dimensions="{} 3" Type="HyperSlab">
<DataItem Dimensions="3 2" Format="XML">{} 0 1 1 {} 3</DataItem>
<DataItem Dimensions="{} 3" Format="HDF" NumberType="Float" Precision="4">{}:/particles/position</DataItem>
</DataItem>
</Geometry>
</Grid>
)",
                           frame.time_s, frame.count, frame.count, frame.first, frame.count, rows, data));
  }
  file.write("</Grid>\n</Domain>\n</Xdmf>\n");
  file.commit();
  tellOf(out, frames.size(), "pictures of the particles");
}

template <class T>
void appendBlock(std::string& bytes, const std::vector<T>& values) {
  const std::uint64_t size = values.size() * sizeof(T);
  bytes.append(reinterpret_cast<const char*>(&size), sizeof(size));
  bytes.append(reinterpret_cast<const char*>(values.data()), size);
}

/// VTK's XML format for points, each a cell of its own, with the arrays as they are behind the description: first their
/// size in bytes, then their values.
std::string vtp(const ParticleFrame& frame) {
  const std::size_t count = frame.position_m.size();
  std::vector<std::int32_t> number(count), end(count);
  for (std::size_t i = 0; i < count; ++i) {
    number[i] = static_cast<std::int32_t>(i);
    end[i] = number[i] + 1;
  }
  const std::size_t points_bytes = sizeof(std::uint64_t) + count * sizeof(frame.position_m[0]);
  const std::size_t cells_bytes = sizeof(std::uint64_t) + count * sizeof(std::int32_t);
  std::string file = fmt::format(
      R"(<?xml version="1.0"?>
<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<PolyData><Piece NumberOfPoints="{0}" NumberOfVerts="{0}" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="0">
<Points><DataArray type="Float32" Name="Points" NumberOfComponents="3" format="appended" offset="0"/></Points>
<Verts>
<DataArray type="Int32" Name="connectivity" format="appended" offset="{1}"/>
<DataArray type="Int32" Name="offsets" format="appended" offset="{2}"/>
</Verts>
</Piece></PolyData>
<AppendedData encoding="raw">
_)",
      count, points_bytes, points_bytes + cells_bytes);
  appendBlock(file, frame.position_m);
  appendBlock(file, number);
  appendBlock(file, end);
  return file + "\n</AppendedData>\n</VTKFile>\n";
}

void exportVtk(const RecordingReader& recording, const ExportOptions& options) {
  requireFrames(recording, options);
  const fs::path out = outFor(options, "");
  const AtomicFolder folder(out);
  Progress progress("picture");
  const std::vector<FrameRow> frames = framesOf(recording);
  std::string collection = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\"><Collection>\n";
  for (std::size_t number = 0; number < frames.size(); ++number) {
    progress.show(number, frames.size());
    const std::string name = fmt::format("particles-{:06}.vtp", number);
    folder.write(name, vtp(recording.readFrame(frames[number])));
    collection += fmt::format("<DataSet timestep=\"{:.12g}\" file=\"{}\"/>\n", frames[number].time_s, name);
  }
  folder.write(out.filename().string() + ".pvd", collection + "</Collection></VTKFile>\n");
  folder.commit();
  progress.end();
  tellOf(out, frames.size(), "pictures of the particles");
}

void exportRecording(const ExportOptions& options) {
  const RecordingReader recording(options.file);
  if (options.format == "csv") {
    exportCsv(recording, options);
  } else if (options.format == "xdmf") {
    exportXdmf(recording, options);
  } else {
    exportVtk(recording, options);
  }
  if (recording.missingTicks() > 0) {
    spdlog::warn(
        "{} lacks {} ticks that the disk or the machine was too slow for; the numbers of those before and after tell "
        "where",
        options.file, recording.missingTicks());
  }
}

}  // namespace

void addExportCommand(CLI::App& app) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command = app.add_subcommand("export", "Convert a recording for other programs: CSV, XDMF or VTK");
  command->footer(kExamples);
  command->add_option("file", options->file, "A recording (.h5)")->required()->option_text("FILE.h5");
  command->add_option("--format", options->format, "csv: ticks; xdmf, vtk: particles, for ParaView")
      ->required()
      ->check(oneOf({"csv", "xdmf", "vtk"}))
      ->option_text("csv|xdmf|vtk");
  command->add_option("--out", options->out, "Where to: a file, for vtk a new folder [named after the recording]")
      ->option_text("PATH");
  options->overwrite.addTo(*command);
  command->callback([options] { exportRecording(*options); });
}

}  // namespace haptolith
