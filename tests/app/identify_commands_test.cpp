#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "program.h"

namespace haptolith {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

class IdentifyCommands : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string in(const std::string& name) const { return (folder_ / name).string(); }

  std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / ("haptolith-identify-" + std::to_string(getpid()));
};

// As a stranger would: where to go, going there, what soil it was.
TEST_F(IdentifyCommands, TellTheSoilOfAScene) {
  const ProgramResult probe = runHaptolith("identify probe --scene probe-field --out " + in("probe.csv"));
  EXPECT_EQ(probe.exit_status, 0) << probe.errors;
  const std::size_t at = probe.errors.find("--origin-mm ");
  ASSERT_NE(at, std::string::npos) << probe.errors;
  const std::string origin = probe.errors.substr(at, probe.errors.find('\n', at) - at);
  const ProgramResult run = runHaptolith("run probe-field --no-realtime --no-serve --poses " + in("probe.csv") +
                                         " --trace " + in("measured.csv"));
  EXPECT_EQ(run.exit_status, 0) << run.errors;

  const std::string soil = "identify soil " + in("measured.csv") + " " + origin;
  const ProgramResult told = runHaptolith(soil + " --soil-out " + in("found.toml"));
  EXPECT_EQ(told.exit_status, 0) << told.errors;
  EXPECT_THAT(told.output, AllOf(HasSubstr("111 of 111 windows"), HasSubstr("friction angle"), HasSubstr("density"),
                                 HasSubstr("not identified")));
  const json numbers = json::parse(runHaptolith(soil + " --json").output).at("soil");
  EXPECT_NEAR(numbers.at("friction_angle_deg").at("median").get<double>(), 41.7, 4);
  EXPECT_NEAR(numbers.at("cohesion_pa").at("median").get<double>(), 545, 300);
  EXPECT_NEAR(numbers.at("tool_friction_angle_deg").at("median").get<double>(), 19.8, 4);
  EXPECT_EQ(numbers.at("strange"), false);

  EXPECT_EQ(
      runHaptolith("run probe-field --no-realtime --no-serve --duration-s 0.01 --set soil.file=" + in("found.toml"))
          .exit_status,
      0);
  const ProgramResult again = runHaptolith(soil + " --soil-out " + in("found.toml"));
  EXPECT_EQ(again.exit_status, 1);
  EXPECT_THAT(again.errors, HasSubstr("--overwrite"));
}

// Part by part: where to begin, its information, and the next part.
TEST_F(IdentifyCommands, ChooseTheNextPart) {
  const ProgramResult first = runHaptolith("identify next --origin-mm 0,0,60.4 --out " + in("first.csv"));
  EXPECT_EQ(first.exit_status, 0) << first.errors;
  EXPECT_THAT(first.output, AllOf(HasSubstr("0 of 6 parts are measured"), HasSubstr("Next: cut 35 mm, upright")));
  EXPECT_EQ(
      runHaptolith("run probe-field --no-realtime --no-serve --poses " + in("first.csv") + " --trace " + in("one.csv"))
          .exit_status,
      0);
  const std::string measured = in("one.csv") + " --origin-mm 0,0,60.4";
  EXPECT_THAT(runHaptolith("identify soil " + measured).output,
              AllOf(HasSubstr("1 of 6 parts"), HasSubstr("cut 35 mm, upright   from 0.0")));

  const json next = json::parse(runHaptolith("identify next --json " + measured + " --out " + in("second.csv")).output);
  EXPECT_EQ(next.at("gains").size(), 5U);
  EXPECT_EQ(next.at("next"), next.at("gains")[0].at("name"));
  EXPECT_TRUE(std::filesystem::exists(in("second.csv")));
  EXPECT_EQ(runHaptolith("identify next " + measured + " --out " + in("second.csv")).exit_status, 1) << "it is there";
  const ProgramResult enough =
      runHaptolith("identify next " + measured + " --target-width 60,3000,60 --out " + in("no.csv"));
  EXPECT_THAT(enough.output, HasSubstr("no other part is needed"));
  EXPECT_FALSE(std::filesystem::exists(in("no.csv")));
}

TEST_F(IdentifyCommands, TellDensityFromAScoop) {
  {
    std::ofstream table(in("weighed.csv"));
    table << "t_s,x_m,y_m,z_m,qw,qx,qy,qz,soil_fx_n,soil_fy_n,soil_fz_n\n";
    for (int i = 0; i < 1000; ++i) {
      const double force_n = (i < 500 ? 0.8 : 0.7) + 1e-3 * (i % 7 - 3);
      table << 0.01 * i << ",0,0,0.1,1,0,0,0,0,0," << force_n << '\n';
    }
  }
  const std::string density =
      "identify density " + in("weighed.csv") + " --empty-s 0,4 --full-s 6,9.9 --gravity-m-s2 2";
  const json told = json::parse(runHaptolith(density + " --volume-cm3 40,2 --json").output);
  EXPECT_NEAR(told.at("mass_kg").at("median").get<double>(), 0.05, 1e-4);
  EXPECT_NEAR(told.at("density_kg_m3").at("median").get<double>(), 1250, 3);
  EXPECT_NEAR(told.at("density_kg_m3").at("interval_90")[0].get<double>(), 1250 / 1.09, 15);
  EXPECT_THAT(runHaptolith(density).output, AllOf(HasSubstr("50.0"), HasSubstr("--volume-cm3")));
  EXPECT_THAT(runHaptolith("identify density " + in("weighed.csv") + " --empty-s 0,4 --full-s 9,6").errors,
              HasSubstr("--full-s"));
}

TEST_F(IdentifyCommands, TrainingGoesOnWhereItStopped) {
  std::ofstream(in("poses.csv")) << "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0.01,1,0,0,0\n1,0,0,-0.0075,1,0,0,0\n";
  const std::string train = "identify train --poses " + in("poses.csv") + " --out " + in("mine.json") +
                            " --set bed.width_mm=140 --set bed.length_mm=140 --set bed.depth_mm=50 --soils ";
  EXPECT_EQ(runHaptolith(train + "1").exit_status, 0);
  EXPECT_EQ(runHaptolith(train + "2").exit_status, 1) << "it is there";
  const ProgramResult more = runHaptolith(train + "2 --resume");
  EXPECT_EQ(more.exit_status, 0) << more.errors;
  EXPECT_THAT(more.errors, AllOf(HasSubstr("1 of 2"), HasSubstr("not enough soils yet")));
  std::ifstream file(in("mine.json"));
  EXPECT_EQ(json::parse(file).at("runs").size(), 2U);
}

TEST_F(IdentifyCommands, SayWhatIsWrong) {
  std::ofstream(in("else.csv")) << "t_s,x_m,y_m,z_m,qw,qx,qy,qz,soil_fx_n,soil_fy_n,soil_fz_n\n"
                                   "0,1,1,1,1,0,0,0,0,0,0\n0.1,1,1,1,1,0,0,0,0,0,0\n";
  const ProgramResult elsewhere = runHaptolith("identify soil " + in("else.csv"));
  EXPECT_EQ(elsewhere.exit_status, 1);
  EXPECT_THAT(elsewhere.errors, HasSubstr("--origin-mm"));
  std::ofstream(in("mm.csv")) << "t_s,x_m,y_m,z_m,qw,qx,qy,qz,soil_fx_n,soil_fy_n,soil_fz_n\n"
                                 "0,20,30,140,1,0,0,0,0,0,0\n1,20,30,30,1,0,0,0,0,0,0\n";
  EXPECT_THAT(runHaptolith("identify soil " + in("mm.csv")).errors, HasSubstr("metres"));
  EXPECT_EQ(runHaptolith("identify soil /nonexistent.csv").exit_status, 2);
  EXPECT_EQ(runHaptolith("identify").exit_status, 2);
  std::ofstream(in("bad.json")) << "{}";
  const ProgramResult bad = runHaptolith("identify soil " + in("else.csv") + " --training " + in("bad.json"));
  EXPECT_EQ(bad.exit_status, 2);
  EXPECT_THAT(bad.errors, HasSubstr("haptolith_training"));
  EXPECT_THAT(runHaptolith("identify soil " + in("else.csv") + " --origin-mm 1,2").errors, HasSubstr("--origin-mm"));
  EXPECT_EQ(runHaptolith("identify train --soils 0 --out " + in("t.json")).exit_status, 2);
  std::ofstream(in("there.json")) << "mine";
  const ProgramResult there = runHaptolith("identify train --out " + in("there.json"));
  EXPECT_EQ(there.exit_status, 1);
  EXPECT_THAT(there.errors, HasSubstr("--overwrite"));
}

}  // namespace
}  // namespace haptolith
