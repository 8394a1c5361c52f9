// A bed on its way to LAMMPS and back, as a user sends it: export, lmp, import, run.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "program.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

using Rows = std::vector<std::vector<double>>;

class ToLammps : public testing::Test {
 protected:
  ToLammps() : folder_(fs::path(testing::TempDir()) / fmt::format("haptolith_lammps_{}", getpid())) {
    fs::create_directories(folder_);
    std::ofstream(folder_ / "springs.toml") << R"(
[soil]
friction_model = "contact"
radius_mm = 6
stiffness_n_m = 1000
gamma_nm = 0.004194
rho0_kg_m3 = 1330
rho_max_kg_m3 = 1824
contact_friction = 0.4
size_spread = 0.15
[bed]
start = "settled"
width_mm = 100
length_mm = 100
depth_mm = 50
)";
  }
  ~ToLammps() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// Numbers of a table whose lines begin with one.
  [[nodiscard]] Rows numbers(const std::string& name) const {
    Rows rows;
    std::ifstream file(path(name));
    for (std::string line; std::getline(file, line);) {
      std::ranges::replace(line, ',', ' ');
      std::istringstream words(line);
      std::vector<double> row;
      for (double number = 0; words >> number;) {
        row.push_back(number);
      }
      if (!row.empty()) {
        rows.push_back(row);
      }
    }
    return rows;
  }

  static bool hasLammps() { return runInShell("command -v lmp").exit_status == 0; }
  [[nodiscard]] ProgramResult lammps(const std::string& name) const {
    return runInShell(fmt::format("cd {} && lmp -in in.haptolith -log none > said.txt", path(name)));
  }

  fs::path folder_;
};

TEST_F(ToLammps, GoesABedAndComesBackAsItLay) {
  const ProgramResult exported =
      runHaptolith(fmt::format("export {} --format lammps --out {} --duration-s 0.2", path("springs.toml"), path("l")));
  ASSERT_EQ(exported.exit_status, 0) << exported.errors;
  EXPECT_THAT(exported.output, HasSubstr("lmp -in in.haptolith"));
  EXPECT_EQ(exported.errors, "") << "springs are what LAMMPS has";
  if (!hasLammps()) {
    GTEST_SKIP() << "needs Debian's package lammps";
  }
  ASSERT_EQ(lammps("l").exit_status, 0);
  const ProgramResult imported =
      runHaptolith(fmt::format("import {} --out {}", path("l/soil.lammpstrj"), path("back.toml")));
  ASSERT_EQ(imported.exit_status, 0) << imported.errors;
  // As dense: the bed lay, and lies.
  double before_m = 0, after_m = 0, grains = 0;
  for (const std::vector<double>& row : numbers("l/bed.data")) {
    if (row.size() == 7 && row[2] > 0.005) {  // an atom's line: id type diameter density x y z
      before_m += row[6];
      ++grains;
    }
  }
  const Rows back = numbers("back.csv");
  ASSERT_EQ(static_cast<double>(back.size()), grains);
  for (const std::vector<double>& row : back) {
    after_m += row[2];
  }
  EXPECT_NEAR(after_m / before_m, 1, 0.01);
  // At rest, to be felt.
  const ProgramResult run = runHaptolith(fmt::format(
      "run {} --motion still --duration-s 0.5 --no-realtime --record {} --json", path("back.toml"), path("back.h5")));
  ASSERT_EQ(run.exit_status, 0) << run.errors;
  ASSERT_EQ(runHaptolith(fmt::format("export {} --format particles-csv --out {}", path("back.h5"), path("p.csv")))
                .exit_status,
            0);
  double fastest_m_s = 0;
  std::size_t looked = 0;
  for (const std::vector<double>& row : numbers("p.csv")) {
    if (row.size() >= 11) {
      fastest_m_s = std::max({fastest_m_s, std::abs(row[8]), std::abs(row[9]), std::abs(row[10])});
      ++looked;
    }
  }
  EXPECT_GT(looked, back.size());
  EXPECT_LT(fastest_m_s, 1e-4);
}

TEST_F(ToLammps, GoesTheToolOfARecording) {
  std::ofstream(folder_ / "down.csv") << "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0.08,1,0,0,0\n0.4,0,0,0.045,1,0,0,0\n"
                                         "0.6,0,0,0.045,1,0,0,0\n";
  const ProgramResult run = runHaptolith(
      fmt::format("run {} --poses {} --set hand.compliance=rigid --duration-s 0.6 --no-realtime --record {}",
                  path("springs.toml"), path("down.csv"), path("run.h5")));
  ASSERT_EQ(run.exit_status, 0) << run.errors;
  ASSERT_EQ(runHaptolith(fmt::format("export {} --format csv --out {}", path("run.h5"), path("run.csv"))).exit_status,
            0);
  const ProgramResult exported =
      runHaptolith(fmt::format("export {} --format lammps --out {}", path("run.h5"), path("l")));
  ASSERT_EQ(exported.exit_status, 0) << exported.errors;
  EXPECT_THAT(exported.output, HasSubstr("a tool of "));
  const ProgramResult later =
      runHaptolith(fmt::format("export {} --format lammps --from-s 0.3 --out {}", path("run.h5"), path("later")));
  ASSERT_EQ(later.exit_status, 0) << later.errors;
  EXPECT_TRUE(fs::exists(path("later/in.haptolith")));
  const ProgramResult after =
      runHaptolith(fmt::format("export {} --format lammps --from-s 5 --out {}", path("run.h5"), path("after")));
  EXPECT_EQ(after.exit_status, 2);
  if (!hasLammps()) {
    GTEST_SKIP() << "needs Debian's package lammps";
  }
  ASSERT_EQ(lammps("l").exit_status, 0);
  // Pressed 7.5 mm into soil that cannot go aside the shovel is held up, by spheres that are stiffer the deeper a grain
  // is in them: the mean of the last 0.1 s in both.
  double ours_n = 0, theirs_n = 0, ours = 0, theirs = 0;
  std::ifstream heading(path("run.csv"));
  std::string names;
  std::getline(heading, names);
  const std::string before = names.substr(0, names.find("soil_fz_n"));
  const auto column = static_cast<std::size_t>(std::ranges::count(before, ','));
  std::ifstream table(path("run.csv"));
  for (std::string line; std::getline(table, line);) {
    std::vector<std::string> cells;
    std::istringstream words(line);
    for (std::string cell; std::getline(words, cell, ',');) {
      cells.push_back(cell);
    }
    if (cells.size() > column && cells[0] != "t_s" && std::stod(cells[0]) > 0.5) {
      ours_n += std::stod(cells[column]);
      ++ours;
    }
  }
  for (const std::vector<double>& row : numbers("l/tool.txt")) {
    if (row.size() == 11 && row[1] > 0.5) {
      theirs_n += row[4];
      ++theirs;
    }
  }
  ASSERT_GT(theirs, 50);
  EXPECT_GT(ours_n / ours, 0.2);
  EXPECT_NEAR((theirs_n / theirs) / (ours_n / ours), 1.2, 0.4);
}

TEST_F(ToLammps, GoesNothingThatLammpsDoesNotHave) {
  const ProgramResult other = runHaptolith(fmt::format("export icra2021 --format lammps --out {}", path("l")));
  EXPECT_EQ(other.exit_status, 2);
  EXPECT_THAT(other.errors, HasSubstr("no other engine has it"));
  const ProgramResult stones = runHaptolith(fmt::format("export stones --format lammps --out {}", path("l")));
  EXPECT_EQ(stones.exit_status, 2);
  EXPECT_THAT(stones.errors, HasSubstr("nothing that turns is exported"));
  EXPECT_FALSE(fs::exists(path("l")));
  const ProgramResult times =
      runHaptolith(fmt::format("export {} --format lammps --from-s 2 --out {}", path("springs.toml"), path("l")));
  EXPECT_EQ(times.exit_status, 2);
  EXPECT_THAT(times.errors, HasSubstr("a scene has no recorded times"));
}

TEST_F(ToLammps, FormerOptionsStillWork) {
  const ProgramResult exported = runHaptolith(
      fmt::format("export {} --format lammps --out {} --run-s 0.2 --own-law", path("springs.toml"), path("l")));
  EXPECT_EQ(exported.exit_status, 0) << exported.errors;
  EXPECT_THAT(exported.errors, HasSubstr("--run-s is now --duration-s"));
  EXPECT_THAT(exported.errors, HasSubstr("--own-law is now --pair-style=haptolith"));
  EXPECT_THAT(exported.output, HasSubstr("built with haptolith's law"));
  const ProgramResult imported =
      runHaptolith(fmt::format("import {} --out {} --picture 1", path("none.lammpstrj"), path("l/dug.toml")));
  EXPECT_NE(imported.exit_status, 0);
  EXPECT_THAT(imported.errors, HasSubstr("--picture is now --frame"));
}

TEST_F(ToLammps, GoesADumpToVtk) {
  const std::string head = "\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS ff ff fm\n-1 1\n-1 1\n0 1\n";
  std::ofstream(path("soil.lammpstrj")) << "ITEM: TIMESTEP\n0\nITEM: TIME\n0" << head
                                        << "ITEM: ATOMS id type x y z radius vx vy vz\n"
                                        << "7 1 0.5 0 0 0.25 0 0 -2\n3 2 0 0 0 0.125 0 0 0\n"
                                        << "ITEM: TIMESTEP\n400\nITEM: TIME\n0.1" << head
                                        << "ITEM: ATOMS id type x y z radius vx vy vz\n"
                                        << "7 1 0.5 0 0 0.25 0 0 -2\n3 2 0 0 0 0.125 0 0 0\n"
                                        << "ITEM: TIMESTEP\n800\nITEM: NUMBER OF ATOMS\n2\n";  // still being written
  const ProgramResult result = runHaptolith("export " + path("soil.lammpstrj") + " --format vtk");
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("2 frames of the particles"));
  const auto text = [&](const std::string& name) {
    std::ifstream file(path("soil-vtk/" + name), std::ios::binary);
    return std::string{std::istreambuf_iterator<char>(file), {}};
  };
  EXPECT_THAT(text("particles.pvd"), HasSubstr("timestep=\"0.1\" file=\"particles-000001.vtu\""));
  const std::string vtu = text("particles-000001.vtu");
  EXPECT_THAT(vtu, HasSubstr("NumberOfPoints=\"2\""));
  // Arrays lie behind the description, each with its size in bytes before it, in the order of ids.
  const auto floats = [&](const std::string& name, std::size_t count) {
    const std::size_t at = vtu.find("offset=\"", vtu.find("Name=\"" + name + "\"")) + 8;
    const std::size_t from = vtu.find("encoding=\"raw\">\n_") + 17 + std::stoul(vtu.substr(at)) + 8;
    std::vector<float> values(count);
    std::memcpy(values.data(), vtu.data() + from, count * sizeof(float));
    return values;
  };
  EXPECT_EQ(floats("radius_m", 2), (std::vector<float>{0.125F, 0.25F}));
  EXPECT_EQ(floats("velocity_m_s", 6), (std::vector<float>{0, 0, 0, 0, 0, -2}));
  EXPECT_EQ(floats("Points", 6), (std::vector<float>{0, 0, 0, 0.5F, 0, 0}));
  EXPECT_EQ(runHaptolith("export " + path("soil.lammpstrj") + " --format vtk").exit_status, 1);  // it is there
  std::ofstream(path("bad.lammpstrj")) << "ITEM: TIMESTEP\n0" << head << "ITEM: ATOMS id x y\n1 0 0\n2 0 0\n";
  const ProgramResult bad = runHaptolith("export " + path("bad.lammpstrj") + " --format vtk");
  EXPECT_EQ(bad.exit_status, 2);
  EXPECT_THAT(bad.errors, HasSubstr("bad.lammpstrj:9"));
  EXPECT_FALSE(fs::exists(path("bad-vtk")));
  const std::string again =
      fmt::format("ITEM: TIMESTEP\n0{}ITEM: ATOMS id x y z radius\n1 0 0 0 0.1\n2 0 0 1 0.1\n", head);
  std::ofstream(path("twice.lammpstrj")) << again << again;
  EXPECT_THAT(runHaptolith("export " + path("twice.lammpstrj") + " --format vtk").errors,
              HasSubstr("2 frames have the step or time 0"));
}

TEST_F(ToLammps, ComesNothingThatIsNoDump) {
  std::ofstream(folder_ / "no.txt") << "x,y\n1,2\n";
  const ProgramResult no_scene = runHaptolith(fmt::format("import {} --out {}", path("no.txt"), path("x.toml")));
  EXPECT_EQ(no_scene.exit_status, 2);
  EXPECT_THAT(no_scene.errors, HasSubstr("scene"));
  const ProgramResult no_dump =
      runHaptolith(fmt::format("import {} --scene {} --out {}", path("no.txt"), path("springs.toml"), path("x.toml")));
  EXPECT_EQ(no_dump.exit_status, 2);
  EXPECT_THAT(no_dump.errors, HasSubstr("no.txt:1"));
  std::ofstream(folder_ / "tool.txt") << "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS ff ff ff\n"
                                         "0 1\n0 1\n0 1\nITEM: ATOMS id type x y z radius\n1 7 0 0 0.01 0.006\n";
  const ProgramResult no_soil = runHaptolith(
      fmt::format("import {} --scene {} --out {}", path("tool.txt"), path("springs.toml"), path("x.toml")));
  EXPECT_EQ(no_soil.exit_status, 2);
  EXPECT_THAT(no_soil.errors, HasSubstr("type 1 (soil)"));
  EXPECT_FALSE(fs::exists(path("x.toml")));
  EXPECT_FALSE(fs::exists(path("x.csv")));
  EXPECT_EQ(
      runHaptolith(fmt::format("import {} --scene {} --out {}", path("no.txt"), path("springs.toml"), path("x.csv")))
          .exit_status,
      2)
      << "a scene's name ends in .toml";
  std::ofstream(folder_ / "x.toml") << "mine";
  EXPECT_EQ(
      runHaptolith(fmt::format("import {} --scene {} --out {}", path("no.txt"), path("springs.toml"), path("x.toml")))
          .exit_status,
      1)
      << "no file is written over unasked";
}

}  // namespace
}  // namespace haptolith
