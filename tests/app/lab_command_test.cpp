#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <string>

#include "program.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

class LabCommand : public testing::Test {
 protected:
  LabCommand() { fs::create_directories(folder_); }
  ~LabCommand() override { fs::remove_all(folder_); }

  fs::path folder_ = fs::temp_directory_path() / ("haptolith_lab_" + std::to_string(getpid()));
};

TEST_F(LabCommand, FreeFallPrintsOneJsonObjectAndWritesFigureAndTrace) {
  const fs::path figure = folder_ / "fall.svg";
  const fs::path trace = folder_ / "fall.csv";
  const ProgramResult result =
      runHaptolith("lab free-fall --json --figure " + figure.string() + " --trace " + trace.string());
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  const json answer = json::parse(result.output);
  EXPECT_EQ(answer.at("test"), "free-fall");
  EXPECT_EQ(answer.at("soil"), "lunar-0-15cm");
  EXPECT_EQ(answer.at("friction"), "contact");
  EXPECT_NEAR(answer.at("acceleration_ratio").get<double>(), 1, 1e-3);
  EXPECT_GT(fs::file_size(figure), 1000U);
  std::string header;
  std::getline(std::ifstream(trace) >> std::ws, header);
  EXPECT_EQ(header, "time_s,fallen_m,free_fall_m");
}

TEST_F(LabCommand, Icra2021FrictionHangsInSpace) {
  const ProgramResult result = runHaptolith("lab free-fall --friction-model icra2021 --json");
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  EXPECT_LT(json::parse(result.output).at("acceleration_ratio").get<double>(), 0.1);
}

TEST_F(LabCommand, AcceptsTheNameOfATestInAnEarlierVersion) {
  const ProgramResult result = runHaptolith("lab fall --fall-m 0.05 --json");
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  EXPECT_EQ(json::parse(result.output).at("test"), "free-fall");
  EXPECT_THAT(result.errors, HasSubstr("lab fall is now lab free-fall; the old name works until version 0.4"));
}

TEST_F(LabCommand, ImpossibleTargetsAreRefusedWithWhatCanBeReached) {
  const std::string rest = " --bulk-density-kg-m3 1500 --json";
  const ProgramResult angle = runHaptolith("soil calibrate --friction-angle-deg 80 --cohesion-pa 0" + rest);
  EXPECT_EQ(angle.exit_status, 2);
  EXPECT_THAT(angle.errors, HasSubstr("friction_angle_deg = 80 is not valid: must be 20 to 52"));
  const ProgramResult cohesion = runHaptolith("soil calibrate --friction-angle-deg 40 --cohesion-pa 1e6" + rest);
  EXPECT_EQ(cohesion.exit_status, 2);
  EXPECT_THAT(cohesion.errors, HasSubstr("must be 0 to 4500"));
}

TEST_F(LabCommand, ProgressInATerminalNeverGoesBack) {
  const ProgramResult result = runInShell("script -qefc '\"$HAPTOLITH\" lab payload' /dev/null");
  EXPECT_EQ(result.exit_status, 0);
  const std::regex percent(R"((\d+) %[:,])");
  int last = 0, shown = 0;
  for (std::sregex_iterator it(result.output.begin(), result.output.end(), percent), end; it != end; ++it, ++shown) {
    const int now = std::stoi((*it)[1]);
    EXPECT_GE(now, last);
    last = now;
  }
  EXPECT_GE(shown, 2) << result.output;
}

TEST_F(LabCommand, NonsenseIsRefused) {
  EXPECT_EQ(runHaptolith("lab").exit_status, 2);
  EXPECT_EQ(runHaptolith("lab dig").exit_status, 2);
  const ProgramResult soil = runHaptolith("lab free-fall --soil lunar-0-51cm");
  EXPECT_EQ(soil.exit_status, 2);
  EXPECT_THAT(soil.errors, HasSubstr("lunar-0-15cm"));
  EXPECT_EQ(runHaptolith("lab free-fall --body Nowhere").exit_status, 2);
  EXPECT_EQ(runHaptolith("lab free-fall --friction-model none").exit_status, 2);
  EXPECT_EQ(runHaptolith("lab free-fall --radius-mm -3").exit_status, 2);
  EXPECT_EQ(runHaptolith("lab shear --normal-pa 100,200").exit_status, 2);
  EXPECT_EQ(runHaptolith("lab rft --size-factor 1").exit_status, 2);
  for (const char* seed : {"-1", "1.5", "99999999999999999999"}) {
    EXPECT_EQ(runHaptolith(std::string("lab free-fall --seed ") + seed).exit_status, 2) << seed;
  }
  EXPECT_THAT(runHaptolith("lab blade --depth-mm 1000").errors, HasSubstr("must be 3e+06 or less"));
  EXPECT_THAT(runHaptolith("lab blade --soil-cohesion-pa 100").errors, HasSubstr("given with friction_angle_deg"));
  EXPECT_THAT(runHaptolith("lab plate --measure-strength --friction-angle-deg 9").errors, HasSubstr("left out"));
  EXPECT_EQ(runHaptolith("lab free-fall --figure nowhere/at/all.svg").exit_status, 1);
}

TEST_F(LabCommand, RefusesInTheUnitThatWasGiven) {
  EXPECT_THAT(runHaptolith("lab blade --rake-deg 20").errors,
              HasSubstr("rake_deg = 20 is not valid: must be 30 to 120 (deg)"));
  EXPECT_THAT(runHaptolith("lab blade --depth-mm 3").errors,
              HasSubstr("depth_mm = 3 is not valid: must be 12 to 10000 (mm)"));
  EXPECT_THAT(runHaptolith("lab plate --plate-diameter-mm 3").errors,
              HasSubstr("plate_diameter_mm = 3 is not valid: must be 28 to 2857 (mm)"));
  EXPECT_THAT(runHaptolith("lab rft --friction-angle-deg 80").errors,
              HasSubstr("friction_angle_deg = 80 is not valid: must be 0 to 63 (deg)"));
}

}  // namespace
}  // namespace haptolith
