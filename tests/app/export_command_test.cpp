#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
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

  /// A second of the shovel in the paper's soil. In real time: of a run that a busy machine gets through between two
  /// turns of its main thread has one picture only.
  void makeRun() const {
    const ProgramResult result = runHaptolith(
        "run icra2021 --duration-s 1 --motion stir --no-serve --record-frames 20 --record " + file("run.h5"));
    ASSERT_EQ(result.exit_status, 0) << result.errors;
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

/// Reads the exports back: parsed files, with the files that they refer to.
constexpr const char* kReaders = R"(
import h5py, numpy, pandas, xml.etree.ElementTree as xml

def xdmf_item(item, folder):
    "The values that an XDMF file refers to, after checking that it describes them as they are."
    shape = tuple(int(n) for n in item.get('Dimensions').split())
    if item.get('Format') == 'XML':
        values = numpy.array(item.text.split(), float)
        assert values.size == numpy.prod(shape)
        return values
    name, path = item.text.split(':')
    values = h5py.File(folder + '/' + name)[path]
    kind = {'Float': 'f', 'Int': 'i', 'UInt': 'u'}[item.get('NumberType')]
    assert values.shape == shape, (path, values.shape, shape)
    assert values.dtype == numpy.dtype(kind + item.get('Precision'))
    return values[:]

def xdmf(name, folder='run-xdmf'):
    "The grids of an XDMF file: time, points, cells and attributes by name."
    root = xml.parse(f'{folder}/{name}.xdmf').getroot()
    assert root.get('Version') == '3.0' and 'HyperSlab' not in xml.tostring(root, 'unicode')
    domain, = root.findall('Domain')
    for grid in [g for g in domain.iter('Grid') if g.get('GridType') == 'Uniform']:
        topology = grid.find('Topology')
        cells = xdmf_item(topology.find('DataItem'), folder)
        assert cells.shape == (int(topology.get('NumberOfElements')), int(topology.get('NodesPerElement')))
        time = grid.find('Time')
        yield (None if time is None else time.get('Value'), xdmf_item(grid.find('Geometry/DataItem'), folder), cells,
               {a.get('Name'): xdmf_item(a.find('DataItem'), folder) for a in grid.findall('Attribute')})

def vtu(name, folder='run-vtk'):
    "A file of VTK: points, cells and arrays by name."
    head, blocks = open(f'{folder}/{name}', 'rb').read().split(b'<AppendedData encoding="raw">\n_', 1)
    blocks, tail = blocks.rsplit(b'\n</AppendedData>', 1)
    grid = xml.fromstring(head + b'</VTKFile>').find('UnstructuredGrid')
    piece = grid.find('Piece')
    end = 0
    def block(array):
        nonlocal end
        assert int(array.get('offset')) == end
        size = int(numpy.frombuffer(blocks, '<u8', 1, end)[0])
        kind = {'Float32': '<f4', 'Int32': '<i4', 'UInt8': 'u1'}[array.get('type')]
        values = numpy.frombuffer(blocks[end + 8:end + 8 + size], kind)
        end += 8 + size
        columns = int(array.get('NumberOfComponents'))
        return values if columns == 1 else values.reshape(-1, columns)
    parts = [a for part in ('Points', 'Cells', 'PointData') for a in piece.iterfind(part + '/DataArray')]
    arrays = {a.get('Name'): block(a) for a in parts}
    assert end == len(blocks)
    points = arrays.pop('Points')
    cells, ends, types = (arrays.pop(name) for name in ('connectivity', 'offsets', 'types'))
    assert len(points) == int(piece.get('NumberOfPoints'))
    assert len(types) == len(ends) == int(piece.get('NumberOfCells'))
    assert len(set(types)) == 1
    per_cell = {1: 1, 3: 2, 5: 3}[types[0]]
    assert (ends == per_cell * numpy.arange(1, len(ends) + 1)).all()
    arrays.update({a.get('Name'): numpy.array(a.text.split(), float) for a in grid.findall('FieldData/DataArray')})
    return points, cells.reshape(-1, per_cell), arrays

def pvd(name, folder='run-vtk'):
    sets = xml.parse(f'{folder}/{name}.pvd').iter('DataSet')
    return [(s.get('timestep'),) + vtu(s.get('file'), folder) for s in sets]

recording = h5py.File('run.h5', 'r')
rows = recording['particles/frames'][:]
def recorded(row):
    return recording['particles/position'][row['first']:row['first'] + row['count']]
ticks = pandas.DataFrame(recording['ticks'][:])
)";

/// `grids` are those of the particles, `tools` those of the tool, `box` has points and edges: of either format.
constexpr const char* kSame = R"(
assert len(grids) == len(rows) > 1
for (time, points, cells, arrays), row in zip(grids, rows):
    assert float(time) == round(row['t_s'], 9) and len(time) < 8, time
    assert (points == recorded(row)).all()
    assert (cells[:, 0] == numpy.arange(len(points))).all() and (arrays['id'] == numpy.arange(len(points))).all()
    assert (arrays['radius_m'] == numpy.float32(0.007)).all()
    assert (arrays['contact_force_n'] >= 0).all() and arrays['contact_force_n'].max() > 0
    assert arrays['velocity_m_s'].shape == points.shape
assert max(abs(arrays['velocity_m_s']).max() for _, _, _, arrays in grids) > 0.01

moments = [ticks[abs(ticks.t_s - row['t_s']) < 1e-9] for row in rows]
moments = [tick.iloc[0] for tick in moments if len(tick)]
assert len(tools) == len(moments) >= len(rows) - 1
for (time, points, triangles, arrays), tick in zip(tools, moments):
    assert float(time) == round(tick.t_s, 9)
    assert len(points) == 8 and triangles.shape == (12, 3)
    middle = numpy.array([tick.tool_x_m, tick.tool_y_m, tick.tool_z_m])
    assert abs(points.mean(axis=0) - middle).max() < 1e-6
    assert abs(arrays['tool_position_m'] - middle).max() < 1e-9
    for name, columns in (('tool_orientation_wxyz', ['tool_qw', 'tool_qx', 'tool_qy', 'tool_qz']),
                          ('soil_force_n', ['soil_fx_n', 'soil_fy_n', 'soil_fz_n']),
                          ('soil_torque_nm', ['soil_tx_nm', 'soil_ty_nm', 'soil_tz_nm'])):
        assert abs(arrays[name].ravel() - tick[columns].to_numpy(float)).max() < 1e-9, name
    assert arrays['tool_opening_m'].ravel() == [0]

points, edges = box
assert len(points) == 8 and edges.shape == (12, 2)
assert (points.min(axis=0) == numpy.float32([-0.063, -0.063, 0])).all()
assert (points.max(axis=0)[:2] == numpy.float32([0.063, 0.063])).all()
assert abs(points[:, 2].max() - max(recorded(row)[:, 2].max() for row in rows) - 0.007) < 1e-6
)";

TEST_F(ExportCommand, XdmfHasParticlesToolAndBoxInPlainDatasets) {
  makeRun();
  const ProgramResult result = runHaptolith("export --format xdmf " + file("run.h5"));
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  EXPECT_THAT(result.errors, testing::IsEmpty());
  EXPECT_THAT(result.output, testing::ContainsRegex("run-xdmf: [0-9]+ frames of the particles with velocities"));
  EXPECT_EQ(files(), (std::vector<std::string>{"run-xdmf", "run.h5"}));
  expectTrueInPython(std::string(kReaders) + R"(
grids, tools, ((_, *box, _),) = list(xdmf('particles')), list(xdmf('tool')), xdmf('box')
)" + kSame + R"(
data = h5py.File('run-xdmf/pictures.h5', 'r')
assert (data['time_s'][:] == rows['t_s']).all() and (data['tick'][:] == rows['tick']).all()
assert data.attrs['scenario'] == recording.attrs['scenario'] and data.attrs['schema'] == b'haptolith pictures'
)");
}

TEST_F(ExportCommand, VtkHasParticlesToolAndBoxInFilesOfTheirOwn) {
  makeRun();
  const ProgramResult result = runHaptolith("export --format vtk " + file("run.h5") + " --out " + file("frames"));
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  EXPECT_EQ(files(), (std::vector<std::string>{"frames", "run.h5"}));
  expectTrueInPython(std::string(kReaders) + R"(
grids, tools, box = pvd('particles', 'frames'), pvd('tool', 'frames'), vtu('box.vtu', 'frames')[:2]
for time, _, _, arrays in grids + tools:
    assert arrays['TimeValue'] == float(time)
)" + kSame);
  const ProgramResult again = runHaptolith("export --format vtk " + file("run.h5") + " --out " + file("frames"));
  EXPECT_EQ(again.exit_status, 1);
  EXPECT_THAT(again.errors, HasSubstr("frames already exists"));
}

TEST_F(ExportCommand, ParticlesAsCsvAreThoseOfVtk) {
  makeRun();
  ASSERT_EQ(runHaptolith("export --format vtk " + file("run.h5")).exit_status, 0);
  const ProgramResult result = runHaptolith("export --format particles-csv " + file("run.h5"));
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  ASSERT_EQ(runHaptolith("export --format csv " + file("run.h5")).exit_status, 0);
  expectTrueInPython(std::string(kReaders) + R"(
table = pandas.read_csv('run-particles.csv', float_precision='round_trip')
assert list(table.columns) == ('t_s tick id x_m y_m z_m radius_m contact_force_n vx_m_s vy_m_s vz_m_s').split()
pictures = list(table.groupby('tick'))
assert len(pictures) == len(rows)
for (tick, picture), row, (_, points, _, arrays) in zip(pictures, rows, pvd('particles')):
    assert tick == row['tick'] and (picture.t_s == row['t_s']).all()
    assert (picture[['x_m', 'y_m', 'z_m']].to_numpy('f4') == points).all()
    assert (picture[['vx_m_s', 'vy_m_s', 'vz_m_s']].to_numpy('f4') == arrays['velocity_m_s']).all()
    for name in ('id', 'radius_m', 'contact_force_n'):
        assert (picture[name].to_numpy(arrays[name].dtype) == arrays[name]).all(), name
joined = table.merge(pandas.read_csv('run.csv', float_precision='round_trip'), on='t_s')
assert len(joined) >= len(table) - rows[0]['count'] and 'tool_z_m' in joined
)");
}

TEST_F(ExportCommand, AFilmHasTheMessagesOfAPage) {
  makeRun();
  const ProgramResult result = runHaptolith("export --format film " + file("run.h5"));
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  EXPECT_EQ(files(), (std::vector<std::string>{"run.film", "run.h5"}));
  expectTrueInPython(R"(
import h5py, json, numpy, struct
film = open('run.film', 'rb').read()
assert film[:16] == b'haptolith film 1'
messages, at = [], 16
while at < len(film):
    size, kind = struct.unpack_from('<IB', film, at)
    messages.append((kind, film[at + 5:at + 5 + size]))
    at += 5 + size
hello, scene = (json.loads(text) for kind, text in messages[:2])
assert hello['type'] == 'hello' and hello['client'] == 1 and hello['read_only'], hello
assert scene['type'] == 'scene' and scene['particles'] == 256 and scene['soil']['preset'] == 'P3'
frames = [frame for kind, frame in messages[2:] if kind == 2]
recorded = h5py.File('run.h5')
assert len(frames) == len(messages) - 2 == len(recorded['particles/frames']), len(frames)
low, high = (numpy.array(scene['quantised'][end]) for end in ('low_m', 'high_m'))
records = numpy.zeros((256, 4), '<u2')
positions, rows = recorded['particles/position'], recorded['particles/frames'][:]
for number, frame in enumerate(frames):
    time_s, = struct.unpack_from('<d', frame, 8)
    particles, runs, count = struct.unpack_from('<III', frame, 108)
    assert particles == 256 and (number > 0 or count == 256)
    values = numpy.frombuffer(frame, '<u2', 4 * count, 128 + 8 * runs).reshape(-1, 4)
    for first, some in numpy.frombuffer(frame, '<u4', 2 * runs, 128).reshape(-1, 2):
        records[first:first + some], values = values[:some], values[some:]
    shown_m = low + records[:, :3] / 65535 * (high - low)
    first = int(rows[number]['first'])
    assert numpy.abs(shown_m - positions[first:first + 256]).max() < (high - low).max() / 65535
    assert time_s == rows[number]['t_s']
)");
}

TEST_F(ExportCommand, WithoutAReplayAllButVelocitiesIsThere) {
  makeRun();
  for (const char* format : {"vtk", "xdmf", "particles-csv"}) {
    const ProgramResult result = runHaptolith(fmt::format("export --no-replay --format {} {}", format, file("run.h5")));
    ASSERT_EQ(result.exit_status, 0) << result.errors;
    EXPECT_THAT(result.errors, testing::IsEmpty());
    EXPECT_THAT(result.output, HasSubstr(" frames of the particles without velocities"));
  }
  expectTrueInPython(std::string(kReaders) + R"(
assert list(pandas.read_csv('run-particles.csv'))[3:] == ['x_m', 'y_m', 'z_m', 'radius_m', 'contact_force_n']
for _, points, _, arrays in pvd('particles') + list(xdmf('particles')):
    assert set(arrays) - {'TimeValue'} == {'id', 'radius_m', 'contact_force_n'}
assert len(pvd('tool')) == len(list(xdmf('tool'))) >= len(rows) - 1
)");
}

TEST_F(ExportCommand, SaysWhyThereAreNoVelocities) {
  makeRecording(400, 20);  // begins in mid-run
  const ProgramResult result = runHaptolith("export --format vtk " + file("run.h5"));
  EXPECT_EQ(result.exit_status, 0);
  EXPECT_THAT(result.errors, HasSubstr("13 of 13 frames have no velocities"));
  EXPECT_THAT(result.errors, HasSubstr("began at tick 7"));
}

TEST_F(ExportCommand, AnUnfinishedRecordingIsExportedToo) {
  runInShell(fmt::format("timeout -s KILL 1 \"$RECORDING_HELPER\" record '{}'", file("run.h5")));
  EXPECT_EQ(runHaptolith("export --format csv " + file("run.h5")).exit_status, 0);
  EXPECT_EQ(runHaptolith("export --format vtk " + file("run.h5")).exit_status, 0);
  EXPECT_EQ(runHaptolith("export --format xdmf " + file("run.h5")).exit_status, 0);
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

TEST_F(ExportCommand, InterruptedAmongPicturesNothingHalfIsLeftBehind) {
  makeRecording(40'000, 2000);
  for (const std::string format : {"particles-csv", "xdmf", "vtk"}) {
    // As soon as there is something half done.
    const ProgramResult stopped = runInShell(fmt::format(
        "cd '{0}' && {{ \"$HAPTOLITH\" export --format {1} run.h5 & }} && "
        "for i in $(seq 1000); do ls -A | grep -q part && break; sleep 0.01; done && kill -INT $! && wait $!",
        folder_.string(), format));
    EXPECT_EQ(stopped.exit_status, 1) << format;
    EXPECT_THAT(stopped.errors, HasSubstr("interrupted"));
    EXPECT_EQ(files(), std::vector<std::string>{"run.h5"}) << format;
  }
}

TEST_F(ExportCommand, AFullDiskIsToldByName) {
  makeRecording(400, 5000);
  for (const auto& [format, name] : {std::pair{"xdmf", "run-xdmf/pictures.h5"},
                                     {"vtk", "run-vtk/particles-"},
                                     {"particles-csv", "run-particles.csv"}}) {
    const ProgramResult full = runInShell(
        fmt::format("trap '' XFSZ; ulimit -f 100; \"$HAPTOLITH\" export --format {} '{}'", format, file("run.h5")));
    EXPECT_EQ(full.exit_status, 1) << format;
    EXPECT_THAT(full.errors, testing::AllOf(HasSubstr("cannot write"), HasSubstr(name), HasSubstr("File too large")));
    EXPECT_EQ(files(), std::vector<std::string>{"run.h5"}) << format;
  }
}

TEST_F(ExportCommand, SaysWhatItHasWritten) {
  makeRecording(400, 20);
  EXPECT_EQ(runHaptolith("export --format csv " + file("run.h5")).output, "saved " + file("run.csv") + ": 400 ticks\n");
  for (const std::string format : {"xdmf", "vtk"}) {
    EXPECT_THAT(runHaptolith("export --format " + format + " " + file("run.h5")).output,
                HasSubstr(file("run-" + format) + ": 13 frames"));
  }
  EXPECT_THAT(runHaptolith("export --format particles-csv " + file("run.h5")).output,
              HasSubstr(file("run-particles.csv") + ": 13 frames"));
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
    for (const char* format : {"csv", "particles-csv", "xdmf", "vtk"}) {
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
    EXPECT_TRUE(fs::exists(file(std::string(name) + "-vtk")));
  }
}

TEST_F(ExportCommand, ReplacesAFileOnlyWhenAskedTo) {
  makeRecording(40, 2);
  std::ofstream(file("notes.csv")) << "mine";
  const std::string command = fmt::format("export '{}' --format csv --out '{}'", file("run.h5"), file("notes.csv"));
  const ProgramResult refused = runHaptolith(command);
  EXPECT_EQ(refused.exit_status, 1);
  EXPECT_THAT(refused.errors, HasSubstr("notes.csv already exists: choose another name, or add --overwrite"));
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
