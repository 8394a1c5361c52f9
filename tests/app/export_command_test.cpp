#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "program.h"

namespace haptolith {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

// Debian's own Python, which has Debian's packages.
constexpr const char* kPython = "/usr/bin/python3";

class ExportCommand : public testing::Test {
 protected:
  ExportCommand() : folder_(fs::path(testing::TempDir()) / fmt::format("haptolith_export_{}", getpid())) {
    fs::create_directories(folder_);
  }
  ~ExportCommand() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string file(const std::string& name) const { return (folder_ / name).string(); }

  void makeRecording(int ticks, int particles) const {
    ASSERT_EQ(
        runInShell(fmt::format("\"$RECORDING_HELPER\" make '{}' {} {}", file("run.h5"), ticks, particles)).exit_status,
        0);
  }

  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  /// Runs a Python program in the folder; what it asserts must be so.
  void expectTrueInPython(const std::string& program) const {
    std::ofstream(file("check.py")) << program;
    const ProgramResult result = runInShell(fmt::format("cd '{}' && {} check.py", folder_.string(), kPython));
    EXPECT_EQ(result.exit_status, 0) << result.errors;
    fs::remove(file("check.py"));
  }

  fs::path folder_;
};

TEST_F(ExportCommand, TicksThatAreMissingAreTold) {
  makeRecording(500, 10);
  EXPECT_THAT(runHaptolith("export --format csv " + file("run.h5")).errors, testing::IsEmpty());
  expectTrueInPython("import h5py, numpy; h5py.File('run.h5', 'r+').attrs['missing_ticks'] = numpy.uint64(100)");
  const ProgramResult told = runHaptolith("export --overwrite --format csv " + file("run.h5"));
  EXPECT_EQ(told.exit_status, 0);
  EXPECT_THAT(told.errors, HasSubstr("lacks 100 ticks"));
}

TEST_F(ExportCommand, PandasFindsTheSameNumbersInCsvAndHdf5) {
  makeRecording(5000, 10);
  const ProgramResult result = runHaptolith("export --format csv " + file("run.h5"));
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  EXPECT_EQ(files(), (std::vector<std::string>{"run.csv", "run.h5"}));
  expectTrueInPython(R"(
import h5py, numpy, pandas
recorded = pandas.DataFrame(h5py.File('run.h5')['ticks'][:])
exported = pandas.read_csv('run.csv', float_precision='round_trip')
assert len(recorded) == 5000
assert list(recorded.columns) == list(exported.columns)
for name in recorded.columns:
    same = recorded[name].to_numpy() == exported[name].to_numpy()
    both_nan = recorded[name].isna().to_numpy() & exported[name].isna().to_numpy()
    assert (same | both_nan).all(), name
assert recorded.t_s.iloc[-1] == 4.999
assert recorded.state_hash.iloc[3] == 3 * 0x9E3779B97F4A7C15 % 2**64
)");
}

TEST_F(ExportCommand, XdmfPointsAtEachFrameInTheRecording) {
  makeRecording(400, 20);
  ASSERT_EQ(runHaptolith("export --format xdmf " + file("run.h5")).exit_status, 0);
  expectTrueInPython(R"(
import h5py, xml.etree.ElementTree as xml
recording = h5py.File('run.h5')
rows = recording['particles/frames'][:]
grids = xml.parse('run.xdmf').findall('./Domain/Grid/Grid')
assert len(grids) == len(rows) == 13
for grid, row in zip(grids, rows):
    assert float(grid.find('Time').get('Value')) == row['t_s']
    slab = grid.find('Geometry/DataItem')
    selection, data = slab.findall('DataItem')
    assert [int(n) for n in selection.text.split()] == [row['first'], 0, 1, 1, row['count'], 3]
    assert slab.get('Dimensions') == f"{row['count']} 3"
    assert grid.find('Topology').get('NumberOfElements') == str(row['count'])
    name, path = data.text.split(':')
    assert h5py.File(name)[path].shape == tuple(int(n) for n in data.get('Dimensions').split())
)");
}

TEST_F(ExportCommand, VtkHasAFileForEveryFrame) {
  makeRecording(400, 20);
  ASSERT_EQ(runHaptolith("export --format vtk " + file("run.h5") + " --out " + file("frames")).exit_status, 0);
  EXPECT_EQ(files(), (std::vector<std::string>{"frames", "run.h5"}));
  expectTrueInPython(R"(
import h5py, numpy, xml.etree.ElementTree as xml
recording = h5py.File('run.h5')
rows = recording['particles/frames'][:]
sets = xml.parse('frames/frames.pvd').findall('./Collection/DataSet')
assert len(sets) == len(rows)
for each, row in zip(sets, rows):
    assert abs(float(each.get('timestep')) - row['t_s']) < 1e-9
    head, blocks = open('frames/' + each.get('file'), 'rb').read().split(b'<AppendedData encoding="raw">\n_', 1)
    blocks, tail = blocks.rsplit(b'\n</AppendedData>', 1)
    piece = xml.fromstring(head + b'</VTKFile>').find('./PolyData/Piece')
    count = int(row['count'])
    assert piece.get('NumberOfPoints') == piece.get('NumberOfVerts') == str(count)
    end = 0
    def block(array, kind):
        global end
        offset = int(array.get('offset'))
        assert offset == end
        size = int(numpy.frombuffer(blocks, '<u8', 1, offset)[0])
        end = offset + 8 + size
        return numpy.frombuffer(blocks[offset + 8:end], kind)
    points = block(piece.find('Points/DataArray'), '<f4').reshape(-1, 3)
    first = int(row['first'])
    assert (points == recording['particles/position'][first:first + count]).all()
    numbers, ends = (block(array, '<i4') for array in piece.findall('Verts/DataArray'))
    assert (numbers == range(count)).all() and (ends == range(1, count + 1)).all()
    assert end == len(blocks)
)");
  const ProgramResult again = runHaptolith("export --format vtk " + file("run.h5") + " --out " + file("frames"));
  EXPECT_EQ(again.exit_status, 1);
  EXPECT_THAT(again.errors, HasSubstr("frames exists already"));
}

TEST_F(ExportCommand, AnUnfinishedRecordingIsExportedToo) {
  runInShell(fmt::format("timeout -s KILL 1 \"$RECORDING_HELPER\" record '{}'", file("run.h5")));
  EXPECT_EQ(runHaptolith("export --format csv " + file("run.h5")).exit_status, 0);
  EXPECT_EQ(runHaptolith("export --format vtk " + file("run.h5")).exit_status, 0);
  const ProgramResult xdmf = runHaptolith("export --format xdmf " + file("run.h5"));
  EXPECT_EQ(xdmf.exit_status, 1);
  EXPECT_THAT(xdmf.errors, HasSubstr("h5clear -s"));
  expectTrueInPython(R"(
import h5py, pandas
assert len(pandas.DataFrame(h5py.File('run.h5', 'r', swmr=True)['ticks'][:])) == len(pandas.read_csv('run.csv')) > 0
)");
}

TEST_F(ExportCommand, NothingHalfIsLeftBehind) {
  makeRecording(60'000, 10);
  const ProgramResult stopped = runInShell(fmt::format(
      "timeout -s INT 0.1 \"$HAPTOLITH\" export --format csv '{}' --out '{}'", file("run.h5"), file("a.csv")));
  EXPECT_NE(stopped.exit_status, 0);
  EXPECT_EQ(runHaptolith("export --format csv " + file("run.h5") + " --out /dev/full").exit_status, 1);
  EXPECT_EQ(runInShell(fmt::format("trap '' XFSZ; ulimit -f 100; \"$HAPTOLITH\" export --format csv '{}' --out '{}'",
                                   file("run.h5"), file("a.csv")))
                .exit_status,
            1);
  EXPECT_EQ(files(), std::vector<std::string>{"run.h5"});
}

TEST_F(ExportCommand, SaysWhatItHasWritten) {
  makeRecording(400, 20);
  EXPECT_EQ(runHaptolith("export --format csv " + file("run.h5")).output, "saved " + file("run.csv") + ": 400 ticks\n");
  EXPECT_THAT(runHaptolith("export --format xdmf " + file("run.h5")).output,
              HasSubstr(file("run.xdmf") + ": 13 pictures"));
  EXPECT_THAT(runHaptolith("export --format vtk " + file("run.h5")).output, HasSubstr(file("run") + ": 13 pictures"));
}

TEST_F(ExportCommand, ShowsWhatATerminalWouldObey) {
  makeRecording(40, 2);
  const ProgramResult result =
      runHaptolith(fmt::format("export '{}' --format csv --out '{}'", file("run.h5"), file("\033]0;pwned\007.csv")));
  EXPECT_EQ(result.exit_status, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("\\u001b]0;pwned\\u0007.csv: 40 ticks\n"));
}

TEST_F(ExportCommand, NeverDestroysARecording) {
  makeRecording(40, 2);
  fs::create_hard_link(file("run.h5"), file("also.csv"));
  fs::create_symlink("run.h5", file("link.csv"));
  const auto size = fs::file_size(file("run.h5"));
  for (const char* out : {"run.h5", "also.csv", "link.csv"}) {
    for (const char* format : {"csv", "xdmf", "vtk"}) {
      for (const char* option : {"", "--overwrite"}) {
        const ProgramResult result = runHaptolith(
            fmt::format("export '{}' --format {} --out '{}' {}", file("run.h5"), format, file(out), option));
        EXPECT_EQ(result.exit_status, 1) << out << ' ' << format << ' ' << option;
        EXPECT_THAT(result.errors, HasSubstr("choose another name"));
      }
    }
  }
  EXPECT_EQ(fs::file_size(file("run.h5")), size);
  EXPECT_TRUE(fs::is_symlink(file("link.csv")));
  EXPECT_EQ(runHaptolith(fmt::format("export '{}' --format csv", file("run.h5"))).exit_status, 0);
}

TEST_F(ExportCommand, ItsOwnNameForTheResultIsNeverTheRecordings) {
  makeRecording(40, 2);
  for (const char* name : {"a.csv", "b", "c.xdmf"}) {
    fs::copy(file("run.h5"), file(name));
    EXPECT_EQ(runHaptolith(fmt::format("export '{}' --format csv", file(name))).exit_status, 0);
    EXPECT_EQ(runHaptolith(fmt::format("export '{}' --format vtk", file(name))).exit_status, 0);
    EXPECT_EQ(fs::file_size(file(name)), fs::file_size(file("run.h5")));
    EXPECT_TRUE(fs::exists(file(std::string(name) + ".csv")));
    EXPECT_TRUE(fs::exists(file(std::string(name) + ".vtk")));
  }
}

TEST_F(ExportCommand, ReplacesAFileOnlyWhenAskedTo) {
  makeRecording(40, 2);
  std::ofstream(file("notes.csv")) << "mine";
  const std::string command = fmt::format("export '{}' --format csv --out '{}'", file("run.h5"), file("notes.csv"));
  const ProgramResult refused = runHaptolith(command);
  EXPECT_EQ(refused.exit_status, 1);
  EXPECT_THAT(refused.errors, HasSubstr("notes.csv exists already: choose another name, or add --overwrite"));
  EXPECT_EQ(fs::file_size(file("notes.csv")), 4U);
  EXPECT_EQ(runHaptolith(command + " --overwrite").exit_status, 0);
  EXPECT_GT(fs::file_size(file("notes.csv")), 4U);
}

TEST_F(ExportCommand, WrongUseIsToldSo) {
  EXPECT_EQ(runHaptolith("export --format png a.h5").exit_status, 2);
  EXPECT_EQ(runHaptolith("export a.h5").exit_status, 2);
  const ProgramResult missing = runHaptolith("export --format csv " + file("no.h5"));
  EXPECT_EQ(missing.exit_status, 1);
  EXPECT_THAT(missing.errors, HasSubstr("no.h5: No such file or directory"));
  makeRecording(10, 0);
}

}  // namespace
}  // namespace haptolith
