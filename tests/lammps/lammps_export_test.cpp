#include "haptolith/lammps/lammps_export.h"

#include <gmock/gmock.h>

#include <cmath>
#include <sstream>
#include <string>

#include "haptolith/bed/start/bed_tile.h"
#include "haptolith/core/error.h"
#include "haptolith/soil/contact_law.h"

namespace haptolith {
namespace {

using testing::HasSubstr;
using testing::Not;

BedParameters springs() {
  BedParameters bed;
  bed.soil.friction = FrictionModel::kContact;
  bed.soil.stiffness_n_m = 1000;
  bed.soil.gamma_nm = linearGamma(bed.soil);
  bed.soil.size_spread = 0.2;
  bed.start = BedStart::kPacked;
  return bed;
}

/// Lines behind a heading, up to the next empty one.
std::vector<std::string> section(const std::string& text, const std::string& heading) {
  std::istringstream lines(text.substr(text.find(heading)));
  std::string line;
  std::getline(lines, line);
  std::getline(lines, line);
  std::vector<std::string> rows;
  while (std::getline(lines, line) && !line.empty()) {
    rows.push_back(line);
  }
  return rows;
}

TEST(LammpsExport, WritesEachGrainWithItsSizeAndMass) {
  const Bed bed(springs());
  const LammpsFiles files = lammpsFiles(bed, {.title = "a bed", .program = "haptolith", .dt_s = 2e-4, .duration_s = 1});
  const std::vector<std::string> atoms = section(files.data, "Atoms # sphere");
  ASSERT_EQ(atoms.size(), bed.particles());
  for (std::size_t i = 0; i < atoms.size(); ++i) {
    std::istringstream row(atoms[i]);
    double id = 0, type = 0, diameter = 0, density = 0, x = 0, y = 0, z = 0;
    row >> id >> type >> diameter >> density >> x >> y >> z;
    const Float4& p = bed.state().position[i];
    EXPECT_EQ(id, static_cast<double>(i + 1));
    EXPECT_EQ(type, LammpsRun::kSoil);
    EXPECT_NEAR(diameter, 2 * (bed.parameters().soil.radius_m + p.w), 1e-10);
    EXPECT_NEAR(density * M_PI / 6 * std::pow(diameter, 3), bed.mass(), 1e-7 * bed.mass());
    EXPECT_NEAR(x, p.x, 1e-8);
    EXPECT_NEAR(z, p.z, 1e-8);
  }
  EXPECT_THAT(files.setup, HasSubstr("Also as in haptolith: sizes, and the contact law"));
  EXPECT_THAT(files.setup, HasSubstr("vector 0 0 -1.625"));
  EXPECT_THAT(files.setup, Not(HasSubstr("group           tool")));
  EXPECT_THAT(files.path, HasSubstr("run             5000"));
}

TEST(LammpsExport, HasWallsWhereTheyAre) {
  const BedParameters parameters = springs();
  const std::string plain = lammpsFiles(Bed(parameters), {.dt_s = 1e-4, .duration_s = 1}).setup;
  EXPECT_THAT(plain, HasSubstr("xplane -0.063 0.063"));
  EXPECT_THAT(plain, HasSubstr("boundary        f f fm"));
  BedParameters periodic = parameters;
  periodic.periodic_x = true;
  const std::string endless = lammpsFiles(Bed(periodic), {.dt_s = 1e-4, .duration_s = 1}).setup;
  EXPECT_THAT(endless, HasSubstr("boundary        p f fm"));
  EXPECT_THAT(endless, Not(HasSubstr("xplane")));
  BedParameters settled = parameters;
  settled.start = BedStart::kSettled;
  const Bed bed(settled);
  const LammpsFiles files = lammpsFiles(bed, {.dt_s = 1e-4, .duration_s = 1});
  const double wall_m = 0.063 + heldWidth(settled);
  EXPECT_THAT(files.setup, HasSubstr(fmt::format("xplane {:.9g} {:.9g}", -wall_m, wall_m)));
  std::size_t held = 0;
  for (const std::string& row : section(files.data, "Atoms # sphere")) {
    held += row.find(" 2 ") == row.find(' ') ? 1 : 0;
  }
  EXPECT_EQ(held, bed.heldParticles());
  EXPECT_GT(held, 0U);
}

TEST(LammpsExport, LetsTheToolGoItsWay) {
  const Bed bed(springs());
  ToolParameters tool;
  // A tenth of a second, a pose each millisecond: to the right, and once round the vertical in 2 s.
  std::vector<TimedPose> path;
  for (int i = 0; i <= 100; ++i) {
    const double t = 1e-3 * i;
    path.push_back({t, {Vec3(0.1 * t, 0, 0.1), Quat(Eigen::AngleAxisd(M_PI * t, Vec3::UnitZ()))}});
  }
  const LammpsFiles files = lammpsFiles(bed, {.dt_s = 1e-4, .tool = &tool, .path = path});
  EXPECT_GT(files.tool_spheres, 100U);
  EXPECT_EQ(section(files.data, "Atoms # sphere").size(), bed.particles() + files.tool_spheres);
  EXPECT_THAT(files.setup, HasSubstr("pair_coeff      1*2 3 hooke "));
  long steps = 0;
  std::istringstream lines(files.path);
  for (std::string line; std::getline(lines, line);) {
    double value = 0;
    if (std::sscanf(line.c_str(), "variable vx equal %lf", &value) == 1) {
      EXPECT_NEAR(value, 0.1, 1e-6);
    } else if (std::sscanf(line.c_str(), "variable wz equal %lf", &value) == 1) {
      EXPECT_NEAR(value, M_PI, 1e-6);
    } else if (std::sscanf(line.c_str(), "run %lf", &value) == 1) {
      steps += std::lround(value);
    }
  }
  EXPECT_EQ(steps, 1000);
}

TEST(LammpsExport, AddsWhatIsLackingByATableOfElevenSizes) {
  BedParameters parameters = springs();
  parameters.soil.contact_cohesion_n = 0.2;
  const Bed bed(parameters);
  const LammpsFiles files = lammpsFiles(bed, {.dt_s = 1e-4, .duration_s = 1});
  EXPECT_EQ(files.soil_types, 11);
  EXPECT_THAT(files.setup, HasSubstr("group           soil type 1:11"));
  EXPECT_THAT(files.setup, HasSubstr("group           held type 12"));
  EXPECT_THAT(files.setup, HasSubstr("hybrid/overlay granular table linear 4000"));
  EXPECT_THAT(files.setup, HasSubstr("pair_coeff      2 4 table rest.table REST_4"));
  // Two of the middle size.
  const std::vector<std::string> rows = section(files.table.substr(files.table.find("REST_10\n")), "N ");
  ASSERT_EQ(rows.size(), 2000U);
  double before_j = 0, before_m = 0, before_n = 0, apart = 0;
  for (const std::string& row : rows) {
    double number = 0, a_m = 0, energy_j = 0, force_n = 0;
    std::istringstream(row) >> number >> a_m >> energy_j >> force_n;
    EXPECT_NEAR(force_n, number == 2000 ? 0 : restForce(files.law, bed.law(), 0, a_m), 1e-6);
    if (number > 1) {
      apart = std::max(apart, std::abs((before_j - energy_j) / (a_m - before_m) - (force_n + before_n) / 2));
    }
    before_j = energy_j;
    before_m = a_m;
    before_n = force_n;
  }
  EXPECT_LT(apart, 1e-2) << "energies fall by what forces do";
  // Each grain is of its bin's size.
  const auto atoms = section(files.data, "Atoms # sphere");
  const double spread_m = 0.2 * bed.parameters().soil.radius_m;
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    std::istringstream row(atoms[i]);
    double id = 0, type = 0, diameter_m = 0;
    row >> id >> type >> diameter_m;
    const double middle_m = spread_m * ((2 * type - 1) / 11 - 1);
    EXPECT_LE(std::abs(bed.state().position[i].w - middle_m), spread_m / 11 + 1e-9);
    EXPECT_NEAR(diameter_m / 2, bed.parameters().soil.radius_m + middle_m + files.law.larger_m, 1e-9);
  }
}

TEST(LammpsExport, WritesOurOwnLawWithOneTypeAndNoTable) {
  BedParameters parameters = springs();
  parameters.soil.gamma_nm /= 20;
  parameters.soil.contact_cohesion_n = 0.02;
  const Bed bed(parameters);
  const LammpsFiles files = lammpsFiles(bed, {.dt_s = 2e-4, .duration_s = 1, .law = LammpsLaw::kHaptolith});
  EXPECT_EQ(files.soil_types, 1);
  EXPECT_EQ(files.table, "");
  EXPECT_THAT(files.setup, HasSubstr("pair_style      granular\npair_coeff      * * haptolith 0.014 "));
  EXPECT_THAT(files.setup, HasSubstr("wall/gran granular haptolith 0.014 "));
  EXPECT_THAT(files.setup, HasSubstr("extras/lammps"));
  EXPECT_THAT(files.setup, Not(HasSubstr("Different: ")));
  // Radii reach as far as cohesion does; the dump has the grains' own.
  const double reach_m = bed.law().cohesion_range_m / 2;
  std::istringstream row(section(files.data, "Atoms # sphere").front());
  double id = 0, type = 0, diameter = 0, density = 0;
  row >> id >> type >> diameter >> density;
  EXPECT_NEAR(diameter, 2 * (parameters.soil.radius_m + bed.state().position[0].w + reach_m), 1e-9);
  EXPECT_NEAR(density * M_PI / 6 * std::pow(diameter, 3), bed.mass(), 1e-7 * bed.mass());
  EXPECT_THAT(files.setup, HasSubstr("variable        radius atom c_sphere-0.0014"));
}

TEST(LammpsExport, RefusesJawsAndAToolWithoutAWay) {
  const Bed bed(springs());
  ToolParameters tool;
  EXPECT_THROW((void)lammpsFiles(bed, {.dt_s = 1e-4, .tool = &tool}), InvalidParameter);
  tool.shape = ToolShape::kJaws;
  EXPECT_THROW((void)lammpsFiles(bed, {.dt_s = 1e-4, .tool = &tool, .path = {{0, {}}, {1, {}}}}), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
